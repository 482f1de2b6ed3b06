//! The quantities of one joint over several campaigns: every identified parameter, and the functions of the parameters (A, B(v)), each with
//! its standard error.

use super::table::Row;
use crate::compare::{change_over_m, parameters_of};
use crate::model::{Direction, Model, Status, shared_speeds};
use crate::numerics::statistics::HALF_WIDTH;

/// A run does not show a parameter whose half width exceeds this many times its value.
const WIDEST: f64 = 1.0;
/// The parameter that may well be 0.
const ZERO: &str = "dynamics.position_zero_rad";
/// Speeds at which B(v) is compared: the slowest and the fastest that all runs have, and the middle on a logarithmic scale.
const LEVELS: usize = 3;

/// One parameter or function over campaigns.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its dotted name, or the function's.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Value and standard error in each campaign; `None` where that one does not show it.
    pub values: Vec<Option<(f64, f64)>>,
}

/// What the travel of the change-over after a reversal is called.
pub(super) const CHANGE_OVER: &str = "change-over travel";

/// Every identified parameter, then A and B(v) of each direction, then the travel of the change-over.
pub(super) fn of(models: &[&Model]) -> Vec<Quantity> {
    let values = models.iter().map(|model| change_over_m(model).filter(|(_, se)| *se > 0.0)).collect();
    let travel = Quantity { name: CHANGE_OVER.to_string(), unit: "m", values };
    parameters(models).into_iter().chain(functions(models)).chain([travel]).collect()
}

/// Every parameter that was identified.
fn parameters(models: &[&Model]) -> Vec<Quantity> {
    let mut names: Vec<(String, &'static str)> = Vec::new();
    for (name, unit, _) in models.iter().flat_map(|model| parameters_of(model)) {
        let known = models.iter().any(|model| model.confidence.contains_key(&name));
        if known && !names.iter().any(|(other, _)| *other == name) {
            names.push((name, unit));
        }
    }
    let of = |name: &String, model: &Model| {
        let known = model.confidence.get(name)?;
        let se = (known.high - known.low) / 2.0 / HALF_WIDTH;
        let value = parameters_of(model).into_iter().find(|row| row.0 == *name)?.2;
        // A zero of the position is known where it is near 0, too.
        let is_told = name == ZERO || HALF_WIDTH * se <= WIDEST * value.abs();
        let shown = !matches!(known.status, Status::Flat | Status::AtBound) && is_told && se > 0.0;
        shown.then_some((value, se))
    };
    let quantity = |(name, unit): (String, &'static str)| {
        let values = models.iter().map(|model| of(&name, model)).collect();
        Quantity { name, unit, values }
    };
    names.into_iter().map(quantity).collect()
}

/// A of each direction and B(v) at some speeds.
fn functions(models: &[&Model]) -> Vec<Quantity> {
    let unit = models.first().map_or("", |model| model.joint.kind.torque_unit());
    let mut all = Vec::new();
    for direction in Direction::BOTH {
        let a = |model: &&Model| {
            let of = model.functions.branches.of(direction).as_ref()?;
            of.a_se_nm.is_finite().then_some((of.a_nm, of.a_se_nm))
        };
        let name = format!("A moving {}", direction.name());
        all.push(Quantity { name, unit, values: models.iter().map(a).collect() });
        if let Some((slowest, fastest)) = speeds(models, direction) {
            let speed = |at: usize| slowest * (fastest / slowest).powf(at as f64 / (LEVELS - 1) as f64);
            all.extend((0..LEVELS).map(|at| friction(models, direction, speed(at).clamp(slowest, fastest))));
        }
    }
    all
}

/// The slowest and the fastest speed at which every model that has any knows B(v), rad/s.
pub(super) fn speeds(models: &[&Model], direction: Direction) -> Option<(f64, f64)> {
    shared_speeds(models.iter().filter_map(|model| model.functions.branches.of(direction).as_ref()))
}

/// B at `speed_rad_s` in one direction.
pub(super) fn friction(models: &[&Model], direction: Direction, speed_rad_s: f64) -> Quantity {
    let b = |model: &&Model| model.functions.b_nm(direction, speed_rad_s).filter(|(_, se)| se.is_finite());
    let kind = models.first().map(|model| model.joint.kind).unwrap_or_default();
    Quantity {
        name: format!("B({speed_rad_s:.3} {}) moving {}", kind.speed_unit(), direction.name()),
        unit: kind.torque_unit(),
        values: models.iter().map(b).collect(),
    }
}

/// A figure of each campaign's table row that has no interval of its own, as the error of prediction.
pub(super) fn figure(rows: &[&Row], name: &str, unit: &'static str) -> Quantity {
    Quantity {
        name: name.to_string(),
        unit,
        values: rows.iter().map(|row| row.figure(name).map(|value| (value, 0.0))).collect(),
    }
}
