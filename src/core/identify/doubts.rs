//! Warnings on an identification: what is outside physics, extrapolated, or not known by itself.

use super::Residual;
use super::whole::rmse_nm;
use crate::model::{Confidence, Direction, Level, Model, Status, Term};
use crate::numerics::statistics::HALF_WIDTH;
use rayon::prelude::*;

/// Beyond the sweeps' speeds the residual may be this many times that within before a word is due.
const EXTRAPOLATED: f64 = 2.0;

/// A word when the model does worse at speeds that no sweep reached.
pub fn extrapolation_warning(residuals: &[Residual], fastest_rad_s: f64, refined: bool) -> Option<String> {
    // Sum of squares and count within and beyond, and the top speed.
    let sums = |trial: &Residual| {
        let (mut parts, mut top_rad_s) = ([(0.0, 0.0); 2], 0f64);
        for (v, r) in trial.velocity_rad_s.iter().zip(&trial.residual_nm) {
            let (sum, count) = &mut parts[usize::from(v.abs() > 1.1 * fastest_rad_s)];
            (*sum, *count) = (*sum + r * r, *count + 1.0);
            top_rad_s = top_rad_s.max(v.abs());
        }
        (parts, top_rad_s)
    };
    let each: Vec<([(f64, f64); 2], f64)> = residuals.par_iter().map(sums).collect();
    let [here_nm, there_nm] = [0, 1].map(|at| rmse_nm(&each.iter().map(|(parts, _)| parts[at]).collect::<Vec<_>>()));
    let top_rad_s = each.iter().fold(0.0, |top: f64, (_, of_trial)| top.max(*of_trial));
    (there_nm > EXTRAPOLATED * here_nm).then(|| {
        let cure = if refined { "" } else { "; record faster sweeps, or try --refine" };
        format!(
            "the sweeps reach {fastest_rad_s:.2} rad/s, other trials {top_rad_s:.2} rad/s: the RMSE is {:.1} mN m at speeds beyond the sweeps, \
             {:.1} mN m within{cure}",
            1e3 * there_nm,
            1e3 * here_nm
        )
    })
}

/// Beyond this a load coefficient leaves a tenth of the torque, or needs ten times as much.
const MU_C_LARGEST: f64 = 0.9;

/// What is outside physics, whether its interval is narrow or not: what a value usually means there.
fn outside_physics(model: &Model, sweeps: bool) -> Vec<String> {
    let mut doubts = Vec::new();
    for direction in Direction::BOTH {
        let (branch, moving) = (model.friction.of(direction), direction.name());
        let known = |term: Term| model.confidence.get(&term.dotted(direction)).filter(|known| known.low.is_finite());
        let mu_c = branch.mu_c;
        // Lowering a load, friction carries part of it, and mu_c is negative; raising it, friction adds to it. On free motion the
        // load may pull either way.
        let smallest = if sweeps && direction == Direction::Up { 0.0 } else { -MU_C_LARGEST };
        if !(smallest..=MU_C_LARGEST).contains(&mu_c) {
            doubts.push(format!(
                "mu_c = {mu_c:.3} moving {moving} is outside physics ({smallest} to {MU_C_LARGEST}): check gravity_nm, the radii, the \
                 torque's unit and the zero of the position"
            ));
        }
        let is_negative = branch.d < 0.0 && known(Term::Viscous).is_none_or(|known| known.high < 0.0);
        if !sweeps && is_negative {
            doubts.push(format!(
                "d = {:.3} {} moving {moving} is viscous friction that drives the motion: it compensates for an unmodelled effect; do \
                 not use it beyond the recorded speeds",
                branch.d,
                Term::Viscous.unit_on(model.joint.kind, model.joint.drive)
            ));
        }
    }
    doubts.extend(hysteresis_that_drives(model));
    doubts.extend(load_that_drives(model));
    doubts
}

/// Friction that grows with the load takes energy from a load that pulls down: A moving up is the larger one, and with it mu_c.
fn load_that_drives(model: &Model) -> Option<String> {
    let known = |direction: Direction| model.confidence.get(&Term::Load.dotted(direction));
    let (up, down) = (known(Direction::Up)?, known(Direction::Down)?);
    let value = |direction: Direction| model.friction.of(direction).mu_c;
    (up.high < down.low).then(|| {
        format!(
            "mu_c = {:.3} moving up is below mu_c = {:.3} moving down: where the load pulls against moving up, friction that grows with \
             it would drive the motion; unless the load pulls the other way, it compensates for an unmodelled effect",
            value(Direction::Up),
            value(Direction::Down)
        )
    })
}

/// B moving up lies above B moving down, or friction would drive the motion.
fn hysteresis_that_drives(model: &Model) -> Option<String> {
    let up = model.functions.branches.up.as_ref()?;
    let of = |level: &Level| {
        let (width_nm, se_nm) = model.functions.width_nm(level.speed_rad_s)?;
        (width_nm + 2.0 * HALF_WIDTH * se_nm < 0.0).then_some((level.speed_rad_s, width_nm))
    };
    let (speed, width_nm) = up.levels.iter().find_map(of)?;
    let kind = model.joint.kind;
    Some(format!(
        "B(v) moving up lies {:.4} {} below B(v) moving down at {speed:.3} {}: friction that drives the motion; torque_sign or the \
         position's sign is likely wrong",
        -width_nm,
        kind.torque_unit(),
        kind.speed_unit()
    ))
}

/// What a reader should not take at face value.
pub fn doubts(model: &Model, sweeps: bool) -> Vec<String> {
    let mut doubts = outside_physics(model, sweeps);
    // What the form taken leaves out has no interval at all; reports say so at its place.
    let bad = |status: Status| -> Vec<&str> {
        let known = |c: &Confidence| c.status == status && (status != Status::Flat || c.low.is_finite());
        model.confidence.iter().filter(|(_, c)| known(c)).map(|(name, _)| name.as_str()).collect()
    };
    for (status, meaning) in [
        (Status::TradeOff, "correlated with other parameters (trade_off): do not read as separate values"),
        (
            Status::Merged,
            "several parameters of the two-exponential form in one (merged): do not read as the single parameter",
        ),
        (Status::Flat, "not shown by these data (flat): do not use as values"),
        (Status::AtBound, "at the limit of what the data could show (at_bound)"),
    ] {
        let names = bad(status);
        if !names.is_empty() {
            doubts.push(format!("{meaning}: {}", names.join(", ")));
        }
    }
    doubts
}
