//! The experiment that would say more: a motion along which rivals differ most, or one that shows what the recordings hide.

mod blind;
mod motions;
mod predictor;
mod words;

pub use blind::BlindSpot;

use super::answer::Kind;
use super::base::BaseModel;
use super::candidates::Cause;
use super::choose::Found;
use super::measures::Measures;
use super::verdict::Verdict;
use crate::log::Campaign;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::mean;
use crate::trajectory::Trajectory;
use motions::{Beyond, Motion, Reach};
use predictor::{Predictor, Rival};
use rayon::prelude::*;

/// Fewest and most repeats that are asked for: a floor needs some, a person has no time for more.
const REPEATS_MIN: u32 = 3;
const REPEATS_MAX: u32 = 20;
/// Rivals that differ by less than this share of the floor along the best motion ...
const APART_FLOORS: f64 = 0.3;
/// ... or by less than this share of the gap, are not told apart by motion: the verdict would tie again.
const APART_GAPS: f64 = 0.04;
/// A decision is clear if it exceeds its own error by this factor.
const CLEAR_ERRORS: f64 = 3.0;
/// A motion beyond the recorded range must separate the causes by this factor more to be proposed.
const WORTH_BEYOND: f64 = 1.5;

/// What to record next.
#[derive(Debug, Clone, PartialEq)]
pub struct NextExperiment {
    /// Why, in a sentence.
    pub reason: String,
    /// The motion, with its repeats; nothing where no motion helps.
    pub trajectory: Option<Trajectory>,
    /// The causes that it tells apart, or shows.
    pub separates: Vec<&'static str>,
    /// How far the two that are closest lie apart along it, root mean square, N m.
    pub difference_nm: Option<f64>,
    /// The same in noise floors.
    pub difference_over_floor: Option<f64>,
    /// What to do.
    pub instruction: String,
}

/// The design of the next experiment: what it is drawn from.
pub struct Design<'s> {
    pub campaign: &'s Campaign,
    /// The base within its confidence, on which the rivals were fitted.
    pub base: &'s BaseModel<'s>,
    pub found: &'s [Found<'s>],
    pub verdict: &'s Verdict,
    pub floor_nm: f64,
}

impl Design<'_> {
    /// The next experiment, if one would say more, and what the recordings hide.
    pub fn propose(&self) -> (Option<NextExperiment>, Vec<BlindSpot>) {
        let reach = Reach::of(&self.base.data().extent, blind::others_rad(self.base.data()));
        let motions = reach.map_or_else(Vec::new, |reach| reach.motions(self.base.data().extent.turns));
        let spots = blind::blind_spots(self.base, &motions);
        let next = match (self.verdict.kind, self.found) {
            (Kind::Ambiguous, [found]) => {
                let rivals = self.rivals(found, &found.rivals);
                Some(self.between(&rivals, &motions).unwrap_or_else(|| by_hand(&rivals)))
            }
            (Kind::Effect | Kind::Stale, [found]) if !found.seconds.is_empty() => {
                self.between(&self.rivals(found, &found.seconds), &motions).map(|next| simplest(found.cause, next))
            }
            (Kind::None | Kind::Unknown, _) => advice(&spots),
            _ => None,
        };
        (next, spots)
    }

    /// The cause that was taken and `others` that do as well, each in its best way.
    fn rivals(&self, found: &Found<'_>, others: &[Cause]) -> Vec<Rival> {
        let is_taken = |cause: Cause, how: &str| cause == found.cause && how == found.how;
        let taken = found.tried.iter().find(|t| is_taken(t.cause, t.how));
        let others = others.iter().filter_map(|rival| found.tried.iter().find(|t| t.cause == *rival));
        taken.into_iter().chain(others).map(|tried| Rival::new(tried, self.base)).collect()
    }

    /// The motion that tells `rivals` apart, if one does.
    fn between(&self, rivals: &[Rival], motions: &[Motion]) -> Option<NextExperiment> {
        let names: Vec<&'static str> = rivals.iter().map(|rival| rival.name).collect();
        let pairs: Vec<(usize, usize)> =
            (0..rivals.len()).flat_map(|a| (a + 1..rivals.len()).map(move |b| (a, b))).collect();
        let apart = self.apart_nm(rivals, &pairs, motions);
        let limit_nm = (APART_FLOORS * self.floor_nm).max(APART_GAPS * self.verdict.gap_before_nm);
        let best = |pair: usize| apart.iter().map(|of| of[pair]).fold(0.0, f64::max);
        let (open, tied): (Vec<usize>, Vec<usize>) = (0..pairs.len()).partition(|pair| best(*pair) > limit_nm);
        let of = |chosen: &[usize]| -> Vec<&'static str> {
            let is_in = |i: usize| chosen.iter().any(|pair| pairs[*pair].0 == i || pairs[*pair].1 == i);
            (0..names.len()).filter(|i| is_in(*i)).map(|i| names[i]).collect()
        };
        let closest = |at: usize| open.iter().map(|pair| apart[at][*pair]).fold(f64::INFINITY, f64::min);
        let worth = |at: usize| match motions[at].beyond {
            Beyond::Nothing => closest(at),
            Beyond::Speed | Beyond::Range => closest(at) / WORTH_BEYOND,
        };
        let chosen = (0..motions.len()).filter(|_| !open.is_empty()).max_by(|a, b| worth(*a).total_cmp(&worth(*b)));
        let chosen = chosen?;
        Some(self.proposal(&motions[chosen], closest(chosen), &of(&open), &of(&tied)))
    }

    /// How far apart each pair is along each motion, N m.
    fn apart_nm(&self, rivals: &[Rival], pairs: &[(usize, usize)], motions: &[Motion]) -> Vec<Vec<f64>> {
        let Some(predictor) = self.predictor() else { return vec![vec![0.0; pairs.len()]; motions.len()] };
        let along = |motion: &Motion| {
            let predicted: Vec<_> = rivals.iter().map(|rival| predictor.predicted(rival, &motion.trajectory)).collect();
            pairs.iter().map(|(a, b)| predictor.apart_nm(&predicted[*a], &predicted[*b])).collect()
        };
        motions.par_iter().with_max_len(1).map(along).collect()
    }

    fn predictor(&self) -> Option<Predictor<'_>> {
        let signal = &self.campaign.signal;
        let records = &self.base.data().records;
        let rate_hz = records.all.first()?.rate_hz;
        let model = &self.base.model;
        let gravity = |own: f64| model.dynamics.gravity_nm(model.joint.kind, own);
        let loads = records.rows(|record, i| {
            let inertia = model.dynamics.inertia_kg_m2 * record.own[i].acceleration;
            record.load_nm(i, model) - gravity(record.own[i].position) - inertia
        });
        let chain = self.campaign.arm.as_ref().map(|arm| &arm.chain);
        Some(Predictor {
            chain,
            rate_hz,
            lowpass: LowPass::new(signal.lowpass_order, signal.lowpass_hz, rate_hz)?,
            lowpass_hz: signal.lowpass_hz,
            floor_nm: self.floor_nm,
            // A chain's share cannot be told from a measured load's here; the predictor has the chain itself.
            load_nm: if chain.is_some() { 0.0 } else { mean(&loads) },
        })
    }

    fn proposal(&self, motion: &Motion, apart_nm: f64, open: &[&'static str], tied: &[&'static str]) -> NextExperiment {
        let floors = apart_nm / self.floor_nm;
        let independent = 2.0 * self.campaign.signal.lowpass_hz * motion.trajectory.own.duration_s();
        // The squares left by two rivals d apart differ by N d^2 with an error of 2 d floor sqrt(N).
        let needed = (2.0 * CLEAR_ERRORS / floors).powi(2) / independent.max(1.0);
        let repeats = (needed.ceil().min(f64::from(REPEATS_MAX)) as u32).max(REPEATS_MIN);
        let (unit, _) = Measures::of(&self.base.model.joint).torque;
        let mut reason = format!(
            "{} explain these recordings about equally well; along {} their predictions still differ by {:.1} m{unit} RMS, {floors:.1} times the noise",
            words::listed(open),
            motion.means,
            1e3 * apart_nm
        );
        let mut instruction = words::record(motion, repeats, &self.base.data().extent);
        if !tied.is_empty() {
            reason.push_str(&format!("; no motion distinguishes {}", words::listed(tied)));
            instruction = format!("{instruction}. {}", words::checks(tied));
        }
        NextExperiment {
            reason,
            trajectory: Some(Trajectory { repeats: Some(repeats), ..motion.trajectory.clone() }),
            separates: open.to_vec(),
            difference_nm: Some(apart_nm),
            difference_over_floor: floors.is_finite().then_some(floors),
            instruction,
        }
    }
}

/// What to do about rivals that no motion tells apart.
fn by_hand(rivals: &[Rival]) -> NextExperiment {
    let names: Vec<&'static str> = rivals.iter().map(|rival| rival.name).collect();
    NextExperiment {
        reason: format!(
            "{} explain these recordings about equally well, and no motion of this joint distinguishes them",
            words::listed(&names)
        ),
        trajectory: None,
        difference_nm: None,
        difference_over_floor: None,
        instruction: words::checks(&names),
        separates: names,
    }
}

/// The same where the verdict rests on `taken` being the simpler alone.
fn simplest(taken: Cause, next: NextExperiment) -> NextExperiment {
    let reason = format!("{}. {} is named as the simplest; this would settle it", next.reason, taken.name());
    NextExperiment { reason, ..next }
}

/// A motion that shows what the recordings hide, where nothing else is open.
fn advice(spots: &[BlindSpot]) -> Option<NextExperiment> {
    let spot = spots.iter().find(|spot| spot.trajectory.is_some())?;
    Some(NextExperiment {
        reason: format!("The recordings cannot show everything: {}", spot.what),
        trajectory: spot.trajectory.clone(),
        separates: spot.hides.clone(),
        difference_nm: None,
        difference_over_floor: None,
        instruction: spot.advice.clone(),
    })
}
