//! The interaction torque of samples as they come.

use super::Frame;
use super::causal::Estimator;
use super::contacts::Detector;
use super::quiet::Quiet;
use crate::log::{Campaign, Log, Sample};
use crate::model::Model;
use crate::problem::Result;

/// After a gap of this many sample periods the filters start anew: what they hold is of another time.
const GAP: f64 = 3.0;

/// Plausible range of a sample of the stream: this multiple of the largest value in the campaign's first trial. A person pushes a joint
/// that moves freely a hundred times harder than its friction does, never a thousand times.
const REACH_TORQUE: f64 = 1000.0;
const REACH_POSITION: f64 = 100.0;
/// The least that is taken for what the first trial shows: it may be at rest. N m and rad (N and m).
const LEAST_TORQUE_NM: f64 = 0.01;
const LEAST_POSITION_RAD: f64 = 1.0;

/// What samples can hold; others do not enter the filters, which would carry them along for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Largest position either way, rad.
    pub position_rad: f64,
    /// Largest torque either way, at the winch, N m.
    pub torque_nm: f64,
    /// Largest load at the joint either way, N m.
    pub load_nm: f64,
}

impl Plausible {
    /// After what `log` shows of a joint of `transmission`, torque at the winch per torque at the joint.
    pub fn after(log: &Log, transmission: f64) -> Self {
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let torque_nm = REACH_TORQUE * largest(&log.torque_nm).max(LEAST_TORQUE_NM);
        let position_rad = REACH_POSITION * largest(&log.position_rad).max(LEAST_POSITION_RAD);
        Self { position_rad, torque_nm, load_nm: torque_nm / transmission }
    }

    /// The name and value of what `sample` cannot hold, if there is such.
    pub fn fault(&self, sample: &Sample) -> Option<(&'static str, f64)> {
        let beyond = |value: f64, most: f64| value.is_nan() || value.abs() > most;
        [
            ("position", sample.position_rad, self.position_rad),
            ("torque", sample.torque_nm, self.torque_nm),
            ("load", sample.load_nm, self.load_nm),
        ]
        .into_iter()
        .chain(sample.others.iter().map(|other| ("another joint's position", *other, self.position_rad)))
        .find(|(_, value, most)| beyond(*value, *most))
        .map(|(name, value, _)| (name, value))
    }
}

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
    plausible: Plausible,
    /// What the last sample gave.
    last: Option<StreamOutput>,
    /// Gaps met so far.
    pub gaps: usize,
    /// Samples left out so far.
    pub left_out: usize,
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
        (deadband_rad, plausible): (f64, Plausible),
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
            plausible,
            last: None,
            gaps: 0,
            left_out: 0,
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

    /// What is wrong with `sample`: a name and a value that no joint or sensor shows. `step` leaves such a sample out.
    pub fn fault(&self, sample: &Sample) -> Option<(&'static str, f64)> {
        self.plausible.fault(sample)
    }

    /// The next sample.
    ///
    /// One that no joint or sensor shows counts as lost: it does not enter the filters, the torque is held, and nothing is known
    /// until the filters have forgotten the gap. Several on end are a gap as any other.
    pub fn step(&mut self, sample: &Sample) -> StreamOutput {
        if self.fault(sample).is_some() {
            self.left_out += 1;
            self.estimator.discard_state();
            return self.held(sample.time_s);
        }
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
        let output = StreamOutput {
            time_s: sample.time_s,
            torque_nm: step.torque_nm,
            uncertainty_nm: self.quiet.levels.uncertainty(weak, step.known, step.change_nm),
            threshold_nm,
            contact: self.detector.touched(),
            known: step.known,
        };
        self.last = Some(output);
        output
    }

    /// What the last sample gave, at `time_s` and not known.
    fn held(&self, time_s: f64) -> StreamOutput {
        let levels = &self.quiet.levels;
        let nothing = StreamOutput {
            time_s,
            torque_nm: 0.0,
            uncertainty_nm: levels.uncertainty(true, false, 0.0),
            threshold_nm: levels.threshold(true, false, 0.0),
            contact: false,
            known: false,
        };
        StreamOutput { time_s, known: false, ..self.last.unwrap_or(nothing) }
    }
}
