//! A motor with its position controller: what it is told, and the torque that it gives.

use crate::dynamics::Motion;

/// Share of its limit of speed, below it and above, within which a motor's torque along its motion goes from all to none, and to braking.
const GOVERNED: f64 = 0.1;

/// What a motor does until it is told otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Nothing: the joint moves it.
    Off,
    /// From `position_rad` at `from_ns` at a speed until `until_ns`, then stays there.
    Follow {
        /// Where, rad.
        position_rad: f64,
        /// How fast, rad/s.
        velocity_rad_s: f64,
        /// Since when, ns.
        from_ns: u64,
        /// Until when, ns.
        until_ns: u64,
    },
    /// A torque at the winch, N m.
    Torque(f64),
}

impl Law {
    /// Where the motor is to be at `now_ns`, and how fast; none where it follows nothing.
    pub fn command(&self, now_ns: u64) -> Option<(f64, f64)> {
        match *self {
            Law::Follow { position_rad, velocity_rad_s, from_ns, until_ns } => {
                let gone_s = now_ns.clamp(from_ns, until_ns).saturating_sub(from_ns) as f64 * 1e-9;
                let velocity = if now_ns > until_ns { 0.0 } else { velocity_rad_s };
                Some((position_rad + velocity_rad_s * gone_s, velocity))
            }
            _ => None,
        }
    }
}

/// A motor with its position controller.
#[derive(Debug, Clone)]
pub struct Motor {
    /// What it does.
    pub law: Law,
    /// At the joint, N m/rad.
    pub stiffness_nm_rad: f64,
    /// At the joint, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// The most that it gives at the winch, N m.
    pub limit_nm: f64,
    /// Its position loop goes no faster, rad/s.
    pub fastest_rad_s: f64,
    /// What it gives, N m.
    pub torque_nm: f64,
    /// What its encoder shows beyond the truth, rad.
    pub encoder_off_rad: f64,
}

impl Motor {
    fn wanted_nm(&self, transmission: f64, own: Motion, now_ns: u64) -> f64 {
        match (self.law, self.law.command(now_ns)) {
            (_, Some((position_rad, velocity_rad_s))) => {
                let behind_rad = position_rad - (own.position + self.encoder_off_rad);
                transmission
                    * (self.stiffness_nm_rad * behind_rad + self.damping_nm_s_rad * (velocity_rad_s - own.velocity))
            }
            (Law::Torque(torque_nm), _) => torque_nm,
            _ => 0.0,
        }
    }

    /// What is wanted, as far as the motor's limits let it: its position loop brakes what is faster than it may be.
    pub(super) fn given_nm(&self, transmission: f64, own: Motion, now_ns: u64) -> f64 {
        let wanted_nm = self.wanted_nm(transmission, own, now_ns).clamp(-self.limit_nm, self.limit_nm);
        if self.law.command(now_ns).is_none() {
            return wanted_nm;
        }
        let left = (1.0 - own.velocity.abs() / self.fastest_rad_s) / GOVERNED;
        let along_nm = (wanted_nm * own.velocity.signum()).min(self.limit_nm * left.clamp(-1.0, 1.0));
        along_nm * own.velocity.signum()
    }

    /// Whether it gives all it may.
    pub fn is_at_limit(&self) -> bool {
        self.torque_nm.abs() >= self.limit_nm
    }
}
