//! A joint under a position controller: how it moves is what its torques make of the command.

mod controller;
mod machine;
mod step;

pub use controller::{Controller, Wanted};
pub use machine::{Load, Machine};

use super::course::{Course, Motions};
use super::driven::{self, start};
use crate::dynamics::{Chain, Motion};
use crate::model::{Model, Passage};
use crate::numerics::resample::between;
use controller::Command;
use step::{Moment, Plant, State};

/// The longest step, s: a tenth of the shortest time constant met, that of a joint against its cable's friction.
const LONGEST_STEP_S: f64 = 2.5e-4;

/// How the joint moves, and its torque.
pub(super) struct Followed {
    /// With the joint's position in place of the command.
    pub course: Course,
    /// y at the winch, before the sensor, N m.
    pub torque_nm: Vec<f64>,
}

/// `model` under `controller`, with `course` as its command.
pub(super) fn follow(
    model: &Model,
    chain: Option<&Chain>,
    controller: &Controller,
    course: &Course,
    rate_hz: f64,
) -> Followed {
    let command = Motions::new(course, rate_hz);
    let feedforward_nm = controller.feedforward.as_ref().map_or(Vec::new(), |known| {
        let alone = Course { contact_nm: Vec::new(), ..course.clone() };
        driven::torque_nm(known, chain, &alone, &command)
    });
    let steps = (1.0 / (rate_hz * LONGEST_STEP_S)).ceil().max(1.0);
    let motor_inertia_kg_m2 = controller.motor_inertia_kg_m2;
    let plant = Plant { model, chain, motor_inertia_kg_m2, step_s: 1.0 / (rate_hz * steps) };
    let transmission = model.joint.transmission();
    let script = Script::new(course, &command, feedforward_nm);
    let mut others = Vec::with_capacity(command.others.len());
    let (command, moment) = script.at(0.0, &mut others);
    let mut state = resting(&plant, controller, course, command, &moment);
    let samples = course.position_rad.len();
    let (mut position_rad, mut torque_nm) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
    for i in 0..samples {
        // The steps that lead to sample i; none to the first.
        for step in 1..=if i > 0 { steps as usize } else { 0 } {
            let at = (i - 1) as f64 + step as f64 / steps;
            let (command, moment) = script.at(at, &mut others);
            state = plant.step(state, &moment, |own| controller.motor_nm(transmission, command, own));
        }
        position_rad.push(state.position_rad);
        torque_nm.push(state.torque_nm);
    }
    Followed { course: Course { position_rad, ..course.clone() }, torque_nm }
}

/// The joint at rest beside its command, where the controller holds it.
fn resting(
    plant: &Plant<'_>,
    controller: &Controller,
    course: &Course,
    command: Command,
    moment: &Moment<'_>,
) -> State {
    /// Times that the deflection and the torque that makes it are brought to agree: each gains a digit or more.
    const SETTLING: usize = 5;
    let still = |position: f64| Motion { position, ..Motion::default() };
    let direction = start(&course.position_rad);
    let k_tilde = direction.k_tilde();
    let transmission = plant.model.joint.transmission();
    let stiffness_nm_rad = transmission * controller.stiffness_nm_rad;
    let mut position_rad = command.position_rad;
    for _ in 0..SETTLING {
        let mass = plant.mass(position_rad, 0.0, moment.others);
        let torque_nm = plant.asked_nm(still(position_rad), k_tilde, &mass, moment);
        position_rad = command.position_rad + (command.feedforward_nm - torque_nm) / stiffness_nm_rad;
    }
    let passage = Passage::after(plant.model, direction, position_rad, 0.0);
    // Beyond the motor's limit it begins to fall.
    let torque_nm = controller.motor_nm(transmission, command, still(position_rad));
    State { position_rad, velocity_rad_s: 0.0, passage, torque_nm }
}

/// What happens at any moment, drawn straight between samples.
struct Script<'c> {
    command: &'c Motions,
    velocity_rad_s: Vec<f64>,
    feedforward_nm: Vec<f64>,
    course: &'c Course,
}

impl<'c> Script<'c> {
    fn new(course: &'c Course, command: &'c Motions, feedforward_nm: Vec<f64>) -> Self {
        let velocity_rad_s = command.own.iter().map(|motion| motion.velocity).collect();
        Self { command, velocity_rad_s, feedforward_nm, course }
    }

    /// What happens `at`, counted in samples from the first; `others` is room for the other joints' motions.
    fn at<'o>(&self, at: f64, others: &'o mut Vec<Motion>) -> (Command, Moment<'o>) {
        others.clear();
        others.extend(self.command.others.iter().map(|other| motion_between(other, at)));
        let time_s = at / self.command.rate_hz;
        let command = Command {
            position_rad: between(&self.course.position_rad, at),
            velocity_rad_s: between(&self.velocity_rad_s, at),
            feedforward_nm: between(&self.feedforward_nm, at),
        };
        let contact_nm = between(&self.course.contact_nm, at);
        (command, Moment { time_s, elapsed_s: self.course.began_s + time_s, contact_nm, others })
    }
}

fn motion_between(motions: &[Motion], at: f64) -> Motion {
    let before = (at as usize).min(motions.len() - 1);
    let (a, b) = (motions[before], motions[(before + 1).min(motions.len() - 1)]);
    let share = at - before as f64;
    let mixed = |a: f64, b: f64| a + share * (b - a);
    Motion {
        position: mixed(a.position, b.position),
        velocity: mixed(a.velocity, b.velocity),
        acceleration: mixed(a.acceleration, b.acceleration),
    }
}
