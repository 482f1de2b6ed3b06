//! What a joint, or the sensors that record it, may have beyond the paper's formula.
//!
//! One effect, one file, two lines here: its module and its entry in `LIBRARY`. An effect is a set of hooks into the formula, each a line of physics for
//! one sample; the model, the simulator and the diagnosis all go through them. With u and d the two branches of friction,
//!
//! y = w + [ (r1/r2) (G + I a + j) + K~ (u + fu) h + (1 - K~) (d + fd) h ] / (1 - mu)
//!
//! where j is `Hooks::joint_torque_nm`, fu and fd `Hooks::friction_nm`, h `Hooks::friction_factor` and w `Hooks::winch_torque_nm`; G is
//! taken where `Hooks::position_lag_rad` says the joint is; K~ changes over by `Hooks::curve` and builds up elastically by
//! `Hooks::presliding`. The sensor's errors are applied to y last: `Hooks::delay_s` and `Hooks::lag_s`, then `Hooks::reading_nm`, last of
//! those that say `Effect::clips`.

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
mod along;
mod clock;
mod effect;
mod library;
mod parameter;
mod region;
mod ripple;
mod sample;
mod transition;

pub use about::{About, ActsOn, Excitation, Family, Starts};
pub use along::Along;
pub use effect::{Effect, Evaluated, Hooks, SimulatorJoint};
pub use elastic_spring::{constant_load, linear_spring};
pub use library::{Added, CONTACT, find};
pub use load_dependent_friction::{friction_of_load, place_of_share, share_name};
pub use parameter::{Parameter, Role};
pub use region::Region;
pub use ripple::{HARMONICS, PERIODS_MIN};
pub use sample::{Carried, Extent, Sample};
pub use transition::{Curve, Presliding};

use clock::{clock_s, scanned, varies};

/// Every effect, in the order of the format's list.
pub const LIBRARY: [&dyn Effect; 20] = [
    &reversal_transition::ReversalTransition,
    &stribeck::Stribeck,
    &load_dependent_friction::LoadDependentFriction,
    &friction_ripple::FrictionRipple,
    &torque_ripple::TorqueRipple,
    &cable_elasticity::CableElasticity,
    &quadratic_viscous::QuadraticViscous,
    &sensor_bias::SensorBias,
    &sensor_gain::SensorGain,
    &sensor_drift::SensorDrift,
    &time_delay::TimeDelay,
    &gravity_phase::GravityPhase,
    &inertia::Inertia,
    &warm_up::WarmUp,
    &joint_coupling::JointCoupling,
    &contact::Contact,
    &elastic_spring::ElasticSpring,
    &saturation::Saturation,
    &end_stop::EndStop,
    &presliding::Bristles,
];

/// One direction's strength may be negative by this share of the other's: it is not known more precisely.
const OPPOSED_MAX: f64 = 0.3;

/// Whether the strengths of friction moving up and down are those of one: what grows in one direction and falls in the other is none.
fn grows_both_ways(up: f64, down: f64) -> bool {
    up.min(down) >= -OPPOSED_MAX * up.abs().max(down.abs())
}

/// Values from `low` to `high`, evenly spaced in their logarithm.
fn spaced(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> {
    let ratio = high / low;
    (0..count).map(move |i| low * ratio.powf(i as f64 / (count.max(2) - 1) as f64))
}

/// Speed over which Coulomb friction of an effect changes sign, rad/s: below it encoders tell no direction.
pub const RESTING_RAD_S: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::grows_both_ways;

    #[test]
    fn what_grows_in_one_direction_and_falls_in_the_other_is_no_friction() {
        assert!(grows_both_ways(0.3, 0.1) && grows_both_ways(0.3, -0.05));
        assert!(!grows_both_ways(0.3, -0.2) && !grows_both_ways(-0.1, -0.1));
    }
}
