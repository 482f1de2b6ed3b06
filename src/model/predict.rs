//! The prediction: the paper's model as one formula, never using the measured torque.
//!
//! The load term of (15) uses the cable's own tension (r1 T0 = y), so (4) is solved for y:
//!
//! y = [ (r1/r2) (G + M a) + Bd + K~ (Bu - Bd) ] / ( 1 - mu_down - K~ (mu_up - mu_down) )
//!
//! with Bu, Bd the unloaded parts of the two branches (`Friction::unloaded_nm`). At K~ = 1 and 0 this is (17) with A and
//! B of each direction.

use super::{Both, Direction, Model};
use crate::effects::{Carried, Sample};
use crate::numerics::causal::Lag;
use crate::numerics::resample::shifted;

/// What a sample asks of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// Gravity, inertia, Coriolis, measured load at the joint, N m.
    pub torque_nm: f64,
    /// How gravity changes with the joint's position, N m/rad.
    pub slope_nm_rad: f64,
}

/// Steps in which the lag of a stretched cable and the torque that stretches it settle: each gains a digit or more.
const SETTLING: usize = 3;

/// What the model makes of one sample, all as torques at the winch, N m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Components {
    /// y, the predicted signal.
    pub torque_nm: f64,
    /// (r1/r2) times the rigid-body torque: what the winch would see without friction.
    pub rigid_nm: f64,
    /// The rest: friction, and what effects add.
    pub friction_nm: f64,
}

impl Model {
    /// y for a rigid-body torque `joint_torque_nm` at the joint (gravity, inertia, measured load), at `velocity_rad_s` and
    /// with friction combined by `k_tilde`.
    pub fn torque_nm(&self, joint_torque_nm: f64, velocity_rad_s: f64, k_tilde: f64) -> Components {
        let branch = |direction| self.branch_nm(direction, velocity_rad_s);
        // Fully on one branch, as nearly always, the other's exponentials are not needed.
        let friction_nm = match k_tilde {
            0.0 => branch(Direction::Down),
            1.0 => branch(Direction::Up),
            _ => {
                let (up, down) = (branch(Direction::Up), branch(Direction::Down));
                down + k_tilde * (up - down)
            }
        };
        let (mu_up, mu_down) = (self.friction.up.mu_c, self.friction.down.mu_c);
        let rigid_nm = self.joint.transmission() * joint_torque_nm;
        let loss = 1.0 - mu_down - k_tilde * (mu_up - mu_down);
        let torque_nm = (rigid_nm + friction_nm) / loss;
        Components { torque_nm, rigid_nm, friction_nm: torque_nm - rigid_nm }
    }

    /// y with everything that the model's effects add to the joint, before the sensor: what `asked` and `sample` come to with
    /// friction combined by `k_tilde`. The formula is the one of `effects`.
    pub fn driven_nm(&self, sample: &Sample<'_>, asked: Asked, k_tilde: f64) -> Components {
        self.driven_by_nm(sample, asked, k_tilde, self.branches_nm(sample.own.velocity))
    }

    /// The unloaded friction of both branches at a speed, N m at the winch.
    pub fn branches_nm(&self, velocity_rad_s: f64) -> Both<f64> {
        Both::make(|direction| self.branch_nm(direction, velocity_rad_s))
    }

    /// The unloaded friction of one branch at a speed, N m at the winch.
    fn branch_nm(&self, direction: Direction, velocity_rad_s: f64) -> f64 {
        let (r1, r2) = (self.joint.winch_radius_m, self.joint.pulley_radius_m);
        self.friction.of(direction).unloaded_nm(direction, velocity_rad_s, r1, r2)
    }

    /// [`Self::driven_nm`] with the branches known already: most of the work is in their exponentials.
    pub fn driven_by_nm(&self, sample: &Sample<'_>, asked: Asked, k_tilde: f64, branches: Both<f64>) -> Components {
        let Both { mut up, mut down } = branches;
        let (mu_up, mu_down) = (self.friction.up.mu_c, self.friction.down.mu_c);
        let transmission = self.joint.transmission();
        let (mut factor, mut winch_nm, mut joint_nm) = (1.0, 0.0, asked.torque_nm);
        for e in &self.effects {
            joint_nm += e.effect.joint_torque_nm(&e.parameters, sample);
            factor *= e.effect.friction_factor(&e.parameters, sample);
        }
        let carried = Carried { load_nm: transmission * joint_nm, friction_nm: branches };
        for e in &self.effects {
            winch_nm += e.effect.winch_torque_nm(&e.parameters, sample, carried.load_nm);
            let more = e.effect.friction_nm(&e.parameters, sample, carried);
            (up, down) = (up + more.up, down + more.down);
        }
        let friction_nm = factor * (down + k_tilde * (up - down));
        let loss = 1.0 - mu_down - k_tilde * (mu_up - mu_down);
        let torque_nm =
            |lag_rad: f64| (transmission * (joint_nm - asked.slope_nm_rad * lag_rad) + friction_nm) / loss + winch_nm;
        let lag_rad = |y_nm: f64| -> f64 {
            self.effects.iter().map(|e| e.effect.position_lag_rad(&e.parameters, joint_nm, y_nm / transmission)).sum()
        };
        let mut y_nm = torque_nm(0.0);
        if lag_rad(y_nm) != 0.0 {
            (0..SETTLING).for_each(|_| y_nm = torque_nm(lag_rad(y_nm)));
        }
        let rigid_nm = transmission * asked.torque_nm;
        Components { torque_nm: y_nm, rigid_nm, friction_nm: y_nm - rigid_nm }
    }

    /// What the sensor reads of `torque_nm`, but for its delay, N m.
    pub fn reading_nm(&self, sample: &Sample<'_>, torque_nm: f64) -> f64 {
        self.noisy_reading_nm(sample, torque_nm, 0.0)
    }

    /// The same with the sensor's noise of `noise_nm`: noise is measured along with the torque, a range that ends clips both.
    pub fn noisy_reading_nm(&self, sample: &Sample<'_>, torque_nm: f64, noise_nm: f64) -> f64 {
        let read = |y: f64, clips: bool| {
            let effects = self.effects.iter().filter(|e| e.effect.clips() == clips);
            effects.fold(y, |y, e| e.effect.reading_nm(&e.parameters, sample, y))
        };
        read(read(torque_nm, false) + noise_nm, true)
    }

    /// How late the sensor's reading is, s.
    pub fn delay_s(&self) -> f64 {
        self.effects.iter().map(|e| e.effect.delay_s(&e.parameters)).sum()
    }

    /// The time constant with which the sensor follows, s.
    pub fn lag_s(&self) -> f64 {
        self.effects.iter().map(|e| e.effect.lag_s(&e.parameters)).sum()
    }

    /// A series of torques at `rate_hz` as the sensor gets them, late by [`Self::delay_s`] and [`Self::lag_s`], N m.
    pub fn late_nm(&self, mut torque_nm: Vec<f64>, rate_hz: f64) -> Vec<f64> {
        let (delay_s, lag_s) = (self.delay_s(), self.lag_s());
        if delay_s != 0.0 {
            torque_nm = shifted(&torque_nm, delay_s * rate_hz);
        }
        if lag_s > 0.0 {
            let mut lag = Lag::new(lag_s * rate_hz);
            torque_nm.iter_mut().for_each(|y| *y = lag.step(*y));
        }
        torque_nm
    }

    /// Whether any effect goes by the time since the campaign began.
    pub fn needs_clock(&self) -> bool {
        self.effects.iter().any(|e| e.effect.needs_clock(&e.parameters))
    }
}
