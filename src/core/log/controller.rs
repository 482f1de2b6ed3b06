//! `[controller]`: the torque of a position controller from its command, for joints whose torque is not measured.
//!
//! At the joint, tau = K (command - position) - D u within +-limit, where u is the joint's velocity, or its velocity less the
//! command's where the controller damps the error, through the first-order low-pass that the controller has for it: late by T, u asks
//! for D T of inertia less than the joint has. The torque at the winch is r1/r2 times that, and positive towards the command:
//! y, without a sign to be declared. An unknown K is taken as 1 N m/rad: all torques are then known up to one factor.

use super::columns::Wanted;
use super::{POSITION, TORQUE};
use crate::document::{Section, write_pairs};
use crate::numerics::causal::Lag;
use crate::numerics::difference::velocity;
use crate::units::{Quantity, Unit};
use toml::Value;

/// What the damping acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Damped {
    /// The joint's velocity: servos, and humanoids whose velocity is commanded to be 0; a motor's back EMF too.
    #[default]
    Velocity,
    /// The velocity of the error: the controller is told the velocity of the command too.
    Error,
}

impl Damped {
    const NAMED: [(&str, Self); 2] = [("velocity", Self::Velocity), ("error", Self::Error)];

    fn name(self) -> &'static str {
        Self::NAMED[usize::from(self == Self::Error)].0
    }
}

/// The law of a position controller, at the joint. For a prismatic joint `_nm` is N and `_rad` is m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controller {
    /// K, N m/rad; unknown where there is none.
    pub stiffness_nm_rad: Option<f64>,
    /// D, N m s/rad; 0 where it is unknown, which leaves it in the viscous friction.
    pub damping_nm_s_rad: f64,
    /// What D acts on.
    pub damped: Damped,
    /// T, the time constant of the low-pass through which it has u, s; 0 where none is given.
    pub speed_filter_s: f64,
    /// The most that it gives, N m; no limit where there is none.
    pub torque_limit_nm: Option<f64>,
}

impl Controller {
    /// Reads `[controller]`.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let stiffness_nm_rad = section.may("stiffness_nm_rad").positive();
        let damping_nm_s_rad = section.may("damping_nm_s_rad").not_negative();
        let damped = section.may("damped").choice(&Damped::NAMED).unwrap_or_default();
        let speed_filter_s = section.may("speed_filter_s").not_negative().unwrap_or(0.0);
        let torque_limit_nm = section.may("torque_limit_nm").positive();
        let damping_nm_s_rad = damping_nm_s_rad.unwrap_or(0.0);
        if speed_filter_s > 0.0 && damping_nm_s_rad == 0.0 {
            let what = "is given without a damping, which acts on the velocity that it filters";
            section.reject("speed_filter_s", what, "give damping_nm_s_rad too, or delete this line");
        }
        if stiffness_nm_rad.is_none() {
            for key in ["damping_nm_s_rad", "torque_limit_nm"] {
                if section.keys().any(|there| there == key) {
                    let what = "is given without the stiffness, of which all torques are then multiples";
                    section.reject(key, what, "give stiffness_nm_rad too, or delete this line");
                }
            }
        }
        Some(Self { stiffness_nm_rad, damping_nm_s_rad, damped, speed_filter_s, torque_limit_nm })
    }

    /// Reads a trial's own.
    pub(super) fn of_trial(section: &Section<'_>) -> Option<Self> {
        let read = Self::read(section);
        if !section.keys().any(|key| key == "stiffness_nm_rad") {
            section.reject(
                "stiffness_nm_rad",
                "is missing",
                "give the stiffness in this trial, or delete its controller",
            );
        }
        read
    }

    /// Keys and values in `campaign.toml`.
    pub(super) fn pairs(&self) -> Vec<(&'static str, Value)> {
        let mut pairs: Vec<(&'static str, Value)> = Vec::new();
        pairs.extend(self.stiffness_nm_rad.map(|k| ("stiffness_nm_rad", k.into())));
        if self.damping_nm_s_rad > 0.0 {
            pairs.push(("damping_nm_s_rad", self.damping_nm_s_rad.into()));
            pairs.push(("damped", self.damped.name().into()));
        }
        if self.speed_filter_s > 0.0 {
            pairs.push(("speed_filter_s", self.speed_filter_s.into()));
        }
        pairs.extend(self.torque_limit_nm.map(|limit| ("torque_limit_nm", limit.into())));
        pairs
    }

    /// `[controller]` as text; nothing of one that is not known.
    pub(super) fn to_toml(self) -> String {
        let (mut text, pairs) = (String::new(), self.pairs());
        if !pairs.is_empty() {
            write_pairs(&mut text, "\n[controller]\n", &pairs);
        }
        text
    }

    /// y for an error and the velocity that is damped, through r1/r2 of `transmission`, N m.
    pub(super) fn torque_nm(&self, transmission: f64, error_rad: f64, damped_rad_s: f64) -> f64 {
        let wanted_nm = self.stiffness_nm_rad.unwrap_or(1.0) * error_rad - self.damping_nm_s_rad * damped_rad_s;
        let most_nm = self.torque_limit_nm.unwrap_or(f64::INFINITY);
        transmission * wanted_nm.clamp(-most_nm, most_nm)
    }

    /// Puts y in the place of the command that `columns`, on an even grid of `rate_hz`, hold as their torque.
    pub(super) fn drive(&self, transmission: f64, columns: &mut [Vec<f64>], wanted: &[Wanted], rate_hz: f64) {
        let si = |at: usize| columns[at].iter().map(|reading| wanted[at].to_si(*reading)).collect::<Vec<f64>>();
        let (position_rad, command_rad) = (si(POSITION), si(TORQUE));
        let error_rad: Vec<f64> = command_rad.iter().zip(&position_rad).map(|(wanted, is)| wanted - is).collect();
        let damped_rad_s = match self.damped {
            Damped::Velocity => velocity(&position_rad, rate_hz),
            Damped::Error => velocity(&error_rad, rate_hz).into_iter().map(|rate| -rate).collect(),
        };
        let mut filter = Lag::new(self.speed_filter_s * rate_hz);
        let of = |(error, rate): (&f64, &f64)| self.torque_nm(transmission, *error, filter.step(*rate));
        columns[TORQUE] = error_rad.iter().zip(&damped_rad_s).map(of).collect();
    }

    /// What `command` becomes once [`Self::drive`] was there: a torque of its own name, in N m.
    pub(super) fn driven(&self, command: &Wanted, unit: Unit) -> Wanted {
        let column = super::columns::Column::new(format!("torque from {}", command.column.name), unit);
        Wanted::new(Quantity::Torque, &column)
    }
}
