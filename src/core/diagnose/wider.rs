//! A wider search: runners-up are followed too, and known causes are fitted anew with each that is tried beside them.

use super::candidates::{Cause, FittedCause, Hypothesis, Set, reach};
use super::criteria::{Share, simplest};
use super::runners_up::RunnerUp;
use super::search::{Forward, Search};

/// Causes that are fitted anew together with those known: the best of a round.
const FREED: usize = 3;

impl<'d> Search<'d, '_> {
    /// The runners-up of `way`, each with one cause more: those that are enough to be named in the place of what was chosen, and, of all
    /// that was tried beside them, what may be followed further.
    pub fn extended(&self, way: &Forward<'d>) -> (Vec<Set<'d>>, Vec<RunnerUp>) {
        let (mut sets, mut next) = (Vec::new(), Vec::new());
        for RunnerUp { causes, score } in &way.runners_up {
            if *score > reach(self.start, way.fit.score()) {
                continue;
            }
            let (causes, fit) = self.together(causes);
            let round = self.round(&causes, &fit, None, f64::INFINITY);
            next.extend(RunnerUp::of_round(&causes, &round.tried));
            let Some(best) = simplest(&round.tried, self.start) else { continue };
            let mut of_round = vec![best];
            of_round.extend((best != 0).then_some(0));
            for at in of_round {
                let all: Vec<Hypothesis> = causes.iter().cloned().chain(round.tried[at].hypothesis()).collect();
                sets.push(self.together(&all));
            }
        }
        sets.retain(|(_, fit)| fit.is_sound() && self.is_material(fit, &way.fit, Share::Further));
        (sets, next)
    }

    /// Follows the best of `tried`, one of each cause, with the causes that are `known` free to go where they do best beside it, if
    /// they have shapes: those stand where they made up for what was not in the model.
    pub fn follow(&self, known: &[Hypothesis], tried: &mut [FittedCause<'d>]) {
        let (_, moves) = self.put(known);
        if moves.iter().all(|way| way.is_linear) {
            return;
        }
        let Some(best) = tried.first().map(FittedCause::score) else { return };
        let mut followed: Vec<Cause> = Vec::new();
        for tried in tried.iter_mut() {
            if followed.len() == FREED {
                break;
            }
            if !followed.contains(&tried.cause) {
                followed.push(tried.cause);
                let freed = self.freed(known, tried, best).filter(|freed| freed.score() < tried.score());
                freed.into_iter().for_each(|freed| *tried = freed);
            }
        }
        tried.sort_by(|a, b| a.score().total_cmp(&b.score()));
    }

    /// `tried` beside `known`, which are fitted anew along with it as long as that may come to what the `best` leaves, (N m)^2; nothing
    /// where something is no longer what it is called.
    fn freed(&self, known: &[Hypothesis], tried: &FittedCause<'d>, best: f64) -> Option<FittedCause<'d>> {
        let all: Vec<Hypothesis> = known.iter().cloned().chain(tried.hypothesis()).collect();
        let (all, _) = self.together_to_reach(best, &all);
        let (own, known) = all.split_last()?;
        Some(self.own(own, &self.base_beside(known))).filter(|own| own.fit.is_sound())
    }
}
