//! A torque whose steps are far larger than its noise.
//!
//! Noise of half a step or more blurs the steps, and means over many samples tell far less than one (Widrow and Kollar,
//! Quantization Noise, Cambridge 2008: a bias of q/pi exp(-2 pi^2 sigma^2/q^2)). With less, the mean over a leg is off by up
//! to a third of a step, in a way that no interval knows of. Where noise is below a third of a step two neighbours in three
//! are equal.

use super::clipped::Motion;
use crate::numerics::statistics::{extent, quantile};

/// Above this share of equal neighbours while the joint moves, noise no longer blurs the steps.
const EQUAL_SHARE: f64 = 0.65;
/// Steps below this share of the torque's range are too fine to matter.
const STEP_SHARE: f64 = 0.01;
/// A change is a whole number of steps within this share of one ...
const WHOLE: f64 = 0.02;
/// ... in at least this share of all changes.
const ON_STEPS: f64 = 0.98;
/// Changes needed to tell a step, and changes looked at.
const CHANGES: usize = 20;
const LOOKED_AT: usize = 20_000;

/// The step of `torque`, in its unit, where it is too coarse for its noise.
pub(super) fn step(position: &[f64], torque: &[f64], rate_hz: f64) -> Option<f64> {
    let equal = torque.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if (equal as f64) < 0.5 * torque.len() as f64 {
        return None;
    }
    let changes = torque.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    let mut changes: Vec<f64> = changes.take(LOOKED_AT).collect();
    let (low, high) = extent(torque);
    let step = quantile(&mut changes, 0.05);
    let is_whole = |change: &&f64| {
        let steps = **change / step;
        (steps - steps.round()).abs() <= WHOLE && steps > 0.5
    };
    let on_steps = changes.iter().filter(is_whole).count();
    if changes.len() < CHANGES
        || (on_steps as f64) < ON_STEPS * changes.len() as f64
        || step < STEP_SHARE * (high - low)
    {
        return None;
    }
    let motion = Motion::of(position, rate_hz);
    let moving = || (1..torque.len()).filter(|i| motion.is_moving(*i));
    let equal = moving().filter(|i| torque[*i] == torque[*i - 1]).count();
    (equal as f64 > EQUAL_SHARE * moving().count() as f64).then_some(step)
}
