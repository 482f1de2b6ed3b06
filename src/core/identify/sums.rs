//! A leg as sums: all that steps 2 to 4 need of its samples, whatever the position's zero turns out to be.
//!
//! The regressor of (17) at a true position of the reading plus z is R = cos(z) g + sin(z) s + r, with g the gravity and s its
//! slope at the reading and r what does not depend on the zero (a measured load, inertia), each over the load that A belongs
//! to. It is linear in (g, s, r): with first and second moments of (g, s, r, y, low-passed y), block by block, every line and
//! every standard error at any z follows without a second look at the samples.

use super::legs::{LegFit, LegZero};
use crate::dynamics::JointKind;
use crate::model::Direction;
use crate::prepare::{Leg, Trial};

/// A load whose standard deviation along a leg is below this share of it does not change.
const STEADY: f64 = 0.01;
/// A leg is cut into this many blocks to judge its errors: a block outlasts the noise's memory, and 20 of them leave a
/// standard error known to 16 %.
pub(super) const BLOCKS: usize = 20;
/// Below this share of the slope's variance the remainder of its regression is rounding error.
const ROUNDING: f64 = 1e-9;

/// Places in the moments.
const GRAVITY: usize = 0;
const SLOPE: usize = 1;
const REST: usize = 2;
const RAW: usize = 3;
const FILTERED: usize = 4;
const COLUMNS: usize = 5;

/// Weights of the columns in a sum of them.
type Mix = [f64; COLUMNS];

/// First and second moments of some samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moments {
    samples: f64,
    /// Sums of the columns.
    first: Mix,
    /// Sums of their products.
    second: [Mix; COLUMNS],
}

impl Moments {
    const NONE: Self = Self { samples: 0.0, first: [0.0; COLUMNS], second: [[0.0; COLUMNS]; COLUMNS] };

    fn add(&mut self, row: &Mix) {
        self.samples += 1.0;
        for i in 0..COLUMNS {
            self.first[i] += row[i];
            for j in 0..=i {
                self.second[i][j] += row[i] * row[j];
            }
        }
    }

    fn join(&mut self, other: &Self) {
        self.samples += other.samples;
        for i in 0..COLUMNS {
            self.first[i] += other.first[i];
            for j in 0..=i {
                self.second[i][j] += other.second[i][j];
            }
        }
    }

    /// The same of the columns less `mean`.
    fn about(mut self, mean: &Mix) -> Self {
        for i in 0..COLUMNS {
            for j in 0..=i {
                let (first, n) = (&self.first, self.samples);
                self.second[i][j] -= mean[i] * first[j] + first[i] * mean[j] - n * mean[i] * mean[j];
            }
        }
        (0..COLUMNS).for_each(|i| self.first[i] -= self.samples * mean[i]);
        self
    }

    /// Sum over the samples of the mix `a`.
    fn sum(&self, a: &Mix) -> f64 {
        (0..COLUMNS).map(|i| a[i] * self.first[i]).sum()
    }

    /// Sum of the product of the mixes `a` and `b`.
    fn product(&self, a: &Mix, b: &Mix) -> f64 {
        let mut sum = 0.0;
        for i in 0..COLUMNS {
            sum += a[i] * b[i] * self.second[i][i];
            for j in 0..i {
                sum += (a[i] * b[j] + a[j] * b[i]) * self.second[i][j];
            }
        }
        sum
    }
}

/// The sums of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LegSums {
    file: String,
    repeat: u32,
    /// Direction of motion.
    pub direction: Direction,
    speed_rad_s: f64,
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Means of the columns.
    mean: Mix,
    /// Moments of the columns less `mean`, of the leg ...
    all: Moments,
    /// ... and of each of its blocks.
    blocks: Vec<Moments>,
    /// Mean position of each block, rad.
    positions_rad: Vec<f64>,
}

/// The line of one leg at a given zero.
struct Line {
    /// Weights of R, of dR/dz, ...
    regressor: Mix,
    slope: Mix,
    /// ... and of what the line leaves of the torque.
    error: Mix,
    /// Sums of squares and products about the mean: RR and R dR/dz.
    square: f64,
    cross: f64,
    a_nm: f64,
}

/// What one leg says of the position's zero.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ZeroOfLeg {
    /// How far the zero is from the one assumed, rad.
    pub step_rad: f64,
    /// What each block adds to the error of that, rad.
    pub by_block_rad: Vec<f64>,
}

impl LegSums {
    /// The sums of `leg`, with a gravity of `gravity_nm` at 90 deg where no chain holds it.
    pub fn new(trial: &Trial, leg: &Leg, gravity_nm: f64, kind: JointKind) -> Self {
        let used: Vec<usize> = leg.used().collect();
        let row = |i: usize| -> Mix {
            let [gravity, slope, rest] = columns(trial, gravity_nm, kind, i);
            [gravity, slope, rest, trial.log.torque_nm[i], trial.torque_nm[i]]
        };
        // Taken off first, so that nothing is lost to rounding.
        let offset = used.first().map_or([0.0; COLUMNS], |first| row(*first));
        let length = used.len().div_ceil(BLOCKS).max(1);
        let (mut all, mut blocks, mut positions_rad) = (Moments::NONE, Vec::new(), Vec::new());
        for block in used.chunks(length) {
            let (mut moments, mut position) = (Moments::NONE, 0.0);
            for i in block {
                let mut row = row(*i);
                row.iter_mut().zip(&offset).for_each(|(x, off)| *x -= off);
                moments.add(&row);
                position += trial.log.position_rad[*i];
            }
            all.join(&moments);
            blocks.push(moments);
            positions_rad.push(position / block.len() as f64);
        }
        let mean = all.first.map(|sum| sum / all.samples);
        Self {
            file: trial.entry.file.clone(),
            repeat: trial.entry.repeat,
            direction: leg.direction,
            speed_rad_s: trial.entry.protocol.speed_rad_s().unwrap_or(f64::NAN),
            duration_s: used.len() as f64 / trial.log.rate_hz,
            mean: std::array::from_fn(|i| mean[i] + offset[i]),
            all: all.about(&mean),
            blocks: blocks.into_iter().map(|block| block.about(&mean)).collect(),
            positions_rad,
        }
    }

    /// Mean position of each of its blocks, rad.
    pub(super) fn positions_rad(&self) -> &[f64] {
        &self.positions_rad
    }

    /// Mean of a mix of the columns.
    fn mean_of(&self, mix: &Mix) -> f64 {
        (0..COLUMNS).map(|i| mix[i] * self.mean[i]).sum()
    }

    fn line(&self, zero_rad: f64) -> Line {
        let (sin, cos) = zero_rad.sin_cos();
        let (mut regressor, mut slope) = ([0.0; COLUMNS], [0.0; COLUMNS]);
        (regressor[GRAVITY], regressor[SLOPE], regressor[REST]) = (cos, sin, 1.0);
        (slope[GRAVITY], slope[SLOPE]) = (-sin, cos);
        let product = |a: &Mix, b: &Mix| self.all.product(a, b);
        let square = product(&regressor, &regressor);
        // A load that is constant except for noise does not determine A.
        let spread = (square.max(0.0) / self.all.samples).sqrt();
        let steady = spread <= STEADY * self.mean_of(&regressor).abs();
        let a_nm = if steady { f64::NAN } else { product(&regressor, &unit(RAW)) / square };
        let mut error = unit(RAW);
        (0..COLUMNS).for_each(|i| error[i] -= a_nm * regressor[i]);
        Line { regressor, slope, error, square, cross: product(&regressor, &slope), a_nm }
    }

    /// Step 2 at a zero of `zero_rad`: the leg's regression.
    pub fn fit(&self, zero_rad: f64) -> LegFit {
        let line = self.line(zero_rad);
        let blocks = self.blocks.len() as f64;
        let small_sample = (blocks / f64::max(blocks - 2.0, 1.0)).sqrt();
        // Sums of errors over blocks, not single errors: neighbours are correlated, blocks hardly.
        let squares = |of: &dyn Fn(&Moments) -> f64| self.blocks.iter().map(|b| of(b).powi(2)).sum::<f64>().sqrt();
        let slope_sum = squares(&|block| block.product(&line.regressor, &line.error));
        let plain_sum = squares(&|block| block.sum(&line.error));
        let (mean_torque_nm, mean_sine) = (self.mean_of(&unit(RAW)), self.mean_of(&line.regressor));
        let (rmse_nm, r_squared) = self.figures(&line, FILTERED);
        LegFit {
            file: self.file.clone(),
            repeat: self.repeat,
            direction: self.direction,
            speed_rad_s: self.speed_rad_s,
            samples: self.all.samples as usize,
            a_nm: line.a_nm,
            a_se_nm: slope_sum / line.square * small_sample,
            b_nm: mean_torque_nm - line.a_nm * mean_sine,
            b_se_nm: plain_sum / self.all.samples * small_sample,
            r_squared,
            rmse_nm,
            raw_rmse_nm: self.figures(&line, RAW).0,
            mean_sine,
            mean_torque_nm,
            zero: LegZero {
                zero_rad,
                mean_slope: self.mean_of(&line.slope),
                a_by_zero_nm_rad: -line.a_nm * line.cross / line.square,
                ..LegZero::default()
            },
        }
    }

    /// The regression of the leg at the zero that it asks for by itself, rad.
    pub fn alone(&self) -> (f64, LegFit) {
        /// Beyond this a single leg does not determine the zero, rad.
        const MOST_RAD: f64 = 0.3;
        let zero_rad = self.zero(0.0).map_or(0.0, |told| told.step_rad);
        let zero_rad = if zero_rad.abs() < MOST_RAD { zero_rad } else { 0.0 };
        (zero_rad, self.fit(zero_rad))
    }

    /// RMSE and R^2 of the line on a column.
    fn figures(&self, line: &Line, column: usize) -> (f64, f64) {
        let (mut error, own) = (unit(column), unit(column));
        (0..COLUMNS).for_each(|i| error[i] -= line.a_nm * line.regressor[i]);
        // The line goes through the mean of the torque as recorded.
        let off_nm = self.mean_of(&own) - self.mean_of(&unit(RAW));
        let error_sum = self.all.product(&error, &error).max(0.0) + self.all.samples * off_nm * off_nm;
        let spread_sum = self.all.product(&own, &own);
        ((error_sum / self.all.samples).sqrt(), 1.0 - error_sum / spread_sum)
    }

    /// What each block adds to the error of the leg's A at a zero of `zero_rad`, N m.
    pub(super) fn a_by_block_nm(&self, zero_rad: f64) -> Vec<f64> {
        let line = self.line(zero_rad);
        self.blocks.iter().map(|b| b.product(&line.regressor, &line.error) / line.square).collect()
    }

    /// The leg's estimate of the zero about `zero_rad`, with its own A and B free; `None` where its load does not determine it.
    ///
    /// y = A R + A dz dR/dz + B to first order: what R leaves of dR/dz is regressed on what the line leaves of y.
    pub(super) fn zero(&self, zero_rad: f64) -> Option<ZeroOfLeg> {
        let line = self.line(zero_rad);
        let mut alone = line.slope;
        (0..COLUMNS).for_each(|i| alone[i] -= line.cross / line.square * line.regressor[i]);
        let square = self.all.product(&alone, &alone);
        let whole = self.all.product(&line.slope, &line.slope);
        let is_told = square > ROUNDING * whole && line.a_nm.is_finite() && line.a_nm != 0.0;
        is_told.then(|| {
            let strength_nm = self.all.product(&alone, &unit(RAW)) / square;
            let mut error = line.error;
            (0..COLUMNS).for_each(|i| error[i] -= strength_nm * alone[i]);
            let by_block = |block: &Moments| block.product(&alone, &error) / (line.a_nm * square);
            ZeroOfLeg { step_rad: strength_nm / line.a_nm, by_block_rad: self.blocks.iter().map(by_block).collect() }
        })
    }
}

fn unit(column: usize) -> Mix {
    let mut mix = [0.0; COLUMNS];
    mix[column] = 1.0;
    mix
}

/// Gravity at the position as read, its slope, and what does not depend on the zero, at sample `i`, each over the load that A
/// belongs to: sin, cos and a measured load over gravity; for a chain what its mass asks of the joint, N m.
pub(super) fn columns(trial: &Trial, gravity_nm: f64, kind: JointKind, i: usize) -> [f64; 3] {
    let (sin, cos) = trial.log.position_rad[i].sin_cos();
    let cos = if kind == JointKind::Revolute { cos } else { 0.0 };
    match (&trial.chain, &trial.load_torque_nm) {
        (Some(chain), _) => {
            let (rigid, slope_nm_rad) = chain[i];
            let slope = if kind == JointKind::Revolute { slope_nm_rad } else { 0.0 };
            [rigid.gravity_nm, slope, rigid.total_nm() - rigid.gravity_nm + trial.load_nm(i)]
        }
        (None, None) => [sin, cos, 0.0],
        (None, Some(load_nm)) if gravity_nm == 0.0 => [0.0, 0.0, load_nm[i]],
        (None, Some(load_nm)) => [sin, cos, load_nm[i] / gravity_nm],
    }
}
