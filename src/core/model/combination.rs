//! How friction passes from one branch to the other after a reversal: K_f and K~, equations (20) to (30).
//!
//! K_f runs between -1 (fully on `down`) and 1 (fully on `up`) with the cable's displacement through the clearance:
//! (21) to (24), K_f(k) = clamp( K_f(k-1) + 2 (x(k) - x(k-1)) / X_cl, -1, 1 ). The paper prints 2 r1 v / X_cl without the
//! time step; what moves is the cable, x = r2 theta. K~ in [0, 1] maps K_f through a curve g.
//!
//! Both directions: the curve is traversed from its own start. A reversal inside the transition must not jump: it restarts
//! the curve from the point (K_f, K~) where it found it and ends at the same end. With u the share of the remaining K_f
//! travel, K~ = K~0 + g(u)/g(1) (K~end - K~0). For a whole transition this is (29) or (30) itself when g(1) = 1.

use crate::dynamics::Direction;
use crate::numerics::scalar::Scalar;

/// |K_f| from which friction is fully on one branch: of motion in even steps the clearance's end often falls on a sample, and the last
/// digit must not decide on which side.
pub const STABLE_K_F: f64 = 1.0 - 1e-9;

/// The curve by which friction changes over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Combination<S = f64> {
    /// (20): at once.
    Sign,
    /// (25): in proportion to the displacement.
    Linear,
    /// (29): K~ = k atan( p (K_f + 1) ).
    Arctan {
        /// Scale, dimensionless; k atan(2 p) = 1 when the curve ends on the branch.
        k: S,
        /// Steepness, dimensionless.
        p: S,
    },
    /// (30): K~ = ((K_f + 1)/2)^n.
    Power {
        /// Exponent, dimensionless.
        n: S,
    },
}

impl<S: Scalar> Combination<S> {
    /// The arctan curve of steepness `p` that ends on the branch: k = 1 / atan(2 p).
    pub fn arctan(p: S) -> Self {
        Self::Arctan { k: scale_of_arctan(p), p }
    }

    /// The name used in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Linear => "linear",
            Self::Arctan { .. } => "arctan",
            Self::Power { .. } => "power",
        }
    }

    /// g(u)/g(1) for u in [0, 1], the share of the transition done.
    pub fn share(&self, u: S) -> S {
        match *self {
            Self::Sign => S::from(1.0),
            Self::Linear => u,
            Self::Arctan { p, .. } => (p * 2.0 * u).atan() / (p * 2.0).atan(),
            Self::Power { n } => u.powf(n),
        }
    }
}

impl Combination {
    /// The share u of the clearance's travel after which `share` of the change-over is done: the inverse of [`Self::share`].
    pub fn done_by(&self, share: f64) -> f64 {
        match *self {
            Self::Sign => 0.0,
            Self::Linear => share,
            Self::Arctan { p, .. } => (share * (2.0 * p).atan()).tan() / (2.0 * p),
            Self::Power { n } => share.powf(1.0 / n),
        }
    }
}

/// k of an arctan curve of steepness `p` that ends on the branch: 1 / atan(2 p).
pub fn scale_of_arctan<S: Scalar>(p: S) -> S {
    S::from(1.0) / (p * 2.0).atan()
}

/// The state of the recursion: explicit memory, one sample at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition<S = f64> {
    /// K_f in [-1, 1].
    pub k_f: S,
    /// K~ in [0, 1].
    pub k_tilde: S,
    direction: Direction,
    start_k_f: S,
    start_k_tilde: S,
    /// Where the joint was when K_f was last brought up to date, rad.
    at_rad: f64,
}

impl<S: Scalar> Transition<S> {
    /// At `position_rad`, having moved in `direction` for long: K_f(0) is not known from a log, so it is taken from the
    /// first sustained motion, and samples before K_f has first saturated are left out of every figure.
    pub fn after(direction: Direction, position_rad: f64) -> Self {
        let (k_f, k_tilde) = (S::from(direction.sign()), S::from(direction.k_tilde()));
        Self { k_f, k_tilde, direction, start_k_f: k_f, start_k_tilde: k_tilde, at_rad: position_rad }
    }

    /// One sample on: the joint is now at `position_rad`; returns K~.
    ///
    /// `backlash_rad` is X_cl / r2. A reversal counts once the joint has come back by more than `deadband_rad`, so that
    /// encoder noise at rest does not restart the curve; the travel inside the deadband is not lost but made up for then.
    pub fn step(&mut self, position_rad: f64, curve: &Combination<S>, backlash_rad: S, deadband_rad: f64) -> S {
        self.step_by(position_rad, |u| curve.share(u), backlash_rad, deadband_rad)
    }

    /// The same along a curve of which `share` says how much is done at u, as [`Combination::share`] does.
    pub fn step_by(&mut self, position_rad: f64, share: impl FnOnce(S) -> S, backlash_rad: S, deadband_rad: f64) -> S {
        let travel_rad = position_rad - self.at_rad;
        let onward = travel_rad * self.direction.sign();
        if onward < -deadband_rad {
            self.direction = if travel_rad > 0.0 { Direction::Up } else { Direction::Down };
            (self.start_k_f, self.start_k_tilde) = (self.k_f, self.k_tilde);
        } else if onward <= 0.0 {
            return self.k_tilde;
        }
        self.at_rad = position_rad;
        let end = S::from(self.direction.sign());
        self.k_f = moved(self.k_f, S::from(travel_rad), backlash_rad, end);
        let whole = end - self.start_k_f;
        let u = if whole.value() == 0.0 { S::from(1.0) } else { (self.k_f - self.start_k_f) / whole };
        // At its end every curve is done: most samples, and no need for its power or arc tangent.
        let done = if u.value() == 1.0 { S::from(1.0) } else { share(u) };
        self.k_tilde = on_the_way(self.start_k_tilde, done, end);
        self.k_tilde
    }

    /// Whether friction is fully on one branch: |K_f| = 1 and the curve at its end.
    pub fn is_stable(&self) -> bool {
        self.k_f.value().abs() >= STABLE_K_F
    }

    /// The direction of the motion that the state last followed.
    pub fn direction(&self) -> Direction {
        self.direction
    }
}

/// (21) to (24): K_f once the cable has moved on through a part of the clearance. Without one the change is at once; the quotient
/// would be infinite.
pub fn moved<S: Scalar>(k_f: S, travel_rad: S, backlash_rad: S, end: S) -> S {
    let change = if backlash_rad.value() > 0.0 { travel_rad * 2.0 / backlash_rad } else { end * 2.0 };
    (k_f + change).max(S::from(-1.0)).min(S::from(1.0))
}

/// K~ once the share `done` of a transition is, that began at `start` and ends where K_f is `end`, -1 or 1.
pub fn on_the_way<S: Scalar>(start: S, done: S, end: S) -> S {
    start + done * ((end + 1.0) / 2.0 - start)
}

/// Where the state of a log becomes known: the direction to start from and the first sample at which it no longer matters.
///
/// Two recursions, started from either end, become one when K_f first saturates: from then on the unknown K_f(0) is
/// forgotten. A log that never moves through the clearance starts `Up` and is never settled.
pub fn settle(positions_rad: &[f64], backlash_rad: f64, deadband_rad: f64) -> (Direction, usize) {
    let Some(first) = positions_rad.first() else { return (Direction::Up, 0) };
    let mut from_up = Transition::<f64>::after(Direction::Up, *first);
    let mut from_down = Transition::<f64>::after(Direction::Down, *first);
    for (i, x) in positions_rad.iter().enumerate() {
        from_up.step(*x, &Combination::Linear, backlash_rad, deadband_rad);
        from_down.step(*x, &Combination::Linear, backlash_rad, deadband_rad);
        if from_up.k_f == from_down.k_f {
            return (if from_up.k_f > 0.0 { Direction::Up } else { Direction::Down }, i);
        }
    }
    (Direction::Up, positions_rad.len())
}
