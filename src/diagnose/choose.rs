//! Which causes explain a gap: one after the other, each compared with all rivals, earlier ones tried again once later ones are in.

use super::base::BaseModel;
use super::candidates::{Cause, FittedCause, Hypothesis, Round, try_all, try_one};
use super::criteria::{
    Decision, FLOOR_SHARE, Requirement, is_makeshift, is_tie, requirements, rivals, seconds, simplest,
};
use super::fit::Fit;
use super::mask::Mask;
use super::pairs;
use super::perturbation::{Perturbation, within_confidence};
use crate::effects::Extent;
use crate::model::Model;
use std::cell::OnceCell;
use std::sync::Arc;

/// Most causes that are looked for.
const CAUSES_MAX: usize = 3;
/// Rounds over the causes found in which each is tried again.
const SWEEPS: usize = 2;
/// Of causes that were refused last so many are told.
const REFUSED_TOLD: usize = 5;

/// Causes found, and all that was tried in the place of each.
#[derive(Debug)]
pub struct Choice<'d> {
    /// The base model, over the rows that the search counted.
    pub base: BaseModel<'d>,
    /// Its fit within its confidence alone.
    pub rest: Fit<'d>,
    /// The causes, in the order in which they were found, with what else was tried in their places, best first.
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
    /// Score without it, the others in, (N m)^2.
    pub without: f64,
    /// Everything tried in its place, best first.
    pub tried: Vec<FittedCause<'d>>,
    /// Causes that do as well with no more numbers.
    pub rivals: Vec<Cause>,
    /// Causes that it is known to be mistaken for, and that do as well with more numbers.
    pub seconds: Vec<Cause>,
}

/// Looks for the causes of what `model` leaves.
pub fn choose<'d>(mask: &Arc<Mask<'d>>, model: &Model, progress: &(dyn Fn() + Sync)) -> Choice<'d> {
    let first = BaseModel::new(mask, model, within_confidence(model));
    let rest = first.alone();
    let start = rest.score();
    let search = Search { first, again: OnceCell::new(), start, progress };
    let Forward { chosen, fit, opening, refused } = search.forward(&rest);
    let (steps, last) = match &chosen[..] {
        [] => (Vec::new(), fit),
        [one] => (vec![search.place(one, opening.tried, rest.clone(), &search.first)], fit),
        _ => search.settle(chosen),
    };
    let decisions = search.decisions(&steps, &last, &refused);
    let of_step = |step: Step<'d>| Found {
        cause: step.taken.cause,
        how: step.taken.how,
        rivals: rivals(&step.taken, &step.tried, start),
        seconds: seconds(&step.taken, &step.tried, start),
        without: step.without.score(),
        tried: step.tried,
    };
    let found = steps.into_iter().map(of_step).collect();
    Choice { found, base: search.first, rest, refused, last, decisions, given_up: None }
}

/// A cause taken, with what it was chosen from.
struct Step<'d> {
    taken: FittedCause<'d>,
    /// Everything tried in its place, best first.
    tried: Vec<FittedCause<'d>>,
    /// The fit of the others alone.
    without: Fit<'d>,
}

/// What the way forward found.
struct Forward<'d> {
    chosen: Vec<Hypothesis>,
    /// All of them together.
    fit: Fit<'d>,
    /// What was tried first.
    opening: Round<'d>,
    /// What was tried last, in vain.
    refused: Vec<FittedCause<'d>>,
}

/// What all rounds share.
struct Search<'d, 's> {
    first: BaseModel<'d>,
    /// The same over the motions as the encoder would have read them once more, of a joint like the model: made when it is first asked for.
    again: OnceCell<Option<BaseModel<'d>>>,
    /// What the base alone leaves, (N m)^2.
    start: f64,
    progress: &'s (dyn Fn() + Sync),
}

impl<'d> Search<'d, '_> {
    /// One cause after the other; two of them also as a pair, for the best one alone may be a compromise between both.
    fn forward(&self, rest: &Fit<'d>) -> Forward<'d> {
        let floor_nm = self.first.mask.floor_nm;
        let is_gap = |now: f64| now - floor_nm.powi(2) > (FLOOR_SHARE * floor_nm).powi(2);
        let mut way = Forward { chosen: Vec::new(), fit: rest.clone(), opening: Round::default(), refused: Vec::new() };
        // However little is left at first: a floor is not known so well that a weak cause could not show.
        while way.chosen.len() < CAUSES_MAX && (way.chosen.is_empty() || is_gap(way.fit.score())) {
            let round = self.round(&self.base_of(&way.fit), &way.chosen);
            let mut next = self.one_more(&way, &round.tried);
            if let [one] = &way.chosen[..] {
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
        let enough = |at: &usize| self.is_material(&tried[*at].fit, &way.fit, way.chosen.is_empty());
        let at = [best, 0].into_iter().find(enough)?;
        let chosen: Vec<Hypothesis> = way.chosen.iter().cloned().chain(tried[at].hypothesis()).collect();
        Some(self.together(&chosen))
    }

    /// A pair that does better than `next`, or than `one` alone where that is nothing.
    fn or_pair(
        &self,
        next: Option<(Vec<Hypothesis>, Fit<'d>)>,
        one: &Hypothesis,
        way: &Forward<'d>,
    ) -> Option<(Vec<Hypothesis>, Fit<'d>)> {
        let likely = pairs::promising(&self.first, &way.opening.hypotheses);
        let fitted = likely
            .into_iter()
            .map(|pair| self.refined(self.together(&pair)))
            .filter(|(_, fit)| fit.is_sound(self.extent()) && self.is_material(fit, &way.fit, false));
        let all: Vec<(Vec<Hypothesis>, Fit<'d>)> = fitted.chain(next).collect();
        let best = all.iter().min_by(|a, b| a.1.score().total_cmp(&b.1.score()))?.1.clone();
        let equals = all.into_iter().filter(|(_, fit)| is_tie(&best, fit, self.start));
        // Of pairs that do as well the simplest; to have what does best alone is worth a number.
        let has_one = |pair: &[Hypothesis]| {
            pair.iter().any(|hypothesis| (hypothesis.cause, hypothesis.how) == (one.cause, one.how))
        };
        equals
            .min_by_key(|(pair, fit)| (fit.moves.len() + usize::from(!has_one(pair)), makeshifts(pair), !has_one(pair)))
    }

    /// Each of `pair` tried anew beside the other as it stands: alone it may have taken a form that is not its own.
    fn refined(&self, mut pair: (Vec<Hypothesis>, Fit<'d>)) -> (Vec<Hypothesis>, Fit<'d>) {
        for at in 0..pair.0.len() {
            let base = self.base_beside(&all_but(&pair.0, at));
            let anew = try_one(&base, pair.0[at].cause).and_then(|tried| tried.hypothesis());
            let Some(anew) = anew else { continue };
            let mut chosen = pair.0.clone();
            chosen[at] = anew;
            let other = self.together(&chosen);
            if other.1.score() < pair.1.score() {
                pair = other;
            }
        }
        pair
    }

    /// Tries each cause again with the others in, until all stay: an early compromise gives way to what it stood for. Leaves out
    /// what the others explain as well without it. Returns the causes, and the fit of all.
    fn settle(&self, mut chosen: Vec<Hypothesis>) -> (Vec<Step<'d>>, Fit<'d>) {
        let mut steps: Vec<Step<'d>> = Vec::new();
        for _ in 0..SWEEPS {
            let before: Vec<Cause> = chosen.iter().map(|hypothesis| hypothesis.cause).collect();
            steps.clear();
            for at in 0..chosen.len() {
                let step = self.again(&chosen, at);
                if let Some(hypothesis) = step.taken.hypothesis() {
                    chosen[at] = hypothesis;
                }
                steps.push(step);
            }
            if chosen.iter().map(|hypothesis| hypothesis.cause).eq(before) {
                break;
            }
        }
        self.without_idle(chosen, steps)
    }

    /// The best in the place of number `at`. What stands there stays unless something does better, or as well by fewer numbers
    /// and still enough to be named.
    fn again(&self, chosen: &[Hypothesis], at: usize) -> Step<'d> {
        let others = all_but(chosen, at);
        let (others, without) = self.together(&others);
        let base = self.base_of(&without);
        let round = self.round(&base, &others);
        let mut step = self.place(&chosen[at], round.tried, without, &self.base_beside(&all_but(chosen, at)));
        let Some(best) = simplest(&step.tried, self.start) else { return step };
        let (own, best, first) = (&step.taken, &step.tried[best], &step.tried[0]);
        let is_simple = own.count() <= best.count();
        let stays = is_simple && is_tie(&first.fit, &own.fit, self.start);
        let order = if stays { [own, best, first] } else { [best, own, first] };
        let enough = |tried: &&FittedCause<'d>| self.is_material(&tried.fit, &step.without, false);
        let taken = order.into_iter().find(enough).unwrap_or(best).clone();
        step.taken = taken;
        step
    }

    /// `hypothesis` as one of `tried`, or fitted on `base` from where it stands, whichever does better: the others alone may have
    /// moved to where it is of no use.
    fn place(
        &self,
        hypothesis: &Hypothesis,
        mut tried: Vec<FittedCause<'d>>,
        without: Fit<'d>,
        base: &BaseModel<'d>,
    ) -> Step<'d> {
        let mut model = base.model.clone();
        let moves = hypothesis.put(&mut model, self.extent());
        let own = FittedCause { cause: hypothesis.cause, how: hypothesis.how, fit: base.fit(model, moves) };
        let is_own = |t: &FittedCause| (t.cause, t.how) == (hypothesis.cause, hypothesis.how);
        let better = |t: &&FittedCause| t.score() <= own.score();
        let taken = tried.iter().find(|t| is_own(t)).filter(better).cloned().unwrap_or_else(|| {
            tried.retain(|t| !is_own(t));
            let behind = tried.partition_point(|t| t.score() < own.score());
            tried.insert(behind, own.clone());
            own.clone()
        });
        Step { taken, tried, without }
    }

    fn without_idle(&self, mut chosen: Vec<Hypothesis>, mut steps: Vec<Step<'d>>) -> (Vec<Step<'d>>, Fit<'d>) {
        loop {
            let (_, all) = self.together(&chosen);
            let idle = (0..chosen.len()).find(|at| {
                steps[*at].without = self.together(&all_but(&chosen, *at)).1;
                !self.is_material(&all, &steps[*at].without, false)
            });
            match idle {
                Some(at) if chosen.len() > 1 => {
                    chosen.remove(at);
                    steps.remove(at);
                }
                _ => return (steps, all),
            }
        }
    }

    fn round(&self, base: &BaseModel<'d>, known: &[Hypothesis]) -> Round<'d> {
        let known: Vec<Cause> = known.iter().map(|hypothesis| hypothesis.cause).collect();
        let round = try_all(base, &known);
        (self.progress)();
        round
    }

    /// `chosen` fitted together on the first base's model, and as they stand there.
    fn together(&self, chosen: &[Hypothesis]) -> (Vec<Hypothesis>, Fit<'d>) {
        let mut model = self.first.model.clone();
        let moves: Vec<Perturbation> =
            chosen.iter().flat_map(|hypothesis| hypothesis.put(&mut model, self.extent())).collect();
        let mut fit = self.first.fit(model, moves.clone());
        if !moves.is_empty() {
            // What the base does depends on the causes: its friction no longer jumps where a transition is. Once more on its own
            // base.
            let own = BaseModel::new(&self.first.mask, &fit.model, self.first.moves.clone());
            fit = own.fit(fit.model, moves);
        }
        let stands = |hypothesis: &Hypothesis| {
            let own: Vec<Perturbation> = hypothesis.moves().to_vec();
            Hypothesis::of((hypothesis.cause, hypothesis.how), &fit.model, &own)
        };
        (chosen.iter().filter_map(stands).collect(), fit)
    }

    /// The base that a fit makes for further causes: its own free within their strides.
    fn base_of(&self, fit: &Fit<'d>) -> BaseModel<'d> {
        if fit.moves.is_empty() {
            return self.first.clone();
        }
        self.base_with(&fit.model, &fit.moves)
    }

    /// The base that `others` make as they stand, free within their strides.
    fn base_beside(&self, others: &[Hypothesis]) -> BaseModel<'d> {
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
    fn decisions(&self, steps: &[Step<'d>], last: &Fit<'d>, refused: &[FittedCause<'d>]) -> Vec<Decision> {
        let is_first = steps.len() < 2;
        let named = steps.iter().flat_map(|step| {
            let all = self.requirements(last, &step.without, is_first);
            all.into_iter().map(|met| met.decision(step.taken.cause.name(), "named"))
        });
        let in_vain = refused.iter().take(REFUSED_TOLD).flat_map(|tried| {
            let all = self.requirements(&tried.fit, last, steps.is_empty());
            all.into_iter().filter(|r| !r.is_met()).map(|short| short.decision(tried.cause.name(), "refused"))
        });
        named.chain(in_vain).collect()
    }

    fn extent(&self) -> &Extent {
        &self.first.data().extent
    }

    fn is_material(&self, with: &Fit<'d>, without: &Fit<'d>, is_first: bool) -> bool {
        self.requirements(with, without, is_first).iter().all(Requirement::is_met)
    }

    fn requirements(&self, with: &Fit<'d>, without: &Fit<'d>, is_first: bool) -> Vec<Requirement> {
        let of_encoder = || {
            let again = self.again.get_or_init(|| {
                let base = &self.first;
                base.mask.again().map(|mask| BaseModel::new(&mask, &base.model, base.moves.clone()))
            });
            let left = |fit: &Fit<'_>| again.as_ref().map_or(0.0, |base| base.square_left(&fit.model, &fit.moves));
            left(without) - left(with)
        };
        requirements(with, without, self.start, is_first, of_encoder)
    }
}

fn makeshifts(chosen: &[Hypothesis]) -> usize {
    chosen.iter().filter(|hypothesis| is_makeshift((hypothesis.cause, hypothesis.how))).count()
}

/// All that were chosen but number `at`.
fn all_but(chosen: &[Hypothesis], at: usize) -> Vec<Hypothesis> {
    chosen.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, hypothesis)| hypothesis.clone()).collect()
}
