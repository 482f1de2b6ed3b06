//! What changed, decided on A and B(v) rather than on parameters, which trade off.
//!
//! `observed` says how.

use super::cause::{Cause, CauseKind, Measure};
use super::observed::Observed;
use crate::model::{Combination, Model};
use crate::numerics::statistics::{HALF_WIDTH, chi_squared_tail, together};

/// Bonferroni factor: a cause is accepted when it explains more of chi squared than chance would in any of this many comparisons, with a
/// probability of 5 %: 3.5 standard errors. A dozen causes are tried in each.
const TRIED: usize = 100;
/// The observations as a whole differ when chance would give their chi squared less often than this.
const DIFFER: f64 = 1e-3;

/// What A and B(v) say of a change.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attribution {
    /// What changed, the clearest first.
    pub causes: Vec<Cause>,
    /// Chance that two identifications of an unchanged joint differ as much; NaN where nothing could be compared.
    pub chance: f64,
    /// Differences compared.
    pub compared: usize,
}

impl Attribution {
    /// Of `before` and `after`; empty where either has no A and B(v).
    /// It is one of `count` comparisons.
    pub(super) fn new(before: &Model, after: &Model, count: usize) -> Self {
        let nothing = Self { chance: f64::NAN, ..Self::default() };
        let explains = (HALF_WIDTH * together(TRIED * count)).powi(2);
        let Some(observed) = Observed::new(before, after, explains) else { return nothing };
        let compared = observed.count();
        let chance = chi_squared_tail(observed.chi_squared(), compared as f64);
        let mut causes = observed.causes();
        causes.extend(change_over(before, after, explains));
        causes.extend(zero(before, after, explains));
        Self { causes, chance: (chance * count as f64).min(1.0), compared }
    }

    /// Whether A and B(v) were compared at all.
    pub fn is_known(&self) -> bool {
        self.compared > 0
    }

    /// Whether they differ by more than chance would have it.
    pub fn differs(&self) -> bool {
        self.is_known() && (!self.causes.is_empty() || self.chance < DIFFER)
    }
}

/// A change of `change` with standard error `se` that concerns both directions, if chance does not explain it.
fn alone(kind: CauseKind, measure: Measure, change: f64, se: f64, explains: f64) -> Option<Cause> {
    let half = HALF_WIDTH * se;
    (change * change > explains * se * se).then(|| Cause {
        kind,
        direction: None,
        change,
        low: change - half,
        high: change + half,
        measure,
        rivals: Vec::new(),
    })
}

/// Standard error of the parameter called `name`; 0 where it was not estimated.
fn se(model: &Model, name: &str) -> f64 {
    model.confidence.get(name).map_or(0.0, |known| (known.high - known.low) / 2.0 / HALF_WIDTH)
}

/// Whether the travel of the change-over changed, which goes as the clearance, and less as p or n are more.
fn change_over(before: &Model, after: &Model, explains: f64) -> Option<Cause> {
    let ln = |model: &Model| {
        let (bend, name) = match model.combination {
            Combination::Arctan { p, .. } => (p, "combination.p"),
            Combination::Power { n } => (n, "combination.n"),
            Combination::Sign | Combination::Linear => (1.0, ""),
        };
        let backlash_m = model.joint.backlash_m;
        let relative = (se(model, name) / bend).hypot(se(model, "joint.backlash_m") / backlash_m);
        (backlash_m.ln() - bend.ln(), relative)
    };
    let (a, b) = (ln(before), ln(after));
    let (ratio, relative) = ((b.0 - a.0).exp(), a.1.hypot(b.1));
    // Without fitted curves nothing is known.
    let is_known = a.1 > 0.0 && b.1 > 0.0 && ratio.is_finite();
    let comparable = is_known && before.combination.name() == after.combination.name();
    comparable.then(|| alone(CauseKind::ChangeOver, Measure::Share, ratio - 1.0, ratio * relative, explains))?
}

/// Whether the zero of the position moved.
fn zero(before: &Model, after: &Model, explains: f64) -> Option<Cause> {
    let name = "dynamics.position_zero_rad";
    let change = after.dynamics.position_zero_rad - before.dynamics.position_zero_rad;
    let se = se(before, name).hypot(se(after, name));
    alone(CauseKind::Zero, Measure::Angle, change, se, explains).filter(|_| se > 0.0)
}
