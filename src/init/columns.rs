//! Which column holds what: by its name, its unit, and what it does: time grows evenly, a velocity is a position's derivative.

use super::guess::{common_step, position_unit, slope_on_derivative, time_unit, too_far};
use super::measure::Measure;
use super::motion::is_rest;
use super::names::{Label, label};
use crate::dynamics::JointKind;
use crate::import::Series;
use crate::numerics::statistics::extent;
use crate::units::{Quantity, Unit};
use std::collections::{BTreeMap, BTreeSet};

/// Slope of a velocity on the derivative of a position at which they are one motion in one unit.
const SAME: std::ops::Range<f64> = 0.9..1.1;
/// Correlation of a velocity with the derivative of the position it belongs to.
const DERIVATIVE: f64 = 0.6;
/// Correlation from which a column without a name is taken for another one's derivative.
const IS_DERIVATIVE: f64 = 0.95;

/// A column chosen for a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its key under `[columns]`.
    pub key: String,
    /// Its name in the file.
    pub name: String,
    /// What a reading of 1 is.
    pub measure: Measure,
    /// Why this column and this unit.
    pub why: String,
    /// What data cannot tell of it.
    pub question: Option<String>,
}

/// The columns of a campaign, as far as they are told.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// How the joint moves.
    pub kind: JointKind,
    /// Time first, then position and torque, where each was found.
    pub columns: Vec<Choice>,
    /// Sample rate to be asked for, where no column holds time.
    pub lacks_time: bool,
    /// The joints that the files hold; the empty name where names tell none.
    pub joints: Vec<String>,
    /// The joint whose columns were chosen.
    pub joint: String,
    /// What was left out, and why.
    pub notes: Vec<String>,
}

impl Chosen {
    /// Whether torque can only follow from the command.
    pub fn is_position_alone(&self) -> bool {
        let has = |quantity| self.of(quantity).is_some();
        has(Quantity::Command) && !has(Quantity::Torque) && !has(Quantity::Current)
    }

    /// The column chosen for `quantity`.
    pub fn of(&self, quantity: Quantity) -> Option<&Choice> {
        self.columns.iter().find(|choice| choice.key == quantity.name())
    }
}

/// What is known beforehand.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// The joint to take where files hold several.
    pub joint: Option<String>,
    /// How it moves.
    pub kind: Option<JointKind>,
    /// Names of columns, by key under `[columns]`.
    pub columns: BTreeMap<String, String>,
    /// What a reading of 1 is, by key under `[columns]`.
    pub measures: BTreeMap<String, Measure>,
    /// Sample rate where no column holds time, Hz.
    pub rate_hz: Option<f64>,
}

struct Labelled<'a> {
    label: Label,
    series: &'a Series,
}

/// Chooses among the `columns` of a recording, whose row of units is `units`.
pub fn choose(columns: &[Series], units: &[String], known: &Known) -> Chosen {
    let unit_row = |at: usize| units.get(at).map_or("", String::as_str);
    let labelled: Vec<Labelled<'_>> = columns
        .iter()
        .enumerate()
        .map(|(at, series)| Labelled { label: told(label(&series.name, unit_row(at)), &series.name, known), series })
        .collect();
    let (taken, chosen, notes) = (BTreeSet::new(), Vec::new(), Vec::new());
    let mut chooser = Chooser { all: labelled, known, taken, chosen, notes };
    let time = chooser.time();
    let joints = chooser.joints();
    let kind = known.kind.unwrap_or_else(|| chooser.kind());
    let joint = chooser.position(kind, &joints);
    chooser.torque(kind, &joint);
    chooser.current(&joint);
    chooser.velocity(kind, &joint, time);
    chooser.others(kind, &joint);
    let Chooser { chosen, notes, .. } = chooser;
    Chosen { kind, columns: chosen, lacks_time: time.is_none(), joints, joint, notes }
}

/// `label` of the column `name`, where it is known which column holds what.
fn told(mut label: Label, name: &str, known: &Known) -> Label {
    let of = |key: &str| known.columns.get(key).is_some_and(|column| column == name);
    match Quantity::ASKED.into_iter().find(|quantity| of(quantity.name())) {
        Some(quantity) => (label.quantity, label.joint) = (Some(quantity), known.joint.clone().unwrap_or_default()),
        None => label.quantity = label.quantity.filter(|quantity| !known.columns.contains_key(quantity.name())),
    }
    label
}

struct Chooser<'a> {
    all: Vec<Labelled<'a>>,
    known: &'a Known,
    taken: BTreeSet<usize>,
    chosen: Vec<Choice>,
    notes: Vec<String>,
}

impl Chooser<'_> {
    fn free(&self) -> impl Iterator<Item = (usize, &Labelled<'_>)> {
        self.all.iter().enumerate().filter(|(at, _)| !self.taken.contains(at))
    }

    /// Takes a column; what is known of its unit counts before what was found.
    fn take(
        &mut self,
        at: usize,
        key: &str,
        found: impl Into<Measure>,
        why: impl Into<String>,
        question: Option<String>,
    ) {
        self.taken.insert(at);
        let name = self.all[at].series.name.clone();
        let known = self.known.measures.get(key).map(|known| (*known, "unit as given".to_string(), None));
        let (measure, why, question) = known.unwrap_or_else(|| (found.into(), why.into(), question));
        self.chosen.push(Choice { key: key.to_string(), name, measure, why, question });
    }

    /// The time: even and growing. Gives its step in s.
    fn time(&mut self) -> Option<f64> {
        let growing: Vec<usize> =
            self.free().filter(|(_, l)| common_step(&l.series.values).is_some()).map(|(at, _)| at).collect();
        let is_named = |at: &&usize| self.all[**at].label.quantity == Some(Quantity::Time);
        let is_counter = |at: usize| {
            let Labelled { label, series } = &self.all[at];
            let counts = || series.values.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
            label.unit.is_none() && (label.is_counter || label.quantity.is_none()) && counts()
        };
        let named = growing.iter().find(is_named).copied();
        // A position that only grows is growing too: unnamed, only what begins every recording's columns is taken, and an x axis
        // only where another column is the position.
        let is_unnamed = |at: &usize| self.all[*at].label.quantity.is_none() && !is_counter(*at);
        let positions = self.all.iter().filter(|l| l.label.quantity == Some(Quantity::Position)).count();
        let is_axis = |at: &usize| *at == 0 && self.all[*at].label.is_axis && positions > 1;
        let unnamed = || growing.iter().copied().find(is_unnamed);
        let found = named.or_else(unnamed).or_else(|| growing.iter().copied().find(is_axis));
        for at in growing.iter().filter(|at| Some(**at) != found && is_counter(**at)) {
            self.taken.insert(*at);
        }
        let at = found?;
        let step = common_step(&self.all[at].series.values)?;
        let (unit, why, question) = match self.all[at].label.unit {
            Some(unit) => (unit, "unit from the header".to_string(), None),
            None => time_unit(step),
        };
        self.take(at, Quantity::Time.name(), unit, why, question);
        self.chosen.last().map(|time| step * time.measure.factor())
    }

    /// The joints that have a position, in the order of their columns.
    fn joints(&self) -> Vec<String> {
        let mut joints: Vec<String> = Vec::new();
        for (_, l) in self.free().filter(|(_, l)| l.label.quantity == Some(Quantity::Position)) {
            if !joints.contains(&l.label.joint) {
                joints.push(l.label.joint.clone());
            }
        }
        joints
    }

    fn kind(&self) -> JointKind {
        let lengths = Quantity::Position.units(JointKind::Prismatic);
        let is_length = |unit: Option<Unit>| unit.is_some_and(|unit| lengths.contains(&unit));
        if let Some(known) = self.known.measures.get(Quantity::Position.name()) {
            return if is_length(Some(known.unit)) { JointKind::Prismatic } else { JointKind::Revolute };
        }
        let mut positions = self.free().filter(|(_, l)| l.label.quantity == Some(Quantity::Position)).peekable();
        let is_slide = positions.peek().is_some() && positions.all(|(_, l)| is_length(l.label.unit));
        if is_slide { JointKind::Prismatic } else { JointKind::Revolute }
    }

    /// Takes the position; gives its joint.
    fn position(&mut self, kind: JointKind, joints: &[String]) -> String {
        let known = self.known;
        let named: Vec<usize> = self
            .free()
            .filter(|(_, l)| l.label.quantity == Some(Quantity::Position))
            .filter(|(_, l)| known.joint.as_ref().is_none_or(|joint| l.label.joint == *joint))
            .map(|(at, _)| at)
            .collect();
        let moving: Vec<usize> = named.iter().copied().filter(|at| !is_rest(&self.all[*at].series.values)).collect();
        let at = moving.first().or(named.first()).copied().or_else(|| self.smoothest());
        let Some(at) = at else {
            self.notes.push("no column could be told to be the position".to_string());
            return known.joint.clone().unwrap_or_default();
        };
        let Labelled { label, series } = &self.all[at];
        let joint = label.joint.clone();
        let (unit, why, mut question) = match label.unit {
            Some(unit) => (unit, "unit from the header".to_string(), too_far(kind, unit, &series.values)),
            None => position_unit(kind, &series.values),
        };
        if named.is_empty() {
            question = Some(
                "which column is the position (--column position=NAME), and in which unit? This one is the likeliest"
                    .to_string(),
            );
        } else if joints.len() > 1 && known.joint.is_none() && moving.len() != 1 {
            let all: Vec<&str> = joints.iter().map(String::as_str).collect();
            question = Some(format!("which joint? The files hold {} (--joint)", all.join(", ")));
        } else if moving.len() > 1 && named.len() > 1 {
            let all: Vec<&str> = moving.iter().map(|at| self.all[*at].series.name.as_str()).collect();
            question = Some(format!("which of {} is the joint's position?", all.join(", ")));
        }
        if joints.len() > 1 && known.joint.is_none() && moving.len() == 1 {
            self.notes.push(format!("of the joints {} only {joint} moves", joints.join(", ")));
        }
        self.take(at, Quantity::Position.name(), unit, why, question);
        joint
    }

    /// The column whose derivative is another one, or that changes least from sample to sample, of those that move.
    fn smoothest(&self) -> Option<usize> {
        let roughness = |values: &[f64]| {
            let (low, high) = extent(values);
            let steps: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            if high > low { steps / (high - low) } else { f64::INFINITY }
        };
        let unnamed = || self.free().filter(|(_, l)| l.label.quantity.is_none());
        // A column whose derivative is another one is the position.
        let has_derivative = |values: &[f64]| {
            unnamed().any(|(_, other)| slope_on_derivative(&other.series.values, values, 1.0, IS_DERIVATIVE).is_some())
        };
        if let Some((at, _)) = unnamed().find(|(_, l)| has_derivative(&l.series.values)) {
            return Some(at);
        }
        unnamed()
            .map(|(at, l)| (at, roughness(&l.series.values)))
            .filter(|(_, roughness)| roughness.is_finite())
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(at, _)| at)
    }

    /// The first column of `quantity` that belongs to `joint`, or to no joint.
    fn find(&self, quantity: Quantity, joint: &str) -> Option<usize> {
        let of = |of_joint: &str| {
            let mut all = self.free().filter(|(_, l)| l.label.quantity == Some(quantity) && l.label.joint == of_joint);
            all.next().map(|(at, _)| at)
        };
        of(joint).or_else(|| of("")).or_else(|| {
            let all: Vec<usize> =
                self.free().filter(|(_, l)| l.label.quantity == Some(quantity)).map(|(at, _)| at).collect();
            if let [only] = all[..] { Some(only) } else { None }
        })
    }

    fn torque(&mut self, kind: JointKind, joint: &str) {
        let has_current = || self.find(Quantity::Current, joint).is_some();
        let named = self.find(Quantity::Torque, joint);
        let is_varied = |l: &Labelled<'_>| extent(&l.series.values).0 < extent(&l.series.values).1;
        let is_velocity = |l: &Labelled<'_>| self.is_derivative(&l.series.values);
        let unnamed = || {
            self.free()
                .find(|(_, l)| l.label.quantity.is_none() && is_varied(l) && !is_velocity(l))
                .map(|(at, _)| at)
                .filter(|_| !has_current())
        };
        let Some(at) = named.or_else(unnamed) else { return };
        let usual = if kind == JointKind::Prismatic { Unit::Newton } else { Unit::NewtonMetre };
        let (unit, why, mut question) = match self.all[at].label.unit {
            Some(unit) => (unit, "unit from the header".to_string(), None),
            None => {
                let asks = format!("unit? The header names none: `{}` only holds its place", usual.name());
                (usual, "no unit in the header".to_string(), Some(asks))
            }
        };
        if named.is_none() {
            question = Some("is this column the torque (else --column torque=NAME), and in which unit?".to_string());
        }
        self.take(at, Quantity::Torque.name(), unit, why, question);
    }

    fn current(&mut self, joint: &str) {
        let Some(at) = self.find(Quantity::Current, joint) else { return };
        let unit = self.all[at].label.unit;
        let question = unit.is_none().then(|| "unit, A or mA? The header names none".to_string());
        self.take(at, Quantity::Current.name(), unit.unwrap_or(Unit::Ampere), "", question);
    }

    /// The velocity, if it is the derivative of the position; it tells units that the header does not.
    fn velocity(&mut self, kind: JointKind, joint: &str, step_s: Option<f64>) {
        let unnamed = || {
            let mut free = self.free().filter(|(_, l)| l.label.quantity.is_none());
            free.find(|(_, l)| self.is_derivative(&l.series.values)).map(|(at, _)| at)
        };
        let Some(at) = self.find(Quantity::Velocity, joint).or_else(unnamed) else { return };
        let position = self.chosen.iter().position(|choice| choice.key == Quantity::Position.name());
        let (Some(position), Some(step_s)) = (position, step_s) else {
            self.taken.insert(at);
            return;
        };
        let slope = self
            .of_position()
            .and_then(|from| slope_on_derivative(&self.all[at].series.values, from, step_s, DERIVATIVE));
        match slope {
            Some(slope) => self.velocity_in_units(kind, at, position, slope),
            None => self.leave_out(at, "is not taken as velocity: it does not follow the position's derivative"),
        }
    }

    /// Chooses column `at`, `slope` times the derivative of the chosen `position` as both are recorded, in units of which one is the
    /// derivative of the other.
    fn velocity_in_units(&mut self, kind: JointKind, at: usize, position: usize, slope: f64) {
        const WHY: &str = "is the position's derivative";
        const NO_UNIT: &str = "is left out: no unit makes it the position's derivative";
        let position_factor = self.chosen[position].measure.factor();
        let times = |unit: &Unit| slope * unit.factor() / position_factor;
        let fits = |unit: &Unit| SAME.contains(&times(unit));
        let key = Quantity::Velocity.name();
        match self.all[at].label.unit {
            Some(unit) if fits(&unit) => {
                self.unit_is_found(kind, position);
                self.take(at, key, unit, WHY, None);
            }
            Some(unit) if self.is_told(position) => {
                let times = times(&unit);
                self.leave_out(
                    at,
                    &format!("is left out: in {} it is {times:.3} times the position's derivative", unit.name()),
                );
            }
            Some(unit) => {
                // The velocity's unit tells the position's.
                let is_its = |of_position: &&Unit| SAME.contains(&(slope * unit.factor() / of_position.factor()));
                match Quantity::Position.units(kind).iter().find(is_its) {
                    Some(found) => {
                        self.unit_is_found(kind, position);
                        self.chosen[position].measure = (*found).into();
                        let name = &self.all[at].series.name;
                        self.chosen[position].why = format!("unit such that `{name}` is its derivative");
                        self.take(at, key, unit, WHY, None);
                    }
                    None => self.leave_out(at, NO_UNIT),
                }
            }
            None => match Quantity::Velocity.units(kind).iter().copied().find(fits) {
                Some(unit) => self.take(at, key, unit, "unit such that it is the position's derivative", None),
                None => self.leave_out(at, NO_UNIT),
            },
        }
    }

    /// Takes back the question of the unit of the chosen `position`, which its velocity's tells.
    fn unit_is_found(&mut self, kind: JointKind, position: usize) {
        let of_unit = self.of_position().and_then(|values| position_unit(kind, values).2);
        self.chosen[position].question.take_if(|question| of_unit.as_ref() == Some(question));
    }

    /// Leaves column `at` out, with a note of `why`.
    fn leave_out(&mut self, at: usize, why: &str) {
        self.taken.insert(at);
        self.notes.push(format!("`{}` {why}", self.all[at].series.name));
    }

    /// The readings of the position that was chosen.
    fn of_position(&self) -> Option<&[f64]> {
        let position = self.chosen.iter().find(|choice| choice.key == Quantity::Position.name())?;
        self.all.iter().find(|l| l.series.name == position.name).map(|l| l.series.values.as_slice())
    }

    /// Whether `values` are, in some unit, the derivative of the position that was chosen.
    fn is_derivative(&self, values: &[f64]) -> bool {
        self.of_position().is_some_and(|position| slope_on_derivative(values, position, 1.0, IS_DERIVATIVE).is_some())
    }

    /// Whether the unit of a chosen column is known or stands in the header.
    fn is_told(&self, chosen: usize) -> bool {
        self.known.measures.contains_key(&self.chosen[chosen].key)
            || self.all.iter().any(|l| l.series.name == self.chosen[chosen].name && l.label.unit.is_some())
    }

    /// The command, temperature, and the positions of other joints.
    fn others(&mut self, kind: JointKind, joint: &str) {
        if let Some(at) = self.find(Quantity::Temperature, joint) {
            self.take(at, Quantity::Temperature.name(), Unit::Celsius, "", None);
        }
        if let Some(at) = self.find(Quantity::Command, joint) {
            let unit = self.all[at].label.unit.filter(|unit| Quantity::Command.units(kind).contains(unit));
            let of_position = || self.chosen.iter().find(|c| c.key == Quantity::Position.name()).map(|c| c.measure);
            let measure = unit.map(Measure::from).or_else(of_position).unwrap_or(Unit::Radian.into());
            self.take(at, Quantity::Command.name(), measure, "", None);
        }
        let moves = |l: &Labelled<'_>| !is_rest(&l.series.values);
        let is_other =
            |l: &Labelled<'_>| l.label.quantity == Some(Quantity::Position) && l.label.joint != joint && moves(l);
        let others: Vec<usize> = self.free().filter(|(_, l)| is_other(l)).map(|(at, _)| at).collect();
        for (index, at) in others.into_iter().enumerate() {
            let key = if index == 0 { "other_position".to_string() } else { format!("other_position_{}", index + 1) };
            let unit = self.all[at].label.unit.unwrap_or_else(|| position_unit(kind, &self.all[at].series.values).0);
            self.take(at, &key, unit, "a joint beside it that moves too", None);
        }
        let left: Vec<String> = self.free().map(|(_, l)| l.series.name.clone()).collect();
        if !left.is_empty() {
            self.notes.push(format!("not used: {}", crate::limits::listed(left.iter().map(String::as_str))));
        }
    }
}
