//! The hooks of an effect along several samples: each is called once for all of them, so that what the parameters alone decide is worked
//! out once, and the compiler sees the loop.

use super::{Carried, Hooks, Sample};
use crate::dynamics::Both;
use crate::numerics::scalar::Scalar;

/// [`Hooks`] at every one of `samples`; the other slices are as long.
pub trait Along<S: Scalar>: Hooks<S> {
    /// Adds [`Hooks::joint_torque_nm`] to `torque_nm`.
    fn add_joint_torque(&self, p: &[S], samples: &[Sample<'_, S::Given>], asked_nm: &[S], torque_nm: &mut [S]) {
        for ((sample, asked_nm), nm) in samples.iter().zip(asked_nm).zip(torque_nm) {
            *nm += self.joint_torque_nm(p, sample, *asked_nm);
        }
    }

    /// Multiplies `factors` by [`Hooks::friction_factor`].
    fn multiply_friction(&self, p: &[S], samples: &[Sample<'_, S::Given>], factors: &mut [S]) {
        samples.iter().zip(factors).for_each(|(sample, factor)| *factor *= self.friction_factor(p, sample));
    }

    /// Adds [`Hooks::friction_nm`] to `friction_nm`.
    fn add_friction(
        &self,
        p: &[S],
        samples: &[Sample<'_, S::Given>],
        carried: &[Carried<S>],
        friction_nm: &mut [Both<S>],
    ) {
        for ((sample, carried), nm) in samples.iter().zip(carried).zip(friction_nm) {
            let Both { up, down } = self.friction_nm(p, sample, *carried);
            nm.up += up;
            nm.down += down;
        }
    }

    /// Adds [`Hooks::winch_torque_nm`] to `torque_nm`.
    fn add_winch_torque(&self, p: &[S], samples: &[Sample<'_, S::Given>], asked_nm: &[S], torque_nm: &mut [S]) {
        for ((sample, asked_nm), nm) in samples.iter().zip(asked_nm).zip(torque_nm) {
            *nm += self.winch_torque_nm(p, sample, *asked_nm);
        }
    }

    /// Adds [`Hooks::position_lag_rad`] to `lag_rad`.
    fn add_lag(&self, p: &[S], load_nm: &[S], pull_nm: &[S], lag_rad: &mut [S]) {
        for ((load_nm, pull_nm), rad) in load_nm.iter().zip(pull_nm).zip(lag_rad) {
            *rad += self.position_lag_rad(p, *load_nm, *pull_nm);
        }
    }

    /// Replaces `torque_nm` by [`Hooks::reading_nm`] of it.
    fn read(&self, p: &[S], samples: &[Sample<'_, S::Given>], torque_nm: &mut [S]) {
        samples.iter().zip(torque_nm).for_each(|(sample, nm)| *nm = self.reading_nm(p, sample, *nm));
    }
}

impl<S: Scalar, E: Hooks<S>> Along<S> for E {}
