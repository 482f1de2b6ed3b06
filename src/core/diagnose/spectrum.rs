//! The torque noise beyond the low-pass, and what it would be within it.

use crate::log::Signal;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::{median_of_squares, quantile};
use crate::prepare::Trial;
use std::f64::consts::{PI, TAU};

/// Noise is measured in bands from this multiple of the low-pass ...
const FROM: f64 = 1.6;
/// ... over a decade, so many of them: mains hum is in one, and its filters' flanks carry some of it into the next to either side ...
const BANDS: i32 = 10;
/// ... and below this share of the rate, but for the first of them ...
const BELOW: f64 = 0.35;
/// ... which may lie as high as this.
const FIRST_BELOW: f64 = 0.45;
/// Frequencies above which the noise's density falls, from the low-pass to the rate (white): number of values that are tried.
const CORNERS: usize = 24;
/// Frequencies at which a density is summed, denser towards 0.
const FREQUENCIES: usize = 1000;
/// Length of a stretch in which it is measured, s; their median is taken.
const STRETCH_S: f64 = 0.5;

/// RMS that the noise found beyond the low-pass would have within it, N m; NaN where the rate leaves no room.
#[derive(Debug, Clone, Copy)]
pub struct SpectralFloor {
    /// The fall of the density beyond the low-pass carried on below.
    pub carried_nm: f64,
    /// Its lowest part as white noise.
    pub white_nm: f64,
    /// The part next to the low-pass as white noise: of a torque that was filtered before it was recorded the density falls too steeply to be
    /// carried on.
    pub next_nm: f64,
}

/// The noise of `trial` beyond the low-pass, carried on below.
///
/// The noise is taken for a first-order process with its corner at the low-pass or above: its density's fall over the bands beyond the low-pass is
/// carried on below. In each band the median over stretches counts, because a reversal is not noise, and among the bands the median, because
/// mains hum in a few of them is none.
///
/// The torque that the motion causes beyond the low-pass is not noise either, and a short motion reverses in every stretch: the torque
/// minus `predicted_nm` is evaluated too, and the lower of both counts.
pub fn spectral(trial: &Trial, predicted_nm: &[f64], signal: &Signal) -> SpectralFloor {
    let raw_nm = &trial.log.torque_nm;
    let left_nm: Vec<f64> = raw_nm.iter().zip(predicted_nm).map(|(y, predicted)| y - predicted).collect();
    let [raw, left] = [raw_nm, &left_nm].map(|series_nm| carried_below(series_nm, trial.log.rate_hz, signal));
    SpectralFloor {
        carried_nm: raw.carried_nm.min(left.carried_nm),
        white_nm: raw.white_nm.min(left.white_nm),
        next_nm: raw.next_nm.min(left.next_nm),
    }
}

/// The noise in `series_nm` beyond the low-pass, carried on below.
fn carried_below(series_nm: &[f64], rate_hz: f64, signal: &Signal) -> SpectralFloor {
    let order = signal.lowpass_order;
    let edge_hz = |i: i32| FROM * signal.lowpass_hz * 10f64.powf(f64::from(i) / f64::from(BANDS));
    let below = |i: i32| if i == 0 { FIRST_BELOW } else { BELOW };
    let edges: Vec<f64> = (0..=BANDS).filter(|i| edge_hz(*i) < below(*i) * rate_hz).map(edge_hz).collect();
    let levels: Option<Vec<Vec<f64>>> =
        edges.iter().map(|edge_hz| Some(LowPass::new(order, *edge_hz, rate_hz)?.zero_phase(series_nm))).collect();
    let Some(mut levels) = levels.filter(|levels| !levels.is_empty()) else {
        return SpectralFloor { carried_nm: f64::NAN, white_nm: f64::NAN, next_nm: f64::NAN };
    };
    levels.push(series_nm.to_vec());
    let half_hz = rate_hz / 2.0;
    let width_hz = |i: usize| edges.get(i + 1).unwrap_or(&half_hz) - edges[i];
    let band = |(i, pair): (usize, &[Vec<f64>])| usual_square((&pair[0], &pair[1]), width_hz(i), rate_hz);
    let squares: Vec<f64> = levels.windows(2).enumerate().map(band).collect();
    // The square of an even grid, whose steps are in proportion to the grid.
    let at = |i: usize| (i as f64 + 0.5) / FREQUENCIES as f64;
    let at_hz = |i: usize| at(i).powi(2) * half_hz;
    let gains = |edge_hz: f64| (0..FREQUENCIES).map(move |i| passed(order, edge_hz, at_hz(i), rate_hz));
    let in_band = |i: usize| -> Vec<f64> {
        let lower = gains(edges[i]);
        match edges.get(i + 1) {
            Some(edge_hz) => gains(*edge_hz).zip(lower).map(|(upper, lower)| (upper - lower).powi(2)).collect(),
            None => lower.map(|lower| (1.0 - lower).powi(2)).collect(),
        }
    };
    let bands: Vec<Vec<f64>> = (0..edges.len()).map(in_band).collect();
    let within: Vec<f64> = gains(signal.lowpass_hz).map(|gain| gain * gain).collect();
    // Of a process of which each sample keeps the share `keep` of the one before: the level of its density in each band, and at level 1 the
    // power within the low-pass.
    let process = |keep: f64| {
        let density = |hz: f64| 1.0 / (1.0 - 2.0 * keep * (TAU * hz / rate_hz).cos() + keep * keep);
        let densities: Vec<f64> = (0..FREQUENCIES).map(|i| 2.0 * at(i) * density(at_hz(i))).collect();
        let power =
            |weights: &[f64]| densities.iter().zip(weights).map(|(d, w)| d * w).sum::<f64>() / FREQUENCIES as f64;
        let levels: Vec<f64> = squares.iter().zip(&bands).map(|(square, band)| square / power(band)).collect();
        (levels, power(&within))
    };
    let fit = |i: usize| {
        let corner_hz = rate_hz * (signal.lowpass_hz / rate_hz).powf(i as f64 / (CORNERS - 1) as f64);
        let (levels, power) = process((-TAU * corner_hz / rate_hz).exp());
        let mut logs: Vec<f64> = levels.iter().map(|level| level.ln()).collect();
        let usual = quantile(&mut logs, 0.5);
        (logs.iter().map(|l| (l - usual).abs()).sum::<f64>(), (usual.exp() * power).sqrt())
    };
    let best = (0..CORNERS).map(fit).min_by(|a, b| a.0.total_cmp(&b.0));
    let (levels, power) = process(0.0);
    let (next, lowest) = (levels[0], levels.iter().copied().fold(f64::INFINITY, f64::min));
    SpectralFloor {
        carried_nm: best.map_or(f64::NAN, |(_, rms_nm)| rms_nm),
        white_nm: (lowest * power).sqrt(),
        next_nm: (next * power).sqrt(),
    }
}

/// Mean square of the noise in a band of `width_hz`, what the second level has beyond the first, by the median over stretches.
fn usual_square((lower, upper): (&[f64], &[f64]), width_hz: f64, rate_hz: f64) -> f64 {
    let stretch = ((STRETCH_S * rate_hz) as usize).max(8);
    let folds = lower.chunks_exact(stretch).zip(upper.chunks_exact(stretch));
    let square = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>();
    let usual = quantile(&mut folds.map(|part| square(part) / stretch as f64).collect::<Vec<f64>>(), 0.5);
    usual / median_of_squares((2.0 * width_hz * stretch as f64 / rate_hz).max(1.0))
}

/// Share of an amplitude at `hz` that passes a zero-phase Butterworth low-pass, as the bilinear transform has it.
fn passed(order: usize, edge_hz: f64, hz: f64, rate_hz: f64) -> f64 {
    let warped = |f: f64| (PI * f / rate_hz).tan();
    1.0 / (1.0 + (warped(hz) / warped(edge_hz)).powi(2 * order as i32))
}

#[cfg(test)]
mod tests {
    use super::carried_below;
    use crate::log::Signal;
    use crate::numerics::filter::LowPass;
    use crate::numerics::statistics::root_mean_square;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 2000.0;

    /// A minute of noise whose density falls from `corner_hz` on.
    fn noise(corner_hz: f64) -> Vec<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let keep = (-TAU * corner_hz / RATE_HZ).exp();
        let mut last = 0.0;
        let step = |_| {
            let fresh: f64 = StandardNormal.sample(&mut rng);
            last = keep * last + fresh;
            last
        };
        (0..(60.0 * RATE_HZ) as usize).map(step).collect()
    }

    #[test]
    fn a_rate_of_four_times_the_low_pass_leaves_room_for_noise_beyond_it_and_one_of_three_none() {
        let within = |lowpass_hz: f64| {
            let (series, signal) = (noise(RATE_HZ), Signal { torque_sign: 1.0, lowpass_hz, lowpass_order: 4 });
            let within = root_mean_square(&LowPass::new(4, lowpass_hz, RATE_HZ).unwrap().zero_phase(&series));
            carried_below(&series, RATE_HZ, &signal).carried_nm / within
        };
        assert!((0.9..1.1).contains(&within(0.25 * RATE_HZ)), "{}", within(0.25 * RATE_HZ));
        assert!(within(RATE_HZ / 3.0).is_nan());
    }

    #[test]
    fn the_fall_of_the_density_beyond_the_low_pass_is_carried_on_below_also_beside_mains_hum() {
        let signal = Signal { torque_sign: 1.0, lowpass_hz: 4.0, lowpass_order: 4 };
        let lowpass = LowPass::new(4, 4.0, RATE_HZ).unwrap();
        for corner_hz in [8.0, 40.0, 900.0] {
            let mut series = noise(corner_hz);
            let within = root_mean_square(&lowpass.zero_phase(&series));
            let ratio = |series: &[f64]| carried_below(series, RATE_HZ, &signal).carried_nm / within;
            assert!((0.8..1.25).contains(&ratio(&series)), "{corner_hz} Hz: {}", ratio(&series));
            let large = 0.3 * root_mean_square(&series);
            series.iter_mut().enumerate().for_each(|(i, x)| *x += large * (TAU * 50.0 * i as f64 / RATE_HZ).sin());
            assert!((0.7..1.5).contains(&ratio(&series)), "{corner_hz} Hz beside hum: {}", ratio(&series));
        }
    }
}
