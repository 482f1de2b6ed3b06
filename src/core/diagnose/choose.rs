//! Which causes explain a gap: one after the other, each compared with all rivals, earlier ones tried again once later ones are in.

use super::base::BaseModel;
use super::candidates::{Cause, FittedCause, Hypothesis, Round, Set};
use super::compare::is_tie;
use super::criteria::{Decision, Requirement, Share, rivals, seconds, simplest, simplest_set};
use super::fit::Fit;
use super::mask::Mask;
use super::perturbation::within_confidence;
use super::policy::Policy;
use super::progress::{Listener, Phase, Progress};
use super::runners_up::RunnerUp;
use super::search::{Forward, Search};
use super::settle::{Step, place};
use crate::model::Model;
use std::sync::Arc;

/// Most causes that are looked for.
pub const CAUSES_MAX: usize = 6;
/// Most causes beside which others, as many, are followed in a wider search.
const RUNNERS_UP_TO: usize = 2;
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

impl Found<'_> {
    /// Whether no other cause explains nearly as much in its place.
    pub fn is_distinct(&self, policy: &Policy) -> bool {
        self.distinctness >= policy.distinct_share
    }
}

/// Searches for the causes of the residual of `model`.
pub fn choose<'d>(mask: &Arc<Mask<'d>>, model: &Model, listener: Listener<'_>) -> Choice<'d> {
    let first = BaseModel::new(mask, model, within_confidence(model));
    let rest = first.alone();
    let search = Search::new(first, rest.clone(), listener);
    let start = search.start;
    let plain = search.outcome();
    let (search, Outcome { opening, steps, last, refused }) = search.or_wider(plain);
    // Causes that were not promising enough alone to be fitted count as explaining nothing alone.
    let scores: Vec<(Cause, f64)> = opening.iter().map(|tried| (tried.cause, tried.score())).collect();
    let alone = |cause: Cause| scores.iter().filter(|(of, _)| *of == cause).fold(start, |least, (_, x)| least.min(*x));
    let count = steps.len();
    let of_step = |step: Step<'d>| Found {
        cause: step.taken.cause,
        how: step.taken.how,
        rivals: rivals(&step.taken, &step.tried, (start, step.without.score())),
        seconds: seconds(&step.taken, &step.tried, (start, step.without.score())),
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

/// What a search comes to.
struct Outcome<'d> {
    /// What was tried first, alone.
    opening: Vec<FittedCause<'d>>,
    /// The causes.
    steps: Vec<Step<'d>>,
    /// Their fit.
    last: Fit<'d>,
    /// What was tried last, without success.
    refused: Vec<FittedCause<'d>>,
}

impl<'d> Search<'d, '_> {
    /// Causes found one after the other, then each tried again beside the others.
    fn outcome(&self) -> Outcome<'d> {
        let Forward { chosen, fit, opening, refused, .. } = self.forward();
        let (steps, last) = match &chosen[..] {
            [] => (Vec::new(), fit),
            [one] => {
                let own = self.own(one, &self.first);
                (vec![place(own, opening.tried.clone(), self.rest.clone())], fit)
            }
            _ => self.settle(chosen),
        };
        Outcome { opening: opening.tried, steps, last, refused }
    }

    /// What the search comes to where other causes than the best are followed too, if `plain` leaves a gap and the wider search leaves less
    /// than it, by fewer causes, by no more numbers or by more than a tie; else `plain`.
    fn or_wider(self, plain: Outcome<'d>) -> (Self, Outcome<'d>) {
        let is_open = !plain.steps.is_empty() && self.is_open(self.first.data().policy.further_floors, &plain.last);
        if !is_open {
            return (self, plain);
        }
        let search = self.widened();
        let wide = search.outcome();
        let is_tie = is_tie(&wide.last, &plain.last, search.start);
        let is_simple = wide.steps.len() < plain.steps.len() || wide.last.moves.len() <= plain.last.moves.len();
        let is_ahead = wide.last.score() < plain.last.score() && (is_simple || !is_tie);
        let outcome = if is_ahead { wide } else { plain };
        (search, outcome)
    }

    /// Whether what `fit` leaves above the floor is more than `share` of it.
    fn is_open(&self, share: f64, fit: &Fit<'d>) -> bool {
        let floor_nm = self.first.mask.floor_nm;
        fit.score() - floor_nm.powi(2) > (share * floor_nm).powi(2)
    }

    /// One cause after the other; also two as a pair, because the best single cause may be a compromise between both.
    fn forward(&self) -> Forward<'d> {
        let (floor_nm, policy) = (self.first.mask.floor_nm, &self.first.data().policy);
        let mut way = Forward {
            chosen: Vec::new(),
            fit: self.rest.clone(),
            opening: Round::default(),
            refused: Vec::new(),
            runners_up: Vec::new(),
        };
        // Even if hardly anything remains at first: the floor is not known so precisely that a weak cause could not show.
        while way.chosen.len() < CAUSES_MAX
            && (way.chosen.is_empty() || way.fit.score() > (policy.further_floors * floor_nm).powi(2))
        {
            (self.listener)(Progress::Begins(Phase::Cause(way.chosen.len() + 1)));
            let round = self.round(&way.chosen, &way.fit, None, f64::INFINITY);
            let mut next = self.one_more(&way, &round.tried);
            let mut runners_up = RunnerUp::of_round(&way.chosen, &round.tried);
            let closes = next.as_ref().is_some_and(|(_, fit)| !self.is_open(policy.first_floors, fit));
            let most = if self.is_wide() { RUNNERS_UP_TO } else { 1 };
            let is_open = !closes && self.is_open(policy.further_floors, &way.fit);
            if is_open && (1..=most).contains(&way.chosen.len()) {
                let mut sets: Vec<Set<'d>> = next.into_iter().collect();
                if way.chosen.len() == 1 {
                    (self.listener)(Progress::Begins(Phase::Pairs));
                    let reached = sets.first().map_or(f64::INFINITY, |(_, fit)| fit.score());
                    sets.splice(..0, self.pairs(&way, reached));
                }
                if self.is_wide() {
                    let (others, beside) = self.extended(&way);
                    sets.extend(others);
                    runners_up.extend(beside);
                }
                next = simplest_set(sets, &way.chosen, self.start);
            }
            let Some((chosen, fit)) = next else {
                way.refused = round.tried;
                break;
            };
            way.runners_up = RunnerUp::best_of(runners_up, &chosen);
            (way.chosen, way.fit) = (chosen, fit);
            if way.chosen.len() == 1 {
                let alone = |tried: &FittedCause<'d>| (tried.hypothesis().into_iter().collect(), tried.fit.clone());
                round.tried.iter().map(alone).for_each(|set| self.note(&set));
                way.opening = round;
            }
        }
        way
    }

    /// What was chosen and the best of `tried` beside it, if that is enough to be named.
    fn one_more(&self, way: &Forward<'d>, tried: &[FittedCause<'d>]) -> Option<Set<'d>> {
        let best = simplest(tried, self.start)?;
        // The simplest that does as well may be too little to be named where the best is not.
        let share = |cause: Cause| if way.chosen.is_empty() { Share::First } else { Share::at_best(cause) };
        let enough = |at: &usize| self.is_material(&tried[*at].fit, &way.fit, share(tried[*at].cause));
        let at = [best, 0].into_iter().find(enough)?;
        let chosen: Vec<Hypothesis> = way.chosen.iter().cloned().chain(tried[at].hypothesis()).collect();
        Some(self.together(&chosen))
    }

    /// What each cause that was found reaches, and in what the best of those refused fall short.
    fn decisions(&self, found: &[Found<'d>], last: &Fit<'d>, refused: &[FittedCause<'d>]) -> Vec<Decision> {
        let policy = &self.first.data().policy;
        let named = found.iter().flat_map(|found| {
            let outcome = if found.is_distinct(policy) { "distinct" } else { "others explain nearly as much" };
            let (subject, value, limit) = (found.cause.name(), found.distinctness, policy.distinct_share);
            let beside = Decision { rule: "distinct", subject, value, limit, outcome };
            found.met.iter().map(move |met| met.decision(subject, "named")).chain([beside])
        });
        let in_vain = refused.iter().take(REFUSED_TOLD).flat_map(|tried| {
            let share = if found.is_empty() { Share::First } else { Share::at_best(tried.cause) };
            let all = self.requirements(&tried.fit, last, share);
            all.into_iter().filter(|r| !r.is_met()).map(|short| short.decision(tried.cause.name(), "refused"))
        });
        named.chain(in_vain).collect()
    }
}
