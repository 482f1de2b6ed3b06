//! Every cause that the library and the model offer, fitted on one base.

use super::base::BaseModel;
use super::compare::is_tie;
use super::data::DataSet;
use super::fit::Fit;
use super::parameter_ref::ParameterRef;
use super::perturbation::{Perturbation, of_effect};
use super::progress::{Listener, Progress};
use super::ripple;
use super::stale::{Stale, named, stale};
use crate::effects::{Added, Effect, Extent, LIBRARY, Role, Starts, find};
use crate::model::{Combination, Model};
use rayon::prelude::*;

/// Starts of one effect that are fitted in full, the most promising first; beside other causes, where its shape is known from the first round,
/// one.
const STARTS: usize = 2;
/// Of the starts in one form so many, those that promised most beside the base alone, are looked at again beside other causes: which
/// shapes are at all likely hardly changes.
const KEPT: usize = 2;
/// Effects that are fitted in full: those that do best at their starts.
const FITTED: usize = 7;
/// What would not come within this share of the gain of the best start is not followed to its end: what ties is far nearer.
const REACH: f64 = 0.3;

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
pub struct FittedCause<'d> {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    /// The fit.
    pub fit: Fit<'d>,
}

impl FittedCause<'_> {
    /// Whether it is the same cause in the same way.
    pub fn is(&self, other: &Self) -> bool {
        (self.cause, self.how) == (other.cause, other.how)
    }

    /// It as it was found.
    pub fn hypothesis(&self) -> Option<Hypothesis> {
        Hypothesis::of((self.cause, self.how), &self.fit.model, &self.fit.moves)
    }

    /// The effect as it was found.
    fn added(&self) -> Option<&Added> {
        self.fit.model.effects.iter().rev().find(|added| Cause::Effect(added.id()) == self.cause)
    }

    /// Whether it agrees with its name, whatever stands beside it.
    pub fn is_itself(&self) -> bool {
        let extent = &self.fit.mask.data.extent;
        self.added().is_none_or(|added| added.effect.is_itself(&added.parameters, extent))
    }

    /// Numbers that were fitted, less what it counts for that the joint confirms some.
    pub fn count(&self) -> usize {
        let effect = match self.cause {
            // To a model that passes over its clearance already, how wide that is would be no news.
            Cause::Effect(_) if self.fit.model.combination == Combination::Sign => self.added(),
            _ => None,
        };
        let confirmed = effect.map_or(0, |added| added.effect.confirmed(&added.parameters, &self.fit.mask.data.extent));
        self.fit.moves.len().saturating_sub(confirmed)
    }

    /// Whether the joint confirms some of its numbers.
    pub fn is_confirmed(&self) -> bool {
        self.count() < self.fit.moves.len()
    }

    /// Whether the effect's numbers suit one that is alike as well.
    pub fn suits_its_like(&self) -> bool {
        self.added().is_some_and(|added| added.effect.suits_its_like(&added.parameters))
    }

    /// Mean square left on units that were held out, with what the base's moves cost, (N m)^2.
    pub fn score(&self) -> f64 {
        self.fit.score()
    }
}

/// A cause as it was found: what can be put into a model beside others.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    change: Change,
}

#[derive(Debug, Clone)]
enum Change {
    Effect(Added),
    Own(Vec<Perturbation>, Vec<(ParameterRef, f64)>),
}

impl Hypothesis {
    /// `cause` as it stands in `model`; of the model's own parameters those that `moves` turn.
    pub fn of((cause, how): (Cause, &'static str), model: &Model, moves: &[Perturbation]) -> Option<Self> {
        let change = match cause {
            Cause::Effect(id) => Change::Effect(model.effects.iter().rev().find(|added| added.id() == id)?.clone()),
            Cause::Stale(_) => {
                let own: Vec<Perturbation> = moves.iter().filter(|way| way.is_own()).cloned().collect();
                let values = own
                    .iter()
                    .flat_map(Perturbation::parameters)
                    .map(|parameter| (parameter, parameter.value(model)))
                    .collect();
                Change::Own(own, values)
            }
        };
        Some(Self { cause, how, change })
    }

    /// What of the model's own parameters it turns.
    pub fn moves(&self) -> &[Perturbation] {
        match &self.change {
            Change::Effect(_) => &[],
            Change::Own(moves, _) => moves,
        }
    }

    /// Puts it into `model`; returns what may move of it there.
    pub fn put(&self, model: &mut Model, extent: &Extent) -> Vec<Perturbation> {
        match &self.change {
            Change::Effect(added) => {
                model.effects.push(added.clone());
                of_effect(model, model.effects.len() - 1, extent)
            }
            Change::Own(moves, values) => {
                values.iter().for_each(|(parameter, value)| parameter.set(model, *value));
                moves.clone()
            }
        }
    }
}

/// Everything that was tried in one place.
#[derive(Debug, Clone, Default)]
pub struct Round<'d> {
    /// What was fitted, best first.
    pub tried: Vec<FittedCause<'d>>,
    /// All of it, and what showed too little promise alone to be fitted.
    pub hypotheses: Vec<Hypothesis>,
    /// Where to look for each effect's shape beside other causes.
    pub likely: Likely,
}

/// Of effects whose shape was searched over all that a campaign shows: where it is likely to be.
pub type Likely = Vec<(&'static str, Vec<Vec<f64>>)>;

/// Causes as they stand, with their fit.
pub type Set<'d> = (Vec<Hypothesis>, Fit<'d>);

/// Which causes `set` has, in order.
pub fn names(set: &[Hypothesis]) -> Vec<Cause> {
    let mut names: Vec<Cause> = set.iter().map(|hypothesis| hypothesis.cause).collect();
    names.sort_unstable();
    names
}

/// All causes that are `wanted` and that `base` has not got already, each at its best; effects without promise are only sketched, and what comes
/// nowhere near the best start, or the score known to be `reached`, (N m)^2, is not followed to its end. Shapes are looked for where they are
/// `likely`, else everywhere.
pub fn try_all<'d>(
    base: &BaseModel<'d>,
    wanted: impl Fn(Cause) -> bool + Sync + Send,
    likely: &Likely,
    reached: f64,
    listener: Listener<'_>,
) -> Round<'d> {
    let residual_nm = base.residual_nm();
    let is_wanted = |effect: &&'static dyn Effect| wanted(Cause::Effect(effect.about().id));
    let effects: Vec<&'static dyn Effect> = LIBRARY.into_iter().filter(is_wanted).collect();
    listener(Progress::Ahead(effects.len()));
    let sketched = |effect: &'static dyn Effect| {
        let initialised = begin(base, effect, likely, &residual_nm);
        listener(Progress::Done(effect.about().id));
        initialised
    };
    let mut initialised: Vec<Initialised> = effects.into_par_iter().filter_map(sketched).collect();
    initialised.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    let mut hypotheses: Vec<Hypothesis> = initialised.iter().flat_map(Initialised::hypotheses).collect();
    let shapes = initialised.iter_mut().filter(|initialised| initialised.effect.about().starts == Starts::Shapes);
    let mut likely: Likely =
        shapes.map(|shape| (shape.effect.about().id, std::mem::take(&mut shape.promising))).collect();
    let mut place = 0..;
    initialised.retain(|initialised| place.next() < Some(FITTED) || initialised.is_shape());
    let reach = initialised.first().map_or(f64::INFINITY, |best| reach(alone(base), best.cost().min(reached)));
    let groups: Vec<Stale> =
        stale(&base.model, &base.data().extent).into_iter().filter(|group| wanted(Cause::Stale(group.name))).collect();
    listener(Progress::Ahead(groups.len() + initialised.len()));
    let told = |tried: FittedCause<'d>| {
        listener(Progress::Done(tried.cause.name()));
        tried
    };
    let of_groups = groups.into_par_iter().map(|group| of_group(base, group));
    // Only its fit says which group a whole line of friction belongs to.
    let of_groups = of_groups.filter(|tried| wanted(tried.cause));
    let of_effects = initialised.into_par_iter().filter_map(|initialised| initialised.fit(base, reach));
    let mut tried: Vec<FittedCause<'d>> = of_effects.chain(of_groups).map(told).collect();
    tried.sort_by(|a, b| a.score().total_cmp(&b.score()));
    hypotheses.extend(tried.iter().filter_map(FittedCause::hypothesis));
    for (id, promising) in &mut likely {
        let fitted = tried.iter().find(|tried| tried.cause == Cause::Effect(id)).and_then(FittedCause::added);
        promising.extend(fitted.map(|added| added.parameters.clone()));
    }
    Round { tried, hypotheses, likely }
}

/// `cause` alone beside `base`, its shape looked for where that is `likely`; none where it cannot be what it is called.
pub fn try_one<'d>(base: &BaseModel<'d>, cause: Cause, likely: &Likely) -> Option<FittedCause<'d>> {
    match cause {
        Cause::Effect(id) => begin(base, find(id)?, likely, &base.residual_nm())?.fit(base, f64::INFINITY),
        Cause::Stale(name) => {
            let groups = stale(&base.model, &base.data().extent).into_par_iter().filter(|group| group.name == name);
            let tried = groups.map(|group| of_group(base, group));
            tried.min_by(|a, b| a.score().total_cmp(&b.score()))
        }
    }
}

fn of_group<'d>(base: &BaseModel<'d>, group: Stale) -> FittedCause<'d> {
    let fit = base.fit(base.model.clone(), group.moves.clone());
    let name = named(&group, (&base.model, &fit.model), &base.data().extent);
    FittedCause { cause: Cause::Stale(name), how: group.how, fit }
}

/// An effect at the starts from which it is to be fitted, the most promising first; never empty.
struct Initialised {
    effect: &'static dyn Effect,
    starts: Vec<(f64, Model, Vec<Perturbation>)>,
    /// The starts themselves, the most promising.
    promising: Vec<Vec<f64>>,
}

impl Initialised {
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

    fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        self.starts.iter().filter_map(|(_, model, moves)| Hypothesis::of(self.cause(), model, moves))
    }

    fn fit<'d>(self, base: &BaseModel<'d>, reach: f64) -> Option<FittedCause<'d>> {
        let (cause, how) = self.cause();
        let fits = self.starts.into_par_iter().map(|(_, model, moves)| base.fit_to_reach(reach, model, moves));
        let fits: Vec<Fit<'d>> = fits.filter(|fit| fit.is_sound()).collect();
        let best = fits.iter().min_by(|a, b| a.score().total_cmp(&b.score()))?;
        // A form with more numbers must do better by them.
        let equal = |fit: &&Fit| is_tie(best, fit, best.score());
        let by_count = |a: &&Fit, b: &&Fit| a.moves.len().cmp(&b.moves.len());
        let by_score = |a: &&Fit, b: &&Fit| a.score().total_cmp(&b.score());
        let fit = fits.iter().filter(equal).min_by(|a, b| by_count(a, b).then(by_score(a, b))).unwrap_or(best).clone();
        Some(FittedCause { cause, how, fit })
    }
}

/// `effect` at its most promising starts beside the base.
fn begin(
    base: &BaseModel<'_>,
    effect: &'static dyn Effect,
    likely: &Likely,
    residual_nm: &[f64],
) -> Option<Initialised> {
    let at = base.model.effects.len();
    let known = likely.iter().find(|(id, _)| *id == effect.about().id);
    let starts = match (effect.about().starts, known) {
        (Starts::Shapes, Some((_, likely))) => likely.clone(),
        (Starts::PositionLines { by_direction }, _) => {
            let forms = effect.starts(&base.data().extent);
            let lines = ripple::lines(base, residual_nm, by_direction).into_iter();
            lines.flat_map(|periods| forms.iter().map(move |form| [&[periods], &form[1..]].concat())).collect()
        }
        (Starts::ClipLevels, _) => saturation_starts(base.data(), effect),
        (Starts::Shapes | Starts::Forms | Starts::Events, _) => effect.starts(&base.data().extent),
    };
    let linearised_cost = |parameters: Vec<f64>| {
        let mut model = base.model.clone();
        let added = Added { effect, parameters };
        model.effects.push(added.clone());
        let moves = of_effect(&model, at, &base.data().extent);
        let linear: Vec<Perturbation> = moves.iter().filter(|way| way.is_linear).cloned().collect();
        let (cost, x) = base.linearised_cost(&model, &added, &linear);
        linear.iter().zip(&x).for_each(|(way, x)| way.apply(&mut model, *x));
        ((cost, model, moves), added.parameters)
    };
    let mut starts: Vec<_> = starts.into_par_iter().map(linearised_cost).collect();
    starts.sort_by(|((a, ..), _), ((b, ..), _)| a.total_cmp(b));
    let (mut starts, all): (Vec<_>, Vec<Vec<f64>>) = starts.into_iter().unzip();
    let in_same_form = |a: &[f64], b: &[f64]| {
        let parameters = effect.about().parameters.iter().zip(a.iter().zip(b));
        parameters
            .filter(|(parameter, _)| matches!(parameter.role, Role::Form | Role::Choice))
            .all(|(_, (a, b))| a == b)
    };
    let is_kept = |at: &usize| all[..*at].iter().filter(|better| in_same_form(better, &all[*at])).count() < KEPT;
    let promising = (0..all.len()).filter(is_kept).map(|at| all[at].clone()).collect();
    let is_linear = starts.first()?.2.iter().all(|way| way.is_linear);
    let reach = reach(alone(base), starts[0].0);
    let has_prospect = |(cost, ..): &(f64, Model, Vec<Perturbation>)| *cost <= reach;
    let followed = match effect.about().starts {
        Starts::Forms => starts.partition_point(has_prospect).max(1),
        Starts::PositionLines { .. } => 1,
        _ if is_linear || known.is_some() => 1,
        _ => STARTS,
    };
    // A form with fewer numbers comes behind in any fit to all rows, and may be ahead on those that a fit does not see.
    let fewest = starts.iter().take(followed).map(|(.., moves)| moves.len()).min()?;
    let others = starts.split_off(followed.min(starts.len()));
    starts.extend(others.into_iter().take_while(has_prospect).find(|(.., moves)| moves.len() < fewest));
    Some(Initialised { effect, starts, promising })
}

/// The cost or score from which on something has no prospect beside what comes to `best` where `alone` is left without any, (N m)^2.
pub fn reach(alone: f64, best: f64) -> f64 {
    best + REACH * (alone - best).max(0.0)
}

/// What `base` leaves alone, as a cost.
fn alone(base: &BaseModel<'_>) -> f64 {
    base.cost_beside(&[], &base.predicted_nm).0
}

/// The levels at which readings pile up, where they do, beside those that are always tried.
fn saturation_starts(data: &DataSet, effect: &dyn Effect) -> Vec<Vec<f64>> {
    let mut starts = effect.starts(&data.extent);
    let levels = data.records.all.iter().filter_map(|record| record.clip_levels_nm);
    if let Some((low, high)) = levels.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
        let (least, most) = data.extent.torque_nm;
        // One level: it is the end of the range that is nearer.
        starts.push(match low == high {
            true if (high - most).abs() < (low - least).abs() => vec![2.0 * least - most, high],
            true => vec![low, 2.0 * most - least],
            false => vec![low, high],
        });
    }
    starts
}
