//! Whether a model is of the joint that a campaign recorded.

use crate::log::{Arm, Campaign};
use crate::model::Model;
use crate::problem::{Problem, Problems, Result};
use std::borrow::Cow;

/// Radii that differ by less than this share are the same, written with fewer digits.
const SAME: f64 = 1e-3;
/// Gravity torques that differ by more than this share of the larger one deserve a word.
const GRAVITY_DIFFERS: f64 = 0.02;

/// `campaign` and `model` as they are used together, if they are of one joint: a chain carries what the model says, a model has the kind
/// of the campaign's joint. What differs without harm comes back as warnings.
///
/// Errors: another joint's name, kind or radii.
pub fn fitted<'c>(campaign: &'c Campaign, model: &Model) -> Result<(Cow<'c, Campaign>, Model, Vec<String>)> {
    let mut model = model.clone();
    // A model's file need not declare the kind of its joint; with both radii 1 no winch is known.
    if (model.joint.winch_radius_m, model.joint.pulley_radius_m) == (1.0, 1.0) {
        model.joint.kind = campaign.joint.kind;
    }
    let (theirs, ours) = (&campaign.joint, &model.joint);
    let mut problems = Vec::new();
    let mut differs = |key: &str, of_model: String, of_campaign: String| {
        let what = format!("the model has {of_model}, the campaign {of_campaign}");
        let cure = "take the model that was identified on this joint";
        problems.push(Problem::error(&campaign.file, what, cure).in_column(format!("joint.{key}")));
    };
    if ours.name != theirs.name {
        differs("name", format!("joint `{}`", ours.name), format!("joint `{}`", theirs.name));
    }
    if ours.kind != theirs.kind {
        differs("kind", format!("a {} joint", ours.kind.name()), format!("a {} one", theirs.kind.name()));
    }
    for (key, a, b) in [
        ("winch_radius_m", ours.winch_radius_m, theirs.winch_radius_m),
        ("pulley_radius_m", ours.pulley_radius_m, theirs.pulley_radius_m),
    ] {
        if (a - b).abs() > SAME * b {
            differs(key, format!("{a} m"), format!("{b} m"));
        }
    }
    if let (Some(of), Some(arm)) = (&model.chain, &campaign.arm)
        && of.joint != arm.chain.joint()
    {
        differs("name", format!("joint `{}` of its chain", of.joint), format!("joint `{}`", arm.chain.joint()));
    }
    if let (Some(of), None) = (&model.chain, &campaign.arm) {
        let what = format!(
            "the model takes gravity and inertia from joint `{}` of {}, the campaign names no URDF",
            of.joint, of.urdf
        );
        let cure = "add urdf and joint under [dynamics], and the other joints' positions under [columns]";
        problems.push(Problem::error(&campaign.file, what, cure).in_column("dynamics"));
    }
    let mut warnings: Vec<String> = campaign.warnings.iter().map(Problem::to_string).collect();
    let (a, b) = (model.dynamics.gravity_nm, campaign.dynamics.gravity_nm);
    if campaign.arm.is_none() && (a - b).abs() > GRAVITY_DIFFERS * a.abs().max(b.abs()) {
        warnings.push(format!(
            "the model's gravity_nm is {a}, the campaign's {b}: the model's is used; with another load on the joint friction \
             and load cannot be told apart"
        ));
    }
    let mut carrying = Cow::Borrowed(campaign);
    if let (Some(arm), false) = (&campaign.arm, model.dynamics.payload.is_none()) {
        carrying.to_mut().arm = Some(Arm { chain: arm.chain.carrying(&model.dynamics.payload), ..arm.clone() });
    }
    Problems(problems).unless_errors((carrying, model, warnings))
}
