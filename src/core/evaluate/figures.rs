//! Figures of error: RMSE, MAE, peak, split into stable state and transition.

use crate::numerics::statistics::{mean, standard_deviation};

/// How large an error is over some samples; NaN without any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Samples judged.
    pub samples: usize,
    /// Root mean square, N m.
    pub rmse_nm: f64,
    /// Mean absolute error, N m.
    pub mae_nm: f64,
    /// Largest absolute error, N m.
    pub peak_nm: f64,
    /// RMSE as percent of the measured torque's range in the trial.
    pub rmse_percent: f64,
    /// MAE as percent of the same.
    pub mae_percent: f64,
}

impl Figures {
    /// Of `errors_nm`, in a trial whose measured torque spans `range_nm`.
    pub fn of(errors_nm: impl Iterator<Item = f64>, range_nm: f64) -> Self {
        let (mut samples, mut squares, mut sum, mut peak_nm) = (0usize, 0.0, 0.0, 0f64);
        for error in errors_nm {
            samples += 1;
            squares += error * error;
            sum += error.abs();
            peak_nm = peak_nm.max(error.abs());
        }
        let n = samples as f64;
        let (rmse_nm, mae_nm) = ((squares / n).sqrt(), sum / n);
        Self {
            samples,
            rmse_nm,
            mae_nm,
            peak_nm: if samples > 0 { peak_nm } else { f64::NAN },
            rmse_percent: 100.0 * rmse_nm / range_nm,
            mae_percent: 100.0 * mae_nm / range_nm,
        }
    }
}

/// Figures over all judged samples, and over its two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// All.
    pub all: Figures,
    /// |K_f| = 1: friction fully on one branch.
    pub stable: Figures,
    /// |K_f| < 1: after a reversal.
    pub transition: Figures,
}

/// Which samples of a trial are judged, and how.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Sample numbers, in order.
    pub samples: Vec<usize>,
    /// Whether each of them is stable.
    pub stable: Vec<bool>,
}

impl Judged {
    /// Figures of `measured_nm` less `predicted_nm`, both over the whole trial.
    pub fn split(&self, measured_nm: &[f64], predicted_nm: &[f64]) -> Split {
        let error = |at: &usize| measured_nm[*at] - predicted_nm[*at];
        let measured = self.samples.iter().map(|at| measured_nm[*at]);
        let (low, high) = measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        let part = |stable: bool| {
            let mine = self.samples.iter().zip(&self.stable).filter(move |(_, s)| **s == stable);
            Figures::of(mine.map(|(at, _)| error(at)), high - low)
        };
        Split {
            all: Figures::of(self.samples.iter().map(error), high - low),
            stable: part(true),
            transition: part(false),
        }
    }
}

/// Mean and standard deviation of a figure over trials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Sample standard deviation; NaN of fewer than two trials.
    pub sd: f64,
}

impl Spread {
    /// Of those of `values` that are known.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let known: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        Self { mean: mean(&known), sd: standard_deviation(&known) }
    }
}

/// Figures over all trials together: squares and sums are pooled over samples, percentages averaged over trials.
pub fn pooled(trials: &[Figures]) -> Figures {
    let known: Vec<&Figures> = trials.iter().filter(|f| f.samples > 0).collect();
    let samples: usize = known.iter().map(|f| f.samples).sum();
    let weighted =
        |of: fn(&Figures) -> f64| known.iter().map(|f| f.samples as f64 * of(f)).sum::<f64>() / samples as f64;
    let percent = |of: fn(&Figures) -> f64| mean(&known.iter().map(|f| of(f)).collect::<Vec<f64>>());
    Figures {
        samples,
        rmse_nm: weighted(|f| f.rmse_nm * f.rmse_nm).sqrt(),
        mae_nm: weighted(|f| f.mae_nm),
        peak_nm: known.iter().map(|f| f.peak_nm).fold(f64::NAN, f64::max),
        rmse_percent: percent(|f| f.rmse_percent),
        mae_percent: percent(|f| f.mae_percent),
    }
}
