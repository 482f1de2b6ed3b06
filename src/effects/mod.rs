//! What a joint, or the sensors that record it, may have beyond the paper's formula.
//!
//! One effect, one file, one entry in `LIBRARY`. An effect is a set of hooks into the formula, each a line of physics for
//! one sample; the model, the simulator and the diagnosis all go through them. With u and d the two branches of friction,
//!
//! y = w + [ (r1/r2) (G + I a + j) + K~ (u + fu) h + (1 - K~) (d + fd) h ] / (1 - mu)
//!
//! where j is `Effect::joint_torque_nm`, fu and fd `Effect::friction_nm`, h `Effect::friction_factor` and w
//! `Effect::winch_torque_nm`; G is taken where `Effect::position_lag_rad` says the joint is; K~ changes over by
//! `Effect::curve` and builds up elastically by `Effect::presliding`. What the sensor makes of y comes last: `Effect::delay_s`
//! and `Effect::lag_s`, then `Effect::reading_nm`, last of those that say `Effect::clips`.

mod cable_elasticity;
mod contact;
mod elastic_spring;
mod end_stop;
mod friction_ripple;
mod gravity_phase;
mod inertia;
mod joint_coupling;
mod library;
mod load_dependent_friction;
mod presliding;
mod quadratic_viscous;
mod reversal_transition;
mod ripple;
mod saturation;
mod sensor_bias;
mod sensor_drift;
mod sensor_gain;
mod stribeck;
mod time_delay;
mod torque_ripple;
mod warm_up;

pub use library::{Added, LIBRARY, find};
pub use ripple::{HARMONICS, NUMBERS as RIPPLE_NUMBERS};

use crate::dynamics::{Both, Motion};

/// What the joint does at one sample, as effects see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    /// Since the trial began, s.
    pub time_s: f64,
    /// Since the campaign began, s: by the logs' own clock where it runs on from trial to trial, else the lengths of the logs
    /// before added up.
    pub elapsed_s: f64,
    /// The joint.
    pub own: Motion,
    /// The other joints, in the order of the campaign's columns.
    pub others: &'a [Motion],
}

/// What the cable carries at one sample, N m at the winch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carried {
    /// (r1/r2) (G + I a + j): the joint's load.
    pub load_nm: f64,
    /// The model's own friction on each branch, u and d.
    pub friction_nm: Both<f64>,
}

/// Over what range a campaign moves, for an effect to know where its shape may lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Lowest and highest position, rad.
    pub position_rad: (f64, f64),
    /// The longest way between two reversals in the trial where that is shortest, rad.
    pub stroke_rad: f64,
    /// Speeds that 5 % and all of the moving samples stay below, rad/s.
    pub speed_rad_s: (f64, f64),
    /// The longest trial, s.
    pub trial_s: f64,
    /// The whole campaign, s.
    pub campaign_s: f64,
    /// Lowest and highest reading of the torque, N m.
    pub torque_nm: (f64, f64),
    /// How many other joints are recorded moving.
    pub others: usize,
    /// Gravity of the model, N m at the joint: 0 where a chain says it.
    pub gravity_nm: f64,
    /// X_cl of the model, m on the cable.
    pub backlash_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// Whether the joint turns rather than slides.
    pub turns: bool,
}

/// How a parameter enters the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// In proportion, or nearly so; at 0 the effect is absent.
    Strength,
    /// Above 0, it decides how the effect acts: searched in its logarithm.
    Shape,
    /// A position at which the effect acts: searched along the joint's range.
    Position,
    /// A torque at which the effect acts: searched along the reading's range.
    Level,
    /// It selects, and is neither fitted nor has it an interval: which joint, which clock.
    Choice,
    /// It selects a form of the effect, like a choice; 0 is the plainest, and is meant where nothing is said.
    Form,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Its name in files; the unit stands in it.
    pub name: &'static str,
    /// How it enters.
    pub role: Role,
    /// The range beyond which it makes no sense.
    pub bounds: (f64, f64),
    /// How large it is believed to be, as a share of the torque's range: infinite where nobody can say.
    pub share: f64,
    /// What it is where nothing is said; none where it must be said.
    pub default: Option<f64>,
}

impl Parameter {
    /// Whether it may be `value`.
    pub fn allows(&self, value: f64) -> bool {
        (self.bounds.0..=self.bounds.1).contains(&value)
    }

    const fn strength(name: &'static str) -> Self {
        Self { role: Role::Strength, default: Some(0.0), ..Self::choice(name, -1e9, 1e9) }
    }

    /// One of many strengths that together describe a curve.
    const fn wave(name: &'static str, share: f64) -> Self {
        Self { share, ..Self::strength(name) }
    }

    const fn shape(name: &'static str, low: f64, high: f64) -> Self {
        Self { role: Role::Shape, ..Self::choice(name, low, high) }
    }

    const fn placed(name: &'static str, role: Role, limit: f64) -> Self {
        Self { role, ..Self::choice(name, -limit, limit) }
    }

    const fn form(name: &'static str, high: f64) -> Self {
        Self { role: Role::Form, default: Some(0.0), ..Self::choice(name, 0.0, high) }
    }

    const fn choice(name: &'static str, low: f64, high: f64) -> Self {
        Self { name, role: Role::Choice, bounds: (low, high), share: f64::INFINITY, default: None }
    }

    const fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }
}

/// What an effect is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// The joint.
    Physics,
    /// The measurement: the joint is innocent.
    Fault,
    /// Something outside both: no model of the joint should hold it.
    Outside,
}

/// Where an effect shows most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Region {
    /// Travel since the last reversal.
    AfterReversal,
    /// The joint rests.
    Rest,
    /// Slow motion.
    LowSpeed,
    /// Fast motion.
    HighSpeed,
    /// Moving up.
    Up,
    /// Moving down.
    Down,
    /// Some positions.
    Position,
    /// Large load.
    Load,
    /// Some times.
    Time,
    /// In step with acceleration.
    Acceleration,
    /// In step with another joint.
    OtherJoint,
    /// One frequency in time.
    Frequency,
    /// The sensor at the end of its range.
    Clipped,
    /// Short stretches that are not repeated.
    Bursts,
    /// No place more than any other.
    Everywhere,
}

impl Region {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::AfterReversal,
        Self::Rest,
        Self::LowSpeed,
        Self::HighSpeed,
        Self::Up,
        Self::Down,
        Self::Position,
        Self::Load,
        Self::Time,
        Self::Acceleration,
        Self::OtherJoint,
        Self::Frequency,
        Self::Clipped,
        Self::Bursts,
        Self::Everywhere,
    ];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::AfterReversal => "after_reversal",
            Self::Rest => "rest",
            Self::LowSpeed => "low_speed",
            Self::HighSpeed => "high_speed",
            Self::Up => "up",
            Self::Down => "down",
            Self::Position => "position",
            Self::Load => "load",
            Self::Time => "time",
            Self::Acceleration => "acceleration",
            Self::OtherJoint => "other_joint",
            Self::Frequency => "frequency",
            Self::Clipped => "clipped",
            Self::Bursts => "bursts",
            Self::Everywhere => "everywhere",
        }
    }
}

/// What an effect is, apart from its physics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct About {
    /// Its name in files.
    pub id: &'static str,
    /// What it is of.
    pub family: Family,
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
    /// Its parameters, in order.
    pub parameters: &'static [Parameter],
}

/// One effect: what it is, and its hooks. A hook's `p` holds the parameters in the order of [`About::parameters`].
pub trait Effect: Sync + std::fmt::Debug {
    /// What it is.
    fn about(&self) -> &'static About;

    /// Parameter sets to begin a search from, strengths at 0: where in `extent` its shape may lie. None where the campaign
    /// cannot show it.
    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>>;

    /// Whether parameter number `at` does anything with these choices.
    fn uses(&self, _p: &[f64], _at: usize) -> bool {
        true
    }

    /// Whether what was found over `extent` is what the effect is called by.
    fn is_itself(&self, _p: &[f64], _extent: &Extent) -> bool {
        true
    }

    /// What it counts for that numbers found are those that the joint of `extent` has: so many numbers less.
    fn confirmed(&self, _p: &[f64], _extent: &Extent) -> usize {
        0
    }

    /// The most that parameter number `at` may be for a campaign to show it.
    fn most(&self, _at: usize, _extent: &Extent) -> f64 {
        f64::INFINITY
    }

    /// Added to gravity and inertia, N m at the joint.
    fn joint_torque_nm(&self, _p: &[f64], _sample: &Sample<'_>) -> f64 {
        0.0
    }

    /// Added to the two branches, N m at the winch, for a load of `load_nm` there; the one of `down` is negative where it
    /// resists.
    fn friction_nm(&self, _p: &[f64], _sample: &Sample<'_>, _carried: Carried) -> Both<f64> {
        Both { up: 0.0, down: 0.0 }
    }

    /// Multiplies the friction of both branches.
    fn friction_factor(&self, _p: &[f64], _sample: &Sample<'_>) -> f64 {
        1.0
    }

    /// Added to y, N m at the winch, for a load of `load_nm` there.
    fn winch_torque_nm(&self, _p: &[f64], _sample: &Sample<'_>, _load_nm: f64) -> f64 {
        0.0
    }

    /// How far the joint is behind the measured position, rad: under a load of `load_nm` at the joint, the cable pulling with
    /// `pull_nm` there, friction and all.
    fn position_lag_rad(&self, _p: &[f64], _load_nm: f64, _pull_nm: f64) -> f64 {
        0.0
    }

    /// The arctan curve and the clearance that take the place of the model's own.
    fn curve(&self, _p: &[f64]) -> Option<Curve> {
        None
    }

    /// How friction builds up elastically.
    fn presliding(&self, _p: &[f64]) -> Option<Presliding> {
        None
    }

    /// How late the torque is recorded, s.
    fn delay_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// The time constant with which the sensor follows the torque, s.
    fn lag_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Whether all it does is to add torque, in proportion to its strengths.
    fn only_adds(&self) -> bool {
        true
    }

    /// Whether it goes by the time since the campaign began.
    fn needs_clock(&self, _p: &[f64]) -> bool {
        false
    }

    /// What the sensor reads of `torque_nm`, N m.
    fn reading_nm(&self, _p: &[f64], _sample: &Sample<'_>, torque_nm: f64) -> f64 {
        torque_nm
    }

    /// Whether its reading is the end of a range, which noise cannot pass either: it acts after all others.
    fn clips(&self) -> bool {
        false
    }
}

/// Friction as bristles that bend before they slide: dk = sgn(K~ - k) |K~ - k|^exponent |dx| / travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Presliding {
    /// Travel in which a bristle bends, rad.
    pub travel_rad: f64,
    /// Dahl's exponent, dimensionless: 1 is exponential.
    pub exponent: f64,
}

impl Presliding {
    /// What is left of a distance `left` in [0, 1] to the branch after `travel_rad` more: the equation integrated.
    pub fn left(&self, left: f64, travel_rad: f64) -> f64 {
        let share = travel_rad / self.travel_rad;
        if left <= 0.0 || (self.exponent - 1.0).abs() < 1e-6 {
            return left * (-share).exp();
        }
        let power = 1.0 - self.exponent;
        (left.powf(power) - power * share).max(0.0).powf(1.0 / power)
    }
}

/// A change-over of friction: K~ = ( atan(2 p u) / atan(2 p) )^n over the share u of the clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// X_cl, m on the cable.
    pub backlash_m: f64,
    /// Steepness at its start, dimensionless.
    pub p: f64,
    /// Exponent, dimensionless: above 1 the change begins slowly.
    pub n: f64,
}

impl Curve {
    /// How much of the change is done at the share `u` of the clearance.
    pub fn share(&self, u: f64) -> f64 {
        ((2.0 * self.p * u).atan() / (2.0 * self.p).atan()).powf(self.n)
    }
}

/// Values from `low` to `high`, evenly spaced in their logarithm.
fn spaced(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> {
    let ratio = high / low;
    (0..count).map(move |i| low * ratio.powf(i as f64 / (count.max(2) - 1) as f64))
}

/// Speed over which Coulomb friction of an effect changes sign, rad/s: below it encoders tell no direction.
pub const RESTING_RAD_S: f64 = 0.01;

/// `time_s` or `elapsed_s` of `sample`: a clock that starts anew with each trial, or runs through the campaign.
fn clock_s(restarts: f64, sample: &Sample<'_>) -> f64 {
    if restarts > 0.5 { sample.time_s } else { sample.elapsed_s }
}
