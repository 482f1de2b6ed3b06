//! What `tautline simulate` takes for a joint under a controller.

use crate::problem::{Problem, Problems, Result};
use crate::simulate::Wanted;

#[derive(Debug, clap::Args)]
pub struct Motor {
    /// The trajectory is a command: a motor under a position controller drives the joint, which moves as its inertia, weight and
    /// friction let it. Logs hold the command too
    #[arg(long, help_heading = "Closed loop")]
    closed_loop: bool,
    /// The controller's stiffness at the joint, N m/rad [default: such that weight and friction deflect the joint by 0.01 rad]
    #[arg(long, requires = "closed_loop", help_heading = "Closed loop")]
    stiffness_nm_rad: Option<f64>,
    /// The controller's damping at the joint, N m s/rad [default: critical, and more where friction falls with speed]
    #[arg(long, requires = "closed_loop", help_heading = "Closed loop")]
    damping_nm_s_rad: Option<f64>,
    /// The most that the motor gives at the winch, N m [default: no limit]
    #[arg(long, requires = "closed_loop", help_heading = "Closed loop")]
    torque_limit_nm: Option<f64>,
    /// Inertia of motor and gear about the winch, before the torque sensor, kg m^2
    #[arg(long, requires = "closed_loop", default_value_t = 0.0, help_heading = "Closed loop")]
    motor_inertia_kg_m2: f64,
    /// The controller adds the torque that the model without --effect predicts along the command
    #[arg(long, requires = "closed_loop", help_heading = "Closed loop")]
    feedforward: bool,
    /// Logs hold no torque, and the campaign declares the command and the controller instead
    #[arg(long, requires = "closed_loop", conflicts_with_all = ["feedforward", "torque_sign"], help_heading = "Closed loop")]
    pub position_alone: bool,
}

impl Motor {
    /// What is wanted of a controller; nothing where the motion is prescribed.
    ///
    /// Errors: every number that makes no sense.
    pub fn wanted(&self) -> Result<Option<Wanted>> {
        if !self.closed_loop {
            return Ok(None);
        }
        let problems = [
            ("stiffness-nm-rad", self.stiffness_nm_rad, 1e-6),
            ("damping-nm-s-rad", self.damping_nm_s_rad, 0.0),
            ("torque-limit-nm", self.torque_limit_nm, 1e-6),
            ("motor-inertia-kg-m2", Some(self.motor_inertia_kg_m2), 0.0),
        ]
        .into_iter()
        .filter_map(|(name, value, low)| {
            let value = value.filter(|x| !x.is_finite() || *x < low)?;
            Some(Problem::error("command line", format!("--{name} is {value}"), format!("expected {low} or more")))
        });
        Problems(problems.collect()).unless_errors(Some(Wanted {
            stiffness_nm_rad: self.stiffness_nm_rad,
            damping_nm_s_rad: self.damping_nm_s_rad,
            torque_limit_nm: self.torque_limit_nm,
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            feedforward: self.feedforward,
        }))
    }
}
