//! What the devices have their hands on: a joint, its motor, its torque sensor.

use super::motor::{Law, Motor};
use crate::dynamics::Motion;
use crate::model::Model;
use crate::simulate::{Load, Machine};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::collections::VecDeque;

/// The longest step of the joint, ns: each is solved for its end, so that none is unstable.
const STEP_NS: u64 = 500_000;
/// Shorter times are made up for in the next step, ns.
const SHORTEST_NS: u64 = 20_000;
/// How long ago the joint was let go, ns.
const SETTLES_IN_NS: u64 = 3_000_000_000;
/// Inertia of the motor about the winch, kg m^2: that of the joint as it is felt there.
pub const MOTOR_INERTIA_KG_M2: f64 = 1e-3;

/// A joint that moves in virtual time.
#[derive(Debug)]
pub struct Joint {
    machine: Machine,
    /// Its motor.
    pub motor: Motor,
    noise: Option<Normal<f64>>,
    random: ChaCha8Rng,
    /// y before the sensor and when, as long as its reading is late.
    past: VecDeque<(u64, f64)>,
    now_ns: u64,
    /// What lets its brake go, if it has one, and whether that is closed.
    brake: Option<BrakeBy>,
    is_braked: bool,
    /// What a cable that is not this motor's own pulls back with, N m at the winch.
    pull_nm: f64,
    /// Where the joint stayed when its cable broke, rad.
    left_at_rad: Option<f64>,
}

/// What a brake is wired to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BrakeBy {
    /// The drive's digital output.
    Drive,
    /// A digital output terminal.
    Terminal,
}

impl Joint {
    /// A joint like `model` that was let go at `position_rad` a while ago, whose torque sensor has white noise of `noise_nm`, N m.
    pub fn new(model: Model, position_rad: f64, noise_nm: f64, seed: u64) -> Self {
        /// Stiffness of a drive of 40 Hz on a joint with its motor, N m/rad, and damping that is just critical, N m s/rad.
        const STIFFNESS_NM_RAD: f64 = 1500.0;
        let felt_kg_m2 = model.dynamics.inertia_kg_m2 + MOTOR_INERTIA_KG_M2 / model.joint.transmission().powi(2);
        let motor = Motor {
            law: Law::Off,
            stiffness_nm_rad: STIFFNESS_NM_RAD,
            damping_nm_s_rad: 2.0 * (STIFFNESS_NM_RAD * felt_kg_m2).sqrt(),
            limit_nm: f64::MAX,
            fastest_rad_s: f64::MAX,
            torque_nm: 0.0,
            encoder_off_rad: 0.0,
        };
        let mut machine = Machine::at_rest(model, MOTOR_INERTIA_KG_M2, position_rad);
        (0..SETTLES_IN_NS / STEP_NS).for_each(|_| machine.step(STEP_NS as f64 * 1e-9, |_| 0.0));
        Self {
            machine,
            motor,
            noise: Normal::new(0.0, noise_nm).ok(),
            random: ChaCha8Rng::seed_from_u64(seed),
            past: VecDeque::new(),
            now_ns: 0,
            brake: None,
            is_braked: false,
            pull_nm: 0.0,
            left_at_rad: None,
        }
    }

    /// The same with a brake that is closed without power, and let go by `by`.
    pub fn with_brake(self, by: BrakeBy) -> Self {
        Self { brake: Some(by), is_braked: true, ..self }
    }

    /// `by` closes the brake from now on, or lets it go, if it is wired to it.
    pub fn brake(&mut self, by: BrakeBy, closed: bool) {
        if self.brake == Some(by) {
            self.is_braked = closed;
        }
    }

    /// The same as a winch alone, without a joint on its cable.
    pub fn unloaded(mut self) -> Self {
        self.machine.load = Load::Nothing;
        self
    }

    /// Its cable breaks: the motor moves itself alone, the joint stays where it is.
    pub fn lose_cable(&mut self) {
        self.machine.load = Load::Nothing;
        self.left_at_rad.get_or_insert(self.machine.position_rad());
    }

    /// Moves on to `now_ns`.
    fn advance(&mut self, now_ns: u64) {
        let ahead_ns = now_ns.saturating_sub(self.now_ns);
        if ahead_ns < SHORTEST_NS {
            return;
        }
        let steps = ahead_ns.div_ceil(STEP_NS);
        let (began_ns, transmission) = (self.now_ns, self.machine.model().joint.transmission());
        let delay_ns = (self.machine.model().delay_s() * 1e9).max(0.0) as u64;
        for step in 1..=steps {
            let at_ns = began_ns + ahead_ns * step / steps;
            let step_s = (at_ns - self.now_ns) as f64 * 1e-9;
            let motor = &self.motor;
            // A winch alone is pulled itself, a joint past the torque sensor.
            let alone_nm = if self.machine.load == Load::Nothing { self.pull_nm } else { 0.0 };
            self.machine.pull_nm = self.pull_nm;
            let load = self.machine.load;
            if self.is_braked {
                self.machine.load = Load::Obstacle;
            }
            self.machine.step(step_s, |own| motor.given_nm(transmission, own, at_ns) - alone_nm);
            self.machine.load = load;
            self.now_ns = at_ns;
            let own = Motion {
                position: self.machine.position_rad(),
                velocity: self.machine.velocity_rad_s(),
                acceleration: 0.0,
            };
            self.motor.torque_nm = self.motor.given_nm(transmission, own, at_ns);
            if delay_ns > 0 {
                self.past.push_back((at_ns, self.machine.torque_nm()));
                while self.past.get(1).is_some_and(|(ns, _)| ns + delay_ns <= at_ns) {
                    self.past.pop_front();
                }
            }
        }
    }

    /// Position of the winch, rad of the joint.
    pub fn position_rad(&self) -> f64 {
        self.machine.position_rad()
    }

    /// Position and speed of the joint itself, rad and rad/s: once its cable has broken it stays where it was, as one that is supported.
    pub fn carried(&self) -> (f64, f64) {
        self.left_at_rad.map_or((self.machine.position_rad(), self.machine.velocity_rad_s()), |at_rad| (at_rad, 0.0))
    }

    /// Position as the encoder shows it, rad.
    pub fn encoder_rad(&self) -> f64 {
        self.machine.position_rad() + self.motor.encoder_off_rad
    }

    /// Speed of the winch, rad/s of the joint.
    pub fn velocity_rad_s(&self) -> f64 {
        self.machine.velocity_rad_s()
    }

    /// y before the sensor, N m.
    pub fn torque_nm(&self) -> f64 {
        self.machine.torque_nm()
    }

    /// What the sensor reads now, N m.
    pub fn reading_nm(&mut self) -> f64 {
        let noise_nm = self.noise.map_or(0.0, |noise| noise.sample(&mut self.random));
        let torque_nm = self.past.front().map_or(self.machine.torque_nm(), |(_, torque_nm)| *torque_nm);
        self.machine.reading_nm(torque_nm, noise_nm)
    }

    /// What the motor moves from now on.
    pub fn set_load(&mut self, load: Load) {
        self.machine.load = load;
    }
}

/// The joints: the one whose torque the terminal reads first, then what further drives move.
#[derive(Debug, Default)]
pub struct World {
    /// They.
    pub joints: Vec<Joint>,
    /// The second winch's cable to the first joint, where there is one.
    pub cable: Option<SecondCable>,
}

/// The cable of a second winch, which pulls the first joint down. It only pulls: slack it is not there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondCable {
    /// How much of it is slack while both winches are at 0, rad of the joint.
    pub slack_rad: f64,
}

/// Stiffness of the second cable, N m at the winch for a rad of the joint: a few mrad at the tensions that are held.
const CABLE_NM_RAD: f64 = 60.0;
/// Its damping, N m s/rad: about critical on the winch's inertia.
const CABLE_NM_S_RAD: f64 = 0.5;

impl SecondCable {
    /// N m at the winch, never below 0.
    fn torque_nm(&self, joint: &Joint, winch: &Joint) -> f64 {
        let (joint_rad, joint_rad_s) = joint.carried();
        let stretch_rad = winch.position_rad() + joint_rad - self.slack_rad;
        if stretch_rad <= 0.0 {
            return 0.0;
        }
        let rate_rad_s = winch.velocity_rad_s() + joint_rad_s;
        (CABLE_NM_RAD * stretch_rad + CABLE_NM_S_RAD * rate_rad_s).max(0.0)
    }
}

impl World {
    /// Moves everything on to `now_ns`.
    pub fn advance(&mut self, now_ns: u64) {
        while let (Some(cable), [joint, winch, ..]) = (&self.cable, self.joints.as_mut_slice()) {
            let at_ns = now_ns.min(joint.now_ns + STEP_NS);
            if at_ns.saturating_sub(joint.now_ns) < SHORTEST_NS {
                break;
            }
            let pull_nm = cable.torque_nm(joint, winch);
            (joint.pull_nm, winch.pull_nm) = (if joint.left_at_rad.is_some() { 0.0 } else { pull_nm }, pull_nm);
            joint.advance(at_ns);
            winch.advance(at_ns);
        }
        self.joints.iter_mut().for_each(|joint| joint.advance(now_ns));
    }

    /// What the second winch's cable pulls with, N m at its winch.
    pub fn pull_nm(&self) -> f64 {
        match (&self.cable, self.joints.as_slice()) {
            (Some(cable), [joint, winch, ..]) => cable.torque_nm(joint, winch),
            _ => 0.0,
        }
    }

    /// The cable of the joint `index` breaks.
    pub fn break_cable(&mut self, index: usize) {
        match self.joints.get_mut(index) {
            Some(winch) if index == 1 && self.cable.take().is_some() => winch.pull_nm = 0.0,
            Some(joint) => joint.lose_cable(),
            None => {}
        }
    }
}
