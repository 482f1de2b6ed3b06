//! Steps 2 to 4 of the protocol: A and B of every leg.
//!
//! (17) y = A sin(theta) + B on each leg by ordinary least squares, on the torque as recorded: over a whole leg least
//! squares is itself a far narrower low-pass than the declared one, and unlike it carries nothing of the reversals into the
//! leg, so that A and B are exact on exact data. The declared low-pass serves the figures (R^2, RMSE), as in the paper.
//! Then A is the mean over the legs of a direction, and B of a leg its mean of y - A sin(theta).
//!
//! The position's zero is estimated along with them (`zero`): the regressor is sin(theta + z), or that of `sums`.
//!
//! A measured load stands beside gravity: then the regressor is (G sin(theta) + load) / G, and without gravity the load alone,
//! of which A is what the winch sees of 1 N m. Without either A is fixed at zero, and y is friction.

use super::sums::{BLOCKS, LegSums};
use super::zero::{FREEDOM_OF_PLACES, Zero, common};
use crate::log::Campaign;
use crate::model::{Both, Direction};
use crate::numerics::statistics::{half_width_of_sum, mean, root_mean_square, standard_deviation, student_t};
use crate::problem::{Problem, Result};
use std::path::Path;

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
    /// The zero of the position that it is fitted at, and what of it enters A and B.
    pub zero: LegZero,
}

/// The zero of the position in the regression of one leg; all 0 where it is taken as declared and exact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LegZero {
    /// The joint is at its reading plus this, rad.
    pub zero_rad: f64,
    /// Half width of the zero's 95 % interval, rad.
    pub half_width_rad: f64,
    /// What A of the leg changes by with the zero, N m/rad.
    pub a_by_zero_nm_rad: f64,
    /// Mean of what the regressor changes by with the zero: cos(theta) of gravity alone.
    pub mean_slope: f64,
    /// Standard error of the direction's A from errors that repeat at the same place in every leg, N m.
    pub a_position_se_nm: f64,
}

impl LegFit {
    /// Half width of the 95 % interval of B, that of `a` and of the zero in it, N m.
    pub fn b_half_width_nm(&self, a: &Amplitude) -> f64 {
        let own = student_t(BLOCKS as f64 - 2.0) * self.b_se_nm;
        let of_zero = (a.by_zero_nm_rad * self.mean_sine + a.a_nm * self.zero.mean_slope) * a.zero_half_width_rad;
        own.hypot(a.given_zero_nm * self.mean_sine).hypot(of_zero)
    }
}

/// A of one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Mean over the legs, N m.
    pub a_nm: f64,
    /// Standard deviation over the legs, N m; NaN of a single leg.
    pub sd_nm: f64,
    /// Half width of the 95 % interval of the mean, that of the position's zero in it, N m; infinite of a single leg.
    pub half_width_nm: f64,
    /// The same were the zero known, N m.
    pub given_zero_nm: f64,
    /// What A changes by with the zero, N m/rad.
    pub by_zero_nm_rad: f64,
    /// Half width of the zero's 95 % interval, rad.
    pub zero_half_width_rad: f64,
    /// Legs.
    pub legs: usize,
    /// Whether A is no result but fixed at zero, there being no load.
    pub fixed: bool,
    /// Root mean square of the legs' own standard errors of A over their scatter: 1 when only noise separates the torque from A sin(theta)
    /// + B, far above when all legs deviate from it in the same way; 0 where the errors are negligible beside A.
    pub misfit: f64,
}

/// Beyond this `misfit` many legs do not follow A sin(theta) + B (white noise leaves 0.7 to 1.4); of few legs, whose scatter is
/// itself uncertain, more is asked.
const MISFIT: f64 = 2.0;
const MISFIT_OF_FEW: f64 = 6.0;
/// Errors of A below this share of it count as none: they move mu_c by less than 0.001, and the interval holds what repeats.
const NEGLIGIBLE_MISFIT: f64 = 1e-3;

impl Amplitude {
    /// Whether the torque of the legs follows A sin(theta) + B.
    pub fn describes(&self) -> bool {
        self.fixed || self.misfit.is_nan() || self.misfit <= self.misfit_limit()
    }

    /// The largest `misfit` of legs that follow it.
    pub fn misfit_limit(&self) -> f64 {
        if self.legs < 3 { f64::INFINITY } else { MISFIT + MISFIT_OF_FEW / (self.legs as f64 - 1.0) }
    }
}

/// The load at the joint that A belongs to, N m: gravity's at 90 deg, or without it 1 N m of a measured load or of the chain's
/// own torque; 0 with none of them.
pub fn load_of_a_nm(campaign: &Campaign) -> f64 {
    let gravity_nm = campaign.dynamics.gravity_nm;
    let loaded = campaign.columns.load_torque.is_some() || campaign.arm.is_some();
    if gravity_nm == 0.0 && loaded { 1.0 } else { gravity_nm }
}

/// Steps 2 and 3 for all legs: the zero of the position, declared within `declared_rad` (0 takes it as declared), then each
/// leg's A and B at it.
pub fn fit_legs(sums: &[&LegSums], declared_rad: f64) -> (Zero, Vec<LegFit>) {
    let zero = Zero::estimate(sums, declared_rad);
    let mut legs: Vec<LegFit> = sums.iter().map(|leg| leg.fit(zero.rad)).collect();
    for direction in Direction::BOTH {
        let a_position_se_nm = position_se_nm(sums, direction, zero.rad);
        for leg in legs.iter_mut().filter(|leg| leg.direction == direction) {
            leg.zero.half_width_rad = zero.half_width_rad;
            leg.zero.a_position_se_nm = a_position_se_nm;
        }
    }
    (zero, legs)
}

/// The same without those of `sums`, and of what stands beside them, along which the load hardly changes: they say nothing of A. Kept is
/// a direction in which it changes along none. How many were left out, the zero, and the legs that remain.
pub fn fit_telling<T>(sums: &mut Vec<LegSums>, beside: &mut Vec<T>, declared_rad: f64) -> (usize, Zero, Vec<LegFit>) {
    let (zero, legs) = fit_legs(&sums.iter().collect::<Vec<_>>(), declared_rad);
    let tells = |leg: &LegFit| leg.a_nm.is_finite();
    let any = Both::make(|direction| legs.iter().any(|leg| leg.direction == direction && tells(leg)));
    let keep: Vec<bool> = legs.iter().map(|leg| tells(leg) || !any.of(leg.direction)).collect();
    let left_out = keep.iter().filter(|kept| !**kept).count();
    if left_out == 0 {
        return (0, zero, legs);
    }
    let (mut of_sums, mut of_beside) = (keep.iter(), keep.iter());
    sums.retain(|_| of_sums.next() == Some(&true));
    beside.retain(|_| of_beside.next() == Some(&true));
    let (zero, legs) = fit_legs(&sums.iter().collect::<Vec<_>>(), declared_rad);
    (left_out, zero, legs)
}

/// Standard error of the mean A of `direction` from errors that repeat at the same place in every leg, N m.
fn position_se_nm(sums: &[&LegSums], direction: Direction, zero_rad: f64) -> f64 {
    let mine: Vec<&LegSums> = sums.iter().copied().filter(|leg| leg.direction == direction).collect();
    let share = 1.0 / mine.len() as f64;
    let of_leg = |leg: &&LegSums| leg.a_by_block_nm(zero_rad).iter().map(|x| share * x).collect();
    let by_leg: Vec<Vec<f64>> = mine.iter().map(of_leg).collect();
    let variance = common(&mine, &by_leg);
    if variance.is_finite() { variance.sqrt() } else { 0.0 }
}

/// Step 3: A of `direction`, the mean over its legs that tell it, NaN where none does; `None` without legs in that direction.
pub fn amplitude<'l>(legs: impl IntoIterator<Item = &'l LegFit>, direction: Direction) -> Option<Amplitude> {
    let mut mine: Vec<&LegFit> = legs.into_iter().filter(|leg| leg.direction == direction).collect();
    if mine.iter().any(|leg| leg.a_nm.is_finite()) {
        mine.retain(|leg| leg.a_nm.is_finite());
    }
    let values: Vec<f64> = mine.iter().map(|leg| leg.a_nm).collect();
    let n = values.len();
    let sd_nm = standard_deviation(&values);
    let LegZero { half_width_rad: zero_half_width_rad, a_position_se_nm, .. } = mine.first()?.zero;
    let freedom = n as f64 - 1.0;
    let of_legs = if n > 1 { sd_nm * sd_nm / n as f64 } else { f64::INFINITY };
    let given_zero = [(of_legs, freedom), (a_position_se_nm.powi(2), FREEDOM_OF_PLACES)];
    let given_zero_nm = half_width_of_sum(&given_zero);
    let by_zero_nm_rad = mean(&mine.iter().map(|leg| leg.zero.a_by_zero_nm_rad).collect::<Vec<f64>>());
    // The zero is known from the legs of both directions.
    let of_both = 2.0 * n as f64 - 1.0;
    let of_zero = ((by_zero_nm_rad * zero_half_width_rad / student_t(of_both)).powi(2), of_both);
    let errors: Vec<f64> = mine.iter().map(|leg| leg.a_se_nm).collect();
    let (a_nm, error_nm) = (mean(&values), root_mean_square(&errors));
    let misfit = if error_nm <= NEGLIGIBLE_MISFIT * a_nm.abs() { 0.0 } else { error_nm / sd_nm };
    Some(Amplitude {
        a_nm,
        sd_nm,
        half_width_nm: half_width_of_sum(&[given_zero[0], given_zero[1], of_zero]),
        given_zero_nm,
        by_zero_nm_rad,
        zero_half_width_rad,
        legs: n,
        fixed: false,
        misfit,
    })
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
        let what = format!("moving {moving}, the load does not change along a leg: A cannot be identified from it");
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
    let none = Amplitude { a_nm: 0.0, sd_nm: 0.0, half_width_nm: 0.0, given_zero_nm: 0.0, ..a };
    Ok(Amplitude { by_zero_nm_rad: 0.0, zero_half_width_rad: 0.0, fixed: true, ..none })
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

/// Weights of points B.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Of each, 1 on average.
    pub each: Vec<f64>,
    /// Variance of a point of weight 1 as the legs themselves claim it, (N m)^2; `None` where their errors are not known.
    pub variance_nm2: Option<f64>,
}

/// Weights of the points B of `legs` (one direction), 1 on average: the inverse of the variance within the leg plus that
/// between repeats of one speed.
///
/// A fast leg is short and its B far less certain than a slow one's; what differs from repeat to repeat beyond that (the
/// method of moments of DerSimonian and Laird, Controlled Clinical Trials 7:177, 1986) counts alike for all and evens the
/// weights out. Alike for all, too, when the standard errors are not known.
pub fn weights(legs: &[&LegFit]) -> Weights {
    let precision: Vec<f64> = legs.iter().map(|leg| leg.b_se_nm.powi(-2)).collect();
    if precision.iter().any(|p| !p.is_finite() || *p <= 0.0) {
        return Weights { each: vec![1.0; legs.len()], variance_nm2: None };
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
    Weights { each: raw.iter().map(|w| w / average).collect(), variance_nm2: Some(1.0 / average) }
}
