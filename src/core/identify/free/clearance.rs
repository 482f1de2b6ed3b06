//! What free motion says of the clearance: whether it contradicts the declared one, whether the estimate has an end.

use super::FreeForm;
use super::halves::Halves;
use super::search::{Judged, Search};
use crate::identify::checks::Check;
use crate::identify::combination::CurveKind;
use crate::identify::moving::{Limits, MAX_BACKLASH};
use crate::identify::predicted::Prepared;
use crate::identify::support::excess;
use crate::identify::whole::{WholeFit, rmse_nm};
use crate::model::Status;
use std::path::Path;

/// A clearance that leaves this much less of the error on strokes not seen contradicts the declared one.
const DOUBT: f64 = 0.9;

/// With which form and curve the clearance is asked for.
pub struct Question<'a> {
    /// The curve.
    pub kind: CurveKind,
    /// The form.
    pub form: FreeForm,
    /// The half that each trial belongs to where whole trials are held out.
    pub folds: &'a [usize],
    /// The campaign's low-pass, Hz.
    pub lowpass_hz: f64,
    /// The campaign's file.
    pub campaign: &'a Path,
}

/// A word when another clearance than the declared one meets strokes that its fit did not see clearly better, with the form
/// and the curve that were taken.
pub fn doubt(trials: &[Prepared], declared: &Search, asked: &Question) -> Option<Check> {
    // A jump does not know the clearance; a straight line through one does.
    let kind = if asked.kind == CurveKind::Sign { CurveKind::Linear } else { asked.kind };
    let widest_rad = MAX_BACKLASH * declared.limits.stroke_rad;
    // Where no stroke is long enough to look for one, none is asked for.
    let halves = Halves::new(trials, asked.folds, widest_rad, asked.lowpass_hz, asked.campaign).ok()?;
    let with = |estimate_backlash| Search { halves: &halves, estimate_backlash, ..*declared };
    let judge = |estimate| -> Judged {
        let load = with(estimate).judge_load(kind);
        if asked.form == FreeForm::Load { load } else { with(estimate).judge_form(kind, asked.form, &load) }
    };
    let (kept, free) = rayon::join(|| judge(false), || judge(true));
    let (kept_nm, free_nm) = (rmse_nm(&kept.sums), rmse_nm(&free.sums));
    let (gain, error) = excess(&kept.squares(), &free.squares());
    let contradicts = free_nm <= DOUBT * kept_nm && gain > error;
    if !contradicts {
        return None;
    }
    let fit = with(true).fit(kind, asked.form, &free);
    let clearance = match limit(&fit, declared.limits) {
        Some(limit) => limit,
        None => format!("near {:.3} mm", 1e3 * fit.model.joint.backlash_m),
    };
    let failure = format!(
        "the reversals ask for a clearance {clearance}, not the declared backlash_m = {:.3} mm: on held-out strokes it leaves \
         {:.2} mN m, the declared one {:.2}; try --estimate-backlash",
        1e3 * declared.start.joint.backlash_m,
        1e3 * free_nm,
        1e3 * kept_nm
    );
    let concerns = vec!["combination.".to_string()];
    Some(Check { name: "clearance", concerns, value: kept_nm / free_nm, limit: 1.0 / DOUBT, failure })
}

/// A word when the estimate of the clearance ended where the search for it does.
pub fn limit_warning(fit: &WholeFit, limits: &Limits) -> Option<String> {
    let limit = limit(fit, limits)?;
    Some(format!(
        "the estimated clearance is {limit}: the change-over has no clear end here; do not use it as a clearance"
    ))
}

/// The limit that the clearance of `fit` ended at, in words.
fn limit(fit: &WholeFit, limits: &Limits) -> Option<String> {
    let known = fit.confidence.iter().find(|(name, _)| name == "joint.backlash_m");
    known.filter(|(_, known)| known.status == Status::AtBound)?;
    let (backlash_m, stroke_m) = (fit.model.joint.backlash_m, limits.stroke_rad * limits.pulley_radius_m);
    Some(if backlash_m > 0.5 * MAX_BACKLASH * stroke_m {
        format!("at the largest looked for, {:.3} mm (half the longest stroke)", 1e3 * backlash_m)
    } else {
        format!("at the smallest looked for, {:.2e} mm", 1e3 * backlash_m)
    })
}
