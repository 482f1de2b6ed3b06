//! A trial thinned to the bandwidth of its low-pass, and any model's prediction of it.

use super::bins::Bins;
use super::on_chain::OnChain;
use super::spectrum::{SpectralFloor, spectral};
use crate::dynamics::{Both, Motion};
use crate::effects::{Added, Carried, Evaluated, Family, Sample};
use crate::log::{Campaign, Log};
use crate::model::{Asked, Model, Strokes, combined, settle};
use crate::numerics::dual::{Dual, VARIABLES};
use crate::numerics::fill::fill;
use crate::numerics::filter::LowPass;
use crate::numerics::scalar::Scalar;
use crate::predict::{forgotten, torque_nm};
use crate::prepare::{REST_RAD, REST_S, Trial, before_turns, prepare, rests};
use crate::problem::{Problem, Result};
use std::ops::Range;

/// Samples kept per period of the low-pass: the filter redesigned for the thinned rate then differs from the declared one by
/// less than 1 % up to 1.2 times its cut-off.
pub(super) const SAMPLES_PER_PERIOD: f64 = 10.0;
/// Rows compared per period of the low-pass, beyond which hardly anything passes.
const ROWS_PER_PERIOD: f64 = 4.0;
/// Samples that effects are asked about at once.
const BLOCK: usize = 16;

/// One trial thinned.
#[derive(Debug)]
pub struct Record {
    /// Its log's name.
    pub file: String,
    /// What it repeats: trials of one protocol, speed and trajectory share it.
    pub repeats: Option<String>,
    /// Thinned rate, Hz.
    pub rate_hz: f64,
    /// The joint at each thinned sample.
    pub own: Vec<Motion>,
    /// Since the trial began, s.
    pub time_s: Vec<f64>,
    /// y after the low-pass, N m.
    pub torque_nm: Vec<f64>,
    /// Which thinned samples are compared, in order.
    pub rows: Vec<usize>,
    /// Whether what the low-pass leaves there of friction that jumps comes from a rest before a turn, where nobody knows it.
    pub before_turn: Vec<bool>,
    /// Whether the joint rests there.
    pub rests: Vec<bool>,
    /// Torque noise beyond the low-pass, as it would show within it.
    pub spectral_floor: SpectralFloor,
    /// Whether the sensor clips at each thinned sample or beside it.
    pub clipped: Vec<bool>,
    /// The readings at which it clips, N m.
    pub clip_levels_nm: Option<(f64, f64)>,
    /// Problems that do not stop us.
    pub warnings: Vec<String>,
    /// When it began, s since the campaign did.
    pub began_s: f64,
    /// How many other joints are recorded.
    pub joints: usize,
    /// Motion of the other joints: of all at the first sample, then of all at the next.
    others: Vec<Motion>,
    load_nm: Vec<f64>,
    /// Gravity at each thinned sample as a share of the largest, and its slope, 1/rad: the position stays what it is, whatever
    /// the model.
    gravity_shares: Vec<(f64, f64)>,
    /// What a chain's mass asks of the joint.
    pub chain: Option<OnChain>,
    step: usize,
    /// The motion at the log's full rate.
    strokes: Strokes,
    /// Travel back below which nothing counts as a reversal, rad.
    pub deadband_rad: f64,
    /// The campaign's low-pass at the thinned rate.
    pub lowpass: LowPass,
}

impl Record {
    /// `trial` thinned. K_f is known from where `model` and any wider clearance would know it.
    ///
    /// Errors: sampled too slowly for the campaign's low-pass.
    pub fn new(campaign: &Campaign, model: &Model, trial: &Trial) -> Result<Self> {
        let floor = spectral(trial, &torque_nm(model, trial).0, &campaign.signal);
        Self::above(campaign, model, trial, floor)
    }

    /// `trial`, which this one is, with another motion at the same rows; nothing where that motion cannot be prepared as the trial was.
    pub fn moved(&self, campaign: &Campaign, model: &Model, trial: &Trial, position_rad: Vec<f64>) -> Option<Self> {
        let log = Log { position_rad, ..trial.log.clone() };
        let trial = prepare(campaign, trial.index, log).ok()?;
        let moved = Self::above(campaign, model, &trial, self.spectral_floor).ok()?;
        Some(Self { rows: self.rows.clone(), ..moved })
    }

    /// `trial` thinned, its torque's noise known.
    fn above(campaign: &Campaign, model: &Model, trial: &Trial, spectral_floor: SpectralFloor) -> Result<Self> {
        let (lowpass_hz, rate_hz) = (campaign.signal.lowpass_hz, trial.log.rate_hz);
        let step = ((rate_hz / (SAMPLES_PER_PERIOD * lowpass_hz)) as usize).max(1);
        let thinned_hz = rate_hz / step as f64;
        let order = campaign.signal.lowpass_order;
        let [thinned, whole] = [thinned_hz, rate_hz].map(|rate_hz| LowPass::new(order, lowpass_hz, rate_hz));
        let Some((lowpass, whole)) = thinned.zip(whole) else {
            let what = format!("sampled at {rate_hz:.4} Hz, too slow for a low-pass at {lowpass_hz} Hz");
            return Problem::error(&trial.log.file, what, "lower lowpass_hz in campaign.toml").alone();
        };
        let n = trial.torque_nm.len();
        let at: Vec<usize> = (0..n).step_by(step).collect();
        let backlash_rad = model.backlash_m() / model.joint.pulley_radius_m;
        let (_, known_from) = settle(trial.followed_rad(), backlash_rad, trial.deadband_rad);
        let memory = forgotten(rate_hz, lowpass_hz);
        let first = (known_from + memory).div_ceil(step);
        let rests = rests(trial.followed_rad(), rate_hz, trial.deadband_rad);
        let turns = trial.turns();
        let before_turn = before_turns(&turns, n, &whole);
        // Acceleration is not known at a log's end, where position has nothing after it, unless the joint rests there.
        let ends_at_rest = rests[n.saturating_sub((2.0 * REST_S * rate_hz) as usize)..].iter().all(|rests| *rests);
        let last = if ends_at_rest { at.len() } else { at.len().saturating_sub(memory.div_ceil(step)) };
        let compared = ((thinned_hz / (ROWS_PER_PERIOD * lowpass_hz)) as usize).max(1);
        // The readings of a stuck sensor say nothing about the joint; those of a clipped one show its range.
        let clear = trial.clear_of(&trial.log.stuck(), lowpass_hz);
        let rows = (first..last).step_by(compared).filter(|row| clear[at[*row]]).collect();
        let entry = &trial.entry;
        let named = entry.trajectory.is_some() || entry.protocol != crate::log::Protocol::Free;
        let in_range = trial.clear_of(&trial.log.clipped, lowpass_hz);
        let levels = |range: &Range<usize>| trial.log.torque_nm[range.start];
        let clips: Vec<f64> = trial.log.clipped.iter().map(levels).collect();
        Ok(Self {
            file: entry.file.clone(),
            repeats: named.then(|| format!("{:?} {:?}", entry.protocol, entry.trajectory)),
            rate_hz: thinned_hz,
            own: at.iter().map(|i| trial.motion(*i)).collect(),
            time_s: at.iter().map(|i| trial.log.time_s[*i] - trial.log.time_s[0]).collect(),
            torque_nm: at.iter().map(|i| trial.torque_nm[*i]).collect(),
            before_turn: at.iter().map(|i| before_turn[*i]).collect(),
            rests: at.iter().map(|i| rests[*i]).collect(),
            clipped: at.iter().map(|i| !in_range[*i]).collect(),
            clip_levels_nm: (!clips.is_empty()).then(|| crate::numerics::statistics::extent(&clips)),
            rows,
            spectral_floor,
            warnings: trial.log.warnings.iter().map(ToString::to_string).collect(),
            began_s: 0.0,
            joints: trial.others.len(),
            others: at.iter().flat_map(|i| trial.others.iter().map(|other| other[*i])).collect(),
            load_nm: at.iter().map(|i| trial.load_nm(*i)).collect(),
            gravity_shares: at.iter().map(|i| model.joint.kind.gravity_share(trial.position_rad[*i])).collect(),
            chain: OnChain::of(campaign, model, trial, &at),
            step,
            strokes: Strokes::new(trial.followed_rad(), trial.directions(&turns), trial.deadband_rad),
            deadband_rad: trial.deadband_rad,
            lowpass,
        })
    }

    /// Since the campaign began, s.
    pub fn elapsed_s(&self, i: usize) -> f64 {
        self.began_s + self.time_s[i]
    }

    /// Another joint's motion.
    pub fn other(&self, joint: usize, i: usize) -> Motion {
        self.others_at(i).get(joint).copied().unwrap_or_default()
    }

    /// The other joints' motion.
    fn others_at(&self, i: usize) -> &[Motion] {
        &self.others[i * self.joints..][..self.joints]
    }

    /// Gravity, inertia and measured load at the joint under `model`, N m.
    pub fn load_nm(&self, i: usize, model: &Model) -> f64 {
        self.asked(i, model).torque_nm
    }

    /// What the sample asks of the joint.
    pub fn asked<S: Scalar>(&self, i: usize, model: &Model<S>) -> Asked<S> {
        let dynamics = &model.dynamics;
        let (gravity_nm, slope_nm_rad, beside_nm) = match &self.chain {
            Some(chain) => chain.asked(i, &dynamics.payload),
            None => {
                let (share, slope) = self.gravity_shares[i];
                let inertia_nm = dynamics.inertia_kg_m2 * self.own[i].acceleration;
                (dynamics.gravity_nm * share, dynamics.gravity_nm * slope, inertia_nm)
            }
        };
        let (gravity_nm, slope_nm_rad) = dynamics.at_true_position(gravity_nm, slope_nm_rad);
        Asked { torque_nm: gravity_nm + beside_nm + self.load_nm[i], slope_nm_rad }
    }

    /// K~ followed at the log's full rate and averaged over what each thinned sample stands for: a reversal between two of
    /// them then comes at its own time.
    pub fn passage<S: Evaluated>(&self, model: &Model<S>) -> Vec<S> {
        // What lies midway between two thinned samples belongs to both: the average would else come half a sample early.
        let bins = |early| Bins::new(self.own.len(), self.step, early, self.strokes.samples());
        let mut halves = vec![bins((self.step - 1) / 2), bins(self.step / 2)];
        halves.truncate(if self.step.is_multiple_of(2) { 2 } else { 1 });
        model.k_tilde_along(&self.strokes, |samples, k_tilde| {
            halves.iter_mut().for_each(|bins| bins.add(samples.clone(), |range| k_tilde.sum(range)));
        });
        let weight = |at: usize| halves.iter().map(|bins| bins.samples(at)).sum::<usize>().max(1) as f64;
        let sum = |at: usize| halves.iter().fold(S::from(0.0), |sum, bins| sum + bins.sums[at]);
        (0..self.own.len()).map(|at| sum(at) / weight(at)).collect()
    }

    /// The unloaded friction of both branches at each thinned sample.
    pub fn branches<S: Evaluated<Given = f64>>(&self, model: &Model<S>) -> Vec<Both<S>> {
        self.own.iter().map(|own| model.branches_nm(own.velocity)).collect()
    }

    /// y at each thinned sample, N m.
    fn torque_nm<S: Evaluated<Given = f64>>(
        &self,
        model: &Model<S>,
        k_tilde: impl Fn(usize) -> S,
        branches: impl Fn(usize) -> Both<S>,
    ) -> Vec<S> {
        let mut torque_nm: Vec<S> = Vec::with_capacity(self.own.len() + BLOCK);
        let none = S::from(0.0);
        let (mut y_nm, mut own_k_tilde) = ([none; BLOCK], [none; BLOCK]);
        let mut asked = [Asked { torque_nm: none, slope_nm_rad: none }; BLOCK];
        let mut own_branches = [Both { up: none, down: none }; BLOCK];
        self.in_blocks(|at, samples| {
            fill(&mut asked, |j| self.asked(at[j], model));
            fill(&mut own_k_tilde, |j| k_tilde(at[j]));
            fill(&mut own_branches, |j| branches(at[j]));
            model.drive_along(samples, &asked, &own_k_tilde, &own_branches, &mut y_nm);
            torque_nm.extend_from_slice(&y_nm);
        });
        torque_nm.truncate(self.own.len());
        if model.effects.iter().any(|added| added.effect.about().family == Family::Fault) {
            torque_nm = model.late_nm(torque_nm, self.rate_hz);
            self.in_blocks(|[first, .., last], samples| model.read_along(samples, &mut torque_nm[*first..=*last]));
        }
        torque_nm
    }

    /// Calls `then` for all thinned samples, a block at a time; where they end before the last block does, that goes on with the last of them.
    fn in_blocks(&self, mut then: impl FnMut(&[usize; BLOCK], &[Sample<'_>; BLOCK])) {
        let last = self.own.len() - 1;
        let mut at = [0; BLOCK];
        let mut samples = [Sample { time_s: 0.0, elapsed_s: 0.0, own: Motion::default(), others: &[] }; BLOCK];
        for from in (0..=last).step_by(BLOCK) {
            fill(&mut at, |j| (from + j).min(last));
            fill(&mut samples, |j| Sample {
                time_s: self.time_s[at[j]],
                elapsed_s: self.elapsed_s(at[j]),
                own: self.own[at[j]],
                others: self.others_at(at[j]),
            });
            then(&at, &samples);
        }
    }

    /// y at the rows, low-passed, N m.
    pub fn predicted_nm(&self, model: &Model, k_tilde: &[f64], branches: &[Both<f64>]) -> Vec<f64> {
        let torque_nm = self.torque_nm(model, |i| k_tilde[i], |i| branches[i]);
        self.at_rows(&self.lowpass.zero_phase(&torque_nm))
    }

    /// How y at the rows, low-passed, changes with each variable of `varied`, N m per unit. Where none of them has a part in K~ or in the
    /// branches, those are given.
    pub fn slopes_nm(
        &self,
        varied: &Model<Dual>,
        k_tilde: Option<&[f64]>,
        branches: Option<&[Both<f64>]>,
    ) -> [Vec<f64>; VARIABLES] {
        let own_k_tilde = if k_tilde.is_none() { self.passage(varied) } else { Vec::new() };
        let own_branches = if branches.is_none() { self.branches(varied) } else { Vec::new() };
        let k_tilde = |i: usize| k_tilde.map_or_else(|| own_k_tilde[i], |k_tilde| Dual::from(k_tilde[i]));
        let over = |branches: Both<f64>| Both { up: Dual::from(branches.up), down: Dual::from(branches.down) };
        let branches = |i: usize| branches.map_or_else(|| own_branches[i], |branches| over(branches[i]));
        self.slopes_at_rows(self.torque_nm(varied, k_tilde, branches).into_iter().map(|y| y.slopes).collect())
    }

    /// `slopes_nm` of each thinned sample, low-passed, at the rows.
    fn slopes_at_rows(&self, mut slopes_nm: Vec<[f64; VARIABLES]>) -> [Vec<f64>; VARIABLES] {
        self.lowpass.zero_phase_together(&mut slopes_nm);
        std::array::from_fn(|at| self.rows.iter().map(|i| slopes_nm[*i][at]).collect())
    }

    /// What each of some strengths of an effect that only adds torque adds to y per unit at the rows, low-passed, N m: the
    /// slopes of `added`.
    pub fn added_nm(
        &self,
        model: &Model,
        added: &Added<Dual>,
        k_tilde: &[f64],
        branches: &[Both<f64>],
    ) -> [Vec<f64>; VARIABLES] {
        let over = model.over::<Dual>();
        let transmission = model.joint.transmission();
        let (hooks, p) = (added.hooks(), &added.parameters[..]);
        let mut slopes_nm = Vec::with_capacity(self.own.len() + BLOCK);
        let none = Dual::from(0.0);
        let neither = Both { up: none, down: none };
        let mut asked_nm = [none; BLOCK];
        let mut carried = [Carried { load_nm: none, friction_nm: neither }; BLOCK];
        self.in_blocks(|at, samples| {
            fill(&mut asked_nm, |j| Dual::from(self.asked(at[j], model).torque_nm));
            fill(&mut carried, |j| {
                let Both { up, down } = branches[at[j]];
                let load_nm = asked_nm[j] * transmission;
                Carried { load_nm, friction_nm: Both { up: Dual::from(up), down: Dual::from(down) } }
            });
            let (mut friction_nm, mut at_joint_nm, mut beside_nm) = ([neither; BLOCK], [none; BLOCK], [none; BLOCK]);
            hooks.add_friction(p, samples, &carried, &mut friction_nm);
            hooks.add_joint_torque(p, samples, &asked_nm, &mut at_joint_nm);
            hooks.read(p, samples, &mut beside_nm);
            fill(&mut asked_nm, |j| {
                let (Carried { load_nm, friction_nm }, k_tilde) = (carried[j], Dual::from(k_tilde[at[j]]));
                over.balance_nm(load_nm, combined(friction_nm, k_tilde), k_tilde)
            });
            hooks.add_winch_torque(p, samples, &asked_nm, &mut beside_nm);
            slopes_nm.extend(at.iter().enumerate().map(|(j, i)| {
                let k_tilde = Dual::from(k_tilde[*i]);
                let friction_nm = combined(friction_nm[j], k_tilde);
                (over.balance_nm(at_joint_nm[j] * transmission, friction_nm, k_tilde) + beside_nm[j]).slopes
            }));
        });
        slopes_nm.truncate(self.own.len());
        self.slopes_at_rows(slopes_nm)
    }

    /// `series` at the rows.
    pub fn at_rows(&self, series: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|i| series[*i]).collect()
    }
}

impl Record {
    /// Travel since the last reversal at each thinned sample, rad; a reversal counts after travel back beyond the encoder's noise.
    pub fn travel_rad(&self) -> Vec<f64> {
        let limit_rad = (4.0 * self.deadband_rad).max(REST_RAD);
        let (mut crest, mut turned, mut rising) = (f64::NAN, f64::NAN, true);
        self.own
            .iter()
            .map(|own| {
                let q = own.position;
                if crest.is_nan() {
                    (crest, turned) = (q, q);
                }
                let ahead = if rising { q - crest } else { crest - q };
                if ahead >= 0.0 {
                    crest = q;
                } else if -ahead > limit_rad {
                    rising = !rising;
                    (turned, crest) = (crest, q);
                }
                (q - turned).abs()
            })
            .collect()
    }
}
