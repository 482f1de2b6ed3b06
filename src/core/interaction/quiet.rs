//! The model's residual when nobody touches the joint: threshold of a contact, false alarms, uncertainty.

use super::contacts::contacts;
use super::extract::Extracted;
use crate::numerics::statistics::{deviation_by_median, poisson_bound, quantile, root_mean_square};

/// A contact is what exceeds all but this share of the quiet samples ...
const BEYOND: f64 = 1e-3;
/// ... by this factor: the largest of a quiet hour lies a little above what a few quiet minutes show.
const MARGIN: f64 = 1.25;
/// The uncertainty holds this share of the quiet samples.
const WITHIN: f64 = 0.95;
/// Samples per period of the low-pass that are looked at: more would say the same again.
const PER_PERIOD: f64 = 20.0;
/// Without quiet trials: standard deviations of the noise, estimated from the median.
const SIGMAS: f64 = 5.0;

/// Levels of stable state and of transition, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Threshold in stable state.
    pub stable_nm: f64,
    /// Threshold while friction changes over.
    pub weak_nm: f64,
    /// 95 % of quiet samples in stable state are within this.
    pub stable_within_nm: f64,
    /// 95 % of quiet samples while friction changes over are.
    pub weak_within_nm: f64,
}

impl Levels {
    /// The threshold at sample `at` of `trial`, N m; with the whole change of friction added where K_f is not known.
    pub fn threshold_nm(&self, trial: &Extracted, at: usize) -> f64 {
        self.threshold(trial.weak[at], trial.known[at], trial.change_nm[at])
    }

    /// The same from its parts.
    pub fn threshold(&self, weak: bool, known: bool, change_nm: f64) -> f64 {
        (if weak { self.weak_nm } else { self.stable_nm }) + if known { 0.0 } else { change_nm }
    }

    /// How far off tau_E may be, N m: 95 % of quiet samples were nearer.
    pub fn uncertainty(&self, weak: bool, known: bool, change_nm: f64) -> f64 {
        (if weak { self.weak_within_nm } else { self.stable_within_nm }) + if known { 0.0 } else { change_nm }
    }
}

/// What quiet trials say.
#[derive(Debug, Clone, PartialEq)]
pub struct Quiet {
    /// Thresholds and uncertainties.
    pub levels: Levels,
    /// What the model leaves of quiet trials, RMSE, N m; `None` without any.
    pub rmse_nm: Option<f64>,
    /// Contacts found in quiet trials with levels that did not see them; `None` where that cannot be tried.
    pub false_alarms: Option<usize>,
    /// How long the quiet trials last, s.
    pub quiet_s: f64,
    /// Quiet trials.
    pub trials: usize,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl Quiet {
    /// From `quiet` trials; without any, from the noise of the `touched` ones. `threshold_nm` replaces the thresholds.
    pub fn new(quiet: &[Extracted], touched: &[Extracted], threshold_nm: Option<f64>, lowpass_hz: f64) -> Self {
        let thinned: Vec<Extracted> =
            quiet.iter().map(|t| thinned(t, lowpass_hz)).filter(|t| t.known.contains(&true)).collect();
        let all: Vec<&Extracted> = thinned.iter().collect();
        // One quiet trial is tried half against half.
        let halves: Vec<Extracted> = match &thinned[..] {
            [one] => one.halves(),
            _ => Vec::new(),
        };
        let tried: Vec<&Extracted> = if halves.is_empty() { all.clone() } else { halves.iter().collect() };
        let mut made = match Self::measured(&all) {
            Some(levels) => Self {
                levels,
                rmse_nm: Some(root_mean_square(&samples(&all, |_| true))),
                false_alarms: None,
                quiet_s: all.iter().map(|t| seconds(t)).sum(),
                trials: all.len(),
                warnings: Vec::new(),
            },
            None => Self::from_touched(touched, lowpass_hz),
        };
        if let Some(threshold_nm) = threshold_nm {
            made.warnings.clear();
            (made.levels.stable_nm, made.levels.weak_nm) = (threshold_nm, threshold_nm);
        }
        let alarms = |at: usize| {
            let rest: Vec<&Extracted> = (0..tried.len()).filter(|other| *other != at).map(|i| tried[i]).collect();
            let levels = if threshold_nm.is_some() { made.levels } else { Self::measured(&rest)? };
            Some(contacts(tried[at], &tried[at].torque_nm, &levels, lowpass_hz).len())
        };
        made.false_alarms = (0..tried.len()).map(alarms).sum::<Option<usize>>().filter(|_| !tried.is_empty());
        made
    }

    fn measured(trials: &[&Extracted]) -> Option<Levels> {
        let mut stable = samples(trials, |weak| !weak);
        let mut weak = samples(trials, |weak| weak);
        if stable.is_empty() && weak.is_empty() {
            return None;
        }
        let mut level = |share: f64| {
            let [stable, weak] = [&mut stable, &mut weak].map(|of| quantile(of, share));
            // Of a part that was not seen the other's level is the best guess; a transition is never surer than the rest.
            let stable = if stable.is_nan() { weak } else { stable };
            (stable, stable.max(if weak.is_nan() { stable } else { weak }))
        };
        let ((stable_nm, weak_nm), (stable_within_nm, weak_within_nm)) = (level(1.0 - BEYOND), level(WITHIN));
        Some(Levels { stable_nm: MARGIN * stable_nm, weak_nm: MARGIN * weak_nm, stable_within_nm, weak_within_nm })
    }

    /// The median resists contacts, if they fill less than half of the time.
    fn from_touched(touched: &[Extracted], lowpass_hz: f64) -> Self {
        let thinned: Vec<Extracted> = touched.iter().map(|t| thinned(t, lowpass_hz)).collect();
        let mut all = samples(&thinned.iter().collect::<Vec<_>>(), |_| true);
        let sigma_nm = deviation_by_median(&mut all);
        let (threshold_nm, within_nm) = (SIGMAS * sigma_nm, 2.0 * sigma_nm);
        let warning = "no quiet trial in which the joint moves: the threshold comes of the noise in the interaction trials themselves, and how often it \
                       gives a false alarm is not known; add cosine or free trials in which nobody touches the joint";
        Self {
            levels: Levels {
                stable_nm: threshold_nm,
                weak_nm: threshold_nm,
                stable_within_nm: within_nm,
                weak_within_nm: within_nm,
            },
            rmse_nm: None,
            false_alarms: None,
            quiet_s: 0.0,
            trials: 0,
            warnings: vec![warning.to_string()],
        }
    }

    /// False alarms per hour of quiet, as counted, and the upper 95 % bound of their rate.
    pub fn false_alarms_per_hour(&self) -> Option<(f64, f64)> {
        let count = self.false_alarms? as f64;
        let per_hour = 3600.0 / self.quiet_s;
        Some((count * per_hour, poisson_bound(count) * per_hour))
    }
}

/// What is looked at of a quiet trial; of one thinned already, all.
pub(super) fn thinned(trial: &Extracted, lowpass_hz: f64) -> Extracted {
    trial.thinned(((trial.rate_hz / (PER_PERIOD * lowpass_hz)) as usize).max(1))
}

fn seconds(trial: &Extracted) -> f64 {
    trial.known.iter().filter(|known| **known).count() as f64 / trial.rate_hz
}

/// |tau_E| of the known samples whose weakness is wanted.
fn samples(trials: &[&Extracted], wanted: impl Fn(bool) -> bool) -> Vec<f64> {
    let of = |t: &&Extracted| -> Vec<f64> {
        (0..t.torque_nm.len()).filter(|i| t.known[*i] && wanted(t.weak[*i])).map(|i| t.torque_nm[i].abs()).collect()
    };
    trials.iter().flat_map(of).collect()
}
