//! The interaction torque one sample at a time: what a controller or a stream can have.
//!
//! Speed and acceleration come of a filter that sees no future, so they are late; the measured torque and the position that
//! K_f follows pass through a filter of the same lateness before the two sides are compared and low-passed.

use super::extract::{Frame, change_nm};
use crate::dynamics::{Chain, Motion};
use crate::effects::Sample;
use crate::log::{Campaign, Place};
use crate::model::{Asked, Direction, Model, Passage};
use crate::numerics::causal::{CausalLowPass, Delay, Follower, Lag};
use crate::numerics::filter::LowPass;
use crate::predict::forgotten;
use crate::prepare::motion_cutoff_hz;
use crate::problem::{Problem, Result};

/// What is known after one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// tau_E, low-passed, N m.
    pub torque_nm: f64,
    /// Whether friction is changing over.
    pub weak: bool,
    /// Whether K_f is known, the joint having moved through its clearance, and the filters have forgotten what was before.
    pub known: bool,
    /// The whole change of friction, N m.
    pub change_nm: f64,
}

/// The filters and the friction's state.
#[derive(Debug, Clone)]
pub struct Estimator {
    model: Model,
    frame: Frame,
    rate_hz: f64,
    deadband_rad: f64,
    joint: Follower,
    torque: Follower,
    load: Follower,
    chain: Option<(Chain, Vec<Place>)>,
    /// One for each recorded other joint, and room for what they say.
    others: Vec<Follower>,
    moved: Vec<Motion>,
    /// Holds the prediction back where the sensor is late, and the measurement where it is early.
    late: Delay,
    lag: Lag,
    early: Delay,
    samples: usize,
    lowpass: CausalLowPass,
    /// From either branch: where they agree, K_f is known whatever it was at first.
    states: Option<[Passage; 2]>,
    /// Samples until the filters have forgotten what they were fed before K_f was known; `None` until it is.
    known_in: Option<usize>,
    forgotten: usize,
}

impl Estimator {
    /// For samples of `campaign`'s joint at `rate_hz`, whose position is noise below `deadband_rad`.
    ///
    /// Errors: the rate does not carry the campaign's low-pass.
    pub fn new(campaign: &Campaign, model: &Model, frame: Frame, rate_hz: f64, deadband_rad: f64) -> Result<Self> {
        let signal = campaign.signal;
        let Some(lowpass) = LowPass::new(signal.lowpass_order, signal.lowpass_hz, rate_hz) else {
            let what = format!("samples at {rate_hz} Hz do not carry a low-pass at {} Hz", signal.lowpass_hz);
            return Problem::error(&campaign.file, what, "lower lowpass_hz below half the sample rate").alone();
        };
        let follower = Follower::new(motion_cutoff_hz(signal.lowpass_hz, rate_hz), rate_hz);
        let chain = campaign.arm.as_ref().map(|arm| (arm.chain.clone(), arm.others.clone()));
        let delay = model.delay_s() * rate_hz;
        Ok(Self {
            model: model.clone(),
            frame,
            rate_hz,
            deadband_rad,
            joint: follower,
            torque: follower,
            load: follower,
            chain,
            others: vec![follower; campaign.columns.other_position.len()],
            moved: Vec::new(),
            late: Delay::new(delay.max(0.0)),
            lag: Lag::new(model.lag_s() * rate_hz),
            early: Delay::new((-delay).max(0.0)),
            samples: 0,
            lowpass: CausalLowPass::new(&lowpass),
            states: None,
            known_in: None,
            forgotten: forgotten(rate_hz, signal.lowpass_hz),
        })
    }

    /// How late the torque is, s.
    pub fn delay_s(&self) -> f64 {
        (self.torque.delay() + self.lowpass.delay() + self.early.samples()) / self.rate_hz
    }

    /// A filter as late as the torque's own, for a reference to compare with.
    pub fn like_the_torque(&self) -> ReferenceFilter {
        ReferenceFilter { follower: self.torque.fresh(), lowpass: self.lowpass.fresh(), early: self.early.fresh() }
    }

    /// The next sample: position (rad), y (N m), measured load at the joint (N m), and the other joints' recorded positions.
    pub fn step(&mut self, position_rad: f64, torque_nm: f64, load_nm: f64, others: &[f64]) -> Step {
        let own = motion(self.joint.step(position_rad));
        let [measured_nm, ..] = self.torque.step(torque_nm);
        let [load_nm, ..] = self.load.step(load_nm);
        let mut moved = std::mem::take(&mut self.moved);
        moved.clear();
        let recorded = |at: usize| others.get(at).copied().unwrap_or(0.0);
        moved.extend(self.others.iter_mut().enumerate().map(|(at, follower)| motion(follower.step(recorded(at)))));
        let mut asked = self.asked(own, &moved);
        asked.torque_nm += load_nm;
        let (state, k_tilde) = self.advance(own);
        let time_s = self.samples as f64 / self.rate_hz;
        self.samples += 1;
        let sample = Sample { time_s, elapsed_s: time_s, own, others: &moved };
        let driven_nm = self.model.driven_nm(&sample, asked, k_tilde).torque_nm;
        let predicted_nm = self.model.reading_nm(&sample, self.lag.step(self.late.step(driven_nm)));
        let measured_nm = self.early.step(measured_nm);
        self.moved = moved;
        let factor = self.frame.factor(&self.model, k_tilde);
        Step {
            torque_nm: factor * self.lowpass.step(measured_nm - predicted_nm),
            weak: !state.is_stable(),
            known: self.known_in == Some(0),
            change_nm: factor * change_nm(&self.model, own.velocity),
        }
    }

    /// A sample was lost: what the filters give is known again once they have forgotten the gap.
    pub fn discard_state(&mut self) {
        self.known_in = self.known_in.map(|_| self.forgotten);
    }

    /// What mass asks of the joint.
    fn asked(&self, own: Motion, others: &[Motion]) -> Asked {
        /// Half the step over which a chain's gravity is differentiated, rad.
        const STEP_RAD: f64 = 1e-4;
        let (kind, dynamics) = (self.model.joint.kind, &self.model.dynamics);
        let Some((chain, places)) = &self.chain else {
            let torque_nm = dynamics.gravity_nm(kind, own.position) + dynamics.inertia_kg_m2 * own.acceleration;
            return Asked { torque_nm, slope_nm_rad: dynamics.gravity_slope_nm_rad(kind, own.position) };
        };
        let place = |place: &Place| match place {
            Place::Held(position) => Motion { position: *position, ..Motion::default() },
            Place::Column(at) => others[*at],
        };
        let moved: Vec<Motion> = places.iter().map(place).collect();
        let slope_nm_rad = if self.model.effects.is_empty() && dynamics.position_zero_rad == 0.0 {
            0.0
        } else {
            let at = |position| chain.torque(Motion { position, ..own }, &moved).gravity_nm;
            (at(own.position + STEP_RAD) - at(own.position - STEP_RAD)) / (2.0 * STEP_RAD)
        };
        let rigid = chain.torque(own, &moved);
        let (gravity_nm, slope_nm_rad) = dynamics.at_true_position(rigid.gravity_nm, slope_nm_rad);
        Asked { torque_nm: gravity_nm + rigid.inertia_nm + rigid.coriolis_nm, slope_nm_rad }
    }

    /// Where friction stands once the joint has moved on, and K~.
    fn advance(&mut self, own: Motion) -> (Passage, f64) {
        let (model, deadband_rad) = (&self.model, self.deadband_rad);
        let states = self.states.get_or_insert_with(|| {
            Direction::BOTH.map(|direction| Passage::after(model, direction, own.position, deadband_rad))
        });
        let [up, down] = states.each_mut().map(|state| state.step(own.position, Direction::of(own.velocity)));
        let [from_up, from_down] = *states;
        self.known_in = match self.known_in {
            None if from_up.k_f() == from_down.k_f() => Some(self.forgotten),
            waiting => waiting.map(|samples| samples.saturating_sub(1)),
        };
        // The one that the motion goes towards is the one whose K_f the other will meet.
        if from_up.direction() == Direction::Up { (from_up, up) } else { (from_down, down) }
    }
}

/// Filters a reference as late as the torque.
#[derive(Debug, Clone)]
pub struct ReferenceFilter {
    follower: Follower,
    lowpass: CausalLowPass,
    early: Delay,
}

impl ReferenceFilter {
    /// The next sample, filtered.
    pub fn step(&mut self, reference_nm: f64) -> f64 {
        let [late_nm, ..] = self.follower.step(reference_nm);
        self.lowpass.step(self.early.step(late_nm))
    }
}

fn motion([position, velocity, acceleration]: [f64; 3]) -> Motion {
    Motion { position, velocity, acceleration }
}
