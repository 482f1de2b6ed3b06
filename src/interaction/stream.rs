//! The interaction torque of samples as they come.

use super::Frame;
use super::causal::Estimator;
use super::contacts::Detector;
use super::quiet::Quiet;
use crate::log::{Campaign, Sample};
use crate::model::Model;
use crate::problem::Result;

/// After a gap of this many sample periods the filters start anew: what they hold is of another time.
const GAP: f64 = 3.0;

/// What a sample gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamOutput {
    /// The sample's time, s; the torque belongs to an earlier one by the filters' delay.
    pub time_s: f64,
    /// tau_E, N m.
    pub torque_nm: f64,
    /// How far off it may be, N m.
    pub uncertainty_nm: f64,
    /// The threshold of a contact, N m.
    pub threshold_nm: f64,
    /// Whether there is contact.
    pub contact: bool,
    /// Whether K_f is known; unlike in a log, readings at the end of the sensor's range are not looked for.
    pub known: bool,
}

/// Everything that a stream needs between two samples.
#[derive(Debug, Clone)]
pub struct Stream {
    fresh: Estimator,
    estimator: Estimator,
    detector: Detector,
    quiet: Quiet,
    period_s: f64,
    /// Samples for which the last transition still reaches through the low-pass.
    smear: usize,
    weak_for: usize,
    last_s: Option<f64>,
    /// Gaps met so far.
    pub gaps: usize,
}

impl Stream {
    /// For samples of `campaign`'s joint at `rate_hz`.
    ///
    /// Errors: the rate does not carry the campaign's low-pass.
    pub fn new(
        campaign: &Campaign,
        model: &Model,
        frame: Frame,
        quiet: Quiet,
        rate_hz: f64,
        deadband_rad: f64,
    ) -> Result<Self> {
        let fresh = Estimator::new(campaign, model, frame, rate_hz, deadband_rad)?;
        let lowpass_hz = campaign.signal.lowpass_hz;
        Ok(Self {
            estimator: fresh.clone(),
            fresh,
            detector: Detector::new(rate_hz, lowpass_hz),
            quiet,
            period_s: 1.0 / rate_hz,
            smear: (rate_hz / lowpass_hz) as usize,
            weak_for: 0,
            last_s: None,
            gaps: 0,
        })
    }

    /// Samples a second that it is for.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.period_s
    }

    /// What counts as contact.
    pub fn quiet(&self) -> &Quiet {
        &self.quiet
    }

    /// How late the torque is, s.
    pub fn delay_s(&self) -> f64 {
        self.fresh.delay_s()
    }

    /// How late the word that there is contact is, s: the torque, and the time that it must stay above the threshold.
    pub fn contact_delay_s(&self) -> f64 {
        self.delay_s() + self.detector.hold() as f64 * self.period_s
    }

    /// The next sample.
    pub fn step(&mut self, sample: &Sample) -> StreamOutput {
        if self.last_s.is_some_and(|last_s| sample.time_s - last_s > GAP * self.period_s) {
            self.estimator = self.fresh.clone();
            self.gaps += 1;
        }
        self.last_s = Some(sample.time_s);
        let step = self.estimator.step(sample.position_rad, sample.torque_nm, sample.load_nm, &sample.others);
        self.weak_for = if step.weak { self.smear + 1 } else { self.weak_for.saturating_sub(1) };
        let weak = self.weak_for > 0;
        let threshold_nm = self.quiet.levels.threshold(weak, step.known, step.change_nm);
        self.detector.step(step.torque_nm, threshold_nm);
        StreamOutput {
            time_s: sample.time_s,
            torque_nm: step.torque_nm,
            uncertainty_nm: self.quiet.levels.uncertainty(weak, step.known, step.change_nm),
            threshold_nm,
            contact: self.detector.touched(),
            known: step.known,
        }
    }
}
