//! Groups of the model's own parameters that go out of date together, and what is known of each.

use super::Term;
use crate::effects::{Excitation, Region};

/// Parameters of the model that go out of date together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group {
    /// Its name in files.
    pub name: &'static str,
    /// For people, in a few words.
    pub means: &'static str,
    /// Where a wrong value shows.
    pub signature: Region,
    /// What the recorded motion must include for it to show; empty: any motion shows it.
    pub needs: &'static [Excitation],
    /// How a person checks it alone, without the joint's motion.
    pub by_hand: Option<&'static str>,
    /// What no motion tells it apart from, and what does.
    pub told_apart: &'static [(&'static str, &'static str)],
    /// The terms of friction that it holds.
    pub terms: &'static [Term],
}

/// The weight.
pub static GRAVITY: Group = Group {
    name: "gravity",
    means: "the gravity torque",
    signature: Region::Position,
    needs: &[Excitation::Loads, Excitation::Range],
    by_hand: Some("weigh the moving part, and find where it hangs at rest with the cables off"),
    told_apart: &[],
    terms: &[],
};

/// The inertia.
pub static INERTIA: Group = Group {
    name: "inertia",
    means: "the inertia",
    signature: Region::Acceleration,
    needs: &[Excitation::Acceleration],
    by_hand: Some("let the joint swing freely with the cables off: its period gives the inertia"),
    told_apart: &[],
    terms: &[],
};

/// X_cl.
pub static BACKLASH_WIDTH: Group = Group {
    name: "backlash_width",
    means: "the width of the clearance",
    signature: Region::AfterReversal,
    needs: &[Excitation::Reversals],
    by_hand: Some("hold the joint and turn the winch by hand from one side to the other: that is the clearance"),
    told_apart: &[],
    terms: &[],
};

/// Constant friction.
pub static COULOMB: Group = Group {
    name: "coulomb",
    means: "Coulomb friction",
    signature: Region::Everywhere,
    needs: &[],
    by_hand: None,
    told_apart: &[],
    terms: &[Term::Coulomb],
};

/// Friction in proportion to speed.
pub static VISCOUS: Group = Group {
    name: "viscous",
    means: "viscous friction",
    signature: Region::HighSpeed,
    needs: &[Excitation::Speeds],
    by_hand: None,
    told_apart: &[],
    terms: &[Term::Viscous],
};

/// Friction in proportion to the tension.
pub static LOAD_COEFFICIENT: Group = Group {
    name: "load_coefficient",
    means: "the friction per load",
    signature: Region::Load,
    needs: &[Excitation::Loads],
    by_hand: Some("repeat one sweep with a second, known load at the joint"),
    told_apart: &[(
        "gravity",
        "weigh the moving part: if its weight is what the model has, load-dependent friction changed",
    )],
    terms: &[Term::Load],
};

/// Friction that falls with speed.
pub static STRIBECK_LEVEL: Group = Group {
    name: "stribeck_level",
    means: "the level of the Stribeck terms",
    signature: Region::LowSpeed,
    needs: &[Excitation::Speeds],
    by_hand: None,
    told_apart: &[],
    terms: &[Term::CableStribeck, Term::CableDecay, Term::JointStribeck, Term::JointDecay],
};

impl Group {
    /// All of them.
    pub const ALL: [&'static Self; 7] =
        [&GRAVITY, &INERTIA, &BACKLASH_WIDTH, &COULOMB, &VISCOUS, &LOAD_COEFFICIENT, &STRIBECK_LEVEL];

    /// The group called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|group| group.name == name)
    }

    /// The group that a term of friction belongs to.
    pub fn of_term(term: Term) -> &'static Self {
        Self::ALL.into_iter().find(|group| group.terms.contains(&term)).unwrap_or(&STRIBECK_LEVEL)
    }
}
