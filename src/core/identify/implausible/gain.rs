//! A load that the torque follows too little or too much, and which mistake would explain by how much.

use super::super::legs::load_of_a_nm;
use super::{Cause, Doubt, Evidence};
use crate::log::Campaign;

/// 1 / (1 - mu_c) of joints: friction gives nothing, and takes less than half of the load; the low end leaves room for declared
/// constants that are off by a few percent.
const GAIN: std::ops::Range<f64> = 0.92..2.0;
/// The low end where the load is measured: its sensor's noise takes from the gain.
const GAIN_OF_MEASURED: f64 = 0.5;
/// A winch this much larger than the pulley is unusual enough to think of a swap.
const SWAPPED: f64 = 1.5;
/// The gain of an ordinary joint, to say by how much a constant is off.
const USUAL_GAIN: f64 = 1.3;
/// A mistake explains a gain if without it the gain is within this.
const EXPLAINED: std::ops::Range<f64> = 0.9..2.2;
/// A gravity torque beyond this was given in another unit, N m.
const GRAVITY_MOST_NM: f64 = 200.0;

/// A mistake that people make.
struct Mistake {
    /// Factor by which it changes the gain.
    factor: f64,
    /// Whether it can have been made at all.
    is_possible: bool,
    /// What it concerns, the likeliest first.
    causes: &'static [Cause],
    /// What it looks like, and what to do.
    cure: String,
}

/// A load that the torque follows too little or too much.
pub(super) fn gain(campaign: &Campaign, found: &Evidence) -> Option<Doubt> {
    let gain = found.gain.hypot(found.gain * found.zero_rad.tan());
    let low = if campaign.columns.load_torque.is_some() { GAIN_OF_MEASURED } else { GAIN.start };
    if (low..GAIN.end).contains(&gain) {
        return None;
    }
    let (side, times) = if gain > USUAL_GAIN { ("large", gain / USUAL_GAIN) } else { ("small", USUAL_GAIN / gain) };
    let explains = |mistake: &Mistake| mistake.is_possible && EXPLAINED.contains(&(gain / mistake.factor));
    let known = mistakes(campaign, side, times).into_iter().find(explains);
    let (causes, cure) = known.map_or_else(|| unexplained(side, times), |mistake| (mistake.causes, mistake.cure));
    let what = format!(
        "the torque follows {} times what gravity and the radii ask for, where friction makes it 1 to 2 times",
        shown(gain)
    );
    Some(Doubt { causes: causes.to_vec(), what, cure })
}

/// The mistakes that people make, the likeliest first; the torque is too `side` by `times`.
fn mistakes(campaign: &Campaign, side: &str, times: f64) -> Vec<Mistake> {
    use Cause::{Gravity, Radius, Scale};
    let ratio = campaign.joint.transmission();
    let load_nm = load_of_a_nm(campaign);
    let is_heavy = load_nm.abs() > GRAVITY_MOST_NM;
    let one = |factor, is_possible, causes, cure: &str| Mistake { factor, is_possible, causes, cure: cure.to_string() };
    let heavy = format!("gravity_nm = {load_nm} looks 1000 times too large: given in mN m?");
    let direct = format!(
        "the torque looks {side} by {times:.2}, about r2/r1: measured at the joint, not at the winch (then drive = \"direct\")? Or a radius, or \
         gravity_nm is off by that"
    );
    vec![
        one(1e3, true, &[Scale], "the torque looks 1000 times too large: recorded in mN m?"),
        one(1e-3, is_heavy, &[Gravity], &heavy),
        one(1e-3, true, &[Scale], "the torque looks 1000 times too small: recorded in kN m, or mN m declared twice?"),
        // What a swap of the radii would make of the gain.
        one(
            ratio.powi(-2),
            ratio > SWAPPED,
            &[Radius, Scale, Gravity],
            "the radii look swapped: winch_radius_m is the motor's, pulley_radius_m the joint's",
        ),
        one(1.0 / ratio, 1.0 / ratio > GAIN.end, &[Scale, Radius, Gravity], &direct),
        one(100.0, true, &[Scale, Gravity, Radius], "the torque looks 100 times too large: recorded in N cm?"),
        one(0.01, true, &[Scale, Gravity, Radius], "the torque looks 100 times too small: N m declared as N cm?"),
        one(
            9.81,
            true,
            &[Gravity, Scale, Radius],
            "gravity_nm looks 9.81 times too small: mass times distance without g? Or the torque is in kgf m",
        ),
        one(
            1.0 / 9.81,
            true,
            &[Gravity, Scale, Radius],
            "gravity_nm looks 9.81 times too large: g taken twice? Or the torque's scale is off by that",
        ),
    ]
}

/// What to say where no mistake explains the gain.
fn unexplained(side: &str, times: f64) -> (&'static [Cause], String) {
    let (nominal, read) = if side == "large" { ("small", "large") } else { ("large", "small") };
    let cure = format!(
        "gravity_nm or the winch's radius is too {nominal}, the pulley's radius or the torque too {read}, by about {times:.1}: a diameter for a radius?"
    );
    (&[Cause::Gravity, Cause::Radius, Cause::Scale], cure)
}

/// A factor with as many digits as it deserves.
fn shown(factor: f64) -> String {
    if factor >= 100.0 {
        format!("{factor:.0}")
    } else if factor >= 0.01 {
        format!("{factor:.2}")
    } else {
        format!("{factor:.1e}")
    }
}
