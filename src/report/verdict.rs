//! An identification in plain words with its numbers: what was found, how certain, and its warnings.

use super::identification::parameter;
use super::number::{counted, r_squared, significant};
use super::parameters::parameters;
use super::wording::{Units, moving};
use crate::identify::combination::JudgedOn;
use crate::identify::stribeck::exponentials;
use crate::identify::{CombinationFit, FreeFit, FrictionFit, Identification, Refinement, Route};
use crate::model::{Both, Direction, Status};

/// The verdict in sentences.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// What was identified, how well it meets the data, how sure its parameters are.
    pub short: Vec<String>,
    /// Step by step: load, friction, combination, refinement.
    pub steps: Vec<String>,
}

/// The verdict on `found`.
pub fn verdict(found: &Identification) -> Verdict {
    let units = Units::of(&found.model.joint);
    let mut steps = match &found.route {
        Route::Sweeps(fits) => vec![load(fits, &units), friction(fits, &units)],
        Route::Free(free) => vec![free_motion(free, &units)],
    };
    steps.push(found.combination.as_ref().map_or_else(no_combination, |fit| combination(fit, &units)));
    steps.extend(found.refinement.as_ref().map(|refined| refinement(refined, &units)));
    let mut short = vec![source(found)];
    short.extend(whole_series(found, &units));
    short.push(sureness(found));
    Verdict { short, steps }
}

/// How well the model meets all trials; `None` where no sample could be compared.
fn whole_series(found: &Identification, units: &Units) -> Option<String> {
    let samples: usize = found.residuals.iter().map(|r| r.residual_nm.len()).sum();
    let rmse = units.torque(found.rmse_nm());
    (samples > 0)
        .then(|| format!("RMSE of the model over all trials, to which it was fitted: {rmse}, after the low-pass."))
}

fn source(found: &Identification) -> String {
    let (trials, rows) = (counted(found.trials, "trial", "trials"), counted(found.rows, "row", "rows"));
    let route = match &found.route {
        Route::Sweeps(_) => format!("from {} at constant speed", counted(found.legs.len(), "leg", "legs")),
        Route::Free(_) => "from free motion, as there are no sweeps at constant speed".to_string(),
    };
    format!("The friction of joint {} was identified {route}: {trials}, {rows}.", found.model.joint.name)
}

fn load(fits: &Both<FrictionFit>, units: &Units) -> String {
    let a = |d: Direction| {
        let a = fits.of(d).a;
        let mu_c = significant(fits.of(d).friction.mu_c, 3);
        format!("{} {} (μ_c = {mu_c})", moving(d), units.amplitude(&a))
    };
    format!("The load amplitude A: {}; {}.", a(Direction::Up), a(Direction::Down))
}

fn friction(fits: &Both<FrictionFit>, units: &Units) -> String {
    let met = |d: Direction| {
        let fit = fits.of(d);
        let (taken, supported) = (fit.taken.rates.len(), fit.supported);
        let advice = match taken == supported {
            true => "as the data support".to_string(),
            false => format!("where the data support {}", exponentials(supported)),
        };
        if fit.taken.freedom() < 1.0 {
            return format!("{}, {}, exactly determined by the points", moving(d), exponentials(taken));
        }
        let (rmse, r_squared) = (units.torque(fit.taken.rmse_nm), r_squared(fit.r_squared));
        format!("{}, {} with a fit RMSE of {rmse} (R² {r_squared}), {advice}", moving(d), exponentials(taken))
    };
    format!("Selected form of the friction B(v): {}; {}.", met(Direction::Up), met(Direction::Down))
}

fn free_motion(free: &FreeFit, units: &Units) -> String {
    let (form, held_out) = (free.form.name(free.is_loaded), units.torque(free.held_out_nm));
    let of_load = share_of_load(free).map_or(String::new(), |words| format!(" {words}"));
    format!("The selected form of friction is {form}: RMSE {held_out} on held-out strokes.{of_load}")
}

/// By how much friction grows with the load, where the form taken says so.
pub(super) fn share_of_load(free: &FreeFit) -> Option<String> {
    let of = |direction: Direction| {
        let (share, known) = free.share_of_load(direction)?;
        Some(format!("{share:.3} of it moving {} ({:.3} to {:.3})", direction.name(), known.low, known.high))
    };
    let (up, down) = (of(Direction::Up)?, of(Direction::Down)?);
    Some(format!("Friction grows with the load's size, whichever way it acts: by {up} and {down}."))
}

fn combination(fit: &CombinationFit, units: &Units) -> String {
    let curve = fit.curve();
    let own = parameter(&curve.curve).map_or(String::new(), |(name, x)| format!(" ({name} = {})", significant(x, 4)));
    let best = fit.curves.get(fit.supported).filter(|_| fit.supported != fit.taken);
    let advice = match best {
        Some(best) => format!(", where the data support {}", best.kind.name()),
        None => String::new(),
    };
    let rest = fit.curves.iter().enumerate().filter(|(at, _)| *at != fit.taken);
    let rest: Vec<String> = rest.map(|(_, c)| format!("{} {}", c.kind.name(), units.torque(c.rmse_nm))).collect();
    let there = match fit.judged_on {
        JudgedOn::Reversals => "there",
        JudgedOn::UnseenStrokes => "on held-out strokes",
    };
    format!(
        "After {} friction changes over along the {} curve{own}, with an RMSE of {} {there}{advice}; RMSE of the others: {}.",
        counted(fit.windows, "reversal", "reversals"),
        curve.kind.name(),
        units.torque(curve.rmse_nm),
        rest.join(", ")
    )
}

fn no_combination() -> String {
    "How friction changes over after a reversal could not be identified; the model changes at once (sign).".to_string()
}

/// What refining gained, in a sentence.
pub fn refinement(refined: &Refinement, units: &Units) -> String {
    let (before, after) = (units.torque(refined.before_nm), units.torque(refined.after_nm));
    let kept = match (refined.kept, refined.gained) {
        (true, _) => "the refined model is kept",
        (false, true) => "but its friction diverges towards rest, so the protocol's model is kept",
        (false, false) => "no significant gain, so the protocol's model is kept",
    };
    format!(
        "Refining all parameters on the whole series changes the RMSE from {before} to {after} on held-out trials: {kept}."
    )
}

fn sureness(found: &Identification) -> String {
    let known: Vec<Status> =
        parameters(&found.model).iter().filter(|p| !p.left_out).filter_map(|p| Some(p.confidence?.status)).collect();
    let count = |status: Status| known.iter().filter(|s| **s == status).count();
    let parts = [
        (count(Status::Pinned), "well determined"),
        (count(Status::TradeOff), "correlated with other parameters"),
        (count(Status::Merged), "merged with others in a smaller form"),
        (count(Status::Flat), "not determined by these data"),
        (count(Status::AtBound), "at the limit of what these data could show"),
    ];
    let told: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    format!("Of its {}: {}.", counted(known.len(), "parameter", "parameters"), told.join(", "))
}
