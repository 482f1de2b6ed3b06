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

/// |K_f| from which friction is fully on one branch: of motion in even steps the clearance's end often falls on a sample, and the last
/// digit must not decide on which side.
pub const STABLE_K_F: f64 = 1.0 - 1e-9;

/// The curve by which friction changes over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Combination {
    /// (20): at once.
    Sign,
    /// (25): in proportion to the displacement.
    Linear,
    /// (29): K~ = k atan( p (K_f + 1) ).
    Arctan {
        /// Scale, dimensionless; k atan(2 p) = 1 when the curve ends on the branch.
        k: f64,
        /// Steepness, dimensionless.
        p: f64,
    },
    /// (30): K~ = ((K_f + 1)/2)^n.
    Power {
        /// Exponent, dimensionless.
        n: f64,
    },
}

impl Combination {
    /// The arctan curve of steepness `p` that ends on the branch: k = 1 / atan(2 p).
    pub fn arctan(p: f64) -> Self {
        Self::Arctan { k: 1.0 / (2.0 * p).atan(), p }
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
    pub fn share(&self, u: f64) -> f64 {
        match *self {
            Self::Sign => 1.0,
            Self::Linear => u,
            Self::Arctan { p, .. } => (2.0 * p * u).atan() / (2.0 * p).atan(),
            Self::Power { n } => u.powf(n),
        }
    }
}

/// The state of the recursion: explicit memory, one sample at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// K_f in [-1, 1].
    pub k_f: f64,
    /// K~ in [0, 1].
    pub k_tilde: f64,
    direction: Direction,
    start_k_f: f64,
    start_k_tilde: f64,
    /// Where the joint was when K_f was last brought up to date, rad.
    at_rad: f64,
}

impl Transition {
    /// At `position_rad`, having moved in `direction` for long: K_f(0) is not known from a log, so it is taken from the
    /// first sustained motion, and samples before K_f has first saturated are left out of every figure.
    pub fn after(direction: Direction, position_rad: f64) -> Self {
        let k_f = direction.sign();
        let k_tilde = (k_f + 1.0) / 2.0;
        Self { k_f, k_tilde, direction, start_k_f: k_f, start_k_tilde: k_tilde, at_rad: position_rad }
    }

    /// One sample on: the joint is now at `position_rad`; returns K~.
    ///
    /// `backlash_rad` is X_cl / r2. A reversal counts once the joint has come back by more than `deadband_rad`, so that
    /// encoder noise at rest does not restart the curve; the travel inside the deadband is not lost but made up for then.
    pub fn step(&mut self, position_rad: f64, curve: &Combination, backlash_rad: f64, deadband_rad: f64) -> f64 {
        self.step_by(position_rad, |u| curve.share(u), backlash_rad, deadband_rad)
    }

    /// The same along a curve of which `share` says how much is done at u, as [`Combination::share`] does.
    pub fn step_by(
        &mut self,
        position_rad: f64,
        share: impl Fn(f64) -> f64,
        backlash_rad: f64,
        deadband_rad: f64,
    ) -> f64 {
        let travel_rad = position_rad - self.at_rad;
        let onward = travel_rad * self.direction.sign();
        if onward < -deadband_rad {
            self.direction = if travel_rad > 0.0 { Direction::Up } else { Direction::Down };
            (self.start_k_f, self.start_k_tilde) = (self.k_f, self.k_tilde);
        } else if onward <= 0.0 {
            return self.k_tilde;
        }
        self.at_rad = position_rad;
        let end = self.direction.sign();
        // Without a clearance the change is at once; the quotient would be infinite.
        let change = if backlash_rad > 0.0 { 2.0 * travel_rad / backlash_rad } else { 2.0 * end };
        self.k_f = (self.k_f + change).clamp(-1.0, 1.0);
        let whole = end - self.start_k_f;
        let u = if whole == 0.0 { 1.0 } else { (self.k_f - self.start_k_f) / whole };
        // At its end every curve is done: most samples, and no need for its power or arc tangent.
        let done = if u == 1.0 { 1.0 } else { share(u) };
        self.k_tilde = self.start_k_tilde + done * ((end + 1.0) / 2.0 - self.start_k_tilde);
        self.k_tilde
    }

    /// Whether friction is fully on one branch: |K_f| = 1 and the curve at its end.
    pub fn is_stable(&self) -> bool {
        self.k_f.abs() >= STABLE_K_F
    }

    /// The direction of the motion that the state last followed.
    pub fn direction(&self) -> Direction {
        self.direction
    }
}

/// Where the state of a log becomes known: the direction to start from and the first sample at which it no longer matters.
///
/// Two recursions, started from either end, become one when K_f first saturates: from then on the unknown K_f(0) is
/// forgotten. A log that never moves through the clearance starts `Up` and is never settled.
pub fn settle(positions_rad: &[f64], backlash_rad: f64, deadband_rad: f64) -> (Direction, usize) {
    let Some(first) = positions_rad.first() else { return (Direction::Up, 0) };
    let mut from_up = Transition::after(Direction::Up, *first);
    let mut from_down = Transition::after(Direction::Down, *first);
    for (i, x) in positions_rad.iter().enumerate() {
        from_up.step(*x, &Combination::Linear, backlash_rad, deadband_rad);
        from_down.step(*x, &Combination::Linear, backlash_rad, deadband_rad);
        if from_up.k_f == from_down.k_f {
            return (if from_up.k_f > 0.0 { Direction::Up } else { Direction::Down }, i);
        }
    }
    (Direction::Up, positions_rad.len())
}
