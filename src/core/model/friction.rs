//! Steady-state friction of one cable, one branch per direction of motion.
//!
//! (14), (15): f = r1 ( mu_c T0 + a_j + b_c exp(-c_c r2 v) + b_j exp(-c_j v) + d v ). The load term mu_c T0 goes to the
//! left side of the prediction (`predict`), the rest is a function of speed alone. On the `down` branch a_j, b_c, b_j, c_c
//! and c_j are negative and v < 0, so the exponentials decay with speed there too.

use super::Drive;
use crate::dynamics::{Both, Direction, JointKind};
use crate::numerics::scalar::Scalar;
use std::ops::{Index, IndexMut};

/// The parameters of one branch (Table II).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction<S = f64> {
    /// Equivalent friction coefficient of the cable, dimensionless: friction per tension carried.
    pub mu_c: S,
    /// Coulomb friction as a force at the winch, N.
    pub a_j: S,
    /// Stribeck amplitude of the cable, N.
    pub b_c: S,
    /// Decay of the cable's Stribeck term per cable speed, s/m.
    pub c_c: S,
    /// Stribeck amplitude of the joint, N.
    pub b_j: S,
    /// Decay of the joint's Stribeck term per joint speed, s/rad.
    pub c_j: S,
    /// Viscous friction, N s/rad.
    pub d: S,
}

/// One parameter of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Term {
    /// mu_c.
    Load,
    /// a_j.
    Coulomb,
    /// b_c.
    CableStribeck,
    /// c_c.
    CableDecay,
    /// b_j.
    JointStribeck,
    /// c_j.
    JointDecay,
    /// d.
    Viscous,
}

impl Term {
    /// How many there are.
    pub const COUNT: usize = 7;

    /// All of them, in the order of files: P = [mu_c, a_j, b_c, c_c, b_j, c_j, d].
    pub const ALL: [Self; Self::COUNT] = [
        Self::Load,
        Self::Coulomb,
        Self::CableStribeck,
        Self::CableDecay,
        Self::JointStribeck,
        Self::JointDecay,
        Self::Viscous,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Load => "mu_c",
            Self::Coulomb => "a_j",
            Self::CableStribeck => "b_c",
            Self::CableDecay => "c_c",
            Self::JointStribeck => "b_j",
            Self::JointDecay => "c_j",
            Self::Viscous => "d",
        }
    }

    /// The term called `name` in files.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|term| term.name() == name)
    }

    /// Its dotted name in files, on the branch of `direction`.
    pub fn dotted(self, direction: Direction) -> String {
        format!("friction.{}.{}", direction.name(), self.name())
    }

    /// Its unit on a joint of this `kind`; empty without.
    pub fn unit(self, kind: JointKind) -> &'static str {
        let turns = kind == JointKind::Revolute;
        match self {
            Self::Load => "",
            Self::Coulomb | Self::CableStribeck | Self::JointStribeck => "N",
            Self::CableDecay => "s/m",
            Self::JointDecay => {
                if turns {
                    "s/rad"
                } else {
                    "s/m"
                }
            }
            Self::Viscous => {
                if turns {
                    "N s/rad"
                } else {
                    "N s/m"
                }
            }
        }
    }

    /// Its unit on a joint of this `kind` and `drive`: without a cable r2 is 1 m, and forces on it are torques at the joint.
    pub fn unit_on(self, kind: JointKind, drive: Drive) -> &'static str {
        match self.unit(kind) {
            unit if drive == Drive::Cable || kind == JointKind::Prismatic => unit,
            "N" => "N m",
            "s/m" => "s/rad",
            "N s/rad" => "N m s/rad",
            unit => unit,
        }
    }

    /// For people, in a few words, on a joint with this `drive`.
    pub fn means_on(self, drive: Drive) -> &'static str {
        match (self, drive) {
            (_, Drive::Cable) => self.means(),
            (Self::Load, _) => "friction per load carried: 1 less the efficiency under load",
            (Self::Coulomb, Drive::Screw) => "Coulomb friction, as a force at the slide",
            (Self::Coulomb, _) => "Coulomb friction at the joint",
            (Self::CableStribeck, _) => "amplitude of the first Stribeck term",
            (Self::CableDecay, _) => "decay of the first Stribeck term with speed",
            (Self::JointStribeck, _) => "amplitude of the second Stribeck term",
            (Self::JointDecay, _) => "decay of the second Stribeck term with speed",
            (Self::Viscous, _) => self.means(),
        }
    }

    /// For people, in a few words.
    pub fn means(self) -> &'static str {
        match self {
            Self::Load => "friction coefficient of the cable: friction per tension carried",
            Self::Coulomb => "Coulomb friction, as a force at the winch",
            Self::CableStribeck => "Stribeck amplitude of the cable",
            Self::CableDecay => "decay of the cable's Stribeck term with cable speed",
            Self::JointStribeck => "Stribeck amplitude of the joint",
            Self::JointDecay => "decay of the joint's Stribeck term with joint speed",
            Self::Viscous => "viscous friction",
        }
    }

    /// The amplitude without which a rate of decay does nothing; `None` for any other term.
    pub fn amplitude(self) -> Option<Self> {
        match self {
            Self::CableDecay => Some(Self::CableStribeck),
            Self::JointDecay => Some(Self::JointStribeck),
            _ => None,
        }
    }

    /// Whether it is a rate of decay, whose sign is that of its branch's speed.
    pub fn is_rate(self) -> bool {
        self.amplitude().is_some()
    }
}

impl<S> Index<Term> for Friction<S> {
    type Output = S;

    fn index(&self, term: Term) -> &S {
        match term {
            Term::Load => &self.mu_c,
            Term::Coulomb => &self.a_j,
            Term::CableStribeck => &self.b_c,
            Term::CableDecay => &self.c_c,
            Term::JointStribeck => &self.b_j,
            Term::JointDecay => &self.c_j,
            Term::Viscous => &self.d,
        }
    }
}

impl<S> IndexMut<Term> for Friction<S> {
    fn index_mut(&mut self, term: Term) -> &mut S {
        match term {
            Term::Load => &mut self.mu_c,
            Term::Coulomb => &mut self.a_j,
            Term::CableStribeck => &mut self.b_c,
            Term::CableDecay => &mut self.c_c,
            Term::JointStribeck => &mut self.b_j,
            Term::JointDecay => &mut self.c_j,
            Term::Viscous => &mut self.d,
        }
    }
}

impl<S: Scalar> Friction<S> {
    /// Whether `term` does nothing: its Stribeck term has no amplitude.
    pub fn lacks(&self, term: Term) -> bool {
        match term {
            Term::CableStribeck | Term::JointStribeck => self[term].is_zero(),
            _ => term.amplitude().is_some_and(|amplitude| self[amplitude].is_zero()),
        }
    }

    /// The part of (15) that does not depend on the load, as a torque at the winch, N m.
    ///
    /// The branch is evaluated at its own sign of speed (`+|v|` on up, `-|v|` on down): in a transition the other
    /// branch would otherwise be evaluated at the wrong sign and explode.
    pub fn unloaded_nm(
        &self,
        direction: Direction,
        speed_rad_s: S::Given,
        winch_radius_m: f64,
        pulley_radius_m: f64,
    ) -> S {
        let v = speed_rad_s.abs() * direction.sign();
        let stribeck = stribeck_n(self.b_c, self.c_c * pulley_radius_m, v) + stribeck_n(self.b_j, self.c_j, v);
        (self.a_j + stribeck + v * self.d) * winch_radius_m
    }

    /// The share of the cable's tension that its own friction leaves: 1 - mu_c, by which (17) to (19) divide.
    pub fn loss(&self) -> S {
        loss(self.mu_c)
    }
}

/// The share of a tension that a friction coefficient `mu_c` leaves.
pub fn loss<S: Scalar>(mu_c: S) -> S {
    S::from(1.0) - mu_c
}

/// b exp(-c v), N; skipped when b = 0, which saves most of the time of a model without it.
fn stribeck_n<S: Scalar>(b_n: S, c_s_rad: S, v_rad_s: S::Given) -> S {
    if b_n.is_zero() { S::from(0.0) } else { b_n * decayed(c_s_rad, v_rad_s) }
}

/// What is left of a Stribeck term of rate `c_s_rad` at speed `v_rad_s`: exp(-c v).
pub fn decayed<S: Scalar>(c_s_rad: S, v_rad_s: S::Given) -> S {
    (v_rad_s * -c_s_rad).exp()
}

impl<S: Scalar> Both<Friction<S>> {
    /// The share of the tension that is left where friction is combined by `k_tilde`: 1 - mu_down - K~ (mu_up - mu_down).
    pub fn loss(&self, k_tilde: S) -> S {
        self.down.loss() - k_tilde * (self.up.mu_c - self.down.mu_c)
    }
}

/// One of two branches, or a torque between them: down + K~ (up - down).
pub fn combined<S: Scalar>(branches: Both<S>, k_tilde: S) -> S {
    branches.down + k_tilde * (branches.up - branches.down)
}
