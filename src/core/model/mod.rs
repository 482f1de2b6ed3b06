//! The paper's model of one joint as the winch's torque sensor sees it.

mod added;
mod combination;
mod directions;
mod file;
mod friction;
mod functions;
pub mod groups;
mod joint;
mod passage;
mod predict;
mod strokes;

pub use crate::dynamics::{Both, Direction};
pub use combination::{Combination, STABLE_K_F, Transition, moved, on_the_way, scale_of_arctan, settle};
pub use directions::{Turn, directions, turns};
pub use file::{RecordedCurve, recorded_curves};
pub use friction::{Friction, Term, combined, decayed, loss};
pub use functions::{BranchFunctions, Functions, Level, SharedError, shared_speeds};
pub use groups::Group;
pub use joint::{Drive, Joint};
pub use passage::Passage;
pub use predict::{Asked, Components};
pub use strokes::{Line, Strokes};

use crate::dynamics::{Dynamics, Payload};
use crate::effects::Added;
use crate::numerics::scalar::Scalar;
use std::collections::BTreeMap;

/// Everything needed to predict y from motion: geometry, rigid body, friction, combination.
#[derive(Debug, Clone, PartialEq)]
pub struct Model<S = f64> {
    /// Geometry.
    pub joint: Joint<S>,
    /// Gravity and inertia; both 0 where `chain` holds them.
    pub dynamics: Dynamics<S>,
    /// The chain whose dynamics take their place, if it was identified with one.
    pub chain: Option<ChainName>,
    /// The two branches.
    pub friction: Both<Friction<S>>,
    /// How friction changes over between them.
    pub combination: Combination<S>,
    /// What the joint or its sensors have beyond the formula.
    pub effects: Vec<Added<S>>,
    /// How well each parameter is known, by dotted name (`friction.up.a_j`); empty where none is given.
    pub confidence: BTreeMap<String, Confidence>,
    /// A and B(v) as the identification measured them.
    pub functions: Functions,
    /// RMSE over the recordings that it was identified from, N m; nothing where that is not known.
    pub own_rmse_nm: Option<f64>,
    /// Names of the checks that it failed when it was identified.
    pub failed_checks: Vec<String>,
}

impl Model {
    /// The same over another kind of number, each of its own a constant; what is known of its parameters is left out.
    pub fn over<S: Scalar>(&self) -> Model<S> {
        let of = S::from;
        let Joint { name, kind, drive, winch_radius_m, pulley_radius_m, backlash_m } = self.joint.clone();
        let branch = |direction| {
            let mut friction = Friction {
                mu_c: of(0.0),
                a_j: of(0.0),
                b_c: of(0.0),
                c_c: of(0.0),
                b_j: of(0.0),
                c_j: of(0.0),
                d: of(0.0),
            };
            Term::ALL.iter().for_each(|term| friction[*term] = of(self.friction.of(direction)[*term]));
            friction
        };
        let effect = |added: &Added| Added {
            effect: added.effect,
            parameters: added.parameters.iter().map(|x| of(*x)).collect(),
        };
        Model {
            joint: Joint { name, kind, drive, winch_radius_m, pulley_radius_m, backlash_m: of(backlash_m) },
            dynamics: Dynamics {
                gravity_nm: of(self.dynamics.gravity_nm),
                inertia_kg_m2: of(self.dynamics.inertia_kg_m2),
                position_zero_rad: of(self.dynamics.position_zero_rad),
                payload: Payload::of(self.dynamics.payload.numbers().map(of)),
            },
            chain: self.chain.clone(),
            friction: Both::make(branch),
            combination: match self.combination {
                Combination::Sign => Combination::Sign,
                Combination::Linear => Combination::Linear,
                Combination::Arctan { k, p } => Combination::Arctan { k: of(k), p: of(p) },
                Combination::Power { n } => Combination::Power { n: of(n) },
            },
            effects: self.effects.iter().map(effect).collect(),
            confidence: BTreeMap::new(),
            functions: Functions::default(),
            own_rmse_nm: None,
            failed_checks: Vec::new(),
        }
    }
}

/// A joint of a URDF: whoever predicts with the model must have the chain, and where its other joints are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainName {
    /// The URDF's name in the campaign.
    pub urdf: String,
    /// The joint's name in it.
    pub joint: String,
}

/// How well the data knew one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// Lower end of the 95 % interval, in the parameter's own unit; infinite where the data set no limit.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Coefficient of variation: standard error over magnitude, dimensionless.
    pub cv: f64,
    /// The verdict in a word.
    pub status: Status,
}

/// What the data say of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Known by itself.
    Pinned,
    /// Known only together with others: a change is made up for by theirs.
    TradeOff,
    /// Stands for several of the full form's parameters, where a smaller form was taken: the interval is of what they make
    /// together.
    Merged,
    /// Hardly changes the prediction at all.
    Flat,
    /// Ended at the limit of what is physical.
    AtBound,
}

impl Status {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Pinned, Self::TradeOff, Self::Merged, Self::Flat, Self::AtBound];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pinned => "pinned",
            Self::TradeOff => "trade_off",
            Self::Merged => "merged",
            Self::Flat => "flat",
            Self::AtBound => "at_bound",
        }
    }
}
