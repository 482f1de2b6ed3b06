//! One short step of a joint under a motor's torque.
//!
//! The balance at the winch is y_motor = y + (r2/r1) J a, with y what the model asks and J the motor's inertia. It is solved for
//! the speed at the end of the step with everything taken there (backward Euler): motor torque and y then fall and rise with
//! that speed, so that there is one solution, however steep friction is. Where friction jumps at rest and the balance lies within
//! the jump, the joint sticks and y is what the motor gives: no threshold of speed is needed, and nothing chatters.

use super::super::driven::asked;
use crate::dynamics::{Chain, Motion};
use crate::effects::Sample;
use crate::model::{Asked, Direction, Model, Passage};
use crate::numerics::root;

/// Speed at either side of rest at which the direction of friction is felt, rad/s: a travel in a step that a double still tells.
const BESIDE_REST_RAD_S: f64 = 1e-9;
/// To what the balance of torques is solved, N m.
const BALANCED_NM: f64 = 1e-10;

/// The joint between steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub position_rad: f64,
    pub velocity_rad_s: f64,
    pub passage: Passage,
    /// y at the winch, before the sensor, N m.
    pub torque_nm: f64,
}

/// What does not change in a step.
pub(super) struct Plant<'a> {
    pub model: &'a Model,
    pub chain: Option<&'a Chain>,
    /// Of motor and gear about the winch, before the torque sensor, kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// The length of a step, s.
    pub step_s: f64,
}

/// What acts on the joint at the end of a step, apart from its motor.
pub(super) struct Moment<'a> {
    pub time_s: f64,
    pub elapsed_s: f64,
    pub contact_nm: f64,
    pub others: &'a [Motion],
}

/// What mass asks of the joint around where it is: to the first order in position, as in acceleration.
#[derive(Clone, Copy)]
pub(super) struct Mass {
    at_rad: f64,
    still_nm: f64,
    inertia_kg_m2: f64,
    slope_nm_rad: f64,
}

impl Mass {
    fn asked(&self, own: Motion) -> Asked {
        let gravity_nm = self.still_nm + self.slope_nm_rad * (own.position - self.at_rad);
        Asked { torque_nm: gravity_nm + self.inertia_kg_m2 * own.acceleration, slope_nm_rad: self.slope_nm_rad }
    }
}

impl Plant<'_> {
    /// What mass asks around `position_rad` at `velocity_rad_s`.
    pub fn mass(&self, position_rad: f64, velocity_rad_s: f64, others: &[Motion]) -> Mass {
        let at = |acceleration| Motion { position: position_rad, velocity: velocity_rad_s, acceleration };
        let (still, pushed) =
            (asked(self.model, self.chain, at(0.0), others), asked(self.model, self.chain, at(1.0), others));
        let slope_nm_rad = match self.chain {
            Some(chain) => {
                let of_reading = chain.torque(at(0.0), others).gravity_nm;
                let slope_nm_rad = chain.gravity_slope_nm_rad(position_rad, others);
                self.model.dynamics.at_true_position(of_reading, slope_nm_rad).1
            }
            None => still.slope_nm_rad,
        };
        let inertia_kg_m2 = pushed.torque_nm - still.torque_nm;
        Mass { at_rad: position_rad, still_nm: still.torque_nm, inertia_kg_m2, slope_nm_rad }
    }

    /// y that the model asks, a person's part included, N m.
    pub fn asked_nm(&self, own: Motion, k_tilde: f64, mass: &Mass, moment: &Moment<'_>) -> f64 {
        let sample = Sample { time_s: moment.time_s, elapsed_s: moment.elapsed_s, own, others: moment.others };
        self.model.driven_nm(&sample, mass.asked(own), k_tilde).torque_nm + moment.contact_nm
    }

    /// The joint one step on from `state`, at `moment`, under a motor whose torque at the winch falls as the joint moves on.
    pub fn step(&self, state: State, moment: &Moment<'_>, motor_nm: impl Fn(Motion) -> f64) -> State {
        let mass = self.mass(state.position_rad, state.velocity_rad_s, moment.others);
        let motion = |velocity: f64| Motion {
            position: state.position_rad + self.step_s * velocity,
            velocity,
            acceleration: (velocity - state.velocity_rad_s) / self.step_s,
        };
        let excess_nm = |velocity: f64| {
            let own = motion(velocity);
            let k_tilde = { state.passage }.step(own.position, Direction::of(own.velocity));
            self.sensed_nm(own, &motor_nm) - self.asked_nm(own, k_tilde, &mass, moment)
        };
        let velocity_rad_s = self.balance_rad_s(excess_nm, &mass);
        let own = motion(velocity_rad_s);
        let mut passage = state.passage;
        if velocity_rad_s != 0.0 {
            passage.step(own.position, Direction::of(own.velocity));
        }
        let torque_nm = self.sensed_nm(own, &motor_nm);
        State { position_rad: own.position, velocity_rad_s, passage, torque_nm }
    }

    /// What reaches the torque sensor from the motor's side, N m.
    pub fn sensed_nm(&self, own: Motion, motor_nm: impl Fn(Motion) -> f64) -> f64 {
        motor_nm(own) - self.motor_inertia_kg_m2 / self.model.joint.transmission() * own.acceleration
    }

    /// The speed at which `excess_nm`, which falls with it, is zero; 0 where the jump of friction at rest holds the joint.
    fn balance_rad_s(&self, excess_nm: impl Fn(f64) -> f64, mass: &Mass) -> f64 {
        // The slope of the excess is at least that of inertia without friction: the zero is hardly farther than this.
        let transmission = self.model.joint.transmission();
        let inertia = transmission * mass.inertia_kg_m2 + self.motor_inertia_kg_m2 / transmission;
        let stride = |excess: f64| if inertia > 0.0 { excess * self.step_s / inertia } else { excess.signum() };
        for side in [BESIDE_REST_RAD_S, -BESIDE_REST_RAD_S] {
            let excess = excess_nm(side);
            if excess * side > 0.0 {
                return root::falling(&excess_nm, side, excess, stride(excess), BALANCED_NM);
            }
        }
        0.0
    }
}
