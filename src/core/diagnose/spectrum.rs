//! The torque noise beyond the low-pass, and what it would be within it.

use crate::log::Signal;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::quantile;
use crate::prepare::Trial;

/// Noise is measured in bands that begin at these multiples of the low-pass ...
const BANDS: [f64; 6] = [1.6, 2.5, 4.0, 6.4, 10.0, 16.0];
/// ... and below this share of the rate.
const BELOW: f64 = 0.35;
/// Autocorrelation of the noise at one sample: number of values that are tried.
const KEEPS: usize = 20;
const KEEP_STEP: f64 = 0.05;
/// Frequencies at which a density is summed.
const FREQUENCIES: usize = 400;
/// Length of a stretch in which it is measured, s; their median is taken.
const STRETCH_S: f64 = 0.5;

/// RMS that the noise found beyond the low-pass would have within it, N m; NaN where the rate leaves no room.
#[derive(Debug, Clone, Copy)]
pub struct SpectralFloor {
    /// The fall of the density beyond the low-pass carried on below.
    pub carried_nm: f64,
    /// Its lowest part as white noise.
    pub white_nm: f64,
}

/// The noise of `trial` beyond the low-pass, carried on below.
///
/// The noise is taken for a first-order process, white at best: its density's fall over the bands beyond the low-pass is carried on below.
/// In each band the median over stretches counts, because a reversal is not noise.
///
/// The torque that the motion causes beyond the low-pass is not noise either, and a short motion reverses in every stretch: the torque
/// minus `predicted_nm` is evaluated too, and the lower of both counts.
pub fn spectral(trial: &Trial, predicted_nm: &[f64], signal: &Signal) -> SpectralFloor {
    let raw_nm = &trial.log.torque_nm;
    let left_nm: Vec<f64> = raw_nm.iter().zip(predicted_nm).map(|(y, predicted)| y - predicted).collect();
    let [raw, left] = [raw_nm, &left_nm].map(|series_nm| carried_below(series_nm, trial.log.rate_hz, signal));
    SpectralFloor { carried_nm: raw.carried_nm.min(left.carried_nm), white_nm: raw.white_nm.min(left.white_nm) }
}

/// The noise in `series_nm` beyond the low-pass, carried on below.
fn carried_below(series_nm: &[f64], rate_hz: f64, signal: &Signal) -> SpectralFloor {
    let order = signal.lowpass_order;
    let edges: Vec<f64> =
        BANDS.iter().map(|factor| factor * signal.lowpass_hz).filter(|edge_hz| *edge_hz < BELOW * rate_hz).collect();
    let levels: Option<Vec<Vec<f64>>> =
        edges.iter().map(|edge_hz| Some(LowPass::new(order, *edge_hz, rate_hz)?.zero_phase(series_nm))).collect();
    let Some(mut levels) = levels.filter(|levels| !levels.is_empty()) else {
        return SpectralFloor { carried_nm: f64::NAN, white_nm: f64::NAN };
    };
    levels.push(series_nm.to_vec());
    let stretch = ((STRETCH_S * rate_hz) as usize).max(8);
    let band = |pair: &[Vec<f64>]| {
        let folds = pair[0].chunks_exact(stretch).zip(pair[1].chunks_exact(stretch));
        let square = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>();
        quantile(&mut folds.map(|part| square(part) / stretch as f64).collect::<Vec<f64>>(), 0.5)
    };
    let squares: Vec<f64> = levels.windows(2).map(band).collect();
    let gain = |edge_hz: f64, hz: f64| passed(order, edge_hz, hz, rate_hz);
    let within = |keep: f64, i: usize| {
        mean_density(keep, rate_hz, |hz| {
            let upper = edges.get(i + 1).map_or(1.0, |edge_hz| gain(*edge_hz, hz));
            (upper - gain(edges[i], hz)).powi(2)
        })
    };
    let fit = |keep: f64| {
        let logs: Vec<f64> = squares.iter().enumerate().map(|(i, square)| (square / within(keep, i)).ln()).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        (logs.iter().map(|l| (l - mean) * (l - mean)).sum::<f64>(), mean.exp())
    };
    let keeps = (0..KEEPS).map(|i| i as f64 * KEEP_STEP);
    let best = keeps.map(|keep| (keep, fit(keep))).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let passed_nm =
        |power: f64, keep: f64| (power * mean_density(keep, rate_hz, |hz| gain(signal.lowpass_hz, hz).powi(2))).sqrt();
    let lowest = squares.iter().enumerate().map(|(i, square)| square / within(0.0, i)).fold(f64::INFINITY, f64::min);
    SpectralFloor {
        carried_nm: best.map_or(f64::NAN, |(keep, (_, power))| passed_nm(power, keep)),
        white_nm: passed_nm(lowest, 0.0),
    }
}

/// Share of an amplitude at `hz` that passes a zero-phase Butterworth low-pass, as the bilinear transform has it.
fn passed(order: usize, edge_hz: f64, hz: f64, rate_hz: f64) -> f64 {
    let warped = |f: f64| (std::f64::consts::PI * f / rate_hz).tan();
    1.0 / (1.0 + (warped(hz) / warped(edge_hz)).powi(2 * order as i32))
}

/// Mean over all frequencies of the density of a process of which each sample keeps the share `keep` of the one before, times
/// what `weight` lets through.
fn mean_density(keep: f64, rate_hz: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let density = |hz: f64| 1.0 / (1.0 - 2.0 * keep * (std::f64::consts::TAU * hz / rate_hz).cos() + keep * keep);
    let at = |i: usize| (i as f64 + 0.5) / FREQUENCIES as f64 * rate_hz / 2.0;
    (0..FREQUENCIES).map(|i| density(at(i)) * weight(at(i))).sum::<f64>() / FREQUENCIES as f64
}
