//! What physics says against a campaign's declared scale, sign, zero, radii and gravity, before any model.
//!
//! All moving samples of all trials: y = g r G(q) + c r G'(q) + (f + h r G(q)) sign(v) + b by least squares, with r = r1/r2 and G
//! gravity and measured load as declared. Friction takes from the motion, so f + h r G > 0 on average: else a sign is wrong. g is
//! 1 / (1 - mu_c), between 1 and 2 where friction takes less than half of the load: else scale, radii or gravity are wrong, and
//! a mistake that people make may explain by how much. c / g is the tangent of the position's zero; sweeps tell that better, leg by
//! leg (`zero`). Near its ends a motion turns, and friction passes from one branch to the other: there nothing is counted. What
//! friction has of speed, in each direction, is fitted along.

use super::legs::{amplitude, fit_legs, load_of_a_nm};
use super::reading::Reading;
use super::sums::LegSums;
use super::zero::Zero;
use crate::dynamics::{Dynamics, JointKind};
use crate::log::{Campaign, Protocol};
use crate::model::Direction;
use crate::numerics::linear::solve;
use crate::numerics::statistics::{extent, mean, quantile, root_mean_square};
use crate::problem::Problem;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::FRAC_PI_2;

/// Samples used at most.
const SAMPLES: usize = 6000;
/// A speed below this share of the trial's fastest is too slow for its sign to count.
const MOVING: f64 = 0.05;
/// This share of a trial's range of position at either end is left out.
const ENDS: f64 = 0.1;
/// Friction below this share of the torque says nothing of a sign.
const FRICTION_SHARE: f64 = 0.01;
/// 1 / (1 - mu_c) of joints: friction gives nothing, and takes less than half of the load; the low end leaves room for declared
/// constants that are off by a few percent.
const GAIN: std::ops::Range<f64> = 0.92..2.0;
/// The low end where the load is measured: its sensor's noise takes from the gain.
const GAIN_OF_MEASURED: f64 = 0.5;
/// A winch this much larger than the pulley is unusual enough to think of a swap.
const SWAPPED: f64 = 1.5;
/// The gain of an ordinary joint, to say by how much a constant is off.
const USUAL_GAIN: f64 = 1.3;
/// A mistake explains a gain if without it the gain is within this.
const EXPLAINED: std::ops::Range<f64> = 0.9..2.2;
/// A zero that is off by more than this is told, beyond its own scatter, rad: 3 deg.
const ZERO_RAD: f64 = 0.052;
/// The same without sweeps, where friction that changes with speed looks alike, rad: 6 deg.
const ZERO_OF_FREE_RAD: f64 = 0.105;
/// A zero is looked for within this, rad, where sweeps tell it.
const ZERO_MOST_RAD: f64 = 0.5;
/// Standard errors of the mean over trials that a zero must be clear by.
const ZERO_ERRORS: f64 = 3.0;
/// Trials whose scatter says how well the zero is known.
const ZERO_TRIALS: usize = 3;
/// The load must change by this share of itself for gravity to be told from an offset.
const LOAD_CHANGE: f64 = 0.2;
/// A gravity torque beyond this was given in another unit, N m.
const GRAVITY_MOST_NM: f64 = 200.0;

/// What is most likely wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The sign of the torque, or of the position.
    Sign,
    /// The torque's scale or unit.
    Scale,
    /// The position's zero.
    Zero,
    /// A radius or the ratio.
    Radius,
    /// The gravity torque.
    Gravity,
}

impl Cause {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Scale => "scale",
            Self::Zero => "zero",
            Self::Radius => "radius",
            Self::Gravity => "gravity",
        }
    }

    /// The key of `campaign.toml` that it concerns.
    fn key(self) -> &'static str {
        match self {
            Self::Sign => "signal.torque_sign",
            Self::Scale => "columns.torque",
            Self::Zero => "columns.position",
            Self::Radius => "joint.winch_radius_m",
            Self::Gravity => "dynamics.gravity_nm",
        }
    }
}

/// A contradiction between data and declaration.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    /// What may explain it, the likeliest first.
    pub causes: Vec<Cause>,
    /// What is contradicted, with its figure.
    pub what: String,
    /// How to mend it.
    pub cure: String,
}

impl Doubt {
    /// As a problem of the campaign.
    pub fn problem(&self, campaign: &Campaign) -> Problem {
        let key = self.causes.first().map_or("", |cause| cause.key());
        Problem::warning(&campaign.file, self.what.as_str(), self.cure.as_str()).in_column(key)
    }
}

/// What the data say of gravity, friction and zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Torque that follows the declared load, over what the declared radii make of it: 1 / (1 - mu_c).
    pub gain: f64,
    /// Torque that friction takes, half the difference between up and down, N m; negative where it drives.
    pub friction_nm: f64,
    /// Angle by which the load leads the declared one, rad.
    pub zero_rad: f64,
    /// Root mean square of y, N m.
    pub torque_nm: f64,
    /// Whether the load changes enough along the motion for `gain` to mean something.
    pub has_load: bool,
}

/// One moving sample: load as seen at the sensor, its derivative, direction, speed, y.
type Row = [f64; 5];

/// What the `readings` of `campaign` say; `None` without motion.
pub fn evidence(campaign: &Campaign, readings: &[Reading]) -> Option<Evidence> {
    let rows: Vec<Vec<Row>> = readings.iter().map(|reading| moving(campaign, reading)).collect();
    Some(by_legs(campaign, fit(&rows.concat())?, &legs_of(readings)))
}

fn legs_of(readings: &[Reading]) -> Vec<LegSums> {
    readings.iter().flat_map(|reading| &reading.legs).cloned().collect()
}

/// `found` with the gain of A over the legs of sweeps, where there are any and the zero is not far off.
fn by_legs(campaign: &Campaign, found: Evidence, legs: &[LegSums]) -> Evidence {
    let scale = campaign.joint.transmission() * load_of_a_nm(campaign);
    let within_rad = if campaign.joint.kind == JointKind::Revolute { ZERO_MOST_RAD } else { 0.0 };
    let (_, fits) = fit_legs(legs, within_rad);
    let both = Direction::BOTH.map(|direction| amplitude(&fits, direction).map(|a| a.a_nm / scale));
    match both {
        [Some(up), Some(down)] if found.zero_rad.abs() < ZERO_MOST_RAD && (up + down).is_finite() => {
            Evidence { gain: (up + down) / 2.0, zero_rad: 0.0, ..found }
        }
        _ => found,
    }
}

/// Contradictions between `campaign` and its `readings`, the gravest first.
pub fn implausible(campaign: &Campaign, readings: &[Reading]) -> Vec<Doubt> {
    let rows: Vec<Vec<Row>> = readings.iter().map(|reading| moving(campaign, reading)).collect();
    let Some(found) = fit(&rows.concat()) else { return Vec::new() };
    let mut doubts = Vec::new();
    doubts.extend(sign(&found));
    let is_scaled = campaign.columns.from_current.is_none_or(|from| from.torque_constant_nm_a.is_some());
    let legs = legs_of(readings);
    if doubts.is_empty() && found.has_load && is_scaled {
        doubts.extend(gain(campaign, &by_legs(campaign, found, &legs)));
    }
    if doubts.is_empty() && found.has_load {
        doubts.extend(zero(campaign, &found, &rows, &legs));
    }
    doubts
}

fn moving(campaign: &Campaign, reading: &Reading) -> Vec<Row> {
    if reading.entry.protocol == Protocol::Interaction {
        return Vec::new();
    }
    let series = &reading.prepared.series;
    let ratio = campaign.joint.transmission();
    let load_nm = series.joint_torque_nm(&campaign.dynamics);
    // Turned by a quarter either way it differs by twice its derivative.
    let turned = |by_rad: f64| Dynamics { position_zero_rad: by_rad, ..campaign.dynamics };
    let (before_nm, after_nm) =
        (series.joint_torque_nm(&turned(-FRAC_PI_2)), series.joint_torque_nm(&turned(FRAC_PI_2)));
    let slope_nm_rad = |i: usize| (after_nm(i) - before_nm(i)) / 2.0;
    let fastest = series.velocity_rad_s.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (low, high) = extent(&series.position_rad);
    let inner = low + ENDS * (high - low)..high - ENDS * (high - low);
    let is_used = |i: &usize| {
        let is_moving = series.velocity_rad_s[*i].abs() > MOVING * fastest;
        is_moving && series.in_range[*i] && inner.contains(&series.position_rad[*i])
    };
    let used: Vec<usize> = (0..series.torque_nm.len()).filter(is_used).collect();
    let step = used.len().div_ceil(SAMPLES).max(1);
    let row = |i: usize| {
        let (load, slope) = (ratio * load_nm(i), ratio * slope_nm_rad(i));
        let velocity_rad_s = series.velocity_rad_s[i];
        [load, slope, velocity_rad_s.signum(), velocity_rad_s.abs(), series.torque_nm[i]]
    };
    used.into_iter().step_by(step).map(row).collect()
}

/// The regression over `rows`.
fn fit(rows: &[Row]) -> Option<Evidence> {
    let step = rows.len().div_ceil(SAMPLES).max(1);
    let rows: Vec<Row> = rows.iter().step_by(step).copied().collect();
    if rows.len() < 50 || [1.0, -1.0].iter().any(|sign| rows.iter().all(|row| row[2] != *sign)) {
        return None;
    }
    let column = |at: usize| rows.iter().map(|row| row[at]).collect::<Vec<f64>>();
    let change = |values: &[f64]| {
        let (low, high) = extent(values);
        (high - low) / low.abs().max(high.abs()).max(f64::MIN_POSITIVE)
    };
    let (load, slope) = (column(0), column(1));
    let has_load = change(&load) > LOAD_CHANGE;
    let has_slope = has_load && change(&slope) > LOAD_CHANGE;
    let speed = column(3);
    let has_speeds = change(&speed) > LOAD_CHANGE;
    let mut terms: Vec<Vec<f64>> = vec![column(2), vec![1.0; rows.len()]];
    let signed = |values: &[f64]| values.iter().zip(&rows).map(|(value, row)| value * row[2]).collect::<Vec<f64>>();
    let mut put = |is_there: bool, term: Vec<f64>| {
        is_there.then(|| {
            terms.push(term);
            terms.len() - 1
        })
    };
    let by_speed = put(has_speeds, signed(&speed));
    put(has_speeds, speed.clone());
    let by_load = put(has_load, signed(&load));
    let of_load = put(has_load, load.clone());
    let of_slope = put(has_slope, slope);
    let design = DMatrix::from_fn(rows.len(), terms.len(), |i, j| terms[j][i]);
    let y = column(4);
    let found = solve(&design, &DVector::from_column_slice(&y))?.coefficients;
    let of = |term: Option<usize>| term.map_or(0.0, |at| found[at]);
    Some(Evidence {
        gain: of(of_load),
        friction_nm: found[0] + of(by_speed) * mean(&speed) + of(by_load) * mean(&load),
        zero_rad: of(of_slope).atan2(of(of_load)),
        torque_nm: root_mean_square(&y),
        has_load,
    })
}

/// Friction that drives, or a load that pulls the wrong way.
fn sign(found: &Evidence) -> Option<Doubt> {
    let Evidence { gain, friction_nm, torque_nm, has_load, .. } = *found;
    if friction_nm.abs() < FRICTION_SHARE * torque_nm {
        return None;
    }
    let cure = "turn torque_sign in [signal], or, if the position counts the other way, give its column `scale = -1.0`";
    if friction_nm < 0.0 {
        let what = format!(
            "moving up the torque is {:.3} N m smaller than moving down: friction would drive the joint{}; the torque's sign is wrong",
            -2.0 * friction_nm,
            if has_load && gain < 0.0 { ", and gravity would lift it" } else { "" }
        );
        return Some(Doubt { causes: vec![Cause::Sign], what, cure: cure.to_string() });
    }
    (has_load && gain < 0.0).then(|| Doubt {
        causes: vec![Cause::Gravity, Cause::Zero, Cause::Sign],
        what: format!("the torque follows {gain:.2} times the declared load, though friction opposes motion: gravity is turned about"),
        cure: "turn the sign of gravity_nm, or correct the zero of the position: it may be off by 180 deg".to_string(),
    })
}

/// A load that the torque follows too little or too much.
fn gain(campaign: &Campaign, found: &Evidence) -> Option<Doubt> {
    let gain = found.gain.hypot(found.gain * found.zero_rad.tan());
    let low = if campaign.columns.load_torque.is_some() { GAIN_OF_MEASURED } else { GAIN.start };
    if (low..GAIN.end).contains(&gain) {
        return None;
    }
    let ratio = campaign.joint.transmission();
    let load_nm = load_of_a_nm(campaign);
    let explains = |factor: f64| EXPLAINED.contains(&(gain / factor));
    let (side, times) = if gain > USUAL_GAIN { ("large", gain / USUAL_GAIN) } else { ("small", USUAL_GAIN / gain) };
    let what = format!(
        "the torque follows {} times what gravity and the radii ask for, where friction makes it 1 to 2 times",
        shown(gain)
    );
    let doubt = |causes: Vec<Cause>, cure: String| Some(Doubt { causes, what: what.clone(), cure });
    let is_heavy = load_nm.abs() > GRAVITY_MOST_NM;
    if explains(1e3) {
        return doubt(vec![Cause::Scale], "the torque looks 1000 times too large: recorded in mN m?".to_string());
    }
    if explains(1e-3) && is_heavy {
        return doubt(
            vec![Cause::Gravity],
            format!("gravity_nm = {load_nm} looks 1000 times too large: given in mN m?"),
        );
    }
    if explains(1e-3) {
        return doubt(
            vec![Cause::Scale],
            "the torque looks 1000 times too small: recorded in kN m, or mN m declared twice?".to_string(),
        );
    }
    // What a swap of the radii would make of the gain.
    let swapped = ratio.powi(-2);
    if ratio > SWAPPED && explains(swapped) {
        let cure = "the radii look swapped: winch_radius_m is the motor's, pulley_radius_m the joint's".to_string();
        return doubt(vec![Cause::Radius, Cause::Scale, Cause::Gravity], cure);
    }
    if explains(1.0 / ratio) && (1.0 / ratio) > GAIN.end {
        let cure = format!(
            "the torque looks {side} by {times:.2}, about r2/r1: measured at the joint, not at the winch (then drive = \"direct\")? Or a radius, or \
             gravity_nm is off by that"
        );
        return doubt(vec![Cause::Scale, Cause::Radius, Cause::Gravity], cure);
    }
    for (factor, cause, why) in [
        (100.0, Cause::Scale, "the torque looks 100 times too large: recorded in N cm?"),
        (0.01, Cause::Scale, "the torque looks 100 times too small: N m declared as N cm?"),
        (
            9.81,
            Cause::Gravity,
            "gravity_nm looks 9.81 times too small: mass times distance without g? Or the torque is in kgf m",
        ),
        (
            1.0 / 9.81,
            Cause::Gravity,
            "gravity_nm looks 9.81 times too large: g taken twice? Or the torque's scale is off by that",
        ),
    ] {
        if explains(factor) {
            let mut causes = vec![Cause::Gravity, Cause::Scale, Cause::Radius];
            causes.sort_by_key(|other| *other != cause);
            return doubt(causes, why.to_string());
        }
    }
    let cure = match side {
        "large" => format!(
            "gravity_nm or the winch's radius is too small, the pulley's radius or the torque too large, by about {times:.1}: a diameter for a radius?"
        ),
        _ => format!(
            "gravity_nm or the winch's radius is too large, the pulley's radius or the torque too small, by about {times:.1}: a diameter for a radius?"
        ),
    };
    doubt(vec![Cause::Gravity, Cause::Radius, Cause::Scale], cure)
}

/// A load that leads or lags the declared one.
fn zero(campaign: &Campaign, found: &Evidence, rows: &[Vec<Row>], legs: &[LegSums]) -> Option<Doubt> {
    if campaign.joint.kind != JointKind::Revolute || campaign.dynamics.gravity_nm == 0.0 {
        return None;
    }
    let of_legs = Zero::estimate(legs, ZERO_MOST_RAD);
    let is_off = match of_legs.is_fitted() && found.zero_rad.abs() < ZERO_MOST_RAD {
        true => of_legs.rad.abs() - of_legs.half_width_rad > ZERO_RAD,
        false => is_off_in_all(found.zero_rad, rows),
    };
    if !is_off {
        return None;
    }
    let zero_rad =
        if of_legs.is_fitted() && found.zero_rad.abs() < ZERO_MOST_RAD { of_legs.rad } else { found.zero_rad };
    let degrees = zero_rad.to_degrees();
    Some(Doubt {
        causes: vec![Cause::Zero],
        what: format!(
            "gravity's torque is 0 at a reading of {:.1} deg, not at 0: the position's zero looks off",
            -degrees
        ),
        cure: format!(
            "add {degrees:.1} deg to the position (its column's `offset`), unless another load (a spring, a centre of mass off the line) does this"
        ),
    })
}

/// Whether the trials agree on a zero that is off like `zero_rad`.
fn is_off_in_all(zero_rad: f64, rows: &[Vec<Row>]) -> bool {
    let each: Vec<f64> = rows.iter().filter_map(|rows| Some(fit(rows)?.zero_rad)).collect();
    if each.len() < ZERO_TRIALS {
        return false;
    }
    let middle = quantile(&mut each.clone(), 0.5);
    let mut apart: Vec<f64> = each.iter().map(|zero| (zero - middle).abs()).collect();
    // The median of the distances times 1.48 is a normal scatter's standard deviation.
    let error = 1.48 * quantile(&mut apart, 0.5) / (each.len() as f64).sqrt();
    let size = middle.abs().min(zero_rad.abs());
    size - ZERO_ERRORS * error > ZERO_OF_FREE_RAD && middle.signum() == zero_rad.signum()
}

/// A factor with as many digits as it deserves.
fn shown(factor: f64) -> String {
    if factor >= 100.0 {
        format!("{factor:.0}")
    } else if factor >= 0.01 {
        format!("{factor:.2}")
    } else {
        format!("{factor:.1e}")
    }
}
