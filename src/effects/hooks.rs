//! The physics of an effect, written once over any kind of number: predicted and simulated with `f64`, differentiated with `Dual`,
//! exported as code with `Expression`.

use super::{Carried, Curve, Effect, Presliding, Sample};
use crate::dynamics::Both;
use crate::numerics::dual::Dual;
use crate::numerics::expression::Expression;
use crate::numerics::scalar::Scalar;

/// What an effect does at one sample. `p` holds its parameters in the order of [`super::About::parameters`].
pub trait Hooks<S: Scalar>: Sync {
    /// Added to gravity and inertia, N m at the joint.
    fn joint_torque_nm(&self, _p: &[S], _sample: &Sample<'_, S>) -> S {
        S::from(0.0)
    }

    /// Added to the two branches, N m at the winch, for a load of `load_nm` there; the one of `down` is negative where it
    /// resists.
    fn friction_nm(&self, _p: &[S], _sample: &Sample<'_, S>, _carried: Carried<S>) -> Both<S> {
        Both { up: S::from(0.0), down: S::from(0.0) }
    }

    /// Multiplies the friction of both branches.
    fn friction_factor(&self, _p: &[S], _sample: &Sample<'_, S>) -> S {
        S::from(1.0)
    }

    /// Added to y, N m at the winch, for a load of `load_nm` there.
    fn winch_torque_nm(&self, _p: &[S], _sample: &Sample<'_, S>, _load_nm: S) -> S {
        S::from(0.0)
    }

    /// How far the joint is behind the measured position, rad: under a load of `load_nm` at the joint, the cable pulling with
    /// `pull_nm` there, friction and all.
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
    fn reading_nm(&self, _p: &[S], _sample: &Sample<'_, S>, torque_nm: S) -> S {
        torque_nm
    }
}

/// A number that effects can be evaluated with.
pub trait Evaluated: Scalar {
    /// The physics of `effect` over this number.
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Hooks<Self> + 'e)
    where
        Self: 'e;
}

impl Evaluated for f64 {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Hooks<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}

impl Evaluated for Dual {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Hooks<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}

impl Evaluated for Expression<'_> {
    fn hooks<'e>(effect: &'e (dyn Effect + 'static)) -> &'e (dyn Hooks<Self> + 'e)
    where
        Self: 'e,
    {
        effect
    }
}
