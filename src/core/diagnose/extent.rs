//! Over what range a campaign moves.

use super::records::Records;
use crate::dynamics::JointKind;
use crate::effects::Extent;
use crate::log::Campaign;
use crate::model::{Combination, Model};
use crate::numerics::statistics::{extent, quantile};

/// Slower than this share of the fastest, the joint does not move.
const MOVING: f64 = 1e-3;
/// This share of the moving samples is slower than a slow motion.
const SLOW: f64 = 0.05;
/// This share is slower than the slowest that shows friction: in starting and turning a joint is slow for a moment.
const SLOWEST: f64 = 0.003;

/// Of `records`, of `campaign`, for a joint like `model`'s.
pub fn of(records: &Records, campaign: &Campaign, model: &Model) -> Extent {
    let mut speeds: Vec<f64> = records.speeds_rad_s();
    let fastest = quantile(&mut speeds, 0.999);
    let mut moving: Vec<f64> = speeds.into_iter().filter(|v| *v > MOVING * fastest).collect();
    let [slow, slowest_rad_s] = [SLOW, SLOWEST].map(|share| quantile(&mut moving, share));
    let end = |of: &dyn Fn(&super::record::Record, usize) -> f64| {
        let last = |record: &super::record::Record| record.time_s.len().checked_sub(1).map_or(0.0, |i| of(record, i));
        records.all.iter().map(last).fold(0.0, f64::max)
    };
    // A reversal is noticed a deadband after it, and what follows it is told from a jump once as far again.
    let resolution_rad = records.all.iter().map(|record| 2.0 * record.deadband_rad).fold(0.0, f64::max);
    let stroke = |record: &super::record::Record| record.travel_rad().into_iter().fold(0.0, f64::max);
    let payload = campaign.arm.as_ref().map(|arm| arm.chain.size_of_payload());
    let of_payload = records.all.iter().filter_map(|record| Some(record.chain.as_ref()?.squares(payload.as_ref()?)));
    let (weight, inertia) = of_payload.fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    Extent {
        stroke_rad: records.all.iter().map(stroke).filter(|stroke| *stroke > 0.0).fold(f64::INFINITY, f64::min),
        resolution_rad,
        position_rad: extent(&records.rows(|record, i| record.own[i].position)),
        speed_rad_s: (slow, fastest),
        slowest_rad_s,
        trial_s: end(&|record, i| record.time_s[i]),
        campaign_s: end(&|record, i| record.elapsed_s(i)),
        one_recording: records.one_recording,
        torque_nm: extent(&records.measured_nm()),
        others: records.others(),
        gravity_nm: model.dynamics.gravity_nm,
        payload,
        payload_weighs: weight > inertia,
        has_inertia: model.chain.is_some() || model.dynamics.inertia_kg_m2 != 0.0,
        changes_gradually: model.combination != Combination::Sign,
        backlash_m: model.joint.backlash_m,
        pulley_radius_m: model.joint.pulley_radius_m,
        turns: model.joint.kind == JointKind::Revolute,
    }
}
