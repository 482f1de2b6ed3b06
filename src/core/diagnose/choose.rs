//! Which causes explain a gap: one after the other, each compared with all rivals, earlier ones tried again once later ones are in.

use super::base::BaseModel;
use super::candidates::{Cause, FittedCause, Hypothesis, Round};
use super::criteria::{Decision, Requirement, Share, requirements, rivals, seconds, simplest};
use super::fit::Fit;
use super::mask::Mask;
use super::perturbation::{Perturbation, within_confidence};
use super::progress::{Listener, Phase, Progress};
use super::rounds::Rounds;
use super::settle::{Step, place};
use crate::effects::Extent;
use crate::model::Model;
use std::cell::OnceCell;
use std::sync::Arc;

/// Most causes that are looked for.
const CAUSES_MAX: usize = 6;
/// Number of the causes refused last that are reported.
const REFUSED_TOLD: usize = 5;

/// Causes found, and all that was tried in the place of each.
#[derive(Debug)]
pub struct Choice<'d> {
    /// The base model, over the rows that the search counted.
    pub base: BaseModel<'d>,
    /// Its fit within its confidence alone.
    pub rest: Fit<'d>,
    /// The causes, the one that explains most alone first, with what else was tried in their places, best first.
    pub found: Vec<Found<'d>>,
    /// What was tried last, and gained too little.
    pub refused: Vec<FittedCause<'d>>,
    /// The final fit; `rest` if nothing was found.
    pub last: Fit<'d>,
    /// What each cause that was found reaches, and in what the best of those refused fall short.
    pub decisions: Vec<Decision>,
    /// Where causes were given up because the gap is too weak: the share of the resamples that agreed on them.
    pub given_up: Option<f64>,
}

impl Choice<'_> {
    /// The same without its causes, on which the share `agreement` of the resamples agreed.
    pub fn given_up(self, agreement: f64) -> Self {
        let tried = self.found.into_iter().flat_map(|found| found.tried);
        let refused = tried.chain(self.refused).collect();
        Self { found: Vec::new(), last: self.rest.clone(), refused, given_up: Some(agreement), ..self }
    }
}

/// One cause with its rivals.
#[derive(Debug)]
pub struct Found<'d> {
    /// The cause.
    pub cause: Cause,
    /// In which way.
    pub how: &'static str,
    /// How far it is ahead of every other cause, as a share of its gain.
    pub distinctness: f64,
    /// What it reaches of what is asked of it, the share of the gap first.
    pub met: Vec<Requirement>,
    /// Score without it, the others in, (N m)^2.
    pub without: f64,
    /// Everything tried in its place, best first.
    pub tried: Vec<FittedCause<'d>>,
    /// Causes that do as well with no more numbers.
    pub rivals: Vec<Cause>,
    /// Causes that it is known to be mistaken for, and that do as well with more numbers.
    pub seconds: Vec<Cause>,
}

/// Searches for the causes of the residual of `model`.
pub fn choose<'d>(mask: &Arc<Mask<'d>>, model: &Model, listener: Listener<'_>) -> Choice<'d> {
    let first = BaseModel::new(mask, model, within_confidence(model));
    let rest = first.alone();
    let start = rest.score();
    let search =
        Search { first, rest: rest.clone(), again: OnceCell::new(), start, rounds: Rounds::default(), listener };
    let Forward { chosen, fit, opening, refused } = search.forward(&rest);
    // Causes that were not promising enough alone to be fitted count as explaining nothing alone.
    let scores: Vec<(Cause, f64)> = opening.tried.iter().map(|tried| (tried.cause, tried.score())).collect();
    let alone = |cause: Cause| scores.iter().filter(|(of, _)| *of == cause).fold(start, |least, (_, x)| least.min(*x));
    let (steps, last) = match &chosen[..] {
        [] => (Vec::new(), fit),
        [one] => (vec![place(search.own(one, &search.first), opening.tried, rest.clone())], fit),
        _ => search.settle(chosen),
    };
    let count = steps.len();
    let of_step = |step: Step<'d>| Found {
        cause: step.taken.cause,
        how: step.taken.how,
        rivals: rivals(&step.taken, &step.tried, start),
        seconds: seconds(&step.taken, &step.tried, start),
        distinctness: step.distinctness,
        met: search.requirements(&last, &step.without, if count < 2 { Share::First } else { step.share() }),
        without: step.without.score(),
        tried: step.tried,
    };
    let mut found: Vec<Found<'d>> = steps.into_iter().map(of_step).collect();
    found.sort_by(|a, b| alone(a.cause).total_cmp(&alone(b.cause)));
    let decisions = search.decisions(&found, &last, &refused);
    Choice { found, base: search.first, rest, refused, last, decisions, given_up: None }
}

/// What the way forward found.
pub(super) struct Forward<'d> {
    chosen: Vec<Hypothesis>,
    /// All of them together.
    pub(super) fit: Fit<'d>,
    /// What was tried first.
    pub(super) opening: Round<'d>,
    /// What was tried last, without success.
    refused: Vec<FittedCause<'d>>,
}

/// What all rounds share.
pub(super) struct Search<'d, 's> {
    pub(super) first: BaseModel<'d>,
    /// The same over the motions as the encoder would have read them once more, of a joint like the model: made when it is first asked for.
    again: OnceCell<Option<BaseModel<'d>>>,
    /// The base alone.
    rest: Fit<'d>,
    /// What it leaves, (N m)^2.
    pub(super) start: f64,
    pub(super) rounds: Rounds<'d>,
    pub(super) listener: Listener<'s>,
}

impl<'d> Search<'d, '_> {
    /// One cause after the other; also two as a pair, because the best single cause may be a compromise between both.
    fn forward(&self, rest: &Fit<'d>) -> Forward<'d> {
        let (floor_nm, policy) = (self.first.mask.floor_nm, &self.first.data().policy);
        let is_above = |share: f64, now: f64| now - floor_nm.powi(2) > (share * floor_nm).powi(2);
        let mut way = Forward { chosen: Vec::new(), fit: rest.clone(), opening: Round::default(), refused: Vec::new() };
        // Even if hardly anything remains at first: the floor is not known so precisely that a weak cause could not show.
        while way.chosen.len() < CAUSES_MAX
            && (way.chosen.is_empty() || is_above(policy.further_floors, way.fit.score()))
        {
            (self.listener)(Progress::Begins(Phase::Cause(way.chosen.len() + 1)));
            let round = self.round(&way.chosen, &way.fit, None, f64::INFINITY);
            let mut next = self.one_more(&way, &round.tried);
            let closes = next.as_ref().is_some_and(|(_, fit)| !is_above(policy.first_floors, fit.score()));
            if let ([one], false) = (&way.chosen[..], closes) {
                (self.listener)(Progress::Begins(Phase::Pairs));
                next = self.or_pair(next, one, &way);
            }
            let Some((chosen, fit)) = next else {
                way.refused = round.tried;
                break;
            };
            (way.chosen, way.fit) = (chosen, fit);
            if way.chosen.len() == 1 {
                way.opening = round;
            }
        }
        way
    }

    /// What was chosen and the best of `tried` beside it, if that is enough to be named.
    fn one_more(&self, way: &Forward<'d>, tried: &[FittedCause<'d>]) -> Option<(Vec<Hypothesis>, Fit<'d>)> {
        let best = simplest(tried, self.start)?;
        // The simplest that does as well may be too little to be named where the best is not.
        let share = |cause: Cause| if way.chosen.is_empty() { Share::First } else { Share::at_best(cause) };
        let enough = |at: &usize| self.is_material(&tried[*at].fit, &way.fit, share(tried[*at].cause));
        let at = [best, 0].into_iter().find(enough)?;
        let chosen: Vec<Hypothesis> = way.chosen.iter().cloned().chain(tried[at].hypothesis()).collect();
        Some(self.together(&chosen))
    }

    /// `chosen` fitted together, and as they stand there. The base's columns depend on the causes (with a transition its friction no longer
    /// jumps): they are taken with all of them in.
    pub(super) fn together(&self, chosen: &[Hypothesis]) -> (Vec<Hypothesis>, Fit<'d>) {
        self.together_to_reach(f64::INFINITY, chosen)
    }

    /// The same, given up once it is clear that its cost will not fall to `reach`.
    pub(super) fn together_to_reach(&self, reach: f64, chosen: &[Hypothesis]) -> (Vec<Hypothesis>, Fit<'d>) {
        let mut model = self.first.model.clone();
        let moves: Vec<Perturbation> =
            chosen.iter().flat_map(|hypothesis| hypothesis.put(&mut model, self.extent())).collect();
        let fit = match moves.is_empty() {
            true => self.rest.clone(),
            false => {
                BaseModel::new(&self.first.mask, &model, self.first.moves.clone()).fit_to_reach(reach, model, moves)
            }
        };
        let stands = |hypothesis: &Hypothesis| {
            let own: Vec<Perturbation> = hypothesis.moves().to_vec();
            Hypothesis::of((hypothesis.cause, hypothesis.how), &fit.model, &own)
        };
        (chosen.iter().filter_map(stands).collect(), fit)
    }

    /// The base that a fit makes for further causes: its own free within their strides.
    pub(super) fn base_of(&self, fit: &Fit<'d>) -> BaseModel<'d> {
        if fit.moves.is_empty() {
            return self.first.clone();
        }
        self.base_with(&fit.model, &fit.moves)
    }

    /// The base that `others` make as they stand, free within their strides.
    pub(super) fn base_beside(&self, others: &[Hypothesis]) -> BaseModel<'d> {
        let mut model = self.first.model.clone();
        let moves: Vec<Perturbation> =
            others.iter().flat_map(|hypothesis| hypothesis.put(&mut model, self.extent())).collect();
        self.base_with(&model, &moves)
    }

    fn base_with(&self, model: &Model, moves: &[Perturbation]) -> BaseModel<'d> {
        let free = moves.iter().map(|way| way.clone().believed_within(way.stride));
        BaseModel::new(&self.first.mask, model, self.first.moves.iter().cloned().chain(free).collect())
    }

    /// What each cause that was found reaches, and in what the best of those refused fall short.
    fn decisions(&self, found: &[Found<'d>], last: &Fit<'d>, refused: &[FittedCause<'d>]) -> Vec<Decision> {
        let limit = self.first.data().policy.distinct_share;
        let named = found.iter().flat_map(|Found { cause, distinctness, met, .. }| {
            let outcome = if *distinctness >= limit { "distinct" } else { "others explain nearly as much" };
            let subject = cause.name();
            let beside = Decision { rule: "distinct", subject, value: *distinctness, limit, outcome };
            met.iter().map(move |met| met.decision(subject, "named")).chain([beside])
        });
        let in_vain = refused.iter().take(REFUSED_TOLD).flat_map(|tried| {
            let share = if found.is_empty() { Share::First } else { Share::at_best(tried.cause) };
            let all = self.requirements(&tried.fit, last, share);
            all.into_iter().filter(|r| !r.is_met()).map(|short| short.decision(tried.cause.name(), "refused"))
        });
        named.chain(in_vain).collect()
    }

    pub(super) fn extent(&self) -> &Extent {
        &self.first.data().extent
    }

    pub(super) fn is_material(&self, with: &Fit<'d>, without: &Fit<'d>, share: Share) -> bool {
        self.requirements(with, without, share).iter().all(Requirement::is_met)
    }

    fn requirements(&self, with: &Fit<'d>, without: &Fit<'d>, share: Share) -> Vec<Requirement> {
        let of_encoder = || {
            let again = self.again.get_or_init(|| {
                let base = &self.first;
                base.mask.again().map(|mask| BaseModel::new(&mask, &base.model, base.moves.clone()))
            });
            let left = |base: &BaseModel<'_>, fit: &Fit<'_>| base.square_left(&fit.model, &fit.moves);
            let gain = |base: &BaseModel<'d>| {
                let gain = left(base, without) - left(base, with);
                // A simulation that leaves more than the recordings do has too much of it.
                gain * (without.held_out_square() / left(base, &self.rest).max(f64::MIN_POSITIVE)).min(1.0)
            };
            again.as_ref().map_or(0.0, gain)
        };
        requirements(with, without, self.start, share, of_encoder)
    }
}
