//! Steps 2 to 4 of the protocol: A and B of every leg.
//!
//! (17) y = A sin(theta) + B on each leg by ordinary least squares, on the torque as recorded: over a whole leg least
//! squares is itself a far narrower low-pass than the declared one, and unlike it carries nothing of the reversals into the
//! leg, so that A and B are exact on exact data. The declared low-pass serves the figures (R^2, RMSE), as in the paper.
//! Then A is the mean over the legs of a direction, and B of a leg its mean of y - A sin(theta).
//!
//! A measured load stands beside gravity: then the regressor is (G sin(theta) + load) / G, and without gravity the load alone,
//! of which A is what the winch sees of 1 N m. Without either A is fixed at zero, and y is friction.

use crate::log::Campaign;
use crate::model::{Both, Direction};
use crate::numerics::statistics::{mean, root_mean_square, standard_deviation, student_t};
use crate::prepare::{Leg, Trial};
use crate::problem::{Problem, Result};
use std::path::Path;

/// A load whose standard deviation along a leg is below this share of it does not change.
const STEADY: f64 = 0.01;
/// A leg is cut into this many blocks to judge its errors: a block outlasts the noise's memory, and 20 of them leave a
/// standard error known to 16 %.
const BLOCKS: usize = 20;

/// The regression of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegFit {
    /// The trial's file.
    pub file: String,
    /// The trial's repeat number.
    pub repeat: u32,
    /// Direction of motion.
    pub direction: Direction,
    /// Declared speed, rad/s, positive.
    pub speed_rad_s: f64,
    /// Samples used.
    pub samples: usize,
    /// A of this leg alone, N m.
    pub a_nm: f64,
    /// Its standard error, N m.
    pub a_se_nm: f64,
    /// B with A of the direction, N m; of this leg alone until `fix_a`.
    pub b_nm: f64,
    /// Its standard error, that of A left out, N m.
    pub b_se_nm: f64,
    /// Share of the low-passed torque's variance that the line explains.
    pub r_squared: f64,
    /// Residual of the low-passed torque, N m.
    pub rmse_nm: f64,
    /// Residual of the torque as recorded, N m.
    pub raw_rmse_nm: f64,
    /// Mean of the regressor: sin(theta), with any measured load over gravity added.
    pub mean_sine: f64,
    /// Mean torque, N m.
    pub mean_torque_nm: f64,
}

/// A of one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Mean over the legs, N m.
    pub a_nm: f64,
    /// Standard deviation over the legs, N m; NaN of a single leg.
    pub sd_nm: f64,
    /// Half width of the 95 % interval of the mean, N m; infinite of a single leg.
    pub half_width_nm: f64,
    /// Legs.
    pub legs: usize,
    /// Whether A is no result but fixed at zero, there being no load.
    pub fixed: bool,
    /// Root mean square of the legs' own standard errors of A over their scatter: 1 when only noise separates the torque from
    /// A sin(theta) + B, far above when every leg strays from it in the same way.
    pub misfit: f64,
}

/// Beyond this `misfit` many legs do not follow A sin(theta) + B (white noise leaves 0.7 to 1.4); of few legs, whose scatter is
/// itself uncertain, more is asked.
const MISFIT: f64 = 2.0;
const MISFIT_OF_FEW: f64 = 6.0;

impl Amplitude {
    /// Whether the torque of the legs follows A sin(theta) + B.
    pub fn describes(&self) -> bool {
        self.fixed || self.legs < 3 || self.misfit < MISFIT + MISFIT_OF_FEW / (self.legs as f64 - 1.0)
    }
}

/// The load at the joint that A belongs to, N m: gravity's at 90 deg, or without it 1 N m of a measured load or of the chain's
/// own torque; 0 with none of them.
pub fn load_of_a_nm(campaign: &Campaign) -> f64 {
    let gravity_nm = campaign.dynamics.gravity_nm;
    let loaded = campaign.columns.load_torque.is_some() || campaign.arm.is_some();
    if gravity_nm == 0.0 && loaded { 1.0 } else { gravity_nm }
}

/// The regressor of (17) at sample `i`: sin(theta), with a measured load G sin(theta) + load over the load of A; for a chain,
/// what its mass asks of the joint.
pub fn regressor(trial: &Trial, gravity_nm: f64, i: usize) -> f64 {
    let sine = trial.log.position_rad[i].sin();
    match (&trial.chain, &trial.load_torque_nm) {
        (Some(chain), _) => chain[i].0.total_nm() + trial.load_nm(i),
        (None, None) => sine,
        (None, Some(load_nm)) if gravity_nm == 0.0 => load_nm[i],
        (None, Some(load_nm)) => sine + load_nm[i] / gravity_nm,
    }
}

/// Regresses every leg of `trial` on gravity of `gravity_nm` and any measured load.
pub fn fit_legs(trial: &Trial, gravity_nm: f64) -> Vec<LegFit> {
    trial.legs.iter().map(|leg| fit_leg(trial, leg, gravity_nm)).collect()
}

fn fit_leg(trial: &Trial, leg: &Leg, gravity_nm: f64) -> LegFit {
    let used: Vec<usize> = leg.used().collect();
    let sine: Vec<f64> = used.iter().map(|i| regressor(trial, gravity_nm, *i)).collect();
    let raw: Vec<f64> = used.iter().map(|i| trial.log.torque_nm[*i]).collect();
    let line = Line::fit(&sine, &raw);
    let filtered: Vec<f64> = used.iter().map(|i| trial.torque_nm[*i]).collect();
    let (rmse_nm, r_squared) = line.figures(&sine, &filtered);
    LegFit {
        file: trial.entry.file.clone(),
        repeat: trial.entry.repeat,
        direction: leg.direction,
        speed_rad_s: trial.entry.protocol.speed_rad_s().unwrap_or(f64::NAN),
        samples: used.len(),
        a_nm: line.slope,
        a_se_nm: line.slope_se,
        b_nm: line.mean_y - line.slope * line.mean_x,
        b_se_nm: line.mean_se,
        r_squared,
        rmse_nm,
        raw_rmse_nm: line.figures(&sine, &raw).0,
        mean_sine: line.mean_x,
        mean_torque_nm: line.mean_y,
    }
}

/// A straight line with standard errors that hold for correlated noise.
struct Line {
    slope: f64,
    slope_se: f64,
    mean_x: f64,
    mean_y: f64,
    mean_se: f64,
}

impl Line {
    fn fit(x: &[f64], y: &[f64]) -> Self {
        let (mean_x, mean_y) = (mean(x), mean(y));
        let (mut sxx, mut sxy) = (0.0, 0.0);
        for (a, b) in x.iter().zip(y) {
            sxx += (a - mean_x) * (a - mean_x);
            sxy += (a - mean_x) * (b - mean_y);
        }
        // A load that stays the same, but for its noise, is no load to tell A from.
        let steady = (sxx / x.len() as f64).sqrt() <= STEADY * mean_x.abs();
        let slope = if steady { f64::NAN } else { sxy / sxx };
        // Sums of errors over blocks, not single errors: neighbours are correlated, blocks hardly.
        let length = x.len().div_ceil(BLOCKS).max(1);
        let (mut slope_square, mut mean_square, mut blocks) = (0.0, 0.0, 0.0);
        for (xs, ys) in x.chunks(length).zip(y.chunks(length)) {
            let (mut weighted, mut plain) = (0.0, 0.0);
            for (a, b) in xs.iter().zip(ys) {
                let error = b - mean_y - slope * (a - mean_x);
                weighted += (a - mean_x) * error;
                plain += error;
            }
            slope_square += weighted * weighted;
            mean_square += plain * plain;
            blocks += 1.0;
        }
        let small_sample = (blocks / f64::max(blocks - 2.0, 1.0)).sqrt();
        let slope_se = slope_square.sqrt() / sxx * small_sample;
        Self { slope, slope_se, mean_x, mean_y, mean_se: mean_square.sqrt() / x.len() as f64 * small_sample }
    }

    /// RMSE and R^2 of the line on `y`.
    fn figures(&self, x: &[f64], y: &[f64]) -> (f64, f64) {
        let middle = mean(y);
        let (mut error_sum, mut spread_sum) = (0.0, 0.0);
        for (a, b) in x.iter().zip(y) {
            error_sum += (b - self.mean_y - self.slope * (a - self.mean_x)).powi(2);
            spread_sum += (b - middle).powi(2);
        }
        ((error_sum / y.len() as f64).sqrt(), 1.0 - error_sum / spread_sum)
    }
}

/// Step 3: A of `direction`, the mean over its legs; `None` without legs in that direction.
pub fn amplitude<'l>(legs: impl IntoIterator<Item = &'l LegFit>, direction: Direction) -> Option<Amplitude> {
    let mine: Vec<&LegFit> = legs.into_iter().filter(|leg| leg.direction == direction).collect();
    let values: Vec<f64> = mine.iter().map(|leg| leg.a_nm).collect();
    let n = values.len();
    let sd_nm = standard_deviation(&values);
    let half_width_nm = if n > 1 { student_t(n as f64 - 1.0) * sd_nm / (n as f64).sqrt() } else { f64::INFINITY };
    let errors: Vec<f64> = mine.iter().map(|leg| leg.a_se_nm).collect();
    let misfit = root_mean_square(&errors) / sd_nm;
    (n > 0).then(|| Amplitude { a_nm: mean(&values), sd_nm, half_width_nm, legs: n, fixed: false, misfit })
}

/// An A of more than this many half widths contradicts the statement that there is no load, ...
const CONTRADICTION: f64 = 5.0;
/// ... unless it is less than this share of the torque: even where nothing scatters a log is not exact.
const NEGLIGIBLE: f64 = 1e-3;

/// Step 3 for both directions. Without a load, `load_nm` = 0, an A that is consistent with none is fixed at zero.
///
/// Errors, naming `campaign`: a direction without legs; an A that contradicts the load.
pub fn amplitudes(legs: &[LegFit], load_nm: f64, campaign: &Path) -> Result<Both<Amplitude>> {
    Both::try_make(|direction| {
        let a = amplitude(legs, direction).ok_or_else(|| no_leg(direction, campaign))?;
        Ok(consistent(a, legs, direction, load_nm, campaign)?)
    })
}

/// What is wrong where no leg moves in `direction`.
pub fn no_leg(direction: Direction, campaign: &Path) -> Problem {
    let what = format!("no leg of constant speed moves {}", direction.name());
    let cure = "record sweeps in both directions, within the range of the sensor, or mark the trials `free`";
    Problem::error(campaign, what, cure)
}

/// `a` of `legs` moving in `direction`, if it agrees with a load of `load_nm`; fixed at zero where there is no load.
///
/// (18) needs 0 < (r1/r2) G <= A: friction adds to the load that the winch feels on the way up and takes from it on the way
/// down, but a loss factor beyond one, or a signal that falls where the load rises, is a wrong sign, unit or radius.
pub fn consistent<'l>(
    a: Amplitude,
    legs: impl IntoIterator<Item = &'l LegFit>,
    direction: Direction,
    load_nm: f64,
    campaign: &Path,
) -> std::result::Result<Amplitude, Problem> {
    let moving = direction.name();
    let wrong = |what: String, cure: &str, key: &str| Err(Problem::error(campaign, what, cure).in_column(key));
    if !a.a_nm.is_finite() {
        let what = format!("moving {moving}, the load does not change along a leg: A is not to be had from it");
        let cure = "record sweeps along which the load changes, or mark the trials `free`";
        return Err(Problem::error(campaign, what, cure));
    }
    if load_nm != 0.0 && a.a_nm * load_nm <= 0.0 {
        let what = format!(
            "A = {:.4} N m moving {moving}, but the load it belongs to is {load_nm} N m: opposite signs",
            a.a_nm
        );
        let cure = "turn torque_sign, or correct gravity_nm, load_torque or the position's zero";
        return wrong(what, cure, "torque_sign");
    }
    if load_nm != 0.0 {
        return Ok(a);
    }
    let torques: Vec<f64> = legs.into_iter().map(|leg| leg.mean_torque_nm).filter(|y| y.is_finite()).collect();
    let negligible_nm = if torques.is_empty() { 0.0 } else { NEGLIGIBLE * root_mean_square(&torques) };
    if a.a_nm.abs() > negligible_nm.max(CONTRADICTION * a.half_width_nm) {
        let what =
            format!("gravity_nm = 0, yet moving {moving} the torque follows sin(theta) with A = {:.4} N m", a.a_nm);
        return wrong(what, "give the gravity torque at 90 deg, or a measured load_torque", "gravity_nm");
    }
    Ok(Amplitude { a_nm: 0.0, sd_nm: 0.0, half_width_nm: 0.0, fixed: true, ..a })
}

/// Step 4: B of every leg with A of its direction fixed.
pub fn fix_a(legs: &mut [LegFit], a: &Both<Amplitude>) {
    for leg in legs {
        leg.b_nm = leg.mean_torque_nm - a.of(leg.direction).a_nm * leg.mean_sine;
    }
}

/// What the lines leave of all legs' low-passed torque, N m: no model does better elsewhere. `None` without legs.
pub fn sliding_nm(legs: &[LegFit]) -> Option<f64> {
    (!legs.is_empty()).then(|| root_mean_square(&legs.iter().map(|leg| leg.rmse_nm).collect::<Vec<f64>>()))
}

/// Weights of the points B of `legs` (one direction), 1 on average: the inverse of the variance within the leg plus that
/// between repeats of one speed.
///
/// A fast leg is short and its B far less certain than a slow one's; what differs from repeat to repeat beyond that (the
/// method of moments of DerSimonian and Laird, Controlled Clinical Trials 7:177, 1986) counts alike for all and evens the
/// weights out. Alike for all, too, when the standard errors are not known.
pub fn weights(legs: &[&LegFit]) -> Vec<f64> {
    let precision: Vec<f64> = legs.iter().map(|leg| leg.b_se_nm.powi(-2)).collect();
    if precision.iter().any(|p| !p.is_finite() || *p <= 0.0) {
        return vec![1.0; legs.len()];
    }
    let (mut excess, mut freedom, mut scale) = (0.0, 0.0, 0.0);
    let mut speeds: Vec<f64> = legs.iter().map(|leg| leg.speed_rad_s).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    for speed in speeds {
        let repeats = || (0..legs.len()).filter(|i| legs[*i].speed_rad_s == speed);
        let total: f64 = repeats().map(|i| precision[i]).sum();
        let middle = repeats().map(|i| precision[i] * legs[i].b_nm).sum::<f64>() / total;
        excess += repeats().map(|i| precision[i] * (legs[i].b_nm - middle).powi(2)).sum::<f64>();
        freedom += repeats().count() as f64 - 1.0;
        scale += total - repeats().map(|i| precision[i].powi(2)).sum::<f64>() / total;
    }
    let between = if scale > 0.0 { ((excess - freedom) / scale).max(0.0) } else { 0.0 };
    let raw: Vec<f64> = precision.iter().map(|p| 1.0 / (1.0 / p + between)).collect();
    let average = mean(&raw);
    raw.iter().map(|w| w / average).collect()
}
