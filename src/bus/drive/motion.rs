//! What the motor does: held, along targets, at a speed, with a torque, or down the ramp of a stop.

use super::objects::{COUNTS_PER_RAD, CSP, CSV, NM_PER_MILLE};
use super::power::Power;
use super::{Drive, OWN_OPTION, OWN_RAMP, STANDS_RAD_S, own};
use crate::bus::application::Moment;
use crate::bus::coe::Dictionary;
use crate::bus::motor::Law;
use crate::bus::world::Joint;

/// The motor runs no faster, rad/s at the joint.
const FASTEST_RAD_S: f64 = 50.0;
/// How long a command is good for beyond the period in which the next is due, ns: a pulse may come late.
const GRACE_NS: u64 = 1_000_000;
/// The most that a command of speed gets ahead of the motor, rad: the motor's limit is met before.
const AHEAD_RAD: f64 = 0.05;

impl Drive {
    /// Where the motor is, there it stays until told otherwise.
    pub(super) fn hold(&mut self, joint: &mut Joint, moment: Moment) {
        self.target = (joint.encoder_rad() * COUNTS_PER_RAD).round() as i64;
        joint.motor.law = Law::Follow {
            position_rad: joint.encoder_rad(),
            velocity_rad_s: 0.0,
            from_ns: moment.now_ns,
            until_ns: moment.now_ns,
        };
    }

    /// What the motor does next.
    pub(super) fn steer(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        match self.power {
            Power::Enabled if self.mode == CSP => self.follow_position(objects, joint, moment),
            Power::Enabled if self.mode == CSV => {
                let speed_rad_s = self.defects.runaway * objects.signed(0x60FF, 0) as f64 / COUNTS_PER_RAD;
                self.run(joint, moment, speed_rad_s);
            }
            Power::Enabled => joint.motor.law = Law::Torque(self.torque_nm(objects, joint)),
            Power::QuickStop | Power::FaultReaction => self.stop(objects, joint, moment),
            _ => {}
        }
    }

    /// The target torque; none that drives a motor on beyond the drive's own limit of speed (0x607F).
    fn torque_nm(&self, objects: &Dictionary, joint: &Joint) -> f64 {
        let torque_nm = objects.signed(0x6071, 0) as f64 * NM_PER_MILLE;
        let speed_rad_s = joint.velocity_rad_s();
        let drives_on = torque_nm * speed_rad_s > 0.0 && speed_rad_s.abs() > joint.motor.fastest_rad_s;
        if drives_on { 0.0 } else { torque_nm }
    }

    /// To the target, evenly over the period in which the next is due. One that stays away is bridged at the same speed; then
    /// the motor stands.
    fn follow_position(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        let Law::Follow { velocity_rad_s: last_rad_s, from_ns, .. } = joint.motor.law else { return };
        let (lowest, highest) = (objects.signed(0x607D, 1), objects.signed(0x607D, 2));
        let target = objects.signed(0x607A, 0).clamp(lowest, highest.max(lowest));
        let exponent = objects.signed(0x60C2, 2).clamp(-6, 0) as i32;
        let period_s = objects.unsigned(0x60C2, 1).max(1) as f64 * 10f64.powi(exponent);
        let (now_ns, period_ns) = (moment.now_ns, (period_s * 1e9) as u64);
        // A pulse may come a little early.
        if target == self.target && now_ns < from_ns + period_ns * 9 / 10 {
            return;
        }
        let missing = !moment.fresh && target == self.target;
        let Some((position_rad, _)) = joint.motor.law.command(now_ns) else { return };
        let velocity_rad_s = match missing {
            false => (target as f64 / COUNTS_PER_RAD - position_rad) / period_s,
            // A jump of the target is no speed to go on at: command and motor would swing about it, and never be apart for long.
            true if self.bridges || last_rad_s.abs() > FASTEST_RAD_S => 0.0,
            true => last_rad_s,
        };
        (self.bridges, self.target) = (missing, target);
        let until_ns = now_ns + period_ns;
        joint.motor.law = Law::Follow { position_rad, velocity_rad_s, from_ns: now_ns, until_ns };
    }

    /// At a speed.
    fn run(&mut self, joint: &mut Joint, moment: Moment, velocity_rad_s: f64) {
        let now_ns = moment.now_ns;
        let at_rad = joint.encoder_rad();
        let (position_rad, _) = joint.motor.law.command(now_ns).unwrap_or((at_rad, 0.0));
        let position_rad = position_rad.clamp(at_rad - AHEAD_RAD, at_rad + AHEAD_RAD);
        let until_ns = now_ns + GRACE_NS + now_ns.saturating_sub(self.worked_ns).min(GRACE_NS);
        joint.motor.law = Law::Follow { position_rad, velocity_rad_s, from_ns: now_ns, until_ns };
    }

    /// Down the ramp; then held, or without torque, as the options say.
    fn stop(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        let by_fault = self.power == Power::FaultReaction;
        let option = own(objects, if by_fault { 0x605E } else { 0x605A }, OWN_OPTION);
        let ramp = if matches!(option, 1 | 5) { 0x6084 } else { 0x6085 };
        let deceleration_rad_s2 = own(objects, ramp, OWN_RAMP) as f64 / COUNTS_PER_RAD;
        let gone_s = moment.now_ns.saturating_sub(self.worked_ns) as f64 * 1e-9;
        let left = (self.stopping_rad_s.abs() - deceleration_rad_s2 * gone_s).max(0.0);
        self.stopping_rad_s = left.copysign(self.stopping_rad_s);
        self.run(joint, moment, self.stopping_rad_s);
        let stands = left == 0.0 && joint.velocity_rad_s().abs() < STANDS_RAD_S;
        if stands && by_fault {
            self.enter(Power::Fault, joint, moment);
        } else if stands && option < 5 && option > 0 {
            self.enter(Power::SwitchOnDisabled, joint, moment);
        }
    }
}
