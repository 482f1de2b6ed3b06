//! Causes that were found one after the other, each tried again with the others in.

use super::base::BaseModel;
use super::candidates::{Cause, FittedCause, Hypothesis, reach};
use super::compare::{is_tie, leaves_more};
use super::criteria::{Share, best_form, distinctness, simplest, simplicity};
use super::fit::Fit;
use super::progress::{Phase, Progress};
use super::search::Search;

/// Most rounds over the causes found; after the first, a cause is tried only where the others are not the causes beside which it was tried last.
const SWEEPS: usize = 2;

/// Standard errors of the difference: a cause stays in its place unless another does better by more of them. The one-standard-error rule:
/// what is simpler, or was there, is preferred as long as it is within one of the best.
const STAYS_WITHIN_ERRORS: f64 = 1.0;

/// What does as well by so many numbers fewer takes the place of what was there even where it is behind by more than one error: an early compromise
/// has numbers to spare.
const MUCH_SIMPLER: usize = 2;

/// A cause taken, with what it was chosen from.
pub struct Step<'d> {
    /// The cause.
    pub taken: FittedCause<'d>,
    /// Everything tried in its place, best first.
    pub tried: Vec<FittedCause<'d>>,
    /// The fit of the others alone.
    pub without: Fit<'d>,
    /// The others' causes, in order; empty until the cause has been settled in its place.
    beside: Vec<Cause>,
    /// How far the cause is ahead of every other that was tried, as a share of its gain on what was left then.
    pub distinctness: f64,
}

impl<'d> Step<'d> {
    fn new(taken: FittedCause<'d>, tried: Vec<FittedCause<'d>>, without: Fit<'d>) -> Self {
        let distinctness = distinctness(&taken, &tried, without.score());
        Self { taken, tried, without, beside: Vec::new(), distinctness }
    }

    /// The causes that gain nearly as much as the best: what falls far short beside causes falls short beside much the same, too.
    fn prospects(&self) -> Vec<Cause> {
        let best = self.tried.first().map_or(0.0, FittedCause::score);
        let reach = reach(self.without.score(), best);
        self.tried.iter().filter(|tried| tried.score() <= reach).map(|tried| tried.cause).collect()
    }

    /// The share of the gap that its cause must explain.
    pub fn share(&self) -> Share {
        Share::of(&self.without.mask.data.policy, self.taken.cause, self.distinctness)
    }
}

impl<'d> Search<'d, '_> {
    /// Tries each cause again with the others in, until all stay or [`SWEEPS`] rounds are over: an early compromise is replaced by the
    /// causes that it stood for. Leaves out what the others explain as well without it. Returns the causes, and the fit of all.
    pub fn settle(&self, mut chosen: Vec<Hypothesis>) -> (Vec<Step<'d>>, Fit<'d>) {
        let mut steps: Vec<Option<Step<'d>>> = chosen.iter().map(|_| None).collect();
        for at in (0..chosen.len()).cycle().take(SWEEPS * chosen.len()) {
            let beside: Vec<Cause> = all_but(&chosen, at).iter().map(|hypothesis| hypothesis.cause).collect();
            if steps[at].as_ref().is_some_and(|step| step.beside == beside) {
                continue;
            }
            let prospects = steps[at].take().map(|step| step.prospects());
            let (step, stand) = self.again(&chosen, at, prospects.as_deref());
            chosen = stand;
            steps[at] = Some(Step { beside, ..step });
        }
        self.without_idle(chosen, steps.into_iter().flatten().collect())
    }

    /// The best in the place of number `at`, of all causes or only of those `among` which it is sought, and all causes as they stand with it.
    /// What stands there stays unless something does better by more than [`STAYS_WITHIN_ERRORS`], or as well and is simpler, or ties with it and is
    /// simpler by [`MUCH_SIMPLER`], and still enough to be named.
    fn again(&self, chosen: &[Hypothesis], at: usize, among: Option<&[Cause]>) -> (Step<'d>, Vec<Hypothesis>) {
        let (others, without) = self.together(&all_but(chosen, at));
        (self.listener)(Progress::Begins(Phase::Rivals(chosen[at].cause.name())));
        let own = self.own(&chosen[at], &self.base_beside(&all_but(chosen, at)));
        let round = self.round(&others, &without, among, own.score());
        let step = place(own, round.tried, without);
        let Some(taken) = self.preferred(&step.tried, &step.taken, &step.without) else {
            return (step, chosen.to_vec());
        };
        let (sets, fits) = self.forms(chosen, at, &step.tried, taken);
        let form = best_form(&fits).unwrap_or(taken);
        let taken = step.tried.iter().find(|tried| tried.is(form)).unwrap_or(form).clone();
        let stand = sets.into_iter().find(|set| (set[at].cause, set[at].how) == (taken.cause, taken.how));
        let stand = stand.unwrap_or_else(|| {
            let mut all = chosen.to_vec();
            taken.hypothesis().into_iter().for_each(|hypothesis| all[at] = hypothesis);
            all
        });
        (Step::new(taken, step.tried, step.without), stand)
    }

    /// Which of `tried`, best first, takes the place where `own` stands: see [`Self::again`]. Its gain on `without`, the fit
    /// with none of them, must be enough to be named.
    fn preferred<'t>(
        &self,
        tried: &'t [FittedCause<'d>],
        own: &'t FittedCause<'d>,
        without: &Fit<'d>,
    ) -> Option<&'t FittedCause<'d>> {
        let (best, first) = (&tried[simplest(tried, self.start)?], &tried[0]);
        let is_behind =
            |fitted: &FittedCause, other: &FittedCause| leaves_more(&other.fit, &fitted.fit, STAYS_WITHIN_ERRORS);
        let is_simple = simplicity(own) <= simplicity(best) && !is_behind(own, best);
        let is_ahead = || is_behind(best, own) && own.count() < best.count() + MUCH_SIMPLER;
        let stays = (is_simple || is_ahead()) && is_tie(&first.fit, &own.fit, self.start);
        let order = if stays { [own, best, first] } else { [best, own, first] };
        let enough = |tried: &&FittedCause<'d>| self.is_material(&tried.fit, without, Share::at_best(tried.cause));
        Some(order.into_iter().find(enough).unwrap_or(best))
    }

    /// Where `taken`, of all that was `tried` in the place of number `at`, is one of several forms of one thing: each of them as it stands with all
    /// others in and fitted with them, best first. Beside a base without any, friction jumps at a turn, and they compare wrongly. Which of them is
    /// taken is decided by that; what is told of rivals comes from what was tried.
    fn forms(
        &self,
        chosen: &[Hypothesis],
        at: usize,
        tried: &[FittedCause<'d>],
        taken: &FittedCause<'d>,
    ) -> (Vec<Vec<Hypothesis>>, Vec<FittedCause<'d>>) {
        let is_form = |tried: &&FittedCause<'d>| tried.cause == taken.cause || tried.cause.is_alike(taken.cause);
        let forms: Vec<&FittedCause<'d>> = tried.iter().filter(is_form).collect();
        if forms.iter().all(|form| form.cause == taken.cause) {
            return (Vec::new(), Vec::new());
        }
        let together = |form: &FittedCause<'d>| {
            let mut all = chosen.to_vec();
            all[at] = form.hypothesis()?;
            let (all, fit) = self.together(&all);
            let is_whole = all.len() == chosen.len() && fit.is_sound();
            is_whole.then_some((all, FittedCause { cause: form.cause, how: form.how, fit }))
        };
        let mut sets: Vec<(Vec<Hypothesis>, FittedCause<'d>)> = forms.into_iter().filter_map(together).collect();
        sets.sort_by(|(_, a), (_, b)| a.score().total_cmp(&b.score()));
        sets.into_iter().unzip()
    }

    /// `hypothesis` fitted on `base` from where it stands.
    pub fn own(&self, hypothesis: &Hypothesis, base: &BaseModel<'d>) -> FittedCause<'d> {
        let mut model = base.model.clone();
        let moves = hypothesis.put(&mut model, self.extent());
        FittedCause { cause: hypothesis.cause, how: hypothesis.how, fit: base.fit(model, moves) }
    }

    fn without_idle(&self, mut chosen: Vec<Hypothesis>, mut steps: Vec<Step<'d>>) -> (Vec<Step<'d>>, Fit<'d>) {
        loop {
            let (_, all) = self.together(&chosen);
            let idle = (0..chosen.len()).find(|at| {
                steps[*at].without = self.best_together(&all_but(&chosen, *at)).1;
                !self.is_material(&all, &steps[*at].without, steps[*at].share())
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
}

/// A cause as one of `tried`, or its `own` fit from where it stood, whichever does better: fitted alone, the others may have moved to where it
/// gains nothing. Where its own fit is no longer what it is called and none of `tried` is, the best of `tried` stands in its place.
pub fn place<'d>(own: FittedCause<'d>, mut tried: Vec<FittedCause<'d>>, without: Fit<'d>) -> Step<'d> {
    let is_own = |t: &FittedCause| t.is(&own);
    let is_itself = own.is_itself();
    let better = |t: &&FittedCause| !is_itself || t.score() <= own.score();
    let taken = match tried.iter().find(|t| is_own(t)).filter(better).or(tried.first().filter(|_| !is_itself)) {
        Some(better) => better.clone(),
        None => {
            tried.retain(|t| !is_own(t));
            let behind = tried.partition_point(|t| t.score() < own.score());
            tried.insert(behind, own.clone());
            own
        }
    };
    Step::new(taken, tried, without)
}

/// All that were chosen but number `at`.
pub fn all_but(chosen: &[Hypothesis], at: usize) -> Vec<Hypothesis> {
    chosen.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, hypothesis)| hypothesis.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::place;
    use crate::diagnose::base::BaseModel;
    use crate::diagnose::candidates::{Cause, try_one};
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::mask::Mask;
    use crate::effects::linear_spring;

    #[test]
    fn a_cause_keeps_its_place_where_what_stands_beside_it_is_no_longer_what_it_is_called() {
        let (data, model) = bundled();
        let mask = Mask::new(&data, data.scored(&model), 1e-3);
        let sound = BaseModel::new(&mask, &model, Vec::new());
        let mut own = try_one(&sound, Cause::Effect("presliding"), &Vec::new()).unwrap();
        let other = try_one(&sound, Cause::Effect("sensor_bias"), &Vec::new()).unwrap();
        assert!(own.score() < other.score());
        // A spring that drives the motion.
        own.fit.model.effects.insert(0, linear_spring(-1.0, 0.0));
        assert!(!own.fit.is_sound() && own.is_itself());
        let step = place(own.clone(), vec![other], sound.alone());
        assert!(step.taken.is(&own));
    }
}
