//! Two models of one joint, before and after: what changed beyond its confidence, and what it does to the prediction.

mod attribution;
mod cause;
mod effect;
mod functions;
mod observed;
mod selection;

pub use attribution::Attribution;
pub use cause::{Cause, CauseKind, Measure};
pub use effect::{Effect, Level};
pub use functions::{FunctionChange, FunctionKind, change_over_m};

use crate::dynamics::{JointKind, Payload};
use crate::model::{Combination, Confidence, Direction, Friction, Model, Status, Term};
use crate::problem::{Problem, Problems, Result};

/// Half width of the 95 % interval of a parameter without one, as a share of the value.
const ASSUMED: f64 = 0.05;
/// Radii that differ by less than this share are the same, written with fewer digits.
const SAME: f64 = 1e-3;

/// Two models compared.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Before.
    pub before: Model,
    /// After.
    pub after: Model,
    /// Every parameter of either.
    pub changes: Vec<Change>,
    /// What both models know with its interval even where parameters trade off.
    pub functions: Vec<FunctionChange>,
    /// A and B(v), by direction, of which one of the models knows nothing: whether they changed is not known.
    pub unknown: Vec<(FunctionKind, Direction)>,
    /// Friction at some speeds, by direction: what the parameters amount to.
    pub levels: Vec<Level>,
    /// What the change does to the predicted torque.
    pub effect: Effect,
    /// What A and B(v) say of it.
    pub attribution: Attribution,
}

impl Comparison {
    /// Whether the effect leaves out gravity and inertia, which a chain holds, and with them the friction that grows with their load.
    pub fn load_is_missing(&self) -> bool {
        self.before.chain.is_some() || self.after.chain.is_some()
    }
}

/// One parameter in both models.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Its dotted name in files.
    pub name: String,
    /// Its unit as in files.
    pub unit: &'static str,
    /// Before; `None` where that model has no such parameter.
    pub before: Option<f64>,
    /// After.
    pub after: Option<f64>,
    /// 95 % interval of the change, in its unit; infinite where either model leaves the parameter open.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// What can be said.
    pub verdict: Verdict,
}

/// What can be said of a parameter's change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It changed by more than its confidence.
    Changed,
    /// Its change is within its confidence.
    Within,
    /// It is known only together with others in one of the models: look at the friction that they amount to.
    Together,
    /// One of the models does not show it, or lacks it.
    Unknown,
}

impl Verdict {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Changed => "changed",
            Self::Within => "within_confidence",
            Self::Together => "known_only_together",
            Self::Unknown => "unknown",
        }
    }
}

/// Compares `before` and `after`.
///
/// Errors: they are of different joints.
pub fn compare(before: &Model, after: &Model) -> Result<Comparison> {
    compare_among(before, after, 1)
}

/// The same of one of `count` pairs: what chance does in many counts as chance.
pub fn compare_among(before: &Model, after: &Model, count: usize) -> Result<Comparison> {
    one_joint(before, after)?;
    let speeds_rad_s = functions::speeds_rad_s(before, after, &effect::REFERENCE_SPEEDS_RAD_S);
    let changes = parameters(before, after)
        .into_iter()
        .map(|(name, unit, a, b)| change(name, unit, (a, before), (b, after)))
        .collect();
    Ok(Comparison {
        before: before.clone(),
        after: after.clone(),
        changes,
        functions: functions::functions(before, after, &speeds_rad_s),
        unknown: functions::unknown(before, after),
        levels: effect::levels(before, after, &speeds_rad_s),
        effect: Effect::new(before, after),
        attribution: Attribution::new(before, after, count),
    })
}

/// What A and B(v) alone say of one of `count` pairs.
///
/// Errors: they are of different joints.
pub fn attribution_among(before: &Model, after: &Model, count: usize) -> Result<Attribution> {
    one_joint(before, after)?;
    Ok(Attribution::new(before, after, count))
}

fn one_joint(before: &Model, after: &Model) -> Result<()> {
    let (a, b) = (&before.joint, &after.joint);
    let mut problems = Vec::new();
    let mut differs = |key: &str, one: String, other: String| {
        let what = format!("one is of {one}, the other of {other}");
        problems.push(Problem::error("the two models", what, "compare models of one joint").in_column(key));
    };
    if a.name != b.name {
        differs("joint.name", format!("`{}`", a.name), format!("`{}`", b.name));
    }
    if a.kind != b.kind {
        differs("joint.kind", a.kind.name().to_string(), b.kind.name().to_string());
    }
    if let (Some(x), Some(y)) = (&before.chain, &after.chain)
        && x.joint != y.joint
    {
        differs("dynamics.joint", format!("`{}`", x.joint), format!("`{}`", y.joint));
    }
    for (key, x, y) in [
        ("joint.winch_radius_m", a.winch_radius_m, b.winch_radius_m),
        ("joint.pulley_radius_m", a.pulley_radius_m, b.pulley_radius_m),
    ] {
        if (x - y).abs() > SAME * x {
            differs(key, format!("{x} m"), format!("{y} m"));
        }
    }
    Problems(problems).unless_errors(())
}

/// Dotted name, unit and value of every parameter that `model` has.
pub fn parameters_of(model: &Model) -> Vec<(String, &'static str, f64)> {
    parameters(model, model).into_iter().filter_map(|(name, unit, value, _)| Some((name, unit, value?))).collect()
}

type Row = (String, &'static str, Option<f64>, Option<f64>);

/// Name, unit and both values of every parameter that either has.
fn parameters(before: &Model, after: &Model) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let mut add = |name: &str, unit, of: &dyn Fn(&Model) -> Option<f64>| {
        let (a, b) = (of(before), of(after));
        if a.is_some() || b.is_some() {
            rows.push((name.to_string(), unit, a, b));
        }
    };
    // Where either takes them from a chain there is nothing to compare.
    if before.chain.is_none() && after.chain.is_none() {
        add("dynamics.gravity_nm", "N m", &|m| Some(m.dynamics.gravity_nm));
        add("dynamics.inertia_kg_m2", "kg m^2", &|m| Some(m.dynamics.inertia_kg_m2));
    }
    let is_off = |m: &Model| m.dynamics.position_zero_rad != 0.0;
    if is_off(before) || is_off(after) {
        add("dynamics.position_zero_rad", "rad", &|m| Some(m.dynamics.position_zero_rad));
    }
    if [before, after].into_iter().any(|m| !m.dynamics.payload.is_none()) {
        let units = ["kg", "kg m", "kg m", "kg m", "kg m^2"];
        for (at, (name, unit)) in Payload::<f64>::NAMES.into_iter().zip(units).enumerate() {
            add(&format!("dynamics.payload.{name}"), unit, &|m| Some(m.dynamics.payload.numbers()[at]));
        }
    }
    for direction in Direction::BOTH {
        for term in Term::ALL {
            let of = |m: &Model| present(m.friction.of(direction), term);
            add(&term.dotted(direction), term.unit(JointKind::Revolute), &of);
        }
    }
    let p = |m: &Model| if let Combination::Arctan { p, .. } = m.combination { Some(p) } else { None };
    let n = |m: &Model| if let Combination::Power { n } = m.combination { Some(n) } else { None };
    add("combination.p", "", &p);
    add("combination.n", "", &n);
    add("joint.backlash_m", "m", &|m| Some(m.joint.backlash_m));
    rows
}

/// `term`, unless it belongs to a Stribeck term without amplitude, which is no term.
fn present(friction: &Friction, term: Term) -> Option<f64> {
    (!friction.lacks(term)).then(|| friction[term])
}

fn change(name: String, unit: &'static str, a: (Option<f64>, &Model), b: (Option<f64>, &Model)) -> Change {
    let (Some(x), Some(y)) = (a.0, b.0) else {
        let verdict = Verdict::Unknown;
        return Change { name, unit, before: a.0, after: b.0, low: f64::NEG_INFINITY, high: f64::INFINITY, verdict };
    };
    // A zero without an interval: 5 % of it would mean that it is known exactly.
    let unsaid = |value: f64, model: &Model| value == 0.0 && !model.confidence.contains_key(&name);
    let known = |value: f64, model: &Model| {
        let assumed = ASSUMED * value.abs();
        model.confidence.get(&name).copied().unwrap_or(Confidence {
            low: value - assumed,
            high: value + assumed,
            cv: ASSUMED,
            status: Status::Pinned,
        })
    };
    let (of_x, of_y) = (known(x, a.1), known(y, b.1));
    // Independent errors: the half widths add as squares, each on its own side.
    let low = (y - x) - (y - of_y.low).hypot(of_x.high - x);
    let high = (y - x) + (of_y.high - y).hypot(x - of_x.low);
    let statuses = [of_x.status, of_y.status];
    let verdict = match () {
        () if x != y && (unsaid(x, a.1) || unsaid(y, b.1)) => Verdict::Unknown,
        () if statuses.iter().any(|s| matches!(s, Status::Flat | Status::AtBound)) => Verdict::Unknown,
        () if x == y || low <= 0.0 && high >= 0.0 => Verdict::Within,
        () if statuses.iter().any(|s| matches!(s, Status::TradeOff | Status::Merged)) => Verdict::Together,
        () => Verdict::Changed,
    };
    Change { name, unit, before: Some(x), after: Some(y), low, high, verdict }
}
