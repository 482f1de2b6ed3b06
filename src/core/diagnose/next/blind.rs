//! What the recordings cannot show at all, whatever the joint has: causes that they hide.

use super::motions::Motion;
use super::words;
use crate::diagnose::base::BaseModel;
use crate::diagnose::cause::needing;
use crate::diagnose::data::DataSet;
use crate::effects::Excitation;
use crate::numerics::statistics::{extent, quantile, root_mean_square};
use crate::trajectory::Trajectory;

/// A load counts as constant if it varies by less than this share of its size, or by less than this many floors at the winch.
const LOAD_SHARE: f64 = 0.25;
const LOAD_FLOORS: f64 = 2.0;
/// Speeds count as one speed if the 90th percentile is less than this multiple of the 10th.
const SPEED_RATIO: f64 = 1.5;
/// A revolute joint that moves less, rad (30 deg), shows functions of position as straight lines.
const WAY_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// A shorter campaign shows neither drift nor warm-up, s.
const CAMPAIGN_S: f64 = 240.0;
/// A delay that matters, s: its torque error must reach the floor to be seen.
const DELAY_S: f64 = 0.02;
/// Radius of gyration of a limb, m, where the model has no inertia: the lever arm of its weight. Without weight no statement is made.
const ARM_M: f64 = 0.3;
/// Another joint that stays within this, rad, does not move.
const STILL_RAD: f64 = 0.02;
/// Share of the range that counts as a reversal.
const REVERSAL_SHARE: f64 = 0.02;

/// Something that the excitation lacks.
#[derive(Debug, Clone, PartialEq)]
pub struct BlindSpot {
    /// What it is: "one load only (0.41 to 0.44 N m at the joint)".
    pub what: String,
    /// Causes that cannot show.
    pub hides: Vec<&'static str>,
    /// What would show them.
    pub advice: String,
    /// The motion that would, where one does.
    pub trajectory: Option<Trajectory>,
}

/// What the recordings hide, of all `motions` the one that shows it.
pub fn blind_spots(base: &BaseModel<'_>, motions: &[Motion]) -> Vec<BlindSpot> {
    let sight = Sight { base, motions };
    [sight.load(), sight.reversal(), sight.speed(), sight.way(), sight.pace(), sight.time(), sight.other()]
        .into_iter()
        .flatten()
        .collect()
}

struct Sight<'s> {
    base: &'s BaseModel<'s>,
    motions: &'s [Motion],
}

impl Sight<'_> {
    /// A spot that `motion` would light, or what `otherwise` says.
    fn spot(&self, what: String, hides: Vec<&'static str>, motion: &str, otherwise: &str) -> Option<BlindSpot> {
        let found = self.motions.iter().find(|m| m.trajectory.name == motion);
        let advice = match found {
            Some(motion) => words::record(motion, super::REPEATS_MIN, &self.base.data().extent),
            None => otherwise.to_string(),
        };
        let trajectory = found.map(|m| Trajectory { repeats: Some(super::REPEATS_MIN), ..m.trajectory.clone() });
        Some(BlindSpot { what, hides, advice, trajectory })
    }

    fn load(&self) -> Option<BlindSpot> {
        let model = &self.base.model;
        let mut loads = self.base.data().records.rows(|record, i| record.load_nm(i, model));
        let (low, high) = (quantile(&mut loads, 0.02), quantile(&mut loads, 0.98));
        let limit = (LOAD_SHARE * low.abs().max(high.abs()))
            .max(LOAD_FLOORS * self.base.mask.floor_nm / model.joint.transmission());
        if high - low > limit {
            return None;
        }
        let unit = if self.base.data().extent.turns { "N m" } else { "N" };
        let weighs = model.chain.is_some() || (self.base.data().extent.turns && model.dynamics.gravity_nm != 0.0);
        self.spot(
            format!("one load only ({low:.3} to {high:.3} {unit} at the joint): load dependence cannot be detected"),
            needing(Excitation::Loads),
            if weighs { "wide_slow_sweeps" } else { "" },
            "Record the same motion again with a second, known load",
        )
    }

    fn reversal(&self) -> Option<BlindSpot> {
        let (low, high) = self.base.data().extent.position_rad;
        let limit = REVERSAL_SHARE * (high - low);
        let turns = |record: &super::super::record::Record| {
            let travel = record.travel_rad();
            record.rows.windows(2).any(|pair| travel[pair[0]] - travel[pair[1]] > limit)
        };
        if self.base.data().records.all.iter().any(turns) {
            return None;
        }
        self.spot(
            "no reversal: what happens after one cannot be detected".to_string(),
            needing(Excitation::Reversals),
            "small_reversals",
            "Record motion back and forth",
        )
    }

    fn speed(&self) -> Option<BlindSpot> {
        let (_, fastest) = self.base.data().extent.speed_rad_s;
        let speeds = self.base.data().records.rows(|record, i| record.own[i].velocity.abs());
        let mut moving: Vec<f64> = speeds.into_iter().filter(|v| *v > 0.05 * fastest).collect();
        let (slow, fast) = (quantile(&mut moving, 0.1), quantile(&mut moving, 0.9));
        if fast > SPEED_RATIO * slow {
            return None;
        }
        self.spot(
            format!(
                "one speed only ({fast:.3} {}): dependence on speed cannot be detected",
                words::speed(&self.base.data().extent)
            ),
            needing(Excitation::Speeds),
            "sweeps",
            "Record at several speeds",
        )
    }

    fn way(&self) -> Option<BlindSpot> {
        let (low, high) = self.base.data().extent.position_rad;
        if !self.base.data().extent.turns || high - low > WAY_RAD {
            return None;
        }
        let range = words::range(&self.base.data().extent, (low, high));
        self.spot(
            format!("a short way only ({range}): functions of position look like straight lines"),
            needing(Excitation::Range),
            "wide_sweeps",
            "Record a wider range",
        )
    }

    /// Neither inertia nor a delay changes the torque by the floor.
    fn pace(&self) -> Option<BlindSpot> {
        let (data, model) = (self.base.data(), &self.base.model);
        let inertia = match model.dynamics.inertia_kg_m2 {
            known if known > 0.0 => known,
            _ => model.dynamics.gravity_nm.abs() * ARM_M / crate::dynamics::GRAVITY_M_S2,
        };
        let asks = data.records.rows(|record, i| model.joint.transmission() * inertia * record.own[i].acceleration);
        let steps = data.records.all.iter().zip(&data.records.ranges).flat_map(|(record, range)| {
            let row_s = record.rows.get(1).map_or(1.0, |next| (next - record.rows[0]) as f64 / record.rate_hz);
            let of_record = &data.measured_nm[range.clone()];
            of_record.windows(2).map(move |y| (y[1] - y[0]) / row_s).collect::<Vec<f64>>()
        });
        let late = DELAY_S * root_mean_square(&steps.collect::<Vec<f64>>());
        let (blind_inertia, blind_delay) = (
            model.chain.is_none() && inertia > 0.0 && root_mean_square(&asks) < self.base.mask.floor_nm / 2.0,
            late < self.base.mask.floor_nm / 2.0,
        );
        let blind = [(Excitation::Acceleration, blind_inertia), (Excitation::TorqueRate, blind_delay)];
        let hides: Vec<&'static str> = blind.into_iter().filter(|x| x.1).flat_map(|x| needing(x.0)).collect();
        if hides.is_empty() {
            return None;
        }
        let what = format!("no fast motion: {} cannot be detected above the noise floor", words::listed(&hides));
        self.spot(what, hides, "fast_cosines", "Record faster motion")
    }

    fn time(&self) -> Option<BlindSpot> {
        let whole_s = self.base.data().extent.campaign_s;
        if whole_s > CAMPAIGN_S {
            return None;
        }
        self.spot(
            format!("only {whole_s:.0} s of data: slow effects (drift, warm-up) cannot be detected"),
            needing(Excitation::Time),
            "long_dwells",
            "Record for some minutes",
        )
    }

    fn other(&self) -> Option<BlindSpot> {
        let others = others_rad(self.base.data());
        let what = match others.is_empty() {
            true => "no other joint is recorded",
            false if others.iter().all(|(low, high)| high - low < STILL_RAD) => "no other joint moves",
            false => return None,
        };
        self.spot(
            format!("{what}: what another joint does to this one cannot be detected"),
            needing(Excitation::OtherJoint),
            "other_1_alone",
            "Where another joint's cables pass this one, record its position too (other_position), moving alone",
        )
    }
}

/// Lowest and highest position of every other joint, rad.
pub fn others_rad(data: &DataSet) -> Vec<(f64, f64)> {
    let of = |joint: usize| extent(&data.records.rows(|record, i| record.other(joint, i).position));
    (0..data.records.others()).map(of).collect()
}
