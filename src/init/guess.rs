//! What a column's numbers say of its unit, and whether one column is the derivative of another.

use crate::dynamics::JointKind;
use crate::numerics::statistics::{extent, quantile};
use crate::units::Unit;

/// Time grows evenly if this share of its steps is near the common one.
const EVEN_SHARE: f64 = 0.8;
/// Sample periods that recorders of joints have, s; beyond, the unit of time is another.
const PERIOD_S: std::ops::Range<f64> = 2e-5..0.05;
/// An angle beyond this was not recorded in rad.
const RADIAN_MOST: f64 = 7.0;
/// Turns within which a joint moves.
const TURNS_MOST: f64 = 2.0;

/// The common step of `values` where they grow nearly evenly; a few that repeat or jump are let pass.
pub fn common_step(values: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < 10 {
        return None;
    }
    let middle = quantile(&mut steps, 0.5);
    let near = steps.iter().filter(|step| (0.4..1.6).contains(&(*step / middle))).count();
    let falls = steps.iter().filter(|step| **step < 0.0).count();
    let is_even = middle > 0.0 && near as f64 >= EVEN_SHARE * steps.len() as f64 && falls == 0;
    is_even.then_some(middle)
}

/// The unit of time in which a `step` is a sample period, why, and what remains to be asked.
pub fn time_unit(step: f64) -> (Unit, String, Option<String>) {
    let units = [Unit::Second, Unit::Millisecond, Unit::Microsecond, Unit::Nanosecond];
    let fits: Vec<Unit> = units.into_iter().filter(|unit| PERIOD_S.contains(&(step * unit.factor()))).collect();
    let unit = fits.first().copied().unwrap_or(Unit::Second);
    let rate_hz = 1.0 / (step * unit.factor());
    let why = format!("no unit in the header; in {} the rate is {rate_hz:.6} Hz", unit.name());
    // One unit alone gives a rate that recorders have, or the next one gives ten thousands of Hz.
    let others: Vec<Unit> = fits.into_iter().skip(1).filter(|unit| step * unit.factor() > 1e-4).collect();
    let is_sure = PERIOD_S.contains(&(step * unit.factor())) && others.is_empty();
    let question = (!is_sure).then(|| format!("unit? In {} the rate would be {rate_hz:.6} Hz", unit.name()));
    (unit, why, question)
}

/// The unit in which `values` are a joint's positions, why, and what remains to be asked.
pub fn position_unit(kind: JointKind, values: &[f64]) -> (Unit, String, Option<String>) {
    let (low, high) = extent(values);
    let most = low.abs().max(high.abs());
    let spans = format!("no unit in the header; it goes from {low:.4} to {high:.4}");
    if kind == JointKind::Prismatic {
        let unit = if most > 3.0 { Unit::Millimetre } else { Unit::Metre };
        return (unit, spans, Some("unit, m or mm?".to_string()));
    }
    match () {
        () if most > 4.0 * 360.0 => {
            let asks = "unit? No joint turns that far. For counts say what one is, such as `1/4096 turn`".to_string();
            (Unit::Degree, spans, Some(asks))
        }
        () if most > RADIAN_MOST => (Unit::Degree, spans, None),
        () => {
            let asks = format!("unit, rad or deg? In rad it moves over {:.0} deg", (high - low).to_degrees());
            (Unit::Radian, spans, Some(asks))
        }
    }
}

/// What is to be asked of a position that turns farther than joints do: a motor's, before its gear.
pub fn too_far(kind: JointKind, unit: Unit, values: &[f64]) -> Option<String> {
    let (low, high) = extent(values);
    let turns = (high - low) * unit.factor() / Unit::Turn.factor();
    (kind == JointKind::Revolute && turns > TURNS_MOST).then(|| {
        let name = unit.name();
        format!("it turns {turns:.1} times: if it is the motor's, say what a reading is at the joint, such as `1/50 {name}`; else `{name}`")
    })
}

/// Slope of `velocity` on the derivative of `position`, sampled every `step_s`; `None` where their correlation is not above `least`.
pub fn slope_on_derivative(velocity: &[f64], position: &[f64], step_s: f64, least: f64) -> Option<f64> {
    /// Samples over which differences are taken, to leave an encoder's steps behind.
    const HALF: usize = 10;
    let n = position.len().min(velocity.len());
    let (mut dd, mut dv, mut vv) = (0.0, 0.0, 0.0);
    for i in HALF..n.saturating_sub(HALF) {
        let derivative = (position[i + HALF] - position[i - HALF]) / (2.0 * HALF as f64 * step_s);
        let here = velocity[i - HALF..=i + HALF].iter().sum::<f64>() / (2 * HALF + 1) as f64;
        if derivative.is_finite() && here.is_finite() {
            dd += derivative * derivative;
            dv += derivative * here;
            vv += here * here;
        }
    }
    let correlation = dv / (dd * vv).sqrt();
    // What is asked for is position's unit per velocity's: a velocity in rad/s of a position in deg has a slope of pi / 180.
    (correlation > least && dd > 0.0).then(|| dv / dd)
}
