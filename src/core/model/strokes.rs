//! K~ along a whole recorded motion: what depends on the motion alone is worked out once, then any model's K~ follows stroke by
//! stroke. Beyond the end of a transition nothing is evaluated, and within it only as often as its curve bends.

use super::directions::set_out;
use super::{Combination, Direction, Model, on_the_way};
use crate::effects::{Evaluated, Presliding};
use crate::numerics::scalar::Scalar;
use std::ops::Range;

/// Samples over which a transition is first taken as two straight lines ...
const SPAN: usize = 64;
/// ... if it is as near to one as this, as a share of the way between both branches; else it is looked at more closely. Two lines are four
/// times as near; friction is known to 1e-3 of itself at best.
const STRAIGHT: f64 = 1e-4;
/// See [`between`], as shares of the travel.
const MIDWAY: std::ops::RangeInclusive<f64> = 0.2..=0.8;

/// A recorded motion cut at its reversals.
#[derive(Debug, Clone)]
pub struct Strokes {
    strokes: Vec<Stroke>,
    /// How far the stroke has come at each sample since the joint turned, rad: moving back within the deadband does not count. Near the
    /// turn, where it matters, 24 bits are far below any encoder's step.
    onward_rad: Vec<f32>,
    /// Travel since the stroke before, forth and back, rad.
    travel_rad: Vec<f32>,
    /// Direction of the motion at each sample.
    moving: Vec<Direction>,
}

/// K~ along some samples: a straight line over the travel.
#[derive(Debug, Clone, Copy)]
pub struct Line<'m, S> {
    value: S,
    per_rad: S,
    /// Where it has that value, rad.
    at_rad: f64,
    /// The travel at each sample of the motion, rad; empty where K~ is constant.
    way_rad: &'m [f32],
}

impl<S: Scalar> Line<'_, S> {
    fn constant(value: S) -> Self {
        Self { value, per_rad: S::from(0.0), at_rad: 0.0, way_rad: &[] }
    }

    /// Its sum over `samples` of the motion, among those that it was given for.
    pub fn sum(&self, samples: Range<usize>) -> S {
        let sum = self.value * samples.len() as f64;
        match self.way_rad.get(samples) {
            Some(way_rad) => sum + self.per_rad * way_rad.iter().map(|rad| f64::from(*rad) - self.at_rad).sum::<f64>(),
            None => sum,
        }
    }
}

/// Motion in one direction.
#[derive(Debug, Clone)]
struct Stroke {
    rows: Range<usize>,
    direction: Direction,
    /// Where the joint turned, rad.
    from_rad: f64,
}

impl Strokes {
    /// Of `positions_rad`, where the joint is `moving`; travel back of less than `deadband_rad` is no reversal.
    pub fn new(positions_rad: &[f64], moving: Vec<Direction>, deadband_rad: f64) -> Self {
        let first_rad = positions_rad.first().copied().unwrap_or(0.0);
        let mut stroke = Stroke { rows: 0..0, direction: set_out(positions_rad, deadband_rad), from_rad: first_rad };
        let (mut strokes, mut at_rad, mut before_rad, mut sum_rad) = (Vec::new(), first_rad, first_rad, 0.0);
        let [mut onward_rad, mut travel_rad] = [(); 2].map(|()| Vec::with_capacity(positions_rad.len()));
        for (i, x) in positions_rad.iter().enumerate() {
            let further_rad = (x - at_rad) * stroke.direction.sign();
            if further_rad < -deadband_rad {
                let direction = if *x > at_rad { Direction::Up } else { Direction::Down };
                let next = Stroke { rows: i..i, direction, from_rad: at_rad };
                strokes.push(std::mem::replace(&mut stroke, next));
                (at_rad, sum_rad) = (*x, 0.0);
            } else if further_rad > 0.0 {
                at_rad = *x;
            }
            stroke.rows.end = i + 1;
            sum_rad += (x - before_rad).abs();
            before_rad = *x;
            onward_rad.push(((at_rad - stroke.from_rad) * stroke.direction.sign()) as f32);
            travel_rad.push(sum_rad as f32);
        }
        strokes.push(stroke);
        Self { strokes, onward_rad, travel_rad, moving }
    }

    /// Samples of the motion.
    pub fn samples(&self) -> usize {
        self.onward_rad.len()
    }

    /// The direction in which K_f first saturates, from where its start no longer matters; `Up` if it never does.
    fn settled(&self, backlash_rad: f64) -> Direction {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let crosses = |stroke: &&Stroke| {
            let onward_rad = f64::from(self.onward_rad[stroke.rows.end - 1]);
            let ends = [stroke.from_rad, stroke.from_rad + onward_rad * stroke.direction.sign()];
            low = ends.iter().copied().fold(low, f64::min);
            high = ends.iter().copied().fold(high, f64::max);
            high - low >= backlash_rad
        };
        let mut moved = self.strokes.iter().filter(|stroke| !stroke.rows.is_empty());
        moved.find(crosses).map_or(Direction::Up, |stroke| stroke.direction)
    }

    /// Tells `then` what `of` the travel comes to at each of `rows`, along which it is smooth.
    fn along<'m, S: Scalar>(
        way_rad: &'m [f32],
        rows: Range<usize>,
        of: &impl Fn(f64) -> S,
        then: &mut impl FnMut(Range<usize>, Line<'m, S>),
    ) {
        let Some(last) = rows.end.checked_sub(1).filter(|last| *last >= rows.start) else { return };
        let mut from = (rows.start, of(f64::from(way_rad[rows.start])));
        then(rows.start..rows.start + 1, Line::constant(from.1));
        while from.0 < last {
            let to = (from.0 + SPAN).min(last);
            let to = (to, of(f64::from(way_rad[to])));
            between(way_rad, from, to, of, then);
            from = to;
        }
    }
}

/// The samples after `from` up to `to`, where the values are known.
fn between<'m, S: Scalar>(
    way_rad: &'m [f32],
    from: (usize, S),
    to: (usize, S),
    of: &impl Fn(f64) -> S,
    then: &mut impl FnMut(Range<usize>, Line<'m, S>),
) {
    let middle = (from.0 + to.0) / 2;
    if middle == from.0 {
        return then(to.0..to.0 + 1, Line::constant(to.1));
    }
    let share = |from: usize, to: usize, at: usize| {
        let [from_rad, to_rad, at_rad] = [from, to, at].map(|i| f64::from(way_rad[i]));
        if to_rad == from_rad { 0.0 } else { (at_rad - from_rad) / (to_rad - from_rad) }
    };
    let chord = |from: (usize, S), to: (usize, S), at: usize| from.1 + (to.1 - from.1) * share(from.0, to.0, at);
    let seen = (middle, of(f64::from(way_rad[middle])));
    // The sample midway in time must be about midway in travel, or it says nothing about the longer part.
    let is_told = way_rad[from.0] == way_rad[to.0] || MIDWAY.contains(&share(from.0, to.0, middle));
    if !is_told || (seen.1 - chord(from, to, middle)).value().abs() > STRAIGHT {
        between(way_rad, from, seen, of, then);
        return between(way_rad, seen, to, of, then);
    }
    for (from, to) in [(from, seen), (seen, to)] {
        let [from_rad, to_rad] = [from.0, to.0].map(|i| f64::from(way_rad[i]));
        let per_rad = if to_rad == from_rad { S::from(0.0) } else { (to.1 - from.1) / (to_rad - from_rad) };
        then(from.0 + 1..to.0 + 1, Line { value: from.1, per_rad, at_rad: from_rad, way_rad });
    }
}

impl<S: Evaluated> Model<S> {
    /// K~ along `motion`: calls `then` for all samples in order, many at a time where it is straight over the travel. It agrees with
    /// [`super::Passage`], sample by sample, to within 1e-4.
    pub fn k_tilde_along<'m>(&self, motion: &'m Strokes, mut then: impl FnMut(Range<usize>, Line<'m, S>)) {
        let backlash_rad = self.backlash_m() / self.joint.pulley_radius_m;
        let (added, presliding) = (self.added_curve(), self.presliding());
        let jumps = added.is_none() && matches!(self.combination, Combination::Sign);
        let share = |u: S| added.map_or_else(|| self.combination.share(u), |curve| curve.share(u));
        let mut k_f = S::from(motion.settled(backlash_rad.value()).sign());
        let mut k_tilde = (k_f + 1.0) / 2.0;
        let mut bent = Bent { k_tilde, at_rad: 0.0 };
        for Stroke { rows, direction, .. } in &motion.strokes {
            let (start, sign) = ((k_f, k_tilde), direction.sign());
            let end = S::from(sign);
            let arrived = (end + 1.0) / 2.0;
            let whole = (end - start.0).abs();
            let crossed_rad = backlash_rad * whole / 2.0;
            let passed = |onward_rad: &f32| f64::from(*onward_rad) < crossed_rad.value();
            let passes = if jumps { 0 } else { motion.onward_rad[rows.clone()].partition_point(passed) };
            let passing = rows.start..rows.start + passes;
            let done = |onward_rad: f64| S::from(onward_rad) / crossed_rad;
            let on_curve = |onward_rad: f64| on_the_way(start.1, share(done(onward_rad)), end);
            let settled = passing.end..rows.end;
            match &presliding {
                None => {
                    Strokes::along(&motion.onward_rad, passing.clone(), &on_curve, &mut then);
                    match jumps {
                        true => motion.by_direction(settled.clone(), &mut then),
                        false if !settled.is_empty() => then(settled.clone(), Line::constant(arrived)),
                        false => (),
                    }
                }
                Some(presliding) => {
                    bent.at_rad = 0.0;
                    for at in passing.clone() {
                        let [onward_rad, to_rad] = [&motion.onward_rad, &motion.travel_rad].map(|of| f64::from(of[at]));
                        bent.follow(presliding, on_curve(onward_rad), to_rad);
                        then(at..at + 1, Line::constant(bent.k_tilde));
                    }
                    bent.settle(presliding, arrived, motion, settled.clone(), &mut then);
                }
            }
            (k_f, k_tilde) = match (settled.is_empty(), rows.end.checked_sub(1)) {
                (true, Some(last)) => {
                    let onward_rad = f64::from(motion.onward_rad[last]);
                    (start.0 + end * whole * done(onward_rad), on_curve(onward_rad))
                }
                _ => (end, arrived),
            };
        }
    }
}

impl Strokes {
    /// K~ that follows the direction alone, as (20) has it.
    fn by_direction<'m, S: Scalar>(&'m self, rows: Range<usize>, then: &mut impl FnMut(Range<usize>, Line<'m, S>)) {
        for at in rows {
            then(at..at + 1, Line::constant(S::from(self.moving[at].k_tilde())));
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

    /// On through `rows`, over which the branch stays at `target`.
    fn settle<'m>(
        &mut self,
        presliding: &Presliding<S>,
        target: S,
        motion: &'m Strokes,
        rows: Range<usize>,
        then: &mut impl FnMut(Range<usize>, Line<'m, S>),
    ) {
        let Some(last) = rows.end.checked_sub(1).filter(|_| !rows.is_empty()) else { return };
        let (behind, from_rad) = (self.k_tilde - target, self.at_rad);
        if Presliding::has_arrived(behind.abs()) {
            *self = Self { k_tilde: target, at_rad: f64::from(motion.travel_rad[last]) };
            return then(rows, Line::constant(target));
        }
        let left = presliding.relaxing(behind.abs());
        let k_tilde = |travel_rad: f64| {
            let left = left(S::from(travel_rad - from_rad));
            if behind.value() < 0.0 { target - left } else { target + left }
        };
        let is_behind = |travel_rad: &f32| !Presliding::has_arrived(left(S::from(f64::from(*travel_rad) - from_rad)));
        let bending = rows.start..rows.start + motion.travel_rad[rows.clone()].partition_point(is_behind);
        Strokes::along(&motion.travel_rad, bending.clone(), &k_tilde, then);
        if bending.end < rows.end {
            then(bending.end..rows.end, Line::constant(target));
        }
        let at_rad = f64::from(motion.travel_rad[last]);
        *self = Self { k_tilde: if bending.end < rows.end { target } else { k_tilde(at_rad) }, at_rad };
    }
}

#[cfg(test)]
mod tests {
    use super::super::{directions, turns};
    use super::{Direction, Strokes};
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

    fn moving(positions_rad: &[f64], deadband_rad: f64) -> Vec<Direction> {
        let turns = turns(positions_rad, |i| positions_rad[i] - positions_rad[i.saturating_sub(1)], deadband_rad);
        directions(positions_rad, &turns, deadband_rad)
    }

    #[test]
    fn k_tilde_stroke_by_stroke_is_that_of_one_sample_after_the_other() {
        let positions_rad = motion_rad();
        let deadband_rad = 1.5e-3;
        let motion = Strokes::new(&positions_rad, moving(&positions_rad, deadband_rad), deadband_rad);
        let (n, p) = (1.7, 3.0);
        let curves = [Combination::Sign, Combination::Linear, Combination::arctan(p), Combination::Power { n }];
        let effects = ["", "reversal_transition:backlash_m=0.002,p=0.4,n=0.6", "presliding:travel_rad=0.02,exponent=1"];
        let more = [
            "presliding:travel_rad=0.02,exponent=0.8",
            "presliding:travel_rad=0.02,exponent=1.4",
            "presliding:travel_rad=0.02,exponent=1,in_place=1",
        ];
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/davinci_l4/base_model.json");
        for curve in curves {
            for effect in effects.into_iter().chain(more) {
                for backlash_m in [0.0, 1e-3, 4e-2] {
                    let mut model = Model::read(file.as_ref()).unwrap();
                    (model.combination, model.joint.backlash_m) = (curve, backlash_m);
                    model.effects.extend((!effect.is_empty()).then(|| Added::parse(effect).unwrap()));
                    let backlash_rad = model.backlash_m() / model.joint.pulley_radius_m;
                    let (direction, known_from) = settle(&positions_rad, backlash_rad, deadband_rad);
                    let mut state = Passage::after(&model, direction, positions_rad[0], deadband_rad);
                    let one_by_one: Vec<f64> =
                        positions_rad.iter().zip(&motion.moving).map(|(x, to)| state.step(*x, Some(*to))).collect();
                    let mut along = Vec::new();
                    model.k_tilde_along(&motion, |rows, k_tilde| {
                        assert_eq!(rows.start, along.len());
                        let (from, whole) = (along.len(), k_tilde.sum(rows.clone()));
                        along.extend(rows.map(|at| k_tilde.sum(at..at + 1)));
                        assert!((along[from..].iter().sum::<f64>() - whole).abs() < 1e-9);
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
