//! Motions to record, held against what the joint may do before anything moves.

mod limits;

pub use limits::Limits;

use crate::dynamics::Chain;
use crate::model::Model;
use crate::problem::{Problem, Problems, Result};
use crate::simulate::{Course, Sensors, record};
use crate::trajectory::{Extremes, Trajectory};

/// Samples a second along which a model's torque is looked at: fifty in the shortest period of the paper's cascade are plenty.
pub const RATE_HZ: f64 = 200.0;
/// A motion may touch its limit: share by which rounding may lift it above.
const ROUNDING: f64 = 1e-9;

/// The joint as it is known, whose torque along a motion is asked for.
#[derive(Debug, Clone)]
pub struct Known {
    /// Its model.
    pub model: Model,
    /// The chain that takes the place of the model's own gravity and inertia.
    pub chain: Option<Chain>,
}

/// A motion, and what it asks of the joint.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The motion.
    pub trajectory: Trajectory,
    /// Of one run, s.
    pub duration_s: f64,
    /// Position, speed, acceleration.
    pub extremes: Extremes,
    /// The torque along it, N m at the winch, `RATE_HZ` a second; nothing without a model.
    pub torque_nm: Option<Vec<f64>>,
}

impl Asked {
    /// Of `trajectory`, with the torque that the joint as it is `known` takes.
    pub fn of(trajectory: Trajectory, known: Option<&Known>) -> Self {
        let torque_nm = known.map(|known| known.torque_nm(&trajectory));
        let (duration_s, extremes) = (trajectory.own.duration_s(), trajectory.own.extremes());
        Self { trajectory, duration_s, extremes, torque_nm }
    }

    /// The largest torque along it, N m.
    pub fn largest_nm(&self) -> Option<f64> {
        Some(self.torque_nm.as_ref()?.iter().map(|y| y.abs()).fold(0.0, f64::max))
    }

    /// All its runs, s.
    pub fn whole_s(&self) -> f64 {
        self.duration_s * f64::from(self.trajectory.repeats.unwrap_or(1))
    }
}

impl Known {
    fn torque_nm(&self, trajectory: &Trajectory) -> Vec<f64> {
        let position_rad = trajectory.positions_rad(RATE_HZ);
        let samples = position_rad.len();
        let along = |path: Option<&crate::trajectory::Path>| {
            let mut positions_rad = path.map_or_else(Vec::new, |path| path.positions_rad(RATE_HZ));
            positions_rad.resize(samples, path.map_or(0.0, crate::trajectory::Path::end_rad));
            positions_rad
        };
        let others = self.chain.as_ref().map_or(trajectory.others.len(), |chain| chain.others().count());
        let others_rad = (0..others).map(|at| along(trajectory.others.get(at))).collect();
        let course = Course { position_rad, others_rad, ..Course::default() };
        let exact = Sensors { torque_noise_nm: 0.0, encoder_counts: 0.0 };
        record(&self.model, self.chain.as_ref(), &course, RATE_HZ, exact, 0).torque_nm
    }
}

/// Every motion in `asked` held against `limits`.
///
/// Errors: each limit that a motion breaks, and a limit on torque where no model tells it.
pub fn check(asked: &[Asked], limits: &Limits) -> Result<()> {
    let mut problems: Vec<Problem> = asked.iter().flat_map(|one| limits.broken_by(one)).collect();
    if limits.torque_nm.is_some() && asked.iter().any(|one| one.torque_nm.is_none()) {
        let what = "the torque has a limit, and nothing tells the torque";
        problems.push(Problem::error("limits", what, "add --model with a model of the joint, or drop that limit"));
    }
    Problems(problems).unless_errors(())
}
