//! The interaction torque one sample at a time: what a controller or a stream can have.
//!
//! Speed and acceleration come of a filter that sees no future, so they are late; the measured torque and the position that
//! K_f follows pass through a filter of the same lateness before the two sides are compared and low-passed.

use super::extract::{Frame, change_nm};
use crate::dynamics::{Chain, Motion};
use crate::log::{Campaign, Place};
use crate::model::{Combination, Direction, Model, Transition};
use crate::numerics::causal::{CausalLowPass, Follower};
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
    chain: Option<(Chain, Vec<(Place, Follower)>)>,
    lowpass: CausalLowPass,
    /// From either branch: where they agree, K_f is known whatever it was at first.
    states: Option<[Transition; 2]>,
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
        let chain = campaign.arm.as_ref().map(|arm| {
            (arm.chain.clone(), arm.others.iter().map(|place| (*place, follower)).collect::<Vec<(Place, Follower)>>())
        });
        Ok(Self {
            model: model.clone(),
            frame,
            rate_hz,
            deadband_rad,
            joint: follower,
            torque: follower,
            load: follower,
            chain,
            lowpass: CausalLowPass::new(&lowpass),
            states: None,
            known_in: None,
            forgotten: forgotten(rate_hz, signal.lowpass_hz),
        })
    }

    /// How late the torque is, s.
    pub fn delay_s(&self) -> f64 {
        (self.torque.delay() + self.lowpass.delay()) / self.rate_hz
    }

    /// A filter as late as the torque's own, for a reference to compare with.
    pub fn like_the_torque(&self) -> ReferenceFilter {
        ReferenceFilter { follower: self.torque.fresh(), lowpass: self.lowpass.fresh() }
    }

    /// The next sample: position (rad), y (N m), measured load at the joint (N m), and the other joints' recorded positions.
    pub fn step(&mut self, position_rad: f64, torque_nm: f64, load_nm: f64, others: &[f64]) -> Step {
        let own = motion(self.joint.step(position_rad));
        let [measured_nm, ..] = self.torque.step(torque_nm);
        let [load_nm, ..] = self.load.step(load_nm);
        let rigid_nm = match &mut self.chain {
            Some((chain, followers)) => {
                let moved = followers.iter_mut().map(|(place, follower)| match place {
                    Place::Held(position) => Motion { position: *position, ..Motion::default() },
                    Place::Column(at) => motion(follower.step(others.get(*at).copied().unwrap_or(0.0))),
                });
                chain.torque(own, &moved.collect::<Vec<Motion>>()).total_nm()
            }
            None => {
                let dynamics = &self.model.dynamics;
                dynamics.gravity_nm(self.model.joint.kind, own.position) + dynamics.inertia_kg_m2 * own.acceleration
            }
        };
        let state = self.advance(own.position);
        let k_tilde = match self.model.combination {
            Combination::Sign => f64::from(u8::from(own.velocity >= 0.0)),
            _ => state.k_tilde,
        };
        let predicted_nm = self.model.torque_nm(rigid_nm + load_nm, own.velocity, k_tilde).torque_nm;
        let factor = self.frame.factor(&self.model, k_tilde);
        Step {
            torque_nm: factor * self.lowpass.step(measured_nm - predicted_nm),
            weak: !state.is_stable(),
            known: self.known_in == Some(0),
            change_nm: factor * change_nm(&self.model, own.velocity),
        }
    }

    fn advance(&mut self, position_rad: f64) -> Transition {
        let states = self.states.get_or_insert_with(|| {
            [Direction::Up, Direction::Down].map(|direction| Transition::after(direction, position_rad))
        });
        let backlash_rad = self.model.joint.backlash_rad();
        for state in states.iter_mut() {
            state.step(position_rad, &self.model.combination, backlash_rad, self.deadband_rad);
        }
        let [from_up, from_down] = *states;
        self.known_in = match self.known_in {
            None if from_up.k_f == from_down.k_f => Some(self.forgotten),
            waiting => waiting.map(|samples| samples.saturating_sub(1)),
        };
        // The one that the motion goes towards is the one whose K_f the other will meet.
        if from_up.direction() == Direction::Up { from_up } else { from_down }
    }
}

/// Filters a reference as late as the torque.
#[derive(Debug, Clone)]
pub struct ReferenceFilter {
    follower: Follower,
    lowpass: CausalLowPass,
}

impl ReferenceFilter {
    /// The next sample, filtered.
    pub fn step(&mut self, reference_nm: f64) -> f64 {
        let [late_nm, ..] = self.follower.step(reference_nm);
        self.lowpass.step(late_nm)
    }
}

fn motion([position, velocity, acceleration]: [f64; 3]) -> Motion {
    Motion { position, velocity, acceleration }
}
