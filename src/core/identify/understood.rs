//! What a campaign's recordings are understood to be, in figures that a reader can hold against the rig.

use super::implausible::{Evidence, evidence};
use super::reading::Reading;
use crate::log::{Campaign, Protocol, TorqueFrom};
use crate::model::Joint;
use crate::numerics::statistics::{extent, quantile};

/// Of a sweep those samples are its constant speed that reach this share of the fastest.
const AT_SPEED: f64 = 0.5;

/// All trials together, and each.
#[derive(Debug, Clone)]
pub struct Understood {
    /// The joint.
    pub joint: Joint,
    /// Each trial.
    pub trials: Vec<UnderstoodTrial>,
    /// r1/r2.
    pub ratio: f64,
    /// Where the torque comes from, if no column holds it.
    pub torque_from: Option<TorqueFrom>,
    /// What the data say of gravity and friction.
    pub evidence: Option<Evidence>,
}

/// One trial; for a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone)]
pub struct UnderstoodTrial {
    /// Its file.
    pub file: String,
    /// How it was moved.
    pub protocol: Protocol,
    /// Rows of its log.
    pub rows: usize,
    /// Rows of its log per second, Hz.
    pub rate_hz: f64,
    /// The speed of a sweep as found: the median where it moves steadily, rad/s.
    pub speed_rad_s: f64,
    /// What a step of the encoder is, where it matters, rad.
    pub step_rad: f64,
    /// Root mean square of what the low-pass takes from the torque, N m.
    pub noise_nm: f64,
    /// Time, position, speed and low-passed y, thinned: s, rad, rad/s, N m.
    pub series: [Vec<f64>; 4],
}

impl Understood {
    /// What `readings` of `campaign` are; nothing without any.
    pub fn of(campaign: &Campaign, readings: &[Reading]) -> Option<Self> {
        (!readings.is_empty()).then(|| Self {
            joint: campaign.joint.clone(),
            trials: readings.iter().map(UnderstoodTrial::of).collect(),
            ratio: campaign.joint.transmission(),
            torque_from: campaign.columns.torque_from,
            evidence: evidence(campaign, readings),
        })
    }

    /// The least and the most of one of the series over all trials.
    pub fn extent(&self, of: usize) -> (f64, f64) {
        let each = self.trials.iter().map(|trial| extent(&trial.series[of]));
        each.fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one.0), all.1.max(one.1)))
    }

    /// The sweeps: each with the speed declared and the speed found, rad/s.
    pub fn sweeps(&self) -> impl Iterator<Item = (f64, f64)> {
        self.trials.iter().filter_map(|trial| Some((trial.protocol.speed_rad_s()?, trial.speed_rad_s)))
    }
}

impl UnderstoodTrial {
    fn of(reading: &Reading) -> Self {
        let series = &reading.prepared.series;
        let speeds_rad_s = reading.speeds_rad_s();
        let fastest = speeds_rad_s.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let mut steady: Vec<f64> = speeds_rad_s.iter().map(|v| v.abs()).filter(|v| *v > AT_SPEED * fastest).collect();
        Self {
            file: reading.entry.file.clone(),
            protocol: reading.entry.protocol,
            rows: reading.rows,
            rate_hz: reading.rate_hz,
            speed_rad_s: if steady.is_empty() { 0.0 } else { quantile(&mut steady, 0.5) },
            step_rad: series.step_rad,
            noise_nm: reading.noise_nm,
            series: [&series.time_s, &series.position_rad, &series.velocity_rad_s, &series.torque_nm].map(Vec::clone),
        }
    }

    /// How long it lasts, s.
    pub fn duration_s(&self) -> f64 {
        (self.rows as f64 - 1.0) / self.rate_hz
    }
}
