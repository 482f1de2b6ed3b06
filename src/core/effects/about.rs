//! What is known of an effect apart from its physics.

use super::{Parameter, Region};

/// Where the cause lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// In the joint.
    Physics,
    /// In the measurement: the joint is innocent.
    Fault,
    /// Outside both: no model of the joint should hold it.
    Outside,
}

/// What an effect changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The friction of the joint and its cable: its size, or how it changes over after a reversal.
    Friction,
    /// What the joint is loaded with.
    Load,
    /// The torque sensor's reading.
    Sensor,
    /// Nothing of the joint: a torque from outside.
    Outside,
}

impl ActsOn {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Load => "load",
            Self::Sensor => "sensor",
            Self::Outside => "outside",
        }
    }
}

/// What the recorded motion must hold for an effect to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Excitation {
    /// More than one load.
    Loads,
    /// Motion back and forth.
    Reversals,
    /// More than one speed.
    Speeds,
    /// A wide range of positions.
    Range,
    /// Acceleration that makes a torque above the noise floor.
    Acceleration,
    /// Torque that changes quickly.
    TorqueRate,
    /// Some minutes of recording.
    Time,
    /// Motion of another joint.
    OtherJoint,
}

impl Excitation {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Loads => "loads",
            Self::Reversals => "reversals",
            Self::Speeds => "speeds",
            Self::Range => "range",
            Self::Acceleration => "acceleration",
            Self::TorqueRate => "torque_rate",
            Self::Time => "time",
            Self::OtherJoint => "other_joint",
        }
    }
}

/// How a search for an effect begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Starts {
    /// From guesses at its shape ([`super::Effect::starts`]), the most promising of which are followed.
    Shapes,
    /// From [`super::Effect::starts`], which are different forms: all of them are followed.
    Forms,
    /// From lines in the residual's spectrum over position, with the sign of the motion if `by_direction`: each line in the place of the first
    /// parameter of every one of [`super::Effect::starts`].
    PositionLines {
        /// Whether the effect changes sign with the direction.
        by_direction: bool,
    },
    /// From guesses at its shape, and from the levels at which readings pile up.
    ClipLevels,
    /// From events that are not repeated from trial to trial.
    Events,
}

/// What an effect is, apart from its physics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct About {
    /// Its name in files.
    pub id: &'static str,
    /// Where the cause lies.
    pub family: Family,
    /// What it changes.
    pub acts_on: ActsOn,
    /// For people, in a few words: "friction passes gradually ...".
    pub means: &'static str,
    /// The formula, in the words of the parameters.
    pub formula: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it shows.
    pub signature: Region,
    /// What it can be mistaken for: ids of effects and names of stale parameters.
    pub trades_with: &'static [&'static str],
    /// Parameters of a size that shows, as a person types them: `name=value,name=value`.
    pub example: &'static str,
    /// Its parameters, in order.
    pub parameters: &'static [Parameter],
    /// What the recorded motion must include for it to show; empty: any motion shows it.
    pub needs: &'static [Excitation],
    /// How a person checks it alone, without the joint's motion.
    pub by_hand: Option<&'static str>,
    /// What no motion distinguishes it from, and what else does.
    pub told_apart: &'static [(&'static str, &'static str)],
    /// How to mend the measurement, for a fault.
    pub remedy: Option<&'static str>,
    /// How a search for it begins.
    pub starts: Starts,
    /// Effects that approximate it over a short range: they stay rivals with one parameter more.
    pub outnumbered_by: &'static [&'static str],
    /// Effects that are the same thing in another form.
    pub alike: &'static [&'static str],
    /// Whether it is a function of time.
    pub of_time: bool,
}

impl About {
    /// Defaults of an effect.
    pub(super) const PLAIN: Self = Self {
        id: "",
        family: Family::Physics,
        acts_on: ActsOn::Friction,
        means: "",
        formula: "",
        source: "",
        signature: Region::Everywhere,
        trades_with: &[],
        example: "",
        parameters: &[],
        needs: &[],
        by_hand: None,
        told_apart: &[],
        remedy: None,
        starts: Starts::Shapes,
        outnumbered_by: &[],
        alike: &[],
        of_time: false,
    };
}
