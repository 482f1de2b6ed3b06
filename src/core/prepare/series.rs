//! A trial thinned to what its low-pass leaves: the form in which whole series are compared.

use super::Trial;
use crate::dynamics::{Dynamics, JointKind};
use crate::numerics::scalar::Scalar;

/// Samples kept per period of the low-pass: the filter redesigned for the thinned rate then differs from the declared one
/// by less than 1 % up to 1.2 times its cut-off, and hardly anything passes beyond.
const SAMPLES_PER_PERIOD: f64 = 20.0;

/// A thinned trial.
#[derive(Debug, Clone)]
pub struct Series {
    /// Position of the trial in the campaign's list.
    pub trial: usize,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Position that K_f follows, rad: without the ringing that a filter leaves at a corner.
    pub position_rad: Vec<f64>,
    /// Speed, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Rigid-body torque at the joint with any measured load, the position's zero taken as right, N m.
    joint_torque_nm: Vec<f64>,
    /// G and dG/dq within it, N m and N m/rad.
    gravity_nm: Vec<(f64, f64)>,
    /// y after the low-pass, N m.
    pub torque_nm: Vec<f64>,
    /// Whether the sensor was in range.
    pub in_range: Vec<bool>,
    /// Travel back below which nothing counts as a reversal, rad.
    pub deadband_rad: f64,
    /// The encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
}

impl Series {
    /// `trial` thinned for a low-pass at `lowpass_hz`, with the rigid-body torque of `dynamics`, whose zero of position is 0.
    pub fn new(trial: &Trial, lowpass_hz: f64, kind: JointKind, dynamics: &Dynamics) -> Self {
        let step = ((trial.log.rate_hz / (SAMPLES_PER_PERIOD * lowpass_hz)) as usize).max(1);
        let n = trial.torque_nm.len();
        let thin = |values: &[f64]| values.iter().step_by(step).copied().collect::<Vec<f64>>();
        let asked = |i: usize| {
            let rigid = trial.rigid(i, kind, dynamics);
            (rigid.total_nm() + trial.load_nm(i), (rigid.gravity_nm, trial.slope_nm_rad(i, kind, dynamics)))
        };
        let (joint_torque_nm, gravity_nm) = (0..n).step_by(step).map(asked).unzip();
        Self {
            trial: trial.index,
            rate_hz: trial.log.rate_hz / step as f64,
            time_s: thin(&trial.log.time_s),
            position_rad: thin(trial.followed_rad()),
            velocity_rad_s: (0..n).step_by(step).map(|i| trial.velocity_rad_s(i)).collect(),
            joint_torque_nm,
            gravity_nm,
            torque_nm: thin(&trial.torque_nm),
            in_range: trial.in_range(lowpass_hz).into_iter().step_by(step).collect(),
            deadband_rad: trial.deadband_rad,
            step_rad: trial.step_rad,
        }
    }

    /// Rigid-body torque at the joint with any measured load where the zero of `dynamics` says that the joint is, sample by
    /// sample, N m.
    pub fn joint_torque_nm<S: Scalar>(&self, dynamics: &Dynamics<S>) -> impl Fn(usize) -> S + use<'_, S> {
        let (sin, less) = (dynamics.position_zero_rad.sin(), dynamics.position_zero_rad.cos() - 1.0);
        move |i| less * self.gravity_nm[i].0 + self.joint_torque_nm[i] + sin * self.gravity_nm[i].1
    }

    /// dG/dq of gravity, the position's zero taken as right, N m/rad.
    pub fn gravity_slope_nm_rad(&self) -> Vec<f64> {
        self.gravity_nm.iter().map(|(_, slope_nm_rad)| *slope_nm_rad).collect()
    }
}
