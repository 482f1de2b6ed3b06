//! K~ along a whole recorded motion: what depends on the motion alone is worked out once, then any model's K~ follows stroke by
//! stroke. Beyond the end of a transition nothing is evaluated, and within it only as often as its curve bends.

use super::{Combination, Direction, Model, on_the_way};
use crate::effects::{Evaluated, Presliding};
use crate::numerics::scalar::Scalar;
use std::ops::Range;

/// Samples over which a transition is first taken as two straight lines ...
const SPAN: usize = 16;
/// ... if it is as near to them as this, as a share of the way between both branches; else it is looked at more closely. Friction is
/// known to 1e-3 of itself at best.
const STRAIGHT: f64 = 2e-5;
/// See [`between`], as shares of the travel.
const MIDWAY: std::ops::RangeInclusive<f64> = 0.2..=0.8;

/// A recorded motion as friction follows it: cut where the joint turns, in each stroke onward only.
#[derive(Debug, Clone, Default)]
pub struct Strokes {
    /// Position at each sample, rad; the last one before the joint turns is where it turns.
    position_rad: Vec<f64>,
    strokes: Vec<Stroke>,
}

/// Motion in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its first sample, ...
    pub start: usize,
    /// ... and the one after its last.
    pub end: usize,
    /// Where the joint goes.
    pub direction: Direction,
    /// Where it comes from: where it turned, rad.
    pub from_rad: f64,
}

impl Stroke {
    /// How far it has come at `position_rad`, rad.
    fn onward_rad(&self, position_rad: f64) -> f64 {
        (position_rad - self.from_rad) * self.direction.sign()
    }
}

impl Strokes {
    /// Of `position_rad`; travel back of less than `deadband_rad` is no reversal. The joint turned where the position is furthest, not where
    /// that was noticed.
    pub fn new(position_rad: Vec<f64>, deadband_rad: f64) -> Self {
        let Some(first_rad) = position_rad.first().copied() else { return Self::default() };
        let turns = turns(&position_rad, deadband_rad);
        let alone = if position_rad[position_rad.len() - 1] < first_rad { Direction::Down } else { Direction::Up };
        let sets_out = turns.first().map_or(alone, |turn| turn.direction.opposite());
        let begins = Stroke { start: 0, end: 0, direction: sets_out, from_rad: first_rad };
        Self::of(position_rad, std::iter::once(begins).chain(turns).collect())
    }

    /// Of strokes whose ends are yet to be set.
    fn of(mut position_rad: Vec<f64>, mut strokes: Vec<Stroke>) -> Self {
        for at in 0..strokes.len() {
            let next = strokes.get(at + 1).copied();
            strokes[at].end = next.map_or(position_rad.len(), |next| next.start);
            let Stroke { start, end, direction, from_rad } = strokes[at];
            let mut furthest_rad = from_rad;
            for x in &mut position_rad[start..end] {
                if (*x - furthest_rad) * direction.sign() > 0.0 {
                    furthest_rad = *x;
                }
                *x = furthest_rad;
            }
            if let Some(next) = next {
                position_rad[end - 1] = next.from_rad;
            }
        }
        Self { position_rad, strokes }
    }

    /// Every `step`th sample, the joint turning where it did.
    pub fn thinned(&self, step: usize) -> Self {
        let mut kept: Vec<Stroke> = Vec::new();
        for stroke in &self.strokes {
            let start = stroke.start.div_ceil(step);
            // Motion back and forth between two samples does not show.
            if start < stroke.end.div_ceil(step) && kept.last().is_none_or(|last| last.direction != stroke.direction) {
                kept.push(Stroke { start, ..*stroke });
            }
        }
        Self::of(self.position_rad.iter().step_by(step).copied().collect(), kept)
    }

    /// Position at each sample, rad.
    pub fn position_rad(&self) -> &[f64] {
        &self.position_rad
    }

    /// All of them in order.
    pub fn all(&self) -> &[Stroke] {
        &self.strokes
    }

    /// Those that begin with a reversal.
    pub fn reversals(&self) -> &[Stroke] {
        self.strokes.get(1..).unwrap_or_default()
    }

    /// Where the joint is at the end of `stroke`, rad.
    fn to_rad(&self, stroke: &Stroke) -> f64 {
        self.position_rad[stroke.end - 1]
    }

    /// The direction in which K_f first saturates, from where its start no longer matters; `Up` if it never does.
    fn settled(&self, backlash_rad: f64) -> Direction {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let crosses = |stroke: &&Stroke| {
            let ends = [stroke.from_rad, self.to_rad(stroke)];
            low = ends.iter().copied().fold(low, f64::min);
            high = ends.iter().copied().fold(high, f64::max);
            high - low >= backlash_rad
        };
        self.strokes.iter().find(crosses).map_or(Direction::Up, |stroke| stroke.direction)
    }
}

/// Tells `then` what `of` the travel comes to at each of `rows` of a stroke, `way_rad` on its way, along which it is smooth.
fn along<S: Scalar>(
    way_rad: &impl Fn(usize) -> f64,
    rows: Range<usize>,
    of: &impl Fn(f64) -> S,
    then: &mut impl FnMut(Range<usize>, S),
) {
    let Some(last) = rows.end.checked_sub(1).filter(|last| *last >= rows.start) else { return };
    let mut from = (rows.start, of(way_rad(rows.start)));
    then(rows.start..rows.start + 1, from.1);
    while from.0 < last {
        let to = (from.0 + SPAN).min(last);
        let to = (to, of(way_rad(to)));
        between(way_rad, from, to, of, then);
        from = to;
    }
}

/// The samples after `from` up to `to`, where the values are known.
fn between<S: Scalar>(
    way_rad: &impl Fn(usize) -> f64,
    from: (usize, S),
    to: (usize, S),
    of: &impl Fn(f64) -> S,
    then: &mut impl FnMut(Range<usize>, S),
) {
    let middle = (from.0 + to.0) / 2;
    if middle == from.0 {
        return then(to.0..to.0 + 1, to.1);
    }
    let share = |from: usize, to: usize, at: usize| {
        let [from_rad, to_rad, at_rad] = [from, to, at].map(way_rad);
        if to_rad == from_rad { 0.0 } else { (at_rad - from_rad) / (to_rad - from_rad) }
    };
    let chord = |from: (usize, S), to: (usize, S), at: usize| from.1 + (to.1 - from.1) * share(from.0, to.0, at);
    let seen = (middle, of(way_rad(middle)));
    // The sample midway in time must be about midway in travel, or it says nothing about the longer part.
    let is_told = way_rad(from.0) == way_rad(to.0) || MIDWAY.contains(&share(from.0, to.0, middle));
    if !is_told || (seen.1 - chord(from, to, middle)).value().abs() > STRAIGHT {
        between(way_rad, from, seen, of, then);
        return between(way_rad, seen, to, of, then);
    }
    for (from, to) in [(from, seen), (seen, to)] {
        let [from_rad, to_rad] = [from.0, to.0].map(way_rad);
        let per_rad = if to_rad == from_rad { S::from(0.0) } else { (to.1 - from.1) / (to_rad - from_rad) };
        let rows = from.0 + 1..=to.0;
        rows.for_each(|at| then(at..at + 1, from.1 + per_rad * (way_rad(at) - from_rad)));
    }
}

impl<S: Evaluated> Model<S> {
    /// K~ along `motion`: calls `then` for all samples in order, many at a time where it is constant. It agrees with [`super::Passage`],
    /// sample by sample, to within 1e-4.
    pub fn k_tilde_along(&self, motion: &Strokes, mut then: impl FnMut(Range<usize>, S)) {
        let backlash_rad = self.backlash_m() / self.joint.pulley_radius_m;
        let (added, presliding) = (self.added_curve(), self.presliding());
        let jumps = added.is_none() && matches!(self.combination, Combination::Sign);
        let share = |u: S| added.map_or_else(|| self.combination.share(u), |curve| curve.share(u));
        let mut k_f = S::from(motion.settled(backlash_rad.value()).sign());
        let mut k_tilde = (k_f + 1.0) / 2.0;
        let mut bent = Bent { k_tilde, at_rad: 0.0 };
        for stroke in &motion.strokes {
            let (rows, start) = (stroke.start..stroke.end, (k_f, k_tilde));
            let end = S::from(stroke.direction.sign());
            let arrived = (end + 1.0) / 2.0;
            let whole = (end - start.0).abs();
            let crossed_rad = if jumps { S::from(0.0) } else { backlash_rad * whole / 2.0 };
            let is_passing = |onward_rad: f64| onward_rad < crossed_rad.value();
            let positions_rad = &motion.position_rad[rows.clone()];
            let passes = positions_rad.partition_point(|x| is_passing(stroke.onward_rad(*x)));
            let (passing, settled) = (rows.start..rows.start + passes, rows.start + passes..rows.end);
            let done = |onward_rad: f64| S::from(onward_rad) / crossed_rad;
            let on_curve = |onward_rad: f64| on_the_way(start.1, share(done(onward_rad)), end);
            let onward_rad = |row: usize| stroke.onward_rad(motion.position_rad[row]);
            let in_all_rad = stroke.onward_rad(motion.to_rad(stroke));
            match &presliding {
                None => {
                    along(&onward_rad, passing, &on_curve, &mut then);
                    if !settled.is_empty() {
                        then(settled, arrived);
                    }
                }
                Some(presliding) => {
                    bent.at_rad = 0.0;
                    for at in passing {
                        bent.follow(presliding, on_curve(onward_rad(at)), onward_rad(at));
                        then(at..at + 1, bent.k_tilde);
                    }
                    match is_passing(in_all_rad) {
                        true => bent.follow(presliding, on_curve(in_all_rad), in_all_rad),
                        false => bent.settle(presliding, arrived, (&onward_rad, in_all_rad), settled, &mut then),
                    }
                }
            }
            (k_f, k_tilde) = match is_passing(in_all_rad) {
                true => (start.0 + end * whole * done(in_all_rad), on_curve(in_all_rad)),
                false => (end, arrived),
            };
        }
    }
}

/// Friction that follows its branch elastically.
struct Bent<S> {
    k_tilde: S,
    /// Travel in the stroke so far, rad.
    at_rad: f64,
}

impl<S: Scalar> Bent<S> {
    /// On to a travel of `to_rad`, the branch at `target` there.
    fn follow(&mut self, presliding: &Presliding<S>, target: S, to_rad: f64) {
        let behind = self.k_tilde - target;
        let left = presliding.left(behind.abs(), S::from(to_rad - self.at_rad));
        *self = Self { k_tilde: if behind.value() < 0.0 { target - left } else { target + left }, at_rad: to_rad };
    }

    /// On through `rows`, over which the branch stays at `target`, to the end of a stroke that goes `in_all_rad`.
    fn settle(
        &mut self,
        presliding: &Presliding<S>,
        target: S,
        (onward_rad, in_all_rad): (&impl Fn(usize) -> f64, f64),
        rows: Range<usize>,
        then: &mut impl FnMut(Range<usize>, S),
    ) {
        let (behind, from_rad) = (self.k_tilde - target, self.at_rad);
        let left = presliding.relaxing(behind.abs());
        let k_tilde = |onward_rad: f64| {
            let left = left(S::from(onward_rad - from_rad));
            if behind.value() < 0.0 { target - left } else { target + left }
        };
        let has_arrived = |onward_rad: f64| Presliding::has_arrived(left(S::from(onward_rad - from_rad)));
        let arrives = match Presliding::has_arrived(behind.abs()) {
            true => rows.start,
            false => first_where(rows.clone(), |row| has_arrived(onward_rad(row))),
        };
        along(onward_rad, rows.start..arrives, &k_tilde, then);
        if arrives < rows.end {
            then(arrives..rows.end, target);
        }
        let is_there = arrives < rows.end || Presliding::has_arrived(behind.abs());
        *self = Self { k_tilde: if is_there { target } else { k_tilde(in_all_rad) }, at_rad: in_all_rad };
    }
}

/// The first of `rows` of which `holds`, which once it does holds for all that follow; their end if there is none.
fn first_where(rows: Range<usize>, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (rows.start, rows.end);
    while low < high {
        let middle = low.midpoint(high);
        if holds(middle) { high = middle } else { low = middle + 1 }
    }
    low
}

/// The strokes that begin where a joint at `position_rad` turns, travel back of less than `deadband_rad` aside.
fn turns(position_rad: &[f64], deadband_rad: f64) -> Vec<Stroke> {
    let Some(first_rad) = position_rad.first() else { return Vec::new() };
    let (mut furthest, mut furthest_rad, mut direction) = (0, *first_rad, None);
    let mut turns = Vec::new();
    for (i, x) in position_rad.iter().enumerate() {
        let away_rad = x - furthest_rad;
        match direction {
            Some(Direction::Up) if away_rad >= 0.0 => (furthest, furthest_rad) = (i, *x),
            Some(Direction::Down) if away_rad <= 0.0 => (furthest, furthest_rad) = (i, *x),
            _ if away_rad.abs() > deadband_rad => {
                let turned = if away_rad > 0.0 { Direction::Up } else { Direction::Down };
                if direction.is_some() {
                    turns.push(vertex(position_rad, furthest, turned));
                }
                direction = Some(turned);
                (furthest, furthest_rad) = (i, *x);
            }
            _ => {}
        }
    }
    turns
}

/// The stroke that begins about sample `at`, the furthest: on the parabola through it and its neighbours, between two samples. Where the
/// joint rested before it turned, at the rest.
fn vertex(position_rad: &[f64], at: usize, direction: Direction) -> Stroke {
    let here_rad = position_rad[at];
    let on_sample = Stroke { start: at + 1, end: at + 1, direction, from_rad: here_rad };
    let (Some(before), Some(after_rad)) = (at.checked_sub(1), position_rad.get(at + 1)) else { return on_sample };
    let before_rad = position_rad[before];
    let rested = before_rad == here_rad && before.checked_sub(1).is_none_or(|i| position_rad[i] == here_rad);
    let bend_rad = before_rad - 2.0 * here_rad + after_rad;
    if rested || bend_rad == 0.0 {
        return on_sample;
    }
    let late = 0.5 * (before_rad - after_rad) / bend_rad;
    let start = if late < 0.0 { at } else { at + 1 };
    Stroke { start, from_rad: here_rad - 0.25 * (before_rad - after_rad) * late, ..on_sample }
}

#[cfg(test)]
mod tests {
    use super::Strokes;
    use crate::effects::Added;
    use crate::model::{Combination, Model, Passage, settle};

    /// Back and forth in strokes of several lengths, read by an encoder with steps and a little noise.
    fn motion_rad() -> Vec<f64> {
        let position = |i: i32| {
            let t = f64::from(i) * 2e-3;
            let noise = 2e-4 * (f64::from(i) * 12.9898).sin();
            (((0.7 * t).sin() + 0.06 * (5.3 * t).sin() + noise) / 1e-3).round() * 1e-3
        };
        (0..20_000).map(position).collect()
    }

    #[test]
    fn k_tilde_stroke_by_stroke_is_that_of_one_sample_after_the_other() {
        let positions_rad = motion_rad();
        let deadband_rad = 1.5e-3;
        let motion = Strokes::new(positions_rad.clone(), deadband_rad);
        let (n, p) = (1.7, 3.0);
        let curves = [Combination::Sign, Combination::Linear, Combination::arctan(p), Combination::Power { n }];
        let effects = ["", "reversal_transition:backlash_m=0.002,p=0.4,n=0.6", "presliding:travel_rad=0.02,exponent=1"];
        let more = ["presliding:travel_rad=0.02,exponent=0.8", "presliding:travel_rad=0.02,exponent=1.4"];
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/davinci_l4/base_model.json");
        for curve in curves {
            for effect in effects.into_iter().chain(more) {
                for backlash_m in [0.0, 1e-3, 4e-2] {
                    let mut model = Model::read(file.as_ref()).unwrap();
                    (model.combination, model.joint.backlash_m) = (curve, backlash_m);
                    model.effects.extend((!effect.is_empty()).then(|| Added::parse(effect).unwrap()));
                    let backlash_rad = model.backlash_m() / model.joint.pulley_radius_m;
                    let (direction, known_from) = settle(motion.position_rad(), backlash_rad, 0.0);
                    let mut state = Passage::after(&model, direction, positions_rad[0], 0.0);
                    let one_by_one: Vec<f64> = motion.position_rad().iter().map(|x| state.step(*x)).collect();
                    let mut along = Vec::new();
                    model.k_tilde_along(&motion, |rows, k_tilde| {
                        assert_eq!(rows.start, along.len());
                        along.resize(rows.end, k_tilde);
                    });
                    assert_eq!(along.len(), positions_rad.len());
                    let after = known_from + 200;
                    for (i, (a, b)) in along.iter().zip(&one_by_one).enumerate().skip(after) {
                        assert!((a - b).abs() < 1e-4, "{curve:?} {effect} {backlash_m}: row {i}: {a}, {b}");
                    }
                }
            }
        }
    }
}
