//! What the mass of a chain asks of its joint along a trial, and how that changes with what its last link carries.

use crate::dynamics::{NUMBERS, Payload, RigidTorque};
use crate::log::Campaign;
use crate::model::Model;
use crate::numerics::scalar::Scalar;
use crate::prepare::{Trial, along};

/// At each thinned sample of a trial.
#[derive(Debug)]
pub struct OnChain {
    /// With what the model's last link carries.
    carrying: Vec<Rigid>,
    carried: [f64; NUMBERS],
    /// For each number of a payload, per unit.
    units: [Vec<Rigid>; NUMBERS],
}

/// What mass asks of the joint, N m, and the slope of gravity, N m/rad.
#[derive(Debug, Clone, Copy)]
struct Rigid {
    gravity_nm: f64,
    slope_nm_rad: f64,
    beside_nm: f64,
}

impl OnChain {
    /// Of `trial` at the samples `at`; nothing where the joint moves alone.
    pub fn of(campaign: &Campaign, model: &Model, trial: &Trial, at: &[usize]) -> Option<Self> {
        let arm = campaign.arm.as_ref()?;
        let rigid = |(torque, slope_nm_rad): (RigidTorque, f64)| {
            let RigidTorque { gravity_nm, inertia_nm, coriolis_nm } = torque;
            Rigid { gravity_nm, slope_nm_rad, beside_nm: inertia_nm + coriolis_nm }
        };
        let carrying = trial.chain.as_ref()?;
        let units = arm.chain.units_of_payload();
        Some(Self {
            carrying: at.iter().map(|i| rigid(carrying[*i])).collect(),
            carried: model.dynamics.payload.numbers(),
            units: units
                .each_ref()
                .map(|chain| along(chain, &arm.others, trial, at.iter().copied()).map(rigid).collect()),
        })
    }

    /// Gravity, its slope and the rest of what mass asks of the joint at sample `i`, the last link carrying `payload`.
    pub fn asked<S: Scalar>(&self, i: usize, payload: &Payload<S>) -> (S, S, S) {
        let Rigid { gravity_nm, slope_nm_rad, beside_nm } = self.carrying[i];
        let mut asked = (S::from(gravity_nm), S::from(slope_nm_rad), S::from(beside_nm));
        for ((number, carried), unit) in payload.numbers().into_iter().zip(self.carried).zip(&self.units) {
            let more = number - S::from(carried);
            asked.0 += more * unit[i].gravity_nm;
            asked.1 += more * unit[i].slope_nm_rad;
            asked.2 += more * unit[i].beside_nm;
        }
        asked
    }

    /// Sums of squares of the gravity that the numbers of `payload` bring one by one, and of the rest, (N m)^2.
    pub fn squares(&self, payload: &Payload) -> (f64, f64) {
        let each = || payload.numbers().into_iter().zip(&self.units);
        let of_rows = |rows: &[Rigid], of: fn(&Rigid) -> f64| rows.iter().map(|row| of(row).powi(2)).sum::<f64>();
        let square = |of: fn(&Rigid) -> f64| each().map(|(number, rows)| number * number * of_rows(rows, of)).sum();
        (square(|row| row.gravity_nm), square(|row| row.beside_nm))
    }
}
