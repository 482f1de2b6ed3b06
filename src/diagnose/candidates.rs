//! Every cause that the library and the model offer, fitted on one ground.

use super::fit::{Bench, Fit, Ground};
use super::moves::{Knob, Move, Stale, of_effect, stale};
use super::ripple;
use super::weigh::is_tie;
use crate::effects::{Added, Effect, LIBRARY, find};
use crate::model::{Combination, Model};
use rayon::prelude::*;

/// Starts of one effect that are fitted in full, the most promising first.
const STARTS: usize = 2;
/// Effects that are fitted in full: those that do best at their starts.
const FITTED: usize = 7;

/// Why a model differs from the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Cause {
    /// An effect of the library, by its id.
    Effect(&'static str),
    /// A group of the model's own parameters, by name.
    Stale(&'static str),
}

impl Cause {
    /// Its name in a verdict.
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect(name) | Self::Stale(name) => name,
        }
    }
}

/// A cause fitted.
#[derive(Debug, Clone)]
pub struct Tried {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    /// The fit.
    pub fit: Fit,
}

impl Tried {
    /// It as it was found.
    pub fn sketch(&self) -> Option<Sketch> {
        Sketch::of((self.cause, self.how), &self.fit.model, &self.fit.moves)
    }

    /// Numbers that were fitted, less what it counts for that the joint confirms some.
    pub fn count(&self, bench: &Bench<'_>) -> usize {
        let effect = match self.cause {
            // To a model that passes over its clearance already, how wide that is would be no news.
            Cause::Effect(id) if self.fit.model.combination == Combination::Sign => {
                self.fit.model.effects.iter().rev().find(|added| added.id() == id)
            }
            _ => None,
        };
        let confirmed = effect.map_or(0, |added| added.effect.confirmed(&added.parameters, &bench.extent));
        self.fit.moves.len().saturating_sub(confirmed)
    }

    /// Mean square left on units that were held out, with what the base's moves cost, (N m)^2.
    pub fn score(&self, bench: &Bench<'_>) -> f64 {
        score(bench, &self.fit)
    }
}

/// A cause as it was found: what can be put into a model beside others.
#[derive(Debug, Clone)]
pub struct Sketch {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    change: Change,
}

#[derive(Debug, Clone)]
enum Change {
    Effect(Added),
    Own(Vec<Move>, Vec<(Knob, f64)>),
}

impl Sketch {
    /// `cause` as it stands in `model`; of the model's own parameters those that `moves` turn.
    pub fn of((cause, how): (Cause, &'static str), model: &Model, moves: &[Move]) -> Option<Self> {
        let change = match cause {
            Cause::Effect(id) => Change::Effect(model.effects.iter().rev().find(|added| added.id() == id)?.clone()),
            Cause::Stale(_) => {
                let own: Vec<Move> = moves.iter().filter(|way| way.is_own()).cloned().collect();
                let values = own.iter().flat_map(Move::knobs).map(|knob| (knob, knob.value(model))).collect();
                Change::Own(own, values)
            }
        };
        Some(Self { cause, how, change })
    }

    /// What of the model's own parameters it turns.
    pub fn moves(&self) -> &[Move] {
        match &self.change {
            Change::Effect(_) => &[],
            Change::Own(moves, _) => moves,
        }
    }

    /// Puts it into `model`; returns what may move of it there.
    pub fn put(&self, model: &mut Model, bench: &Bench<'_>) -> Vec<Move> {
        match &self.change {
            Change::Effect(added) => {
                model.effects.push(added.clone());
                of_effect(model, model.effects.len() - 1, &bench.extent)
            }
            Change::Own(moves, values) => {
                values.iter().for_each(|(knob, value)| knob.set(model, *value));
                moves.clone()
            }
        }
    }
}

/// Everything that was tried in one place.
#[derive(Debug, Clone, Default)]
pub struct Round {
    /// What was fitted, best first.
    pub tried: Vec<Tried>,
    /// All of it, and what showed too little promise alone to be fitted.
    pub sketches: Vec<Sketch>,
}

/// Mean square left on held-out units plus the cost of the base's moves, (N m)^2.
pub fn score(bench: &Bench<'_>, fit: &Fit) -> f64 {
    bench.surprise_factor(fit) * fit.held_out.iter().sum::<f64>() / bench.rows().max(1) as f64
}

/// All causes but those that `ground` has already, each at its best; effects without promise are only sketched.
pub fn try_all(bench: &Bench<'_>, ground: &Ground, known: &[Cause]) -> Round {
    let residual_nm = bench.rest_residual_nm(ground);
    let effects = LIBRARY.into_par_iter().filter(|effect| !known.contains(&Cause::Effect(effect.about().id)));
    let mut begun: Vec<Begun> = effects.filter_map(|effect| begin(bench, ground, effect, &residual_nm)).collect();
    begun.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    let mut sketches: Vec<Sketch> = begun.iter().flat_map(Begun::sketches).collect();
    let mut place = 0..;
    begun.retain(|begun| place.next() < Some(FITTED) || begun.is_shape());
    let groups: Vec<Stale> =
        stale(&ground.model).into_iter().filter(|group| !known.contains(&Cause::Stale(group.name))).collect();
    let of_groups = groups.into_par_iter().map(|group| of_group(bench, ground, group));
    let of_effects = begun.into_par_iter().filter_map(|begun| begun.fit(bench, ground));
    let mut tried: Vec<Tried> = of_effects.chain(of_groups).collect();
    tried.sort_by(|a, b| a.score(bench).total_cmp(&b.score(bench)));
    sketches.extend(tried.iter().filter_map(Tried::sketch));
    Round { tried, sketches }
}

/// `cause` alone beside `ground`, from every start; none where it cannot be what it is called.
pub fn try_one(bench: &Bench<'_>, ground: &Ground, cause: Cause) -> Option<Tried> {
    match cause {
        Cause::Effect(id) => begin(bench, ground, find(id)?, &bench.rest_residual_nm(ground))?.fit(bench, ground),
        Cause::Stale(name) => {
            let groups = stale(&ground.model).into_par_iter().filter(|group| group.name == name);
            let tried = groups.map(|group| of_group(bench, ground, group));
            tried.min_by(|a, b| a.score(bench).total_cmp(&b.score(bench)))
        }
    }
}

fn of_group(bench: &Bench<'_>, ground: &Ground, group: Stale) -> Tried {
    let fit = bench.fit(ground, ground.model.clone(), group.moves);
    Tried { cause: Cause::Stale(group.name), how: group.how, fit }
}

/// Whether `effect` is one that `model` could lack.
fn can_be(model: &Model, effect: &dyn Effect) -> bool {
    match effect.about().id {
        "reversal_transition" => matches!(model.combination, Combination::Sign | Combination::Linear),
        "inertia" => model.chain.is_none() && model.dynamics.inertia_kg_m2 == 0.0,
        _ => true,
    }
}

/// An effect at the starts from which it is to be fitted, the most promising first; never empty.
struct Begun {
    effect: &'static dyn Effect,
    starts: Vec<(f64, Model, Vec<Move>)>,
}

impl Begun {
    fn cost(&self) -> f64 {
        self.starts[0].0
    }

    /// Whether it has no strength that a start could find at once.
    fn is_shape(&self) -> bool {
        self.starts[0].2.iter().all(|way| !way.is_linear)
    }

    fn cause(&self) -> (Cause, &'static str) {
        (Cause::Effect(self.effect.about().id), "")
    }

    fn sketches(&self) -> impl Iterator<Item = Sketch> {
        self.starts.iter().filter_map(|(_, model, moves)| Sketch::of(self.cause(), model, moves))
    }

    fn fit(self, bench: &Bench<'_>, ground: &Ground) -> Option<Tried> {
        let (cause, how) = self.cause();
        let fits = self.starts.into_par_iter().map(|(_, model, moves)| bench.fit(ground, model, moves));
        let fits: Vec<Fit> = fits.filter(|fit| fit.is_sound(&bench.extent)).collect();
        let best = fits.iter().min_by(|a, b| score(bench, a).total_cmp(&score(bench, b)))?;
        // A form with more numbers must do better by them.
        let equal = |fit: &&Fit| is_tie(bench, best, fit, score(bench, best));
        let by_count = |a: &&Fit, b: &&Fit| a.moves.len().cmp(&b.moves.len());
        let by_score = |a: &&Fit, b: &&Fit| score(bench, a).total_cmp(&score(bench, b));
        let fit = fits.iter().filter(equal).min_by(|a, b| by_count(a, b).then(by_score(a, b))).unwrap_or(best).clone();
        Some(Tried { cause, how, fit })
    }
}

/// `effect` at its most promising starts beside the ground.
fn begin(bench: &Bench<'_>, ground: &Ground, effect: &'static dyn Effect, residual_nm: &[f64]) -> Option<Begun> {
    if !can_be(&ground.model, effect) {
        return None;
    }
    let at = ground.model.effects.len();
    let starts = match effect.about().id {
        id @ ("friction_ripple" | "torque_ripple") => {
            ripple::starts(bench, ground, residual_nm, id == "friction_ripple")
        }
        "saturation" => saturation_starts(bench, effect),
        _ => effect.starts(&bench.extent),
    };
    let glance = |parameters: Vec<f64>| {
        let mut model = ground.model.clone();
        model.effects.push(Added { effect, parameters });
        let moves = of_effect(&model, at, &bench.extent);
        let linear: Vec<Move> = moves.iter().filter(|way| way.is_linear).cloned().collect();
        let (cost, x) = bench.glance(ground, &model, &linear);
        linear.iter().zip(&x).for_each(|(way, x)| way.apply(&mut model, *x));
        (cost, model, moves)
    };
    let mut starts: Vec<(f64, Model, Vec<Move>)> = starts.into_par_iter().map(glance).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_linear = starts.first()?.2.iter().all(|way| way.is_linear);
    let followed = match effect.about().id {
        // Their starts are no guesses at one form, they are forms.
        "sensor_drift" | "time_delay" | "elastic_spring" | "gravity_phase" => starts.len(),
        id if is_linear || id.ends_with("ripple") => 1,
        _ => STARTS,
    };
    starts.truncate(followed);
    Some(Begun { effect, starts })
}

/// The levels at which readings pile up, where they do, beside those that are always tried.
fn saturation_starts(bench: &Bench<'_>, effect: &dyn Effect) -> Vec<Vec<f64>> {
    let mut starts = effect.starts(&bench.extent);
    let levels = bench.records.all.iter().filter_map(|record| record.clip_levels_nm);
    if let Some((low, high)) = levels.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
        let (least, most) = bench.extent.torque_nm;
        // One level: it is the end of the range that is nearer.
        starts.push(match low == high {
            true if (high - most).abs() < (low - least).abs() => vec![2.0 * least - most, high],
            true => vec![low, 2.0 * most - least],
            false => vec![low, high],
        });
    }
    starts
}
