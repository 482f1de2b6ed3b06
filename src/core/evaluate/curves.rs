//! The four curves to compare: the model's own, and the others with the parameters that the identification gave them.

use crate::identify::CurveKind;
use crate::model::{Combination, Model, RecordedCurve};

/// Shares of the travel at which two curves are compared.
const POINTS: usize = 200;
/// Golden section steps: the exponent is then known to 1e-6 of its range.
const STEPS: usize = 40;

/// A curve to be compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rival {
    /// Which of the four.
    pub kind: CurveKind,
    /// With its parameter.
    pub curve: Combination,
    /// The clearance that goes with it, m.
    pub backlash_m: f64,
    /// Where the parameter comes from.
    pub source: Source,
}

/// Where a rival's parameter comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// It is the model's own curve.
    Model,
    /// The identification fitted it beside the model's own.
    Identification,
    /// Not fitted: the curve of its kind that is nearest to the model's.
    Nearest,
    /// It has none.
    None,
}

impl Source {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Identification => "identification",
            Self::Nearest => "nearest to the model's curve",
            Self::None => "no parameter",
        }
    }
}

/// `sign`, `linear`, `arctan` and `power`, of which one is `model`'s own; `recorded` are those that its file lists.
pub fn rivals(model: &Model, recorded: &[RecordedCurve]) -> Vec<Rival> {
    CurveKind::ALL.into_iter().map(|kind| rival(kind, model, recorded)).collect()
}

fn rival(kind: CurveKind, model: &Model, recorded: &[RecordedCurve]) -> Rival {
    let backlash_m = model.joint.backlash_m;
    if kind.name() == model.combination.name() {
        return Rival { kind, curve: model.combination, backlash_m, source: Source::Model };
    }
    let Some(range) = kind.range() else {
        return Rival { kind, curve: kind.with(1.0), backlash_m, source: Source::None };
    };
    match recorded.iter().find(|r| r.curve.name() == kind.name()) {
        Some(found) => Rival { kind, curve: found.curve, backlash_m: found.backlash_m, source: Source::Identification },
        None => Rival { kind, curve: nearest(kind, range, &model.combination), backlash_m, source: Source::Nearest },
    }
}

/// The curve of `kind` that differs least from `own` over a whole transition, by least squares.
fn nearest(kind: CurveKind, (low, high): (f64, f64), own: &Combination) -> Combination {
    let curve = |log_parameter: f64| kind.with(log_parameter.exp());
    let misfit = |log_parameter: f64| {
        let tried = curve(log_parameter);
        (1..POINTS).map(|i| i as f64 / POINTS as f64).map(|u| (tried.share(u) - own.share(u)).powi(2)).sum::<f64>()
    };
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut from, mut to) = (low.ln(), high.ln());
    for _ in 0..STEPS {
        let (left, right) = (to - golden * (to - from), from + golden * (to - from));
        if misfit(left) < misfit(right) { to = right } else { from = left }
    }
    curve((from + to) / 2.0)
}
