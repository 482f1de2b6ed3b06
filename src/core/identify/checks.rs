//! Checks of the model on the data that it was identified from. An interval knows only what scatters; where the form itself
//! fails, nothing that rests on it is pinned.

use super::confidence::demote;
use super::friction::FrictionFit;
use super::legs::{Amplitude, LegFit};
use super::sums::LegSums;
use super::zero::Zero;
use crate::model::{Both, Direction, Model};
use crate::numerics::statistics::mean;

/// The zeros that both directions ask for differ by at most this many standard errors (a chance of 1 in 10,000) ...
const ZEROS_AGREE: f64 = 4.0;
/// ... or by this, rad: 0.1 deg moves mu_c by 0.001.
const ZEROS_NEGLIGIBLE_RAD: f64 = 1.7e-3;
/// The zero is certainly at most this many times as far off as was declared.
const FAR_OFF: f64 = 1.1;
/// A has no trend over speed: Spearman's rank correlation in standard errors (a chance of 1 in 10,000).
const TREND: f64 = 4.0;
/// Share of the legs, slowest and fastest, whose A are compared for the size of a trend.
const ENDS: f64 = 1.0 / 3.0;

/// One check.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Its name in files.
    pub name: &'static str,
    /// How the dotted names begin of the parameters that rest on it.
    pub concerns: Vec<String>,
    /// What was found, dimensionless.
    pub value: f64,
    /// The most that passes.
    pub limit: f64,
    /// What failed, with its likely cause; empty where another warning says it.
    pub failure: String,
}

impl Check {
    /// Whether the model passes.
    pub fn passes(&self) -> bool {
        // What cannot be computed cannot fail.
        self.value.is_nan() || self.value <= self.limit
    }

    /// What failed, if it did.
    pub fn warning(&self) -> Option<String> {
        (!self.passes() && !self.failure.is_empty()).then(|| self.failure.clone())
    }

    /// Takes `pinned` from the parameters of `model` that rest on it, if it failed.
    pub fn demote(&self, model: &mut Model) {
        if !self.passes() {
            let concerned = |name: &String| self.concerns.iter().any(|prefix| name.starts_with(prefix.as_str()));
            demote(model.confidence.iter_mut().filter(|(name, _)| concerned(name)).map(|(_, known)| known));
        }
    }
}

/// The checks of the legs; `legs` are those of `sums`, in their order.
pub(super) fn of_sweeps(fits: &Both<FrictionFit>, zero: &Zero, legs: &[LegFit], sums: &[LegSums]) -> Vec<Check> {
    let mut checks: Vec<Check> = Direction::BOTH.into_iter().map(|d| line(&fits.of(d).a, d)).collect();
    checks.extend(zero.is_fitted().then(|| declaration(zero)));
    checks.extend(zeros(zero));
    checks.extend(Direction::BOTH.into_iter().map(|d| trend(&fits.of(d).a, d, legs, sums)));
    checks
}

fn friction_of(direction: Direction) -> Vec<String> {
    vec![format!("friction.{}.", direction.name())]
}

/// Whether the legs follow A sin(theta + z) + B.
fn line(a: &Amplitude, direction: Direction) -> Check {
    let (value, limit) = (if a.fixed { 0.0 } else { a.misfit }, a.misfit_limit());
    Check { name: "legs_follow_line", concerns: friction_of(direction), value, limit, failure: String::new() }
}

/// Whether the zero is about as far off as was declared: beyond, something else is as likely.
fn declaration(zero: &Zero) -> Check {
    let value = (zero.rad.abs() - zero.half_width_rad).max(0.0) / zero.declared_rad;
    let failure = format!(
        "the legs ask for a zero of the position of {:.2} deg, which is declared to be right within {:.2} deg: a wrong zero, or \
         another load that follows the position; correct it, or declare position_zero_rad in [uncertainty]; until then no \
         friction parameter counts as pinned",
        zero.rad.to_degrees(),
        zero.declared_rad.to_degrees()
    );
    let concerns = vec!["friction.".to_string()];
    Check { name: "zero_as_declared", concerns, value, limit: FAR_OFF, failure }
}

/// Whether both directions give the same zero: they share the encoder.
fn zeros(zero: &Zero) -> Option<Check> {
    let ((up, se_up), (down, se_down)) = (zero.by_direction.up?, zero.by_direction.down?);
    let apart = (up - down).abs();
    let value = if apart <= ZEROS_NEGLIGIBLE_RAD { 0.0 } else { apart / se_up.hypot(se_down) };
    let failure = format!(
        "moving up the legs ask for a zero of the position of {:.2} deg, moving down for {:.2} deg, {value:.0} standard errors \
         apart: something beside gravity follows the position (a spring, friction that varies with position, drift); until it is \
         found no friction parameter counts as pinned",
        up.to_degrees(),
        down.to_degrees()
    );
    Some(Check {
        name: "directions_agree_on_zero",
        concerns: vec!["friction.".to_string()],
        value,
        limit: ZEROS_AGREE,
        failure,
    })
}

/// Whether A is the same at all speeds.
fn trend(a: &Amplitude, direction: Direction, legs: &[LegFit], sums: &[LegSums]) -> Check {
    let mine = legs.iter().zip(sums).filter(|(leg, _)| leg.direction == direction);
    let mut by_duration: Vec<(f64, f64)> = mine.map(|(leg, sums)| (sums.duration_s, leg.a_nm)).collect();
    by_duration.sort_by(|x, y| x.0.total_cmp(&y.0));
    let values: Vec<f64> = by_duration.iter().map(|leg| leg.1).collect();
    let number = values.len();
    let ends = ((ENDS * number as f64) as usize).min(number);
    let (fast_nm, slow_nm) = (mean(&values[..ends]), mean(&values[number - ends..]));
    let is_small = ends == 0 || (fast_nm - slow_nm).abs() <= a.given_zero_nm;
    let value = if is_small || a.fixed { 0.0 } else { spearman(&by_duration).abs() * (number as f64 - 1.0).sqrt() };
    let failure = format!(
        "moving {}, A goes from {fast_nm:.4} N m in the fastest legs to {slow_nm:.4} in the slowest, where (17) has one A at all \
         speeds: a torque that drifts during a trial, or a load that follows the speed; nothing of this direction counts as pinned",
        direction.name()
    );
    Check { name: "a_at_all_speeds", concerns: friction_of(direction), value, limit: TREND, failure }
}

/// Spearman's rank correlation of pairs sorted by the first; equal firsts share their mean rank.
fn spearman(sorted: &[(f64, f64)]) -> f64 {
    let ranks = |values: &dyn Fn(usize) -> f64| {
        let mut order: Vec<usize> = (0..sorted.len()).collect();
        order.sort_by(|a, b| values(*a).total_cmp(&values(*b)));
        let mut ranks = vec![0.0; sorted.len()];
        let mut at = 0;
        for group in order.chunk_by(|a, b| values(*a) == values(*b)) {
            let rank = at as f64 + (group.len() as f64 - 1.0) / 2.0;
            group.iter().for_each(|i| ranks[*i] = rank);
            at += group.len();
        }
        ranks
    };
    let (x, y) = (ranks(&|i| sorted[i].0), ranks(&|i| sorted[i].1));
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let sum = |a: &[f64], mean_a: f64, b: &[f64], mean_b: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
    };
    sum(&x, mean_x, &y, mean_y) / (sum(&x, mean_x, &x, mean_x) * sum(&y, mean_y, &y, mean_y)).sqrt()
}
