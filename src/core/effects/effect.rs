//! One effect: what a search and a simulator ask of it, and its physics, written once over any kind of number: predicted and
//! simulated with `f64`, differentiated with `Dual`, exported as code with `Expression`.

use super::{About, Along, Carried, Curve, Extent, Presliding, Sample};
use crate::dynamics::Both;
use crate::numerics::dual::Dual;
use crate::numerics::expression::Expression;
use crate::numerics::scalar::Scalar;

/// One effect: what it is, how a search treats it, and its physics in [`Hooks`]. `p` holds its parameters in the order of
/// [`About::parameters`].
pub trait Effect: Along<f64> + Along<Dual> + for<'t> Along<Expression<'t>> + Sync + std::fmt::Debug {
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

    /// Whether these numbers suit an effect that is alike as well as this one.
    fn suits_its_like(&self, _p: &[f64]) -> bool {
        false
    }

    /// By how many the number of its fitted parameters is reduced in comparisons, because their values agree with those that the joint of
    /// `extent` has.
    fn confirmed(&self, _p: &[f64], _extent: &Extent) -> usize {
        0
    }

    /// Limits within which a search keeps parameter number `at`, narrower than its bounds: beyond them a campaign does not show it, or the
    /// effect would be another.
    fn limits(&self, _at: usize, _extent: &Extent) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// What it is in a simulator whose joints know a spring and an inertia.
    fn in_simulator(&self, _p: &[f64]) -> Option<SimulatorJoint> {
        None
    }

    /// The other joint that it follows, counted from 0.
    fn other_joint(&self, _p: &[f64]) -> Option<usize> {
        None
    }

    /// Whether all it does is to add torque, in proportion to its strengths.
    fn only_adds(&self) -> bool {
        true
    }

    /// Whether it depends on the time since the campaign began.
    fn needs_clock(&self, _p: &[f64]) -> bool {
        false
    }

    /// Whether it leaves the joint behind the measured position.
    fn lags(&self) -> bool {
        false
    }

    /// Whether its reading is the end of a range, which noise cannot pass either: it acts after all others.
    fn clips(&self) -> bool {
        false
    }
}

/// What an effect does at one sample. `p` holds its parameters in the order of [`super::About::parameters`].
pub trait Hooks<S: Scalar>: Sync {
    /// Added to gravity, inertia and a measured load, N m at the joint, where those ask `asked_nm`: without what effects add, whose order
    /// does not matter.
    fn joint_torque_nm(&self, _p: &[S], _sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        S::from(0.0)
    }

    /// Added to the two branches, N m at the winch, for a load of `load_nm` there; the one of `down` is negative where it
    /// resists.
    fn friction_nm(&self, _p: &[S], _sample: &Sample<'_, S::Given>, _carried: Carried<S>) -> Both<S> {
        Both { up: S::from(0.0), down: S::from(0.0) }
    }

    /// Multiplies the friction of both branches.
    fn friction_factor(&self, _p: &[S], _sample: &Sample<'_, S::Given>) -> S {
        S::from(1.0)
    }

    /// Added to y, N m at the winch, where the model asks `asked_nm` there, friction and all: without what effects add, whose order does not
    /// matter.
    fn winch_torque_nm(&self, _p: &[S], _sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        S::from(0.0)
    }

    /// How far the joint is behind the measured position, rad: under a load of `load_nm` at the joint, the cable pulling with `pull_nm` there,
    /// friction and all. Asked only of an effect that [`Effect::lags`].
    fn position_lag_rad(&self, _p: &[S], _load_nm: S, _pull_nm: S) -> S {
        S::from(0.0)
    }

    /// The arctan curve and the clearance that take the place of the model's own.
    fn curve(&self, _p: &[S]) -> Option<Curve<S>> {
        None
    }

    /// How friction builds up elastically.
    fn presliding(&self, _p: &[S]) -> Option<Presliding<S>> {
        None
    }

    /// How late the torque is recorded, s.
    fn delay_s(&self, _p: &[S]) -> S {
        S::from(0.0)
    }

    /// The time constant with which the sensor follows the torque, s.
    fn lag_s(&self, _p: &[S]) -> S {
        S::from(0.0)
    }

    /// What the sensor reads of `torque_nm`, N m.
    fn reading_nm(&self, _p: &[S], _sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        torque_nm
    }
}

/// A number that effects can be evaluated with.
pub trait Evaluated: Scalar {
    /// The physics of `effect` over this number.
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Along<Self> + 'e)
    where
        Self: 'e;
}

impl Evaluated for f64 {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Along<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}

impl Evaluated for Dual {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Along<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}

impl Evaluated for Expression<'_> {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Along<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}

/// What an effect is in a simulator's joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SimulatorJoint {
    /// Inertia beyond the link's own, kg m^2.
    pub inertia_kg_m2: f64,
    /// Of a spring, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Torque of that spring at position 0, N m.
    pub preload_nm: f64,
}
