//! The torque sensor's zero moves with time.

use super::{
    About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, Starts, clock_s, scanned,
    varies,
};
use crate::numerics::scalar::Scalar;
use crate::numerics::statistics;
use std::f64::consts::PI;

/// Where what settles, and where the waves stand among the parameters.
const SETTLES: std::ops::RangeInclusive<usize> = 3..=4;
const FIRST_WAVE: usize = 6;
/// Most waves; without waves the drift settles and goes on linearly, with them it varies slowly. Both together are not identifiable on a
/// held-out trial: only the first trial shows what settles.
const WAVES: usize = 4;
/// So few are tried, too: what varies slowly is foreseen best by them where a trial is held out.
const FEW_WAVES: f64 = 2.0;
/// Largest way of a drift, as a share of the reading's range: at its ends, which few samples show, its law goes a little beyond what was read.
const SPAN_MAX: f64 = 1.1;
/// Largest share of all its way that a drift may go back where it starts anew with each trial: creep goes one way, and what wanders has no
/// reason to wander alike in every trial.
const BACK_MAX: f64 = 0.1;
/// Where the constant stands: what drifts has no reason to begin at zero.
const OFFSET: usize = FIRST_WAVE + WAVES;

static ABOUT: About = About {
    id: "sensor_drift",
    family: Family::Fault,
    acts_on: ActsOn::Sensor,
    means: "the torque sensor's offset moves with time",
    formula: "reading = y + offset_nm + line_nm t/horizon_s + settle_nm exp(-t/settle_s) + sum over k of wave_k_nm cos(pi k t/horizon_s), k to \
              waves",
    source: "temperature drift of strain gauges; a smooth function of time",
    signature: Region::Time,
    trades_with: &["warm_up", "joint_coupling", "sensor_bias"],
    example: "restarts=0,horizon_s=40,waves=4,settle_s=5,line_nm=0.1,wave_2_nm=0.03",
    parameters: &[
        Parameter::choice("restarts", 0.0, 1.0),
        Parameter::choice("horizon_s", 1e-3, 1e9),
        Parameter::form("waves", WAVES as f64),
        Parameter::shape("settle_s", 1e-3, 1e7),
        Parameter::strength("settle_nm"),
        Parameter::strength("line_nm"),
        Parameter::wave("wave_1_nm", 0.05),
        Parameter::wave("wave_2_nm", 0.0125),
        Parameter::wave("wave_3_nm", 0.0056),
        Parameter::wave("wave_4_nm", 0.0031),
        Parameter::strength("offset_nm"),
    ],
    needs: &[Excitation::Time],
    by_hand: Some("leave the joint at rest without load for as long as the campaign took and log the sensor"),
    remedy: Some("Let the torque sensor warm up and tare it before each trial; the model need not change for it."),
    starts: Starts::Forms,
    of_time: true,
    ..About::PLAIN
};

#[derive(Debug)]
pub struct SensorDrift;

impl Effect for SensorDrift {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs_clock(&self, p: &[f64]) -> bool {
        p[0] <= 0.5
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let of = |waves: f64| {
            extent.clocks().map(move |(restarts, horizon_s)| {
                let shapes = [restarts, horizon_s, waves, horizon_s / 8.0];
                shapes.into_iter().chain([0.0; 2 + WAVES + 1]).collect()
            })
        };
        of(0.0).chain(of(FEW_WAVES)).chain(of(WAVES as f64)).collect()
    }

    fn uses(&self, p: &[f64], at: usize) -> bool {
        let wanders = p[2] > 0.0;
        match at {
            _ if SETTLES.contains(&at) => !wanders,
            _ => at < FIRST_WAVE || at == OFFSET || ((at - FIRST_WAVE) as f64) < p[2],
        }
    }

    /// A zero that moves by more than all that the sensor read is no drift, one that hardly moves is an offset, and one that goes forth and
    /// back alike in each trial follows the motion.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let drift_nm = |t_s| offset_nm(p, t_s);
        let course_nm = scanned(drift_nm, p[1]);
        let (low, high) = statistics::extent(&course_nm);
        let is_small = high - low <= SPAN_MAX * (extent.torque_nm.1 - extent.torque_nm.0);
        is_small && varies(drift_nm, p[1]) && (p[0] <= 0.5 || share_back(&course_nm) <= BACK_MAX)
    }
}

impl<S: Scalar> Hooks<S> for SensorDrift {
    fn reading_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        torque_nm + offset_nm(p, clock_s(p[0].value(), sample))
    }
}

/// The share of its whole way that `course` goes against the direction in which it goes further.
fn share_back(course: &[f64]) -> f64 {
    let way = |sign: f64| course.windows(2).map(|pair| (sign * (pair[1] - pair[0])).max(0.0)).sum::<f64>();
    let (up, down) = (way(1.0), way(-1.0));
    up.min(down) / (up + down).max(f64::MIN_POSITIVE)
}

/// The offset `t_s` on its clock, N m.
fn offset_nm<S: Scalar>(p: &[S], t_s: S::Given) -> S {
    let share = t_s / p[1];
    // cos(k x) from the two before: a smooth drift needs no more.
    let first = (share * PI).cos();
    let (mut before, mut now, mut sum) = (S::from(1.0), first, p[OFFSET]);
    for wave_nm in &p[FIRST_WAVE..OFFSET] {
        sum += *wave_nm * now;
        (before, now) = (now, first * 2.0 * now - before);
    }
    p[4] * (-t_s / p[3]).exp() + p[5] * share + sum
}
