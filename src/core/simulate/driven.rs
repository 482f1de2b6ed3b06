//! The torque of a joint that moves as prescribed.

use super::course::{Course, Motions};
use crate::dynamics::{Chain, Motion};
use crate::effects::Evaluated;
use crate::model::{Asked, Direction, Model, Passage};

/// y along `course` before the sensor, N m; `chain` takes the place of the model's own gravity and inertia.
pub(super) fn torque_nm<S: Evaluated<Given = f64>>(
    model: &Model<S>,
    chain: Option<&Chain>,
    course: &Course,
    motions: &Motions,
) -> Vec<S> {
    let Some(first) = motions.own.first() else { return Vec::new() };
    let mut passage = Passage::after(model, start(&course.position_rad), first.position, 0.0);
    let mut others = Vec::new();
    let torque = |i: usize| {
        let sample = motions.sample(i, &mut others);
        let own = motions.own[i];
        let asked = asked(model, chain, own, sample.others);
        let k_tilde = passage.step(own.position, Direction::of(own.velocity));
        let contact_nm = course.contact_nm.get(i).copied().unwrap_or(0.0);
        model.driven_nm(&sample, asked, k_tilde).torque_nm + contact_nm
    };
    (0..motions.own.len()).map(torque).collect()
}

/// The direction of the first motion: before it the joint is taken to have moved that way.
pub(super) fn start(positions_rad: &[f64]) -> Direction {
    let first = positions_rad.first().copied().unwrap_or(0.0);
    match positions_rad.iter().find(|x| **x != first) {
        Some(x) if *x < first => Direction::Down,
        _ => Direction::Up,
    }
}

/// What mass asks of the joint.
pub(super) fn asked<S: Evaluated<Given = f64>>(
    model: &Model<S>,
    chain: Option<&Chain>,
    own: Motion,
    others: &[Motion],
) -> Asked<S> {
    let dynamics = &model.dynamics;
    match chain {
        Some(chain) => {
            // Only a joint that lags its encoder asks for the slope, and a chain's takes as long as its torque.
            let lags = model.effects.iter().any(|e| e.effect.lags());
            let needs_slope = lags || !dynamics.position_zero_rad.is_zero();
            let slope_nm_rad = if needs_slope { chain.gravity_slope_nm_rad(own.position, others) } else { 0.0 };
            let rigid = chain.torque(own, others);
            let (gravity_nm, slope_nm_rad) =
                dynamics.at_true_position(S::from(rigid.gravity_nm), S::from(slope_nm_rad));
            Asked { torque_nm: gravity_nm + rigid.inertia_nm + rigid.coriolis_nm, slope_nm_rad }
        }
        None => model.asked_alone(own, S::from(0.0)),
    }
}
