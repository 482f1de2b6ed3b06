//! The words of a report: units of the joint's kind, what each parameter means, what each status means.

use crate::dynamics::JointKind;
use crate::identify::combination::JudgedOn;
use crate::identify::{Amplitude, FrictionFit};
use crate::model::{Direction, Drive, Joint, Status};
use crate::report::number::{as_precise_as, r_squared, significant};

/// Names of units as a reader sees them; the fields called `_nm` and `_rad` hold N and m for a prismatic joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Of torque, as y is.
    pub torque: &'static str,
    /// Of a load at the joint, gravity's.
    pub load: &'static str,
    /// Of a thousandth of the torque.
    pub milli_torque: &'static str,
    /// Of speed.
    pub speed: &'static str,
    /// Of position as shown.
    pub position: &'static str,
    /// Position as shown per position as held.
    pub position_factor: f64,
}

impl Units {
    /// The units of `joint`: the torque of a screw's motor is one, whatever its slide does.
    pub fn of(joint: &Joint) -> Self {
        let of_kind = Self::of_kind(joint.kind);
        match joint.drive {
            Drive::Screw => Self { torque: "N m", milli_torque: "mN m", ..of_kind },
            _ => of_kind,
        }
    }

    /// The units of a joint of this `kind` whose torque is measured on its own side.
    pub fn of_kind(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => Self {
                torque: "N m",
                load: "N m",
                milli_torque: "mN m",
                speed: "rad/s",
                position: "deg",
                position_factor: 180.0 / std::f64::consts::PI,
            },
            JointKind::Prismatic => {
                Self { torque: "N", load: "N", milli_torque: "mN", speed: "m/s", position: "mm", position_factor: 1e3 }
            }
        }
    }

    /// Unit and factor for torques no larger than `largest_nm`: thousandths where they read better.
    pub fn torque_scale(&self, largest_nm: f64) -> (&'static str, f64) {
        if largest_nm < 0.1 { (self.milli_torque, 1e3) } else { (self.torque, 1.0) }
    }

    /// `value_nm` with three digits and the unit that suits it.
    pub fn torque(&self, value_nm: f64) -> String {
        self.torque_beside(value_nm, value_nm.abs())
    }

    /// The same in the unit that suits `largest_nm`, with which it is compared.
    pub fn torque_beside(&self, value_nm: f64, largest_nm: f64) -> String {
        let (unit, factor) = self.torque_scale(largest_nm);
        format!("{} {unit}", significant(factor * value_nm, 3))
    }

    /// A with what is known of it.
    pub fn amplitude(&self, a: &Amplitude) -> String {
        match a.half_width_nm.is_finite() {
            _ if a.fixed => format!("0 {}, fixed, as there is no load", self.torque),
            true => format!("{} {}, {}", as_precise_as(a.a_nm, a.half_width_nm), self.torque, amplitude_spread(a)),
            false => format!("{} {}, {}", significant(a.a_nm, 4), self.torque, amplitude_spread(a)),
        }
    }
}

/// How well A is known, and, which is not the same, how far its legs scatter.
pub fn amplitude_spread(a: &Amplitude) -> String {
    let figure = |x: f64| as_precise_as(x, x);
    match a.half_width_nm.is_finite() {
        _ if a.fixed => "fixed, as there is no load".to_string(),
        true => format!("95 % ± {}, SD {} over {} legs", figure(a.half_width_nm), figure(a.sd_nm), a.legs),
        false => "from a single leg".to_string(),
    }
}

/// How well the form taken meets B(v).
pub fn met(fit: &FrictionFit, units: &Units) -> String {
    match fit.taken.freedom() < 1.0 {
        true => "exactly determined".to_string(),
        false => format!("fit RMSE {}, R² {}", units.torque(fit.taken.rmse_nm), r_squared(fit.r_squared)),
    }
}

/// The status in a word for people.
pub fn status_word(status: Status) -> &'static str {
    match status {
        Status::Pinned => "pinned",
        Status::TradeOff => "trade-off",
        Status::Merged => "merged",
        Status::Flat => "flat",
        Status::AtBound => "at bound",
    }
}

/// What the status says.
pub fn status_meaning(status: Status) -> &'static str {
    match status {
        Status::Pinned => "well determined: its standard error is at most 10 % of it",
        Status::TradeOff => {
            "correlated with other parameters: they compensate for a change in it, so do not read it alone"
        }
        Status::Merged => {
            "several parameters of the two-exponential form (19) in one: the interval is of their sum, not of the single parameter"
        }
        Status::Flat => "hardly changes the prediction: these data do not show it, so do not use its value",
        Status::AtBound => "ended at the limit of what these data could show: the true value may lie beyond",
    }
}

/// The word for a parameter that the form taken does without.
pub const LEFT_OUT: &str = "left out";

/// What that says.
pub const LEFT_OUT_MEANING: &str = "not part of the form that the model takes";

/// What a curve's residual is of.
pub fn judged_on(judged_on: JudgedOn) -> &'static str {
    match judged_on {
        JudgedOn::Reversals => "after reversals",
        JudgedOn::UnseenStrokes => "held out",
    }
}

/// "moving up", "moving down".
pub fn moving(direction: Direction) -> &'static str {
    match direction {
        Direction::Up => "moving up",
        Direction::Down => "moving down",
    }
}
