//! Steps 2 to 4 of the protocol: A and B of every leg.
//!
//! (17) y = A sin(theta) + B on each leg by ordinary least squares, on the torque as recorded: over a whole leg least
//! squares is itself a far narrower low-pass than the declared one, and unlike it carries nothing of the reversals into the
//! leg, so that A and B are exact on exact data. The declared low-pass serves the figures (R^2, RMSE), as in the paper.
//! Then A is the mean over the legs of a direction, and B of a leg its mean of y - A sin(theta).

use crate::model::{Both, Direction};
use crate::numerics::statistics::{mean, root_mean_square, standard_deviation, student_t};
use crate::prepare::{Leg, Trial};
use crate::problem::{Problem, Result};
use std::path::Path;

/// A leg is cut into this many blocks to judge its errors: a block outlasts the noise's memory, and 20 of them leave a
/// standard error known to 16 %.
const BLOCKS: usize = 20;
/// A leg of which more than this share is clipped is left out: what remains of it is a biased choice.
const MAX_CLIPPED: f64 = 0.05;

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
    /// Mean of sin(theta), with any measured load over gravity added.
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
        self.legs < 3 || self.misfit < MISFIT + MISFIT_OF_FEW / (self.legs as f64 - 1.0)
    }
}

/// Regresses every leg of `trial` that is not clipped away; `gravity_nm` scales a measured load beside sin(theta).
pub fn fit_legs(trial: &Trial, gravity_nm: f64) -> Vec<LegFit> {
    let clipped = |leg: &Leg| leg.samples.clone().filter(|i| is_clipped(trial, *i)).count();
    let usable = |leg: &&Leg| clipped(leg) as f64 <= MAX_CLIPPED * leg.samples.len() as f64;
    trial.legs.iter().filter(usable).map(|leg| fit_leg(trial, leg, gravity_nm)).collect()
}

fn is_clipped(trial: &Trial, sample: usize) -> bool {
    trial.log.clipped.iter().any(|range| range.contains(&sample))
}

fn fit_leg(trial: &Trial, leg: &Leg, gravity_nm: f64) -> LegFit {
    let load = trial.load_torque_nm.as_deref().filter(|_| gravity_nm != 0.0);
    let used: Vec<usize> = match trial.log.clipped.is_empty() {
        true => leg.samples.clone().collect(),
        false => leg.samples.clone().filter(|i| !is_clipped(trial, *i)).collect(),
    };
    let sine: Vec<f64> =
        used.iter().map(|i| trial.log.position_rad[*i].sin() + load.map_or(0.0, |l| l[*i] / gravity_nm)).collect();
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
        let slope = sxy / sxx;
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
pub fn amplitude(legs: &[LegFit], direction: Direction) -> Option<Amplitude> {
    let mine = || legs.iter().filter(|leg| leg.direction == direction);
    let values: Vec<f64> = mine().map(|leg| leg.a_nm).collect();
    let n = values.len();
    let sd_nm = standard_deviation(&values);
    let half_width_nm = if n > 1 { student_t(n as f64 - 1.0) * sd_nm / (n as f64).sqrt() } else { f64::INFINITY };
    let errors: Vec<f64> = mine().map(|leg| leg.a_se_nm).collect();
    let misfit = root_mean_square(&errors) / sd_nm;
    (n > 0).then(|| Amplitude { a_nm: mean(&values), sd_nm, half_width_nm, legs: n, misfit })
}

/// Step 3 for both directions; `campaign` is named when one has no legs.
pub fn amplitudes(legs: &[LegFit], campaign: &Path) -> Result<Both<Amplitude>> {
    Both::try_make(|direction| {
        amplitude(legs, direction).ok_or_else(|| {
            let what = format!("no leg of constant speed moves {}", direction.name());
            Problem::error(
                campaign,
                what,
                "record sweeps in both directions, within the range of the sensor, or mark the trials `free`",
            )
            .into()
        })
    })
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
