//! The noise floor: the part of the torque that no model could explain, because it does not repeat with the motion.
//!
//! From repeats of one motion: half the variance of the difference of their residuals, aligned in time by their positions. Slow differences
//! are removed (a drift between repeats is not noise), and blocks are combined by their median (neither is a contact in one repeat).
//! Without repeats: the density of the raw torque's noise beyond the low-pass, extrapolated below; where no fit predicts any of the
//! residual on held-out data, all of it. In both cases the residual that the encoder's steps give a perfect model is added, as far as it
//! repeats with the motion.

use super::data::DataSet;
use super::policy::Policy;
use super::record::Record;
use super::spectrum::SpectralFloor;
use crate::model::{AT_REST_RAD_S, Model};
use crate::numerics::statistics::{extent, median_of_squares, quantile};

/// Independent samples in a block.
const BLOCK: f64 = 10.0;
/// The same once the causes are known, and a drift is explained: noise that is not white has its slow part, too.
const BLOCK_LATER: f64 = 40.0;
/// Slow differences are averaged over this many blocks and removed; [`kept_of_noise`] says what white noise is left.
const SLOW_BLOCKS: f64 = 2.0;
/// Repeats are aligned within this many independent samples.
const LAG_MAX: f64 = 10.0;
/// Fewer blocks do not determine a floor.
const BLOCKS_MIN: usize = 8;

/// The floor and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// RMS, N m, at the declared low-pass.
    pub rms_nm: f64,
    /// RMS of its quick part, N m: slow noise may come on top.
    pub quick_nm: f64,
    /// The residual that the encoder alone gives a perfect model in every repeat of a motion, N m; included in the RMS above.
    pub encoder_nm: f64,
    /// The same as simulated, N m: more where the model leaves less than that, which is then all that is counted.
    pub encoder_simulated_nm: f64,
    /// Its source.
    pub source: FloorSource,
    /// Standard error of the floor's square as a share of it.
    pub relative_error: f64,
}

impl Floor {
    /// The floor's square with its standard error, (N m)^2: what lies above it is a gap, in spite of the floor's error.
    pub fn upper_square(&self) -> f64 {
        self.rms_nm * self.rms_nm * (1.0 + self.relative_error)
    }

    /// The floor with its standard error, N m: where the gap begins.
    pub fn upper_nm(&self) -> f64 {
        self.upper_square().sqrt()
    }

    /// A floor of noise alone.
    pub(super) fn of_noise(rms_nm: f64, source: FloorSource, relative_error: f64) -> Self {
        Self { rms_nm, quick_nm: rms_nm, encoder_nm: 0.0, encoder_simulated_nm: 0.0, source, relative_error }
    }

    /// The floor of noise alone, its square raised by that of the encoder, (N m)^2, both limited to `most_square`: no floor is above the
    /// residual of a fit on held-out units.
    fn with_encoder(self, policy: &Policy, encoder_square: f64, most_square: f64) -> Self {
        let encoder_simulated_nm = encoder_square.sqrt();
        let encoder_square = encoder_square.min((most_square - self.rms_nm.powi(2)).max(0.0));
        let with = |nm: f64| ((nm * nm).min(most_square) + encoder_square).sqrt();
        let rms_nm = with(self.rms_nm);
        let share = encoder_square / rms_nm.powi(2).max(f64::MIN_POSITIVE);
        let relative_error = ((1.0 - share) * self.relative_error).hypot(policy.floor_encoder_error * share);
        let (quick_nm, encoder_nm) = (with(self.quick_nm), encoder_square.sqrt());
        Self { rms_nm, quick_nm, relative_error, encoder_nm, encoder_simulated_nm, ..self }
    }

    /// The same of its quick part.
    pub fn quick_upper_square(&self) -> f64 {
        self.quick_nm * self.quick_nm * (1.0 + self.relative_error)
    }
}

/// Where a floor comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorSource {
    /// Repeats of one motion.
    Repeats,
    /// The noise beyond the low-pass, its density carried on below.
    Spectrum,
    /// The whole residual: no fit predicts it on held-out data.
    Unforeseen,
}

impl FloorSource {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Spectrum => "spectrum",
            Self::Unforeseen => "unforeseen",
        }
    }
}

/// The floor of noise alone; some fit leaves `most_square` on held-out units: where the density extrapolated below the low-pass exceeds
/// that, all of it is noise; where far, the density was not that of noise, and only its lowest part is used.
pub fn of_noise(data: &DataSet, residual_nm: &[f64], most_square: f64) -> Floor {
    let Differences { mut blocks, by_speed } = differences(data, residual_nm, BLOCK);
    if blocks.len() >= BLOCKS_MIN {
        let of_noise_square = most_of_noise(&data.policy, by_speed) / 2.0 / kept_of_noise(BLOCK);
        let rms_nm = differing_square(&mut blocks).min(of_noise_square).sqrt();
        let chance = (std::f64::consts::PI / (BLOCK * blocks.len() as f64)).sqrt();
        let relative_error = chance.hypot(data.policy.floor_repeats_error);
        return Floor::of_noise(rms_nm, FloorSource::Repeats, relative_error);
    }
    let usual = |of: fn(&SpectralFloor) -> f64| {
        let floors = data.records.all.iter().map(|record| of(&record.spectral_floor)).filter(|floor| floor.is_finite());
        Some(quantile(&mut floors.collect::<Vec<f64>>(), 0.5)).filter(|rms_nm| rms_nm.is_finite()).unwrap_or_default()
    };
    let (carried_nm, white_nm) = (usual(|floor| floor.carried_nm), usual(|floor| floor.white_nm));
    let most_nm = most_square.sqrt();
    let rms_nm =
        if carried_nm <= data.policy.floor_coloured_max * most_nm { carried_nm.min(most_nm) } else { white_nm };
    Floor::of_noise(rms_nm, FloorSource::Spectrum, data.policy.floor_spectrum_error)
}

/// Mean square of the residual that the encoder alone causes on a joint exactly like `model`, (N m)^2, without the part that differs
/// between repeats: it repeats with the motion.
fn of_encoder(data: &DataSet, model: &Model) -> f64 {
    let Some(again) = data.again() else { return 0.0 };
    let (encoder_nm, scored) = (data.encoder_nm(model), data.scored(model));
    let counted: Vec<f64> = encoder_nm.iter().zip(scored).filter(|(_, scored)| *scored).map(|(x, _)| *x).collect();
    let mut blocks = differences(again, &encoder_nm, BLOCK).blocks;
    let in_repeats = if blocks.len() >= BLOCKS_MIN { differing_square(&mut blocks) } else { 0.0 };
    if counted.is_empty() { 0.0 } else { (mean_square(&counted) - in_repeats).max(0.0) }
}

/// Mean square of one of two series whose quick differences have these mean squares in blocks.
fn differing_square(blocks: &mut [f64]) -> f64 {
    median_square(blocks) / 2.0 / kept_of_noise(BLOCK)
}

/// The floor under `left_nm`, the residual at all rows of `after`, the model with its causes, oscillations left out; it includes slow noise.
/// Without long repeats, slow noise differs from a cause only in that no fit predicts it on held-out units: `unforeseen_square` is the residual
/// of a flexible fit there, (N m)^2. The residual of the model itself, `left_square`, limits the encoder's part. Where there are no repeats and
/// such a fit predicts nothing, the residual is noise unless its level depends on the speed, most of it lasts, or so little of it that it swings
/// faster than noise: all of it if no cause and no contact was found (`is_bare`), else as far as noise that is not white may exceed the density
/// beyond the low-pass.
pub fn settled(
    (data, after): (&DataSet, &Model),
    left_nm: &[f64],
    (unforeseen_square, left_square): (f64, f64),
    is_bare: bool,
) -> Floor {
    let (policy, encoder_square) = (&data.policy, of_encoder(data, after));
    let noise_square = (unforeseen_square - encoder_square).max(0.0);
    let fast = of_noise(data, left_nm, noise_square);
    let found_again = left_square - unforeseen_square;
    let least = policy.floor_found_again_share * (left_square - encoder_square - fast.rms_nm.powi(2));
    let lasting = lasting_share(data, left_nm);
    let moving: Vec<(f64, f64)> = speeds(data).zip(left_nm).map(|(speed, left)| (speed, left * left)).collect();
    let is_noise = found_again <= least
        && usual_square(&moving) <= most_of_noise(policy, moving)
        && (policy.floor_lasting_share / BLOCK..=policy.floor_lasting_share).contains(&lasting);
    if fast.source == FloorSource::Spectrum && noise_square > fast.rms_nm.powi(2) && is_noise {
        let all_nm = noise_square.sqrt();
        let (rms_nm, source) = match is_bare {
            true => (all_nm, FloorSource::Unforeseen),
            false => (all_nm.min(policy.floor_coloured_max * fast.rms_nm), FloorSource::Spectrum),
        };
        return Floor::of_noise(rms_nm, source, policy.floor_spectrum_error).with_encoder(
            policy,
            encoder_square,
            left_square,
        );
    }
    let blocks = differences(data, left_nm, BLOCK_LATER).blocks;
    let whole_square = match blocks.len() >= BLOCKS_MIN {
        true => usual_mean(blocks, policy.floor_outlier) / 2.0 / kept_of_noise(BLOCK_LATER),
        false => noise_square,
    };
    let rms_nm = whole_square.sqrt().min(policy.floor_rise_max * fast.rms_nm).max(fast.rms_nm);
    let rise = (rms_nm / fast.rms_nm.max(f64::MIN_POSITIVE)).powi(2) - 1.0;
    let settled = Floor { rms_nm, relative_error: fast.relative_error.hypot(policy.floor_rise_error * rise), ..fast };
    settled.with_encoder(policy, encoder_square, left_square)
}

/// Share of the square of `left_nm` that stands in means over blocks of [`BLOCK`] independent samples: a tenth of white noise.
fn lasting_share(data: &DataSet, left_nm: &[f64]) -> f64 {
    let rows = (BLOCK * data.records.rows_per_independent).round().max(1.0) as usize;
    let pieces = || data.records.ranges.iter().flat_map(|range| left_nm[range.clone()].chunks_exact(rows));
    let sum = |of: fn(&[f64]) -> f64| pieces().map(of).sum::<f64>();
    let lasting = sum(|piece| piece.iter().sum::<f64>().powi(2) / piece.len() as f64);
    lasting / sum(|piece| piece.iter().map(|x| x * x).sum()).max(f64::MIN_POSITIVE)
}

/// The most that noise may have as its mean square over `rows` (speed and square at each): it does not depend on the motion, so no more
/// than noise that is not white may exceed another, of what the quietest third by speed has. At rest nothing is compared: a
/// torque read in steps does not change there.
fn most_of_noise(policy: &Policy, mut rows: Vec<(f64, f64)>) -> f64 {
    rows.retain(|(speed, _)| *speed >= AT_REST_RAD_S);
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let thirds = rows.chunks(rows.len().div_ceil(3).max(1));
    policy.floor_coloured_max.powi(2) * thirds.map(usual_square).fold(f64::INFINITY, f64::min)
}

/// Mean square over rows of speed and square.
fn usual_square(rows: &[(f64, f64)]) -> f64 {
    rows.iter().map(|(_, square)| square).sum::<f64>() / rows.len().max(1) as f64
}

/// The speed at each row, rad/s.
fn speeds(data: &DataSet) -> impl Iterator<Item = f64> {
    data.records.all.iter().flat_map(|record| record.rows.iter().map(|i| record.own[*i].velocity.abs()))
}

/// What repeats differ by, slow differences removed.
#[derive(Default)]
struct Differences {
    /// Mean squares in blocks.
    blocks: Vec<f64>,
    /// Speed and square at each row.
    by_speed: Vec<(f64, f64)>,
}

/// What repeats of one motion differ by, in blocks of `block` independent samples.
fn differences(data: &DataSet, residual_nm: &[f64], block: f64) -> Differences {
    let (records, apart) = (&data.records, data.policy.same_place_share);
    let rows = |independent: f64| (independent * records.rows_per_independent).round() as usize;
    let spans = Spans { block: rows(block), slow: rows(SLOW_BLOCKS * block), lag: rows(LAG_MAX) as isize, apart };
    let mut found = Differences::default();
    for (a, first) in records.all.iter().enumerate() {
        for (b, second) in records.all.iter().enumerate().skip(a + 1) {
            if first.repeats.is_some() && first.repeats == second.repeats {
                let [ra, rb] = [a, b].map(|at| &residual_nm[records.ranges[at].clone()]);
                add_differences((first, ra), (second, rb), spans, &mut found);
            }
        }
    }
    found
}

/// The share of white noise's square that is left once slow differences are removed with blocks of `block` independent samples.
fn kept_of_noise(block: f64) -> f64 {
    1.0 - 1.0 / (SLOW_BLOCKS * block)
}

/// The mean over blocks without those above `outlier` times their median, such as a contact in one repeat.
fn usual_mean(mut blocks: Vec<f64>, outlier: f64) -> f64 {
    let most = outlier * quantile(&mut blocks, 0.5);
    blocks.retain(|square| *square <= most);
    blocks.iter().sum::<f64>() / blocks.len().max(1) as f64
}

/// The median of mean squares over blocks, corrected to their mean.
fn median_square(blocks: &mut [f64]) -> f64 {
    quantile(blocks, 0.5) / median_of_squares(BLOCK)
}

/// Lengths in rows, and how far apart repeats may be, as a share of the range.
#[derive(Clone, Copy)]
struct Spans {
    block: usize,
    slow: usize,
    lag: isize,
    apart: f64,
}

fn add_differences((a, ra): (&Record, &[f64]), (b, rb): (&Record, &[f64]), spans: Spans, found: &mut Differences) {
    let [qa, qb] = [a, b].map(|record| record.rows.iter().map(|i| record.own[*i].position).collect::<Vec<f64>>());
    if ra.len() < 2 * spans.slow || rb.len() < 2 * spans.slow {
        return;
    }
    // Rows of both records are counted from their own first; what lies between is part of the lag.
    let offset = b.rows[0] as isize - a.rows[0] as isize;
    let base = offset / (a.rows.get(1).map_or(1, |next| next - a.rows[0]).max(1)) as isize;
    let apart = |lag: isize| {
        let (mut sum, mut count) = (0.0, 0usize);
        for i in (0..qa.len()).step_by(5) {
            if let Some(q) = usize::try_from(i as isize + lag).ok().and_then(|j| qb.get(j)) {
                sum += (q - qa[i]) * (q - qa[i]);
                count += 1;
            }
        }
        if count * 10 > qa.len() { sum / count as f64 } else { f64::INFINITY }
    };
    let lags = (-spans.lag..=spans.lag).map(|lag| lag - base);
    let Some(lag) = lags.min_by(|x, y| apart(*x).total_cmp(&apart(*y))) else { return };
    let (low, high) = extent(&qa);
    let limit = spans.apart * (high - low);
    let speed = |i: usize| a.own[a.rows[i]].velocity.abs();
    let pair = |i: usize| {
        let j = usize::try_from(i as isize + lag).ok()?;
        let near = (qb.get(j)? - qa[i]).abs() <= limit;
        near.then(|| (speed(i), ra[i] - rb[j]))
    };
    let differences: Vec<Option<(f64, f64)>> = (0..qa.len()).map(pair).collect();
    for run in differences.split(Option::is_none) {
        let (speeds, run): (Vec<f64>, Vec<f64>) = run.iter().flatten().copied().unzip();
        if run.len() < spans.slow {
            continue;
        }
        let fast = without_slow(&run, spans.slow);
        found.by_speed.extend(speeds.iter().zip(&fast).map(|(speed, d)| (*speed, d * d)));
        found.blocks.extend(fast.chunks_exact(spans.block).map(mean_square));
    }
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|d| d * d).sum::<f64>() / values.len() as f64
}

/// `values` less their running mean over `slow` of them.
fn without_slow(values: &[f64], slow: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    sums.push(0.0);
    for v in values {
        sums.push(sums[sums.len() - 1] + v);
    }
    let mean = |i: usize| {
        let from = i.saturating_sub(slow / 2).min(values.len() - slow);
        (sums[from + slow] - sums[from]) / slow as f64
    };
    values.iter().enumerate().map(|(i, v)| v - mean(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Floor, FloorSource, lasting_share, of_encoder, of_noise, settled, speeds};
    use crate::diagnose::data::DataSet;
    use crate::diagnose::data::tests::bundled;

    /// Noise with as many independent samples as the recordings have.
    fn white(data: &DataSet) -> Vec<f64> {
        let mut state = 1u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let rows = data.measured_nm.len();
        let independent: Vec<f64> = (0..rows).map(|_| noise()).collect();
        (0..rows).map(|i| independent[(i as f64 / data.records.rows_per_independent) as usize]).collect()
    }

    /// A sine that takes as many independent samples.
    fn wave(data: &DataSet, independent: f64) -> Vec<f64> {
        let rows_per_rad = independent * data.records.rows_per_independent / std::f64::consts::TAU;
        (0..data.measured_nm.len()).map(|i| (i as f64 / rows_per_rad).sin()).collect()
    }

    #[test]
    fn without_repeats_what_no_fit_predicts_is_noise_beside_causes_up_to_a_limit() {
        let (mut data, model) = bundled();
        data.records.all.iter_mut().for_each(|record| record.repeats = None);
        let (white, slow, quick) = (white(&data), wave(&data, 50.0), wave(&data, 3.0));
        let of_left = |left_nm: &[f64], left_square: f64, unforeseen_square: f64, is_bare: bool| -> Floor {
            settled((&data, &model), left_nm, (unforeseen_square, left_square), is_bare)
        };
        let of = |left_square, unforeseen_square, is_bare| of_left(&white, left_square, unforeseen_square, is_bare);
        let without_encoder = |floor: Floor| (floor.rms_nm.powi(2) - floor.encoder_nm.powi(2)).sqrt();
        let (fast_nm, encoder_square) = (of_noise(&data, &white, f64::MAX).rms_nm, of_encoder(&data, &model));
        let [less, weak, strong] = [0.8, 1.5, 10.0].map(|factor: f64| (factor * fast_nm).powi(2) + encoder_square);
        let (limit, rise) = (data.policy.floor_coloured_max, data.policy.floor_rise_max);
        let near = |floor: Floor, factor: f64| (without_encoder(floor) / fast_nm - factor).abs() < 1e-6;
        assert!(near(of(weak, weak, false), 1.5) && near(of(strong, strong, false), limit));
        assert!(near(of(strong, strong, true), 10.0));
        assert_eq!(
            [false, true].map(|is_bare| of(strong, strong, is_bare).source),
            [FloorSource::Spectrum, FloorSource::Unforeseen]
        );
        // No floor is above what a fit leaves on held-out units.
        assert!([false, true].iter().all(|is_bare| near(of(strong, less, *is_bare), 0.8)));
        // What a fit predicts is no noise, and neither is what lasts, swings faster than noise or is as loud as the speed.
        let loud: Vec<f64> = speeds(&data).zip(&white).map(|(speed, x)| speed * x).collect();
        for is_bare in [false, true] {
            assert!(near(of(2.0 * strong, strong, is_bare), rise));
            assert!([&slow, &quick, &loud].iter().all(|left_nm| near(of_left(left_nm, strong, strong, is_bare), rise)));
        }
    }

    #[test]
    fn what_lasts_is_told_from_noise() {
        let (data, _) = bundled();
        // Of independent samples a tenth stands in means of ten; of a wave as long as 50 nearly all.
        let [white, wave] = [white(&data), wave(&data, 50.0)].map(|left_nm| lasting_share(&data, &left_nm));
        assert!((0.05..0.2).contains(&white) && wave > 0.8, "{white} and {wave}");
    }
}
