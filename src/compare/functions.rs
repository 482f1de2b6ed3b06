//! What both models know well even where their parameters trade off, each with its interval: A, B(v), the width of the hysteresis,
//! the travel of the change-over after a reversal.

use crate::model::{Both, BranchFunctions, Combination, Direction, Model, shared_speeds};
use crate::numerics::statistics::HALF_WIDTH;

/// The share of the change-over whose travel is reported: a curve that approaches its end asymptotically has no other end.
const DONE: f64 = 0.9;

/// A function of both models.
#[derive(Debug, Clone, PartialEq)]
pub struct FunctionChange {
    /// Which.
    pub kind: FunctionKind,
    /// Moving where; `None` of what concerns both directions.
    pub direction: Option<Direction>,
    /// At what speed, rad/s; `None` where it has none.
    pub speed_rad_s: Option<f64>,
    /// Before, with the half width of its 95 % interval; in N m, the travel in m.
    pub before: (f64, f64),
    /// After, likewise.
    pub after: (f64, f64),
}

/// Which function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FunctionKind {
    /// A of (17): how the torque grows with gravity's.
    Load,
    /// B(v): friction without load.
    Friction,
    /// B moving up less B moving down: what a loop without load is wide.
    Hysteresis,
    /// Cable travel after a reversal until friction has changed over by nine tenths.
    ChangeOver,
}

impl FunctionKind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Load => "a",
            Self::Friction => "b",
            Self::Hysteresis => "hysteresis_width",
            Self::ChangeOver => "change_over_travel",
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Load => "A",
            Self::Friction => "B(v)",
            Self::Hysteresis => "hysteresis width without load",
            Self::ChangeOver => "travel of the change-over to 90 %",
        }
    }
}

impl FunctionChange {
    /// After less before.
    pub fn change(&self) -> f64 {
        self.after.0 - self.before.0
    }

    /// Half width of the change's 95 % interval.
    pub fn half_width(&self) -> f64 {
        self.before.1.hypot(self.after.1)
    }
}

/// Cable travel until friction has changed over by `DONE`, m, with its standard error; `None` where the curve was not fitted.
pub fn change_over_m(model: &Model) -> Option<(f64, f64)> {
    let travel = |curve: Combination| model.joint.backlash_m * curve.done_by(DONE);
    let se = |name: &str| {
        let known = model.confidence.get(name)?;
        Some((known.high - known.low) / 2.0 / HALF_WIDTH).filter(|se| se.is_finite())
    };
    /// Step of a derivative by difference, as a share.
    const STEP: f64 = 1e-4;
    let slope = |at: f64, curve: &dyn Fn(f64) -> Combination| {
        (travel(curve(at * (1.0 + STEP))) - travel(curve(at * (1.0 - STEP)))) / (2.0 * STEP * at)
    };
    let by_curve = match model.combination {
        Combination::Arctan { p, .. } => se("combination.p")? * slope(p, &Combination::arctan),
        Combination::Power { n } => se("combination.n")? * slope(n, &|n| Combination::Power { n }),
        Combination::Sign | Combination::Linear => return None,
    };
    let value = travel(model.combination);
    let by_backlash = se("joint.backlash_m").map_or(0.0, |se| value * se / model.joint.backlash_m);
    Some((value, by_curve.hypot(by_backlash)))
}

/// Number of speeds at which B is reported where the usual ones lie outside the range of the models.
const SPEEDS: usize = 3;

/// Those of `usual_rad_s` at which both models know B in both directions, or some of their own between the slowest and the fastest.
pub(super) fn speeds_rad_s(before: &Model, after: &Model, usual_rad_s: &[f64]) -> Vec<f64> {
    let branches = || {
        [before, after].into_iter().flat_map(|model| Direction::BOTH.map(|d| model.functions.branches.of(d).as_ref()))
    };
    let Some((slowest, fastest)) = shared_speeds(branches().flatten()) else { return usual_rad_s.to_vec() };
    let known = |speed: &f64| branches().flatten().all(|of| of.at(*speed).is_some());
    let usual: Vec<f64> = usual_rad_s.iter().copied().filter(known).collect();
    if usual.len() >= SPEEDS {
        return usual;
    }
    let share = |i: usize| i as f64 / (SPEEDS - 1) as f64;
    (0..SPEEDS).map(|i| (slowest * (fastest / slowest).powf(share(i))).clamp(slowest, fastest)).collect()
}

/// The functions of which one of the models knows nothing: A where no load shows it in one of them, B(v) where they share no speed.
pub(super) fn unknown(before: &Model, after: &Model) -> Vec<(FunctionKind, Direction)> {
    let of = |model: &Model, direction: Direction| model.functions.branches.of(direction).clone();
    let both = |direction| of(before, direction).zip(of(after, direction));
    let has_load = |of: &BranchFunctions| of.a_nm != 0.0;
    let lacks_a = |direction: &Direction| {
        both(*direction)
            .is_none_or(|(a, b)| (has_load(&a) || has_load(&b)) && !(a.a_se_nm.is_finite() && b.a_se_nm.is_finite()))
    };
    let lacks_b = |direction: &Direction| {
        both(*direction).is_none_or(|(a, b)| {
            let se = |of: &BranchFunctions| of.levels.iter().map(|level| level.se_nm).fold(of.common_se_nm, f64::max);
            shared_speeds([&a, &b]).is_none() || !(se(&a).is_finite() && se(&b).is_finite())
        })
    };
    let a = Direction::BOTH.into_iter().filter(lacks_a).map(|d| (FunctionKind::Load, d));
    a.chain(Direction::BOTH.into_iter().filter(lacks_b).map(|d| (FunctionKind::Friction, d))).collect()
}

/// What both models know, at `speeds_rad_s`.
pub(super) fn functions(before: &Model, after: &Model, speeds_rad_s: &[f64]) -> Vec<FunctionChange> {
    let both = |of: &dyn Fn(&Model) -> Option<(f64, f64)>| {
        let known = |model| of(model).filter(|(_, se)| se.is_finite()).map(|(value, se)| (value, HALF_WIDTH * se));
        known(before).zip(known(after))
    };
    let make = |kind, direction, speed_rad_s, of: &dyn Fn(&Model) -> Option<(f64, f64)>| {
        both(of).map(|(before, after)| FunctionChange { kind, direction, speed_rad_s, before, after })
    };
    let a = |direction: Direction| {
        make(FunctionKind::Load, Some(direction), None, &|model| {
            model.functions.branches.of(direction).as_ref().map(|of| (of.a_nm, of.a_se_nm))
        })
    };
    let friction = |direction: Direction, speed: f64| {
        make(FunctionKind::Friction, Some(direction), Some(speed), &|model| model.functions.b_nm(direction, speed))
    };
    let width =
        |speed: f64| make(FunctionKind::Hysteresis, None, Some(speed), &|model| model.functions.width_nm(speed));
    let speeds = || speeds_rad_s.iter().copied();
    let b = Direction::BOTH.into_iter().flat_map(|direction| speeds().map(move |speed| (direction, speed)));
    Direction::BOTH
        .into_iter()
        .filter_map(a)
        .chain(b.filter_map(|(direction, speed)| friction(direction, speed)))
        .chain(speeds().filter_map(width))
        .chain(make(FunctionKind::ChangeOver, None, None, &change_over_m))
        .collect()
}

/// RMS, N m, of what the intervals of A and B(v) may make of the torque along `positions_rad`, 95 %; infinite where one is open.
pub(super) fn known_nm(model: &Model, positions_rad: &[f64], rate_hz: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    let errors = Both::make(|direction| model.functions.errors(direction));
    for pair in positions_rad.windows(2) {
        let speed_rad_s = (pair[1] - pair[0]) * rate_hz;
        let direction = if speed_rad_s < 0.0 { Direction::Down } else { Direction::Up };
        let Some(of) = model.functions.branches.of(direction) else { return f64::INFINITY };
        let Some((slowest, fastest)) = of.levels.first().zip(of.levels.last()) else { return f64::INFINITY };
        let level = of.at(speed_rad_s.abs().clamp(slowest.speed_rad_s, fastest.speed_rad_s)).unwrap_or(*slowest);
        // Without gravity A is zero, and has no error.
        let share = if of.a_nm == 0.0 { 0.0 } else { model.joint.kind.gravity_share(pair[0]).0 };
        if !of.common_se_nm.is_finite() || (share != 0.0 && !of.a_se_nm.is_finite()) {
            return f64::INFINITY;
        }
        let shared = errors.of(direction).iter().map(|error| (share * error.a_nm + error.b_nm).powi(2)).sum::<f64>();
        sum += shared + level.se_nm.powi(2);
        count += 1;
    }
    HALF_WIDTH * (sum / f64::from(count.max(1))).sqrt()
}
