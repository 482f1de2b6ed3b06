//! Which causes explain a gap: one after the other, each held against all rivals, earlier ones tried again once later ones are in.

use super::candidates::{Cause, Round, Sketch, Tried, score, try_all, try_one};
use super::fit::{Bench, Fit, Ground};
use super::moves::{Move, within_confidence};
use super::pairs;
use super::weigh::{FLOOR_SHARE, is_makeshift, is_material, is_tie, rivals, seconds, simplest};
use crate::model::Model;

/// Most causes that are looked for.
const CAUSES_MAX: usize = 3;
/// Rounds over the causes found in which each is tried again.
const SWEEPS: usize = 2;

/// Causes found, and all that was tried in the place of each.
#[derive(Debug)]
pub struct Choice {
    /// The base within its confidence alone.
    pub rest: Fit,
    /// The causes, in the order in which they were found, with what else was tried in their places, best first.
    pub found: Vec<Found>,
    /// What was tried last, and gained too little.
    pub refused: Vec<Tried>,
    /// The final fit; `rest` if nothing was found.
    pub last: Fit,
}

/// One cause with its rivals.
#[derive(Debug)]
pub struct Found {
    /// The cause.
    pub cause: Cause,
    /// In which way.
    pub how: &'static str,
    /// Score without it, the others in, (N m)^2.
    pub without: f64,
    /// Everything tried in its place, best first.
    pub tried: Vec<Tried>,
    /// Causes that do as well with no more numbers.
    pub rivals: Vec<Cause>,
    /// Causes that it is known to be mistaken for, and that do as well with more numbers.
    pub seconds: Vec<Cause>,
}

/// Looks for the causes of what `model` leaves.
pub fn choose(bench: &Bench<'_>, model: &Model, progress: &(dyn Fn() + Sync)) -> Choice {
    let first = bench.ground(model, within_confidence(model));
    let rest = bench.rest(&first);
    let start = score(bench, &rest);
    let search = Search { bench, first, start, progress };
    let Forward { chosen, fit, opening, refused } = search.forward(&rest);
    let (steps, last) = match &chosen[..] {
        [] => (Vec::new(), fit),
        [one] => (vec![search.place(one, opening.tried, rest.clone(), &search.first)], fit),
        _ => search.settle(chosen),
    };
    let found = steps.into_iter().map(|step| Found {
        cause: step.taken.cause,
        how: step.taken.how,
        rivals: rivals(bench, &step.taken, &step.tried, start),
        seconds: seconds(bench, &step.taken, &step.tried, start),
        without: score(bench, &step.without),
        tried: step.tried,
    });
    Choice { found: found.collect(), rest, refused, last }
}

/// A cause taken, with what it was chosen from.
struct Step {
    taken: Tried,
    /// Everything tried in its place, best first.
    tried: Vec<Tried>,
    /// The fit of the others alone.
    without: Fit,
}

/// What the way forward found.
struct Forward {
    chosen: Vec<Sketch>,
    /// All of them together.
    fit: Fit,
    /// What was tried first.
    opening: Round,
    /// What was tried last, in vain.
    refused: Vec<Tried>,
}

/// What all rounds share.
struct Search<'s> {
    bench: &'s Bench<'s>,
    first: Ground,
    /// What the base alone leaves, (N m)^2.
    start: f64,
    progress: &'s (dyn Fn() + Sync),
}

impl Search<'_> {
    /// One cause after the other; two of them also as a pair, for the best one alone may be a compromise between both.
    fn forward(&self, rest: &Fit) -> Forward {
        let floor_nm = self.bench.floor_nm;
        let is_gap = |now: f64| now - floor_nm.powi(2) > (FLOOR_SHARE * floor_nm).powi(2);
        let mut way = Forward { chosen: Vec::new(), fit: rest.clone(), opening: Round::default(), refused: Vec::new() };
        while way.chosen.len() < CAUSES_MAX && is_gap(score(self.bench, &way.fit)) {
            let round = self.round(&self.ground_of(&way.fit), &way.chosen);
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
    fn one_more(&self, way: &Forward, tried: &[Tried]) -> Option<(Vec<Sketch>, Fit)> {
        let best = simplest(self.bench, tried, self.start)?;
        // The simplest that does as well may be too little to be named where the best is not.
        let enough = |at: &usize| self.is_material(&tried[*at].fit, &way.fit, way.chosen.is_empty());
        let at = [best, 0].into_iter().find(enough)?;
        let chosen: Vec<Sketch> = way.chosen.iter().cloned().chain(tried[at].sketch()).collect();
        Some(self.together(&chosen))
    }

    /// A pair that does better than `next`, or than `one` alone where that is nothing.
    fn or_pair(&self, next: Option<(Vec<Sketch>, Fit)>, one: &Sketch, way: &Forward) -> Option<(Vec<Sketch>, Fit)> {
        let likely = pairs::promising(self.bench, &self.first, &way.opening.sketches);
        let fitted = likely
            .into_iter()
            .map(|pair| self.refined(self.together(&pair)))
            .filter(|(_, fit)| fit.is_sound(&self.bench.extent) && self.is_material(fit, &way.fit, false));
        let all: Vec<(Vec<Sketch>, Fit)> = fitted.chain(next).collect();
        let best = all.iter().min_by(|a, b| score(self.bench, &a.1).total_cmp(&score(self.bench, &b.1)))?.1.clone();
        let equals = all.into_iter().filter(|(_, fit)| is_tie(self.bench, &best, fit, self.start));
        // Of pairs that do as well the simplest; to have what does best alone is worth a number.
        let has_one = |pair: &[Sketch]| pair.iter().any(|sketch| (sketch.cause, sketch.how) == (one.cause, one.how));
        equals
            .min_by_key(|(pair, fit)| (fit.moves.len() + usize::from(!has_one(pair)), makeshifts(pair), !has_one(pair)))
    }

    /// Each of `pair` tried anew beside the other as it stands: alone it may have taken a form that is not its own.
    fn refined(&self, mut pair: (Vec<Sketch>, Fit)) -> (Vec<Sketch>, Fit) {
        for at in 0..pair.0.len() {
            let ground = self.ground_beside(&all_but(&pair.0, at));
            let anew = try_one(self.bench, &ground, pair.0[at].cause).and_then(|tried| tried.sketch());
            let Some(anew) = anew else { continue };
            let mut chosen = pair.0.clone();
            chosen[at] = anew;
            let other = self.together(&chosen);
            if score(self.bench, &other.1) < score(self.bench, &pair.1) {
                pair = other;
            }
        }
        pair
    }

    /// Tries each cause again with the others in, until all stay: an early compromise gives way to what it stood for. Leaves out
    /// what the others explain as well without it. Returns the causes, and the fit of all.
    fn settle(&self, mut chosen: Vec<Sketch>) -> (Vec<Step>, Fit) {
        let mut steps: Vec<Step> = Vec::new();
        for _ in 0..SWEEPS {
            let before: Vec<Cause> = chosen.iter().map(|sketch| sketch.cause).collect();
            steps.clear();
            for at in 0..chosen.len() {
                let step = self.again(&chosen, at);
                if let Some(sketch) = step.taken.sketch() {
                    chosen[at] = sketch;
                }
                steps.push(step);
            }
            if chosen.iter().map(|sketch| sketch.cause).eq(before) {
                break;
            }
        }
        self.without_idle(chosen, steps)
    }

    /// The best in the place of number `at`. What stands there stays unless something does better, or as well by fewer numbers
    /// and still enough to be named.
    fn again(&self, chosen: &[Sketch], at: usize) -> Step {
        let others = all_but(chosen, at);
        let (others, without) = self.together(&others);
        let ground = self.ground_of(&without);
        let round = self.round(&ground, &others);
        let mut step = self.place(&chosen[at], round.tried, without, &self.ground_beside(&all_but(chosen, at)));
        let Some(best) = simplest(self.bench, &step.tried, self.start) else { return step };
        let (own, best, first) = (&step.taken, &step.tried[best], &step.tried[0]);
        let is_simple = own.count(self.bench) <= best.count(self.bench);
        let stays = is_simple && is_tie(self.bench, &first.fit, &own.fit, self.start);
        let order = if stays { [own, best, first] } else { [best, own, first] };
        let enough = |tried: &&Tried| self.is_material(&tried.fit, &step.without, false);
        let taken = order.into_iter().find(enough).unwrap_or(best).clone();
        step.taken = taken;
        step
    }

    /// `sketch` as one of `tried`, or fitted on `ground` from where it stands, whichever does better: the others alone may have
    /// moved to where it is of no use.
    fn place(&self, sketch: &Sketch, mut tried: Vec<Tried>, without: Fit, ground: &Ground) -> Step {
        let mut model = ground.model.clone();
        let moves = sketch.put(&mut model, self.bench);
        let own = Tried { cause: sketch.cause, how: sketch.how, fit: self.bench.fit(ground, model, moves) };
        let is_own = |t: &Tried| (t.cause, t.how) == (sketch.cause, sketch.how);
        let better = |t: &&Tried| t.score(self.bench) <= own.score(self.bench);
        let taken = tried.iter().find(|t| is_own(t)).filter(better).cloned().unwrap_or_else(|| {
            tried.retain(|t| !is_own(t));
            let behind = tried.partition_point(|t| t.score(self.bench) < own.score(self.bench));
            tried.insert(behind, own.clone());
            own.clone()
        });
        Step { taken, tried, without }
    }

    fn without_idle(&self, mut chosen: Vec<Sketch>, mut steps: Vec<Step>) -> (Vec<Step>, Fit) {
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

    fn round(&self, ground: &Ground, known: &[Sketch]) -> Round {
        let known: Vec<Cause> = known.iter().map(|sketch| sketch.cause).collect();
        let round = try_all(self.bench, ground, &known);
        (self.progress)();
        round
    }

    /// `chosen` fitted together on the first ground's model, and as they stand there.
    fn together(&self, chosen: &[Sketch]) -> (Vec<Sketch>, Fit) {
        let mut model = self.first.model.clone();
        let moves: Vec<Move> = chosen.iter().flat_map(|sketch| sketch.put(&mut model, self.bench)).collect();
        let mut fit = self.bench.fit(&self.first, model, moves.clone());
        if !moves.is_empty() {
            // What the base does depends on the causes: its friction no longer jumps where a transition is. Once more on its own
            // ground.
            let own = self.bench.ground(&fit.model, self.first.moves.clone());
            fit = self.bench.fit(&own, fit.model, moves);
        }
        let stands = |sketch: &Sketch| {
            let own: Vec<Move> = sketch.moves().to_vec();
            Sketch::of((sketch.cause, sketch.how), &fit.model, &own)
        };
        (chosen.iter().filter_map(stands).collect(), fit)
    }

    /// The ground that a fit makes for further causes: its own free within their strides.
    fn ground_of(&self, fit: &Fit) -> Ground {
        if fit.moves.is_empty() {
            return self.first.clone();
        }
        self.ground_with(&fit.model, &fit.moves)
    }

    /// The ground that `others` make as they stand, free within their strides.
    fn ground_beside(&self, others: &[Sketch]) -> Ground {
        let mut model = self.first.model.clone();
        let moves: Vec<Move> = others.iter().flat_map(|sketch| sketch.put(&mut model, self.bench)).collect();
        self.ground_with(&model, &moves)
    }

    fn ground_with(&self, model: &Model, moves: &[Move]) -> Ground {
        let free = moves.iter().map(|way| way.clone().believed_within(way.stride));
        self.bench.ground(model, self.first.moves.iter().cloned().chain(free).collect())
    }

    fn is_material(&self, with: &Fit, without: &Fit, is_first: bool) -> bool {
        is_material(self.bench, with, without, self.start, is_first)
    }
}

fn makeshifts(chosen: &[Sketch]) -> usize {
    chosen.iter().filter(|sketch| is_makeshift((sketch.cause, sketch.how))).count()
}

/// All that were chosen but number `at`.
fn all_but(chosen: &[Sketch], at: usize) -> Vec<Sketch> {
    chosen.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, sketch)| sketch.clone()).collect()
}
