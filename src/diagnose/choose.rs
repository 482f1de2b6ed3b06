//! Which causes explain a gap: one after the other, each held against all rivals, earlier ones tried again once later ones are in.

use super::candidates::{Cause, Tried, score, try_all};
use super::fit::{Bench, Fit, Ground};
use super::moves::{Move, within_confidence};
use crate::effects::find;
use crate::model::Model;
use crate::numerics::statistics::standard_deviation;

/// Most causes that are looked for.
const CAUSES_MAX: usize = 3;
/// A cause must change the prediction by this share of the floor at least, RMS ...
const FLOOR_SHARE: f64 = 0.6;
/// ... the first by this share of the gap's square, any other by this share of what is left ...
const GAP_SHARE_FIRST: f64 = 0.15;
const GAP_SHARE_MORE: f64 = 0.30;
/// ... and of the whole gap's square ...
const WHOLE_SHARE_MORE: f64 = 0.02;
/// ... or by so much of the whole: of a gap with many small causes even a large one is no great share of what is left.
const WHOLE_SHARE_ALONE: f64 = 0.12;
/// Its gain must exceed so many standard errors over clusters.
const ERRORS: f64 = 2.0;
/// What clusters lose by it is little, as a share of what others win.
const LOST_SHARE: f64 = 0.2;
/// A simpler cause is taken, and an equal one is a rival, within so many standard errors over clusters ...
const TIE_ERRORS: f64 = 1.5;
/// ... or this share of the gap's square, or of the floor's.
const TIE_SHARE: f64 = 0.001;
const TIE_FLOOR_SHARE: f64 = 0.01;
/// However uncertain, what lies further apart than this share of the gap's square is not equal.
const TIE_SHARE_MAX: f64 = 0.05;

/// A cause that moves the base by so much more, in squared standard deviations, does not do as well: e^-5 as likely.
const SURPRISE_APART: f64 = 10.0;

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
    let search = Search { bench, first: bench.ground(model, within_confidence(model)), progress };
    let rest = bench.rest(&search.first);
    let start = score(bench, &rest);
    let (mut chosen, refused, mut last) = search.forward(&rest, start);
    if chosen.len() > 1 {
        search.again(&mut chosen, start);
        last = search.without_idle(&mut chosen, start);
    }
    let found = chosen
        .into_iter()
        .map(|step| Found {
            cause: step.taken.cause,
            how: step.taken.how,
            rivals: rivals(bench, &step.taken, &step.tried, start),
            seconds: seconds(bench, &step.taken, &step.tried, start),
            without: score(bench, &step.without),
            tried: step.tried,
        })
        .collect();
    Choice { rest, found, refused, last }
}

/// A cause taken, with what it was chosen from.
struct Step {
    taken: Tried,
    /// Everything tried in its place, best first.
    tried: Vec<Tried>,
    /// The fit of the others alone.
    without: Fit,
}

/// What all rounds share.
struct Search<'s> {
    bench: &'s Bench<'s>,
    first: Ground,
    progress: &'s (dyn Fn() + Sync),
}

impl Search<'_> {
    /// One cause after the other; what the last round tried in vain; the fit of what was found.
    fn forward(&self, rest: &Fit, start: f64) -> (Vec<Step>, Vec<Tried>, Fit) {
        let bench = self.bench;
        let is_gap = |now: f64| now - bench.floor_nm.powi(2) > (FLOOR_SHARE * bench.floor_nm).powi(2);
        let mut chosen: Vec<Step> = Vec::new();
        let (mut ground, mut fit) = (self.first.clone(), rest.clone());
        while chosen.len() < CAUSES_MAX && is_gap(score(bench, &fit)) {
            let known: Vec<Cause> = chosen.iter().map(|step| step.taken.cause).collect();
            let tried = self.round(&ground, &known);
            let Some(best) = simplest(bench, &tried, start) else { break };
            // The simplest that does as well may be too little to be named where the best is not.
            let enough = |at: &usize| is_material(bench, &tried[*at].fit, &fit, start, chosen.is_empty());
            let Some(best) = [best, 0].into_iter().find(enough) else { return (chosen, tried, fit) };
            let taken = tried[best].clone();
            chosen.push(Step { taken, tried, without: fit });
            fit = self.together(&chosen.iter().map(|step| &step.taken).collect::<Vec<&Tried>>());
            ground = self.ground_of(&fit);
        }
        (chosen, Vec::new(), fit)
    }

    /// Tries each cause but the last again, the others being in: an early compromise gives way to what it stood for.
    fn again(&self, chosen: &mut [Step], start: f64) {
        for at in 0..chosen.len() - 1 {
            let others: Vec<&Tried> = others(chosen, at);
            let known: Vec<Cause> = others.iter().map(|tried| tried.cause).collect();
            let without = self.together(&others);
            let tried = self.round(&self.ground_of(&without), &known);
            let Some(best) = simplest(self.bench, &tried, start) else { continue };
            // What was taken stays unless something does better, or as well by fewer numbers and still enough to be named.
            let before = &chosen[at].taken;
            let is_own = |t: &Tried| (t.cause, t.how) == (before.cause, before.how);
            let own = tried.iter().position(is_own).unwrap_or(best);
            let stays = tried[own].count() <= tried[best].count() && is_tie(self.bench, &tried[0], &tried[own], start);
            let enough = |at: &usize| is_material(self.bench, &tried[*at].fit, &without, start, false);
            let order = if stays { [own, best, 0] } else { [best, own, 0] };
            let taken = tried[order.into_iter().find(enough).unwrap_or(best)].clone();
            chosen[at] = Step { taken, tried, without };
        }
    }

    /// Leaves out what the others explain as well without it; returns the fit of those that stay.
    fn without_idle(&self, chosen: &mut Vec<Step>, start: f64) -> Fit {
        loop {
            let all = self.together(&chosen.iter().map(|step| &step.taken).collect::<Vec<&Tried>>());
            let idle = (0..chosen.len()).find(|at| {
                chosen[*at].without = self.together(&others(chosen, *at));
                !is_material(self.bench, &all, &chosen[*at].without, start, false)
            });
            match idle {
                Some(at) if chosen.len() > 1 => drop(chosen.remove(at)),
                _ => return all,
            }
        }
    }

    fn round(&self, ground: &Ground, known: &[Cause]) -> Vec<Tried> {
        let tried = ranked(self.bench, try_all(self.bench, ground, known));
        (self.progress)();
        tried
    }

    /// `chosen` fitted together on the first ground's model.
    fn together(&self, chosen: &[&Tried]) -> Fit {
        let mut model = self.first.model.clone();
        let mut moves: Vec<Move> = Vec::new();
        for tried in chosen {
            match tried.cause {
                Cause::Effect(_) => {
                    let Some(added) = tried.fit.model.effects.last() else { continue };
                    model.effects.push(added.clone());
                    let at = model.effects.len() - 1;
                    moves.extend(super::moves::of_effect(&model, at, &self.bench.extent));
                }
                Cause::Stale(_) => {
                    for way in &tried.fit.moves {
                        way.knobs().for_each(|knob| knob.set(&mut model, knob.value(&tried.fit.model)));
                    }
                    moves.extend(tried.fit.moves.iter().cloned());
                }
            }
        }
        let fit = self.bench.fit(&self.first, model, moves.clone());
        if moves.is_empty() {
            return fit;
        }
        // What the base does depends on the causes: its friction no longer jumps where a transition is. Once more on its own ground.
        let own = self.bench.ground(&fit.model, self.first.moves.clone());
        self.bench.fit(&own, fit.model, moves)
    }

    /// The ground that a fit makes for further causes: its own free within their strides.
    fn ground_of(&self, fit: &Fit) -> Ground {
        let free = fit.moves.iter().map(|way| way.clone().believed_within(way.stride));
        self.bench.ground(&fit.model, self.first.moves.iter().cloned().chain(free).collect())
    }
}

/// All that were taken but number `at`.
fn others(chosen: &[Step], at: usize) -> Vec<&Tried> {
    chosen.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, step)| &step.taken).collect()
}

/// Best first by what is left on held-out units.
fn ranked(bench: &Bench<'_>, mut tried: Vec<Tried>) -> Vec<Tried> {
    tried.sort_by(|a, b| a.score(bench).total_cmp(&b.score(bench)));
    tried
}

/// The simplest of those that do as well as the best.
fn simplest(bench: &Bench<'_>, tried: &[Tried], start: f64) -> Option<usize> {
    let best = tried.first()?;
    let equals = tried.iter().enumerate().filter(|(_, t)| is_tie(bench, best, t, start));
    equals.min_by_key(|(_, t)| t.count()).map(|(at, _)| at)
}

/// Whether `other` does as well as `best` on held-out units, as far as they can tell.
fn is_tie(bench: &Bench<'_>, best: &Tried, other: &Tried, start: f64) -> bool {
    let floor_square = bench.floor_nm * bench.floor_nm;
    let behind = other.score(bench) - best.score(bench);
    let negligible = (TIE_SHARE * (start - floor_square)).max(TIE_FLOOR_SHARE * floor_square);
    let weigh = |t: &Tried| bench.surprise_factor(&t.fit);
    let (a, b) = (weigh(best), weigh(other));
    if other.fit.cost.surprise > best.fit.cost.surprise + SURPRISE_APART {
        return false;
    }
    let differences = clusters(bench, best.fit.held_out.iter().zip(&other.fit.held_out).map(|(x, y)| b * y - a * x));
    let uncertain = behind * bench.rows() as f64 <= TIE_ERRORS * error_of_sum(&differences);
    behind <= negligible || (uncertain && behind <= TIE_SHARE_MAX * (start - floor_square).max(floor_square))
}

/// Sums of `of_units` over each cluster.
fn clusters(bench: &Bench<'_>, of_units: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0; bench.parts.cluster.iter().max().map_or(0, |last| last + 1)];
    bench.parts.cluster.iter().zip(of_units).for_each(|(cluster, x)| sums[*cluster] += x);
    sums
}

/// Standard error of the sum of `values`.
fn error_of_sum(values: &[f64]) -> f64 {
    let sd = standard_deviation(values);
    if sd.is_finite() { sd * (values.len() as f64).sqrt() } else { 0.0 }
}

/// Whether a fit with one cause more changes enough, and surely enough, for it to be named.
fn is_material(bench: &Bench<'_>, with: &Fit, without: &Fit, start: f64, is_first: bool) -> bool {
    let floor_square = bench.floor_nm * bench.floor_nm;
    let now = score(bench, without);
    let gain = now - score(bench, with);
    let gap = (now - floor_square).max(0.0);
    let whole = start - floor_square;
    let enough = match is_first {
        true => gain >= GAP_SHARE_FIRST * gap,
        false => gain >= GAP_SHARE_MORE * gap && gain >= WHOLE_SHARE_MORE * whole || gain >= WHOLE_SHARE_ALONE * whole,
    };
    enough && gain >= FLOOR_SHARE * FLOOR_SHARE * floor_square && is_sure(bench, &without.held_out, &with.held_out)
}

/// Whether the squares left fall from `before` to `after` by more than chance between clusters: by several standard errors, or,
/// where only a few clusters show the cause, with hardly any that it harms.
fn is_sure(bench: &Bench<'_>, before: &[f64], after: &[f64]) -> bool {
    let gains = clusters(bench, before.iter().zip(after).map(|(b, a)| b - a));
    let won: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    let lost: f64 = -gains.iter().filter(|g| **g < 0.0).sum::<f64>();
    won - lost > ERRORS * error_of_sum(&gains) || lost < LOST_SHARE * won
}

/// Causes other than `taken` that do as well with no more numbers; one that a spring over a short way is mistaken for may have
/// one less.
fn rivals(bench: &Bench<'_>, taken: &Tried, tried: &[Tried], start: f64) -> Vec<Cause> {
    let spare = |cause: Cause| {
        usize::from(taken.cause == Cause::Effect("gravity_phase") && cause == Cause::Effect("elastic_spring"))
    };
    let mut found: Vec<Cause> = Vec::new();
    for other in tried.iter().filter(|other| other.cause != taken.cause && is_tie(bench, taken, other, start)) {
        if other.count() <= taken.count() + spare(other.cause) && !found.contains(&other.cause) {
            found.push(other.cause);
        }
    }
    found
}
/// Causes that `taken` is known to be mistaken for and that do as well: only their numbers speak against them.
fn seconds(bench: &Bench<'_>, taken: &Tried, tried: &[Tried], start: f64) -> Vec<Cause> {
    let known = rivals(bench, taken, tried, start);
    let mut found: Vec<Cause> = Vec::new();
    for other in tried.iter().filter(|other| other.cause != taken.cause && is_tie(bench, taken, other, start)) {
        let is_new = !known.contains(&other.cause) && !found.contains(&other.cause);
        if is_new && (names(taken.cause, other.cause) || names(other.cause, taken.cause)) {
            found.push(other.cause);
        }
    }
    found
}

/// Whether `cause`, an effect, says that it can be mistaken for `other`.
fn names(cause: Cause, other: Cause) -> bool {
    match cause {
        Cause::Effect(id) => find(id).is_some_and(|effect| effect.about().trades_with.contains(&other.name())),
        Cause::Stale(_) => false,
    }
}
