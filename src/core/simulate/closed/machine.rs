//! A joint and its motor for whoever commands it as it goes: a drive on a bus rather than a trajectory.

use super::step::{Moment, Plant, State};
use crate::dynamics::{Direction, Motion};
use crate::effects::Sample;
use crate::model::{Model, Passage};
use crate::numerics::root;

/// To what the balance of a motor alone is solved, N m.
const BALANCED_NM: f64 = 1e-10;

/// What the motor moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Load {
    /// The joint.
    #[default]
    Joint,
    /// Nothing moves: the joint stands against an obstacle.
    Obstacle,
    /// Itself alone: the cable is broken.
    Nothing,
}

/// A joint that a motor moves, step by step.
#[derive(Debug, Clone)]
pub struct Machine {
    model: Model,
    motor_inertia_kg_m2: f64,
    state: State,
    elapsed_s: f64,
    /// What the motor moves.
    pub load: Load,
    /// What else pulls the joint down, as torque at the winch, N m; a motor without the joint is not pulled.
    pub pull_nm: f64,
}

impl Machine {
    /// A joint like `model` at rest at `position_rad`, last moved up, with a motor of `motor_inertia_kg_m2` (above 0) about the
    /// winch, before the torque sensor.
    pub fn at_rest(model: Model, motor_inertia_kg_m2: f64, position_rad: f64) -> Self {
        let passage = Passage::after(&model, Direction::Up, position_rad, 0.0);
        let state = State { position_rad, velocity_rad_s: 0.0, passage, torque_nm: 0.0 };
        Self { model, motor_inertia_kg_m2, state, elapsed_s: 0.0, load: Load::Joint, pull_nm: 0.0 }
    }

    /// `step_s` on, under a motor whose torque at the winch, N m, is `motor_nm` of the joint's motion and falls as it moves on.
    pub fn step(&mut self, step_s: f64, motor_nm: impl Fn(Motion) -> f64) {
        self.elapsed_s += step_s;
        let plant = Plant { model: &self.model, chain: None, motor_inertia_kg_m2: self.motor_inertia_kg_m2, step_s };
        let moment =
            Moment { time_s: self.elapsed_s, elapsed_s: self.elapsed_s, contact_nm: self.pull_nm, others: &[] };
        match self.load {
            Load::Joint => self.state = plant.step(self.state, &moment, motor_nm),
            Load::Obstacle => {
                self.state.velocity_rad_s = 0.0;
                self.state.torque_nm = motor_nm(Motion { position: self.state.position_rad, ..Motion::default() });
            }
            Load::Nothing => {
                let before = self.state;
                let motion = |velocity: f64| Motion {
                    position: before.position_rad + step_s * velocity,
                    velocity,
                    acceleration: (velocity - before.velocity_rad_s) / step_s,
                };
                let excess_nm = |velocity: f64| plant.sensed_nm(motion(velocity), &motor_nm);
                let at_before = excess_nm(before.velocity_rad_s);
                let stride = at_before * step_s * self.model.joint.transmission() / self.motor_inertia_kg_m2;
                let found = if at_before == 0.0 {
                    before.velocity_rad_s
                } else {
                    root::falling(excess_nm, before.velocity_rad_s, at_before, stride, BALANCED_NM)
                };
                let own = motion(found);
                self.state =
                    State { position_rad: own.position, velocity_rad_s: own.velocity, torque_nm: 0.0, ..before };
            }
        }
    }

    /// The model that the joint follows.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Position, rad.
    pub fn position_rad(&self) -> f64 {
        self.state.position_rad
    }

    /// Speed, rad/s.
    pub fn velocity_rad_s(&self) -> f64 {
        self.state.velocity_rad_s
    }

    /// y at the winch, before the sensor, N m.
    pub fn torque_nm(&self) -> f64 {
        self.state.torque_nm
    }

    /// What the sensor reads of `torque_nm` (the present one, or one of its delay ago) with noise of `noise_nm`, N m.
    pub fn reading_nm(&self, torque_nm: f64, noise_nm: f64) -> f64 {
        let own =
            Motion { position: self.state.position_rad, velocity: self.state.velocity_rad_s, ..Motion::default() };
        let sample = Sample { time_s: self.elapsed_s, elapsed_s: self.elapsed_s, own, others: &[] };
        self.model.noisy_reading_nm(&sample, torque_nm, noise_nm)
    }
}
