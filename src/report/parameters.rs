//! The parameters of a model as rows, for every table and figure that shows them.

use super::number::{interval, significant};
use super::wording::Units;
use crate::dynamics::JointKind;
use crate::identify::stribeck::rate_limits;
use crate::identify::{Identification, zero};
use crate::model::{Combination, Confidence, Direction, Drive, Model, Status, Term};

/// One parameter, in the unit in which it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The branch that it belongs to; `None` for the combination's.
    pub direction: Option<Direction>,
    /// Its name in files, last part.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// The unit of the numbers here; empty without.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// What is known of it; `None` where it was not identified.
    pub confidence: Option<Confidence>,
    /// Whether the form that the model takes does without it.
    pub left_out: bool,
    /// Whether the interval's lower and upper end are where the search for it ended, not what the data say.
    pub searched: [bool; 2],
    /// Whether the interval is wider than what is physically possible.
    pub is_open: bool,
}

impl Parameter {
    /// Its interval in words; empty where nothing is known of it.
    pub fn interval(&self) -> String {
        let Some(known) = self.confidence.filter(|_| !self.left_out) else { return String::new() };
        if self.is_open {
            return "not identifiable".to_string();
        }
        let text = interval(self.value, known.low, known.high);
        match (text.split_once(" to "), self.searched) {
            (Some((_, high)), [true, false]) => format!("search limit to {high}"),
            (Some((low, _)), [false, true]) => format!("{low} to search limit"),
            (Some(_), [true, true]) => "all that was searched".to_string(),
            _ => text,
        }
    }
}

/// Friction of both branches, `up` first, in the order of [`Term::ALL`], then the combination.
pub fn parameters(model: &Model) -> Vec<Parameter> {
    let branches = Direction::BOTH.into_iter().flat_map(|direction| friction(model, direction));
    branches.chain(combination(model)).collect()
}

/// The seven of one branch, in the order of [`Term::ALL`].
pub fn friction(model: &Model, direction: Direction) -> [Parameter; Term::COUNT] {
    let branch = model.friction.of(direction);
    Term::ALL.map(|term| {
        let value = branch[term];
        let confidence = model.confidence.get(&term.dotted(direction)).copied();
        // What ended at its bound was fitted, even if the bound is zero.
        let open = confidence
            .is_some_and(|c| c.low == f64::NEG_INFINITY && c.high == f64::INFINITY && c.status != Status::AtBound);
        let row = Parameter {
            direction: Some(direction),
            name: term.name(),
            meaning: term.means_on(model.joint.drive),
            unit: term.unit_on(model.joint.kind, model.joint.drive),
            value,
            confidence,
            // A Stribeck term without amplitude is no term, whatever its rate says.
            left_out: branch.lacks(term) || open && value == 0.0,
            searched: [false; 2],
            is_open: false,
        };
        with_limits(row, term, direction, model)
    })
}

/// A force whose half width exceeds this many times the largest friction measured is not identifiable.
const TIMES_MEASURED: f64 = 3.0;
/// An end this close to a limit, relative to it, is the limit.
const AT_LIMIT: f64 = 1e-6;

/// `row` with what the recorded speeds and the friction that was measured say of its interval: whether an end is where the search
/// for a rate ended, and whether it is wider than any friction that the torque allows.
fn with_limits(row: Parameter, term: Term, direction: Direction, model: &Model) -> Parameter {
    let (Some(functions), Some(known)) = (model.functions.branches.of(direction), row.confidence) else { return row };
    let speeds = functions.levels.first().zip(functions.levels.last());
    let Some(range) = speeds.map(|(slow, fast)| (slow.speed_rad_s, fast.speed_rad_s)) else { return row };
    let (slow, fast) = rate_limits(range);
    let at_limit = |per_rate: f64| {
        move |end: f64| [slow, fast].iter().any(|limit| (end.abs() / (limit * per_rate) - 1.0).abs() < AT_LIMIT)
    };
    let largest_nm = functions.levels.iter().map(|level| level.b_nm.abs()).fold(0.0, f64::max);
    let largest_n = largest_nm / model.joint.winch_radius_m;
    let widest = match term {
        Term::Load => 1.0,
        Term::Coulomb | Term::CableStribeck | Term::JointStribeck => TIMES_MEASURED * largest_n,
        Term::Viscous => TIMES_MEASURED * largest_n / range.1,
        Term::CableDecay | Term::JointDecay => f64::INFINITY,
    };
    let is_open = (known.high - known.low) / 2.0 > widest;
    let searched = match term {
        Term::CableDecay => [known.low, known.high].map(at_limit(1.0 / model.joint.pulley_radius_m)),
        Term::JointDecay => [known.low, known.high].map(at_limit(1.0)),
        _ => [false; 2],
    };
    Parameter { searched, is_open, ..row }
}

/// The curve's and the clearance.
pub fn combination(model: &Model) -> Vec<Parameter> {
    let mut rows = Vec::new();
    let mut add = |name: &'static str, key: &str, meaning, unit, factor: f64, value: f64| {
        let confidence =
            model.confidence.get(key).map(|c| Confidence { low: factor * c.low, high: factor * c.high, ..*c });
        let (direction, value) = (None, factor * value);
        rows.push(Parameter {
            direction,
            name,
            meaning,
            unit,
            value,
            confidence,
            left_out: false,
            searched: [false; 2],
            is_open: false,
        });
    };
    match model.combination {
        Combination::Arctan { k, p } => {
            add("p", "combination.p", "steepness of the arctan curve", "", 1.0, p);
            add("k", "combination.k", "scale of the arctan curve; follows from p", "", 1.0, k);
        }
        Combination::Power { n } => add("n", "combination.n", "exponent of the power curve", "", 1.0, n),
        Combination::Sign | Combination::Linear => {}
    }
    // Without a cable it counts on a radius of 1 m: 1 mm is 1 mrad.
    let (meaning, unit) = match (model.joint.drive, model.joint.kind) {
        (Drive::Cable, _) => ("clearance of the cable, X_cl", "mm"),
        (_, JointKind::Revolute) => ("clearance at the joint", "mrad"),
        (_, JointKind::Prismatic) => ("clearance at the slide", "mm"),
    };
    add("backlash", "joint.backlash_m", meaning, unit, 1e3, model.joint.backlash_m);
    rows
}

/// What the intervals of the friction parameters assume, in a sentence or two; `None` where they do not come from sweeps.
pub fn rests_on(found: &Identification, units: &Units) -> Option<String> {
    found.route.sweeps()?;
    let largest = |term: Term, on: &str| {
        let of = |direction: Direction| found.rests_on.get(&term.dotted(direction));
        let moves =
            Direction::BOTH.into_iter().filter_map(of).flatten().filter(|one| one.on == on).map(|one| one.moves);
        moves.fold(0.0, f64::max)
    };
    let of_load = largest(Term::Load, "gravity or measured load");
    let of_torque = largest(Term::Coulomb, "zero of the torque");
    let zero = found.model.confidence.get(zero::NAME).map(|known| {
        let at_deg = found.model.dynamics.position_zero_rad.to_degrees();
        let half_deg = (known.high - known.low).to_degrees() / 2.0;
        format!("The position's zero is fitted: {at_deg:.3} ± {half_deg:.3} deg")
    });
    let declared = (of_load > 0.0).then(|| {
        format!(
            "gravity or the load, the radii and the torque's scale (1 % of any moves mu_c by {})",
            significant(of_load, 1)
        )
    });
    let torque = (of_torque > 0.0).then(|| {
        let milli = units.torque(1e-3);
        format!("the torque's zero ({milli} moves a_j by {} N)", significant(of_torque, 2))
    });
    let rests: Vec<String> = declared.into_iter().chain(torque).collect();
    let rests = (!rests.is_empty()).then(|| format!("The intervals assume that {} are right", rests.join(" and ")));
    let all: Vec<String> = rests.into_iter().chain(zero).collect();
    (!all.is_empty()).then(|| all.join(". "))
}
