//! What a joint, or the sensors that record it, may have beyond the paper's formula.
//!
//! One effect, one file, one entry in `LIBRARY`. An effect is a set of hooks into the formula, each a line of physics for
//! one sample; the model, the simulator and the diagnosis all go through them. With u and d the two branches of friction,
//!
//! y = w + [ (r1/r2) (G + I a + j) + K~ (u + fu) h + (1 - K~) (d + fd) h ] / (1 - mu)
//!
//! where j is `Effect::joint_torque_nm`, fu and fd `Effect::friction_nm`, h `Effect::friction_factor` and w
//! `Effect::winch_torque_nm`; G is taken where `Effect::position_lag_rad` says the joint is; K~ changes over by
//! `Effect::curve` and builds up elastically by `Effect::presliding`. What the sensor makes of y comes last: `Effect::delay_s`
//! and `Effect::lag_s`, then `Effect::reading_nm`, last of those that say `Effect::clips`.

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
mod library;
mod parameter;
mod region;
mod ripple;
mod sample;
mod transition;

pub use about::{About, ActsOn, Excitation, Family, Starts};
pub use library::{Added, CONTACT, LIBRARY, constant_load, find};
pub use parameter::{Parameter, Role};
pub use region::Region;
pub use ripple::{HARMONICS, NUMBERS as RIPPLE_NUMBERS};
pub use sample::{Carried, Extent, Sample};
pub use transition::{Curve, Presliding};

use crate::dynamics::Both;

/// One effect: what it is, and its hooks. A hook's `p` holds the parameters in the order of [`About::parameters`].
pub trait Effect: Sync + std::fmt::Debug {
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

    /// Added to gravity and inertia, N m at the joint.
    fn joint_torque_nm(&self, _p: &[f64], _sample: &Sample<'_>) -> f64 {
        0.0
    }

    /// Added to the two branches, N m at the winch, for a load of `load_nm` there; the one of `down` is negative where it
    /// resists.
    fn friction_nm(&self, _p: &[f64], _sample: &Sample<'_>, _carried: Carried) -> Both<f64> {
        Both { up: 0.0, down: 0.0 }
    }

    /// Multiplies the friction of both branches.
    fn friction_factor(&self, _p: &[f64], _sample: &Sample<'_>) -> f64 {
        1.0
    }

    /// Added to y, N m at the winch, for a load of `load_nm` there.
    fn winch_torque_nm(&self, _p: &[f64], _sample: &Sample<'_>, _load_nm: f64) -> f64 {
        0.0
    }

    /// How far the joint is behind the measured position, rad: under a load of `load_nm` at the joint, the cable pulling with
    /// `pull_nm` there, friction and all.
    fn position_lag_rad(&self, _p: &[f64], _load_nm: f64, _pull_nm: f64) -> f64 {
        0.0
    }

    /// The arctan curve and the clearance that take the place of the model's own.
    fn curve(&self, _p: &[f64]) -> Option<Curve> {
        None
    }

    /// How friction builds up elastically.
    fn presliding(&self, _p: &[f64]) -> Option<Presliding> {
        None
    }

    /// How late the torque is recorded, s.
    fn delay_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// The time constant with which the sensor follows the torque, s.
    fn lag_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Whether all it does is to add torque, in proportion to its strengths.
    fn only_adds(&self) -> bool {
        true
    }

    /// Whether it goes by the time since the campaign began.
    fn needs_clock(&self, _p: &[f64]) -> bool {
        false
    }

    /// What the sensor reads of `torque_nm`, N m.
    fn reading_nm(&self, _p: &[f64], _sample: &Sample<'_>, torque_nm: f64) -> f64 {
        torque_nm
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
fn clock_s(restarts: f64, sample: &Sample<'_>) -> f64 {
    if restarts > 0.5 { sample.time_s } else { sample.elapsed_s }
}
