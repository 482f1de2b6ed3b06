//! What a search for causes goes by: the base model, the fits of causes together, what was tried beside which, and what is asked of a cause.

use super::base::BaseModel;
use super::candidates::{Cause, FittedCause, Hypothesis, Round, Set, names, try_all};
use super::criteria::{Requirement, Share, requirements};
use super::fit::Fit;
use super::perturbation::Perturbation;
use super::progress::Listener;
use super::rounds::Rounds;
use super::runners_up::RunnerUp;
use crate::effects::Extent;
use crate::model::Model;
use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;

/// What all rounds share.
pub struct Search<'d, 's> {
    /// The base model.
    pub first: BaseModel<'d>,
    /// The same over the motions as the encoder would have read them once more, of a joint like the model: made when it is first asked for.
    again: OnceCell<Option<BaseModel<'d>>>,
    /// The base alone.
    pub rest: Fit<'d>,
    /// What it leaves, (N m)^2.
    pub start: f64,
    rounds: Rounds<'d>,
    /// The same where other causes than the best are followed too; none where they are not.
    followed: Option<Rounds<'d>>,
    /// The best fit known of each set of causes.
    best: RefCell<HashMap<Vec<Cause>, Set<'d>>>,
    /// Who hears what it is at.
    pub listener: Listener<'s>,
}

/// How far a search has come.
pub struct Forward<'d> {
    /// The causes.
    pub chosen: Vec<Hypothesis>,
    /// All of them together.
    pub fit: Fit<'d>,
    /// What was tried first.
    pub opening: Round<'d>,
    /// What was tried last, without success.
    pub refused: Vec<FittedCause<'d>>,
    /// Other causes, as many, that do nearly as well.
    pub runners_up: Vec<RunnerUp>,
}

impl<'d, 's> Search<'d, 's> {
    /// Of causes beside `first`, which leaves `rest` alone.
    pub fn new(first: BaseModel<'d>, rest: Fit<'d>, listener: Listener<'s>) -> Self {
        let start = rest.score();
        Self {
            first,
            rest,
            again: OnceCell::new(),
            start,
            rounds: Rounds::default(),
            followed: None,
            best: RefCell::default(),
            listener,
        }
    }

    /// `chosen` fitted together, and as they stand there. The base's columns depend on the causes (with a transition its friction no longer
    /// jumps): they are taken with all of them in.
    pub fn together(&self, chosen: &[Hypothesis]) -> Set<'d> {
        self.together_to_reach(f64::INFINITY, chosen)
    }

    /// The same, given up once it is clear that its cost will not fall to `reach`.
    pub fn together_to_reach(&self, reach: f64, chosen: &[Hypothesis]) -> Set<'d> {
        let (model, moves) = self.put(chosen);
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
        let set = (chosen.iter().filter_map(stands).collect(), fit);
        self.note(&set);
        set
    }

    /// Keeps `set` if each of its effects is what it is called and no better fit of its causes is known.
    pub fn note(&self, set: &Set<'d>) {
        if !set.1.is_sound() {
            return;
        }
        let mut best = self.best.borrow_mut();
        let causes = names(&set.0);
        if best.get(&causes).is_none_or(|(_, known)| set.1.score() < known.score()) {
            best.insert(causes, set.clone());
        }
    }

    /// `chosen` fitted together, from where they stand, or as they are known to do better.
    pub fn best_together(&self, chosen: &[Hypothesis]) -> Set<'d> {
        let set = self.together(chosen);
        self.best.borrow().get(&names(chosen)).cloned().unwrap_or(set)
    }

    /// The base that a fit makes for further causes: its own free within their strides.
    pub fn base_of(&self, fit: &Fit<'d>) -> BaseModel<'d> {
        if fit.moves.is_empty() {
            return self.first.clone();
        }
        self.base_with(&fit.model, &fit.moves)
    }

    /// The base that `others` make as they stand, free within their strides.
    pub fn base_beside(&self, others: &[Hypothesis]) -> BaseModel<'d> {
        let (model, moves) = self.put(others);
        self.base_with(&model, &moves)
    }

    /// The model with `hypotheses` in, as they stand, and what may move of them.
    pub fn put(&self, hypotheses: &[Hypothesis]) -> (Model, Vec<Perturbation>) {
        let mut model = self.first.model.clone();
        let put = |hypothesis: &Hypothesis| hypothesis.put(&mut model, self.extent());
        let moves = hypotheses.iter().flat_map(put).collect();
        (model, moves)
    }

    fn base_with(&self, model: &Model, moves: &[Perturbation]) -> BaseModel<'d> {
        let free = moves.iter().map(|way| way.clone().believed_within(way.stride));
        BaseModel::new(&self.first.mask, model, self.first.moves.iter().cloned().chain(free).collect())
    }

    /// Everything, or what is `among` some causes, tried beside `known`, whose fit is `fit`, in a place where some cause is known to have
    /// `reached` a score: again only if the same causes stand elsewhere than before.
    pub fn round(&self, known: &[Hypothesis], fit: &Fit<'d>, among: Option<&[Cause]>, reached: f64) -> Round<'d> {
        let mut causes: Vec<_> = known.iter().map(|hypothesis| (hypothesis.cause, hypothesis.how)).collect();
        causes.sort_unstable();
        let score = fit.score();
        let rounds = self.followed.as_ref().unwrap_or(&self.rounds);
        if let Some(round) = rounds.known(&causes, score) {
            return round;
        }
        let is_new = |cause: Cause| known.iter().all(|known| known.cause.may_stand_beside(cause));
        let wanted = |cause: Cause| is_new(cause) && among.is_none_or(|among| among.contains(&cause));
        let anew = || try_all(&self.base_of(fit), wanted, &self.rounds.likely(), reached, self.listener);
        let mut round = self.rounds.known(&causes, score).unwrap_or_else(anew);
        if self.followed.is_some() {
            self.follow(known, &mut round.tried);
        }
        if among.is_none() {
            rounds.keep(causes, score, &round);
        }
        round
    }

    /// The same search with other causes than the best followed too.
    pub fn widened(self) -> Self {
        Self { followed: Some(Rounds::default()), ..self }
    }

    /// Whether other causes than the best are followed too.
    pub fn is_wide(&self) -> bool {
        self.followed.is_some()
    }

    /// What the campaign spans.
    pub fn extent(&self) -> &Extent {
        &self.first.data().extent
    }

    /// Whether a cause meets every requirement by its fits `with` and `without` it.
    pub fn is_material(&self, with: &Fit<'d>, without: &Fit<'d>, share: Share) -> bool {
        self.requirements(with, without, share).iter().all(Requirement::is_met)
    }

    /// What a cause reaches by its fits `with` and `without` it, up to the first requirement that it does not meet.
    pub fn requirements(&self, with: &Fit<'d>, without: &Fit<'d>, share: Share) -> Vec<Requirement> {
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
