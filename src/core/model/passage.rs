//! Where friction stands between its branches as the joint moves on: one sample at a time, the memory explicit.

use super::{Combination, Direction, Model, Transition};
use crate::effects::{Curve, Evaluated, Presliding};

/// K~ of a model along a motion: the transition through the clearance, then presliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage<S = f64> {
    transition: Transition<S>,
    curve: Combination<S>,
    /// In the place of `curve`.
    added: Option<Curve<S>>,
    backlash_rad: S,
    deadband_rad: f64,
    presliding: Option<Presliding<S>>,
    /// K~ after presliding, and where it was last brought up to date, rad.
    k_tilde: S,
    at_rad: f64,
}

impl<S: Evaluated> Passage<S> {
    /// At `position_rad`, having moved in `direction` for long; travel back of less than `deadband_rad` is no reversal.
    pub fn after(model: &Model<S>, direction: Direction, position_rad: f64, deadband_rad: f64) -> Self {
        let transition = Transition::after(direction, position_rad);
        Self {
            transition,
            curve: model.combination,
            added: model.added_curve(),
            backlash_rad: model.backlash_m() / model.joint.pulley_radius_m,
            deadband_rad,
            presliding: model.presliding(),
            k_tilde: transition.k_tilde,
            at_rad: position_rad,
        }
    }

    /// One sample on: the joint is now at `position_rad`, and `moving`; returns K~.
    ///
    /// With `Sign` and no presliding K~ follows the direction alone, as (20) has it: that in which the joint is `moving`, where that is known, else
    /// that of the last motion further than the deadband.
    pub fn step(&mut self, position_rad: f64, moving: Option<Direction>) -> S {
        let (backlash_rad, deadband_rad) = (self.backlash_rad, self.deadband_rad);
        let through_clearance = match &self.added {
            Some(added) => self.transition.step_by(position_rad, |u| added.share(u), backlash_rad, deadband_rad),
            None => self.transition.step(position_rad, &self.curve, backlash_rad, deadband_rad),
        };
        let jumps = self.added.is_none() && matches!(self.curve, Combination::Sign);
        let followed = moving.filter(|_| self.presliding.is_none()).unwrap_or(self.direction());
        let target = if jumps { S::from(followed.k_tilde()) } else { through_clearance };
        let Some(presliding) = self.presliding else { return target };
        let behind = self.k_tilde - target;
        let left = presliding.left(behind.abs(), S::from((position_rad - self.at_rad).abs()));
        self.at_rad = position_rad;
        self.k_tilde = if behind.value() < 0.0 { target - left } else { target + left };
        self.k_tilde
    }

    /// K_f in [-1, 1].
    pub fn k_f(&self) -> S {
        self.transition.k_f
    }

    /// Whether friction is fully on one branch: |K_f| = 1.
    pub fn is_stable(&self) -> bool {
        self.transition.is_stable()
    }

    /// The direction of the motion that the state last followed.
    pub fn direction(&self) -> Direction {
        self.transition.direction()
    }
}

impl<S: Evaluated> Model<S> {
    /// X_cl, m: the joint's own, or that of an effect in its place.
    pub fn backlash_m(&self) -> S {
        self.added_curve().map_or(self.joint.backlash_m, |curve| curve.backlash_m)
    }

    /// How friction builds up elastically, where an effect says so.
    pub fn presliding(&self) -> Option<Presliding<S>> {
        self.effects.iter().rev().find_map(|e| e.hooks().presliding(&e.parameters))
    }

    /// The change-over that an effect puts in the place of the model's own.
    pub fn added_curve(&self) -> Option<Curve<S>> {
        self.effects.iter().rev().find_map(|e| e.hooks().curve(&e.parameters))
    }
}
