//! What a joint, or the sensors that record it, may have beyond the paper's formula.
//!
//! One effect, one file, one entry in `LIBRARY`. An effect is a set of hooks into the formula, each a line of physics for
//! one sample; the model, the simulator and the diagnosis all go through them. With u and d the two branches of friction,
//!
//! y = w + [ (r1/r2) (G + I a + j) + K~ (u + fu) h + (1 - K~) (d + fd) h ] / (1 - mu)
//!
//! where j is `Hooks::joint_torque_nm`, fu and fd `Hooks::friction_nm`, h `Hooks::friction_factor` and w
//! `Hooks::winch_torque_nm`; G is taken where `Hooks::position_lag_rad` says the joint is; K~ changes over by
//! `Hooks::curve` and builds up elastically by `Hooks::presliding`. What the sensor makes of y comes last: `Hooks::delay_s`
//! and `Hooks::lag_s`, then `Hooks::reading_nm`, last of those that say `Effect::clips`.

mod cable_elasticity;
mod contact;
mod elastic_spring;
mod end_stop;
mod friction_ripple;
mod gravity_phase;
mod inertia;
mod joint_coupling;
mod load_dependent_friction;
mod presliding;
mod quadratic_viscous;
mod reversal_transition;
mod saturation;
mod sensor_bias;
mod sensor_drift;
mod sensor_gain;
mod stribeck;
mod time_delay;
mod torque_ripple;
mod warm_up;

mod about;
mod hooks;
mod library;
mod parameter;
mod region;
mod ripple;
mod sample;
mod transition;

pub use about::{About, ActsOn, Excitation, Family, Starts};
pub use hooks::{Evaluated, Hooks};
pub use library::{Added, CONTACT, LIBRARY, constant_load, find};
pub use parameter::{Parameter, Role};
pub use region::Region;
pub use ripple::{HARMONICS, NUMBERS as RIPPLE_NUMBERS};
pub use sample::{Carried, Extent, Sample};
pub use transition::{Curve, Presliding};

use crate::numerics::dual::Dual;
use crate::numerics::expression::Expression;
use crate::numerics::scalar::Scalar;

/// One effect: what it is, how a search treats it, and its physics in [`Hooks`]. `p` holds its parameters in the order of
/// [`About::parameters`].
pub trait Effect: Hooks<f64> + Hooks<Dual> + for<'t> Hooks<Expression<'t>> + Sync + std::fmt::Debug {
    /// What it is.
    fn about(&self) -> &'static About;

    /// Parameter sets to begin a search from, strengths at 0: where in `extent` its shape may lie. None where the campaign
    /// cannot show it.
    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>>;

    /// Whether parameter number `at` does anything with these choices.
    fn uses(&self, _p: &[f64], _at: usize) -> bool {
        true
    }

    /// Whether what was found over `extent` is what the effect is called by.
    fn is_itself(&self, _p: &[f64], _extent: &Extent) -> bool {
        true
    }

    /// What it counts for that numbers found are those that the joint of `extent` has: so many numbers less.
    fn confirmed(&self, _p: &[f64], _extent: &Extent) -> usize {
        0
    }

    /// The most that parameter number `at` may be for a campaign to show it.
    fn most(&self, _at: usize, _extent: &Extent) -> f64 {
        f64::INFINITY
    }

    /// What it is in a simulator whose joints know a spring and an inertia.
    fn in_simulator(&self, _p: &[f64]) -> Option<SimulatorJoint> {
        None
    }

    /// The other joint that it follows, counted from 0.
    fn other_joint(&self, _p: &[f64]) -> Option<usize> {
        None
    }

    /// Whether all it does is to add torque, in proportion to its strengths.
    fn only_adds(&self) -> bool {
        true
    }

    /// Whether it goes by the time since the campaign began.
    fn needs_clock(&self, _p: &[f64]) -> bool {
        false
    }

    /// Whether its reading is the end of a range, which noise cannot pass either: it acts after all others.
    fn clips(&self) -> bool {
        false
    }
}

/// What an effect is in a simulator's joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SimulatorJoint {
    /// Inertia beyond the link's own, kg m^2.
    pub inertia_kg_m2: f64,
    /// Of a spring, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Torque of that spring at position 0, N m.
    pub preload_nm: f64,
}

/// Values from `low` to `high`, evenly spaced in their logarithm.
fn spaced(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> {
    let ratio = high / low;
    (0..count).map(move |i| low * ratio.powf(i as f64 / (count.max(2) - 1) as f64))
}

/// Speed over which Coulomb friction of an effect changes sign, rad/s: below it encoders tell no direction.
pub const RESTING_RAD_S: f64 = 0.01;

/// `time_s` or `elapsed_s` of `sample`: a clock that starts anew with each trial, or runs through the campaign.
fn clock_s<S: Scalar>(restarts: S, sample: &Sample<'_, S>) -> S {
    if restarts.value() > 0.5 { sample.time_s } else { sample.elapsed_s }
}
