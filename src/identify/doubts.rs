//! What a reader of an identification should distrust.

use super::Residual;
use crate::model::{Confidence, Direction, Model, Status};
use crate::numerics::statistics::root_mean_square;

/// Beyond the sweeps' speeds the residual may be this many times that within before a word is due.
const EXTRAPOLATED: f64 = 2.0;

/// A word when the model does worse at speeds that no sweep reached.
pub fn extrapolation_warning(residuals: &[Residual], fastest_rad_s: f64, refined: bool) -> Option<String> {
    let (mut within, mut beyond) = (Vec::new(), Vec::new());
    let mut top_rad_s = 0f64;
    for (v, r) in residuals.iter().flat_map(|t| t.velocity_rad_s.iter().zip(&t.residual_nm)) {
        if v.abs() > 1.1 * fastest_rad_s {
            beyond.push(*r)
        } else {
            within.push(*r)
        }
        top_rad_s = top_rad_s.max(v.abs());
    }
    let (here_nm, there_nm) = (root_mean_square(&within), root_mean_square(&beyond));
    (there_nm > EXTRAPOLATED * here_nm).then(|| {
        let cure = if refined { "" } else { "; record faster sweeps, or try --refine" };
        format!(
            "the sweeps reach {fastest_rad_s:.2} rad/s, other trials {top_rad_s:.2}: beyond the sweeps the model leaves \
             {:.1} mN m, within {:.1}{cure}",
            1e3 * there_nm,
            1e3 * here_nm
        )
    })
}

/// What a reader should not take at face value.
pub fn doubts(model: &Model, sweeps: bool) -> Vec<String> {
    let mut doubts = Vec::new();
    for direction in Direction::BOTH {
        let mu_c = model.friction.of(direction).mu_c;
        // On free motion a load that pulls the other way makes it negative, rightly.
        if sweeps && !(0.0..0.9).contains(&mu_c) {
            doubts.push(format!(
                "mu_c = {mu_c:.3} moving {} is no likely friction coefficient: check gravity_nm, the radii, the torque's unit and the \
                 zero of the position",
                direction.name()
            ));
        }
    }
    // What the form taken leaves out has no interval at all; reports say so at its place.
    let bad = |status: Status| -> Vec<&str> {
        let known = |c: &Confidence| c.status == status && (status != Status::Flat || c.low.is_finite());
        model.confidence.iter().filter(|(_, c)| known(c)).map(|(name, _)| name.as_str()).collect()
    };
    for (status, meaning) in [
        (Status::TradeOff, "known only together with others (trade_off): do not read as separate values"),
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
