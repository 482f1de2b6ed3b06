//! Which parameters a fit on whole series may move, how, and how far.

use super::combination::CurveKind;
use super::predicted::Prepared;
use super::zero::MOST_RAD;
use crate::effects::{place_of_share, share_name};
use crate::model::{Combination, Direction, Model, Term};
use crate::numerics::scalar::Scalar;
use crate::numerics::statistics::extent;

/// The largest clearance looked for, as a share of the longest stroke: beyond, no sample would ever be off a transition.
pub const MAX_BACKLASH: f64 = 0.5;

/// A parameter that may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Free {
    /// A term of friction. Rates move by their logarithm.
    Friction(Direction, Term),
    /// The share of the load's size by which friction grows, where the model has that effect.
    Carried(Direction),
    /// p or n of a curve that has one, by its logarithm.
    Curve(CurveKind),
    /// X_cl, by its logarithm.
    Backlash,
    /// The zero of the position.
    Zero,
}

impl Free {
    /// Dotted name as in `model.json`.
    pub fn name(self) -> String {
        match self {
            Self::Friction(direction, term) => term.dotted(direction),
            Self::Carried(direction) => share_name(direction),
            Self::Curve(kind) => format!("combination.{}", if kind == CurveKind::Power { "n" } else { "p" }),
            Self::Backlash => "joint.backlash_m".to_string(),
            Self::Zero => super::zero::NAME.to_string(),
        }
    }

    fn is_rate(self) -> bool {
        matches!(self, Self::Friction(_, term) if term.is_rate())
    }

    fn is_logarithmic(self) -> bool {
        self.is_rate() || matches!(self, Self::Curve(_) | Self::Backlash)
    }

    /// Whether it changes where friction stands between its branches.
    pub fn moves_passage(self) -> bool {
        matches!(self, Self::Curve(_) | Self::Backlash)
    }

    /// The parameter of `model` as it moves: its logarithm or itself.
    pub fn read(self, model: &Model) -> f64 {
        let value = match self {
            Self::Friction(direction, term) => model.friction.of(direction)[term],
            Self::Carried(direction) => {
                let place = place_of_share(&model.effects, direction);
                place.map_or(0.0, |(at, i)| model.effects[at].parameters[i])
            }
            Self::Curve(_) => match model.combination {
                Combination::Arctan { p, .. } => p,
                Combination::Power { n } => n,
                _ => 1.0,
            },
            Self::Backlash => model.joint.backlash_m,
            Self::Zero => model.dynamics.position_zero_rad,
        };
        if self.is_logarithmic() { value.abs().max(f64::MIN_POSITIVE).ln() } else { value }
    }

    /// Sets the parameter of `model` from how it moves.
    pub fn write<S: Scalar>(self, model: &mut Model<S>, moved: S) {
        let value = if self.is_logarithmic() { moved.exp() } else { moved };
        match self {
            Self::Friction(direction, term) => {
                let sign = if term.is_rate() { direction.sign() } else { 1.0 };
                model.friction.of_mut(direction)[term] = value * sign;
            }
            Self::Carried(direction) => {
                if let Some((at, i)) = place_of_share(&model.effects, direction) {
                    model.effects[at].parameters[i] = value;
                }
            }
            Self::Curve(kind) => model.combination = kind.with(value),
            Self::Backlash => model.joint.backlash_m = value,
            Self::Zero => model.dynamics.position_zero_rad = value,
        }
    }
}

/// What parameters may be.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Largest friction as a force at the winch, N.
    pub force_n: f64,
    /// Fastest motion, rad/s.
    pub speed_rad_s: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// Longest stroke, rad.
    pub stroke_rad: f64,
    /// How far the zero of the position may be off, rad; 0 where it is not fitted.
    pub zero_rad: f64,
}

impl Limits {
    /// What the campaign's motion and torque allow of a model's parameters.
    pub fn new(trials: &[Prepared], model: &Model, zero_rad: f64) -> Self {
        let over = |values: &dyn Fn(&Prepared) -> f64| trials.iter().map(values).fold(f64::MIN_POSITIVE, f64::max);
        let largest = |values: &[f64]| values.iter().fold(0f64, |m, x| m.max(x.abs()));
        let stroke = |t: &Prepared| {
            let (low, high) = extent(&t.series.position_rad);
            high - low
        };
        Self {
            force_n: over(&|t| largest(&t.series.torque_nm)) / model.joint.winch_radius_m,
            speed_rad_s: over(&|t| largest(&t.series.velocity_rad_s)),
            pulley_radius_m: model.joint.pulley_radius_m,
            stroke_rad: over(&stroke),
            zero_rad,
        }
    }

    /// (low, high) of `free` as it moves; widened to hold the start `from`, which is never argued with.
    pub fn of(&self, free: Free, from: f64) -> (f64, f64) {
        let rates = ((0.2 / self.speed_rad_s).ln(), (100.0 / self.speed_rad_s).ln());
        let (low, high) = match free {
            // Below zero where the load pulls the other way: mu_c y must oppose the motion whatever the sign of y.
            Free::Friction(_, Term::Load) => (-5.0, 0.9),
            Free::Friction(_, Term::CableDecay) => {
                (rates.0 - self.pulley_radius_m.ln(), rates.1 - self.pulley_radius_m.ln())
            }
            Free::Friction(_, Term::JointDecay) => rates,
            // Of either sign, as in the fit of B(v): where friction falls with speed, a bound at zero would hold the rest off its
            // best and slow the search tenfold.
            Free::Friction(_, Term::Viscous) => {
                let steepest = 10.0 * self.force_n / self.speed_rad_s;
                (-steepest, steepest)
            }
            // Of either sign near 0, as friction itself.
            Free::Carried(_) => (-1.0, 5.0),
            Free::Friction(..) => (-10.0 * self.force_n, 10.0 * self.force_n),
            Free::Curve(kind) => kind.range().map_or((0.0, 1.0), |(low, high)| (low.ln(), high.ln())),
            Free::Zero => (-MOST_RAD, MOST_RAD),
            Free::Backlash => {
                let stroke_m = self.stroke_rad * self.pulley_radius_m;
                ((1e-4 * stroke_m).ln(), (MAX_BACKLASH * stroke_m).ln())
            }
        };
        let room = 0.5 * from.abs();
        (if from < low { from - room } else { low }, if from > high { from + room } else { high })
    }
}
