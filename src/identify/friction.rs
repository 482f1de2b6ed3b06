//! Step 5 of the protocol: mu_c from A (18), the other six parameters from B(v) (19), each with what the data know of it.

use super::confidence::demote;
use super::legs::{Amplitude, LegFit, weights};
use super::scale::{CONSPIRING, Scale};
use super::stribeck::{ExponentialFit, Points, Profile, exponentials};
use crate::model::{Both, Confidence, Direction, Friction, Joint};
use crate::numerics::statistics::{fisher_tail, mean, standard_deviation};
use crate::problem::{Problem, Result};
use std::path::Path;

/// A gravity of zero is contradicted by an A of this many half widths.
const CONTRADICTION: f64 = 5.0;
/// Speeds at which the confidence band of B is drawn.
const BAND_POINTS: usize = 60;

/// Friction between rest and the slowest sweep may be this many times the largest that the sweeps saw: static friction is
/// seldom over twice the sliding one.
const EXTRAPOLATION: f64 = 2.5;

/// Which form of (19) the model takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Two exponentials, as the paper: seven parameters; fewer where they would run away towards rest.
    #[default]
    Two,
    /// One exponential; it goes to b_j, c_j, and b_c is zero.
    One,
    /// Whichever the data support.
    Supported,
}

/// The fit of one direction.
#[derive(Debug, Clone)]
pub struct FrictionFit {
    /// The direction.
    pub direction: Direction,
    /// Its amplitude A.
    pub a: Amplitude,
    /// The seven parameters.
    pub friction: Friction,
    /// What is known of each, in the order of `Friction::NAMES`.
    pub confidence: [Confidence; 7],
    /// The points B(v).
    pub points: Points,
    /// The fit that the model took.
    pub taken: ExponentialFit,
    /// Its intervals and the band of B; `None` with no more points than parameters.
    pub profile: Option<Profile>,
    /// All forms that the speeds can hold, by their number of exponentials.
    pub forms: Vec<ExponentialFit>,
    /// How many exponentials the data support, by Akaike's corrected criterion.
    pub supported: usize,
    /// Why, in words.
    pub why: String,
    /// Share of the variance of B that the taken fit explains.
    pub r_squared: f64,
}

impl FrictionFit {
    /// The form with `exponentials`, if the speeds could hold it.
    pub fn form(&self, exponentials: usize) -> Option<&ExponentialFit> {
        self.forms.iter().find(|fit| fit.rates.len() == exponentials)
    }
}

/// Fits both directions at once. `campaign` is the file named when the data contradict the geometry.
pub fn fit_friction(
    legs: &[LegFit],
    a: &Both<Amplitude>,
    joint: &Joint,
    gravity_nm: f64,
    form: Form,
    campaign: &Path,
) -> Result<Both<FrictionFit>> {
    let one = |direction| fit_direction(legs, a, direction, joint, gravity_nm, form, campaign);
    let (up, down) = rayon::join(|| one(Direction::Up), || one(Direction::Down));
    Ok(Both { up: up?, down: down? })
}

fn fit_direction(
    legs: &[LegFit],
    a: &Both<Amplitude>,
    direction: Direction,
    joint: &Joint,
    gravity_nm: f64,
    form: Form,
    campaign: &Path,
) -> Result<FrictionFit> {
    let a = *a.of(direction);
    check_amplitude(&a, direction, gravity_nm, campaign)?;
    let mine: Vec<&LegFit> = legs.iter().filter(|leg| leg.direction == direction).collect();
    let weighted = mine.iter().zip(weights(&mine)).map(|(leg, weight)| (leg.speed_rad_s, leg.b_nm, weight));
    let points = Points::new(weighted.collect());
    let forms: Vec<ExponentialFit> = (0..=2).filter_map(|n| points.fit(n)).collect();
    let Some(best) = forms.iter().min_by(|x, y| x.aicc().total_cmp(&y.aicc())) else {
        let what = format!("{} of all legs move {}: too few speeds for B(v)", mine.len(), direction.name());
        return Problem::error(campaign, what, "record sweeps at six speeds or more, at least two").alone();
    };
    let supported = best.rates.len();
    let wanted = match form {
        Form::Two => 2,
        Form::One => 1,
        Form::Supported => supported,
    };
    let fits = |fit: &&ExponentialFit| {
        fit.rates.len() <= wanted && (fit.rates.is_empty() || holds_at_rest(|u| fit.b_nm(u), &points))
    };
    let Some(taken) = forms.iter().rev().find(fits).cloned() else {
        return Problem::error(campaign, "B(v) has no solution", "check the sweeps' speeds").alone();
    };
    let (slow, fast) = points.speed_range_rad_s();
    let band = (0..BAND_POINTS).map(|i| slow * (fast / slow).powf(i as f64 / (BAND_POINTS - 1) as f64)).collect();
    let profile = points.profile(&taken, band, CONSPIRING);
    let mean_sine = mean(&mine.iter().map(|leg| leg.mean_sine).collect::<Vec<f64>>());
    let scale = Scale::new(&a, direction, joint, gravity_nm, mean_sine);
    let mut confidence = scale.confidence(&taken, profile.as_ref(), &points);
    if !a.describes() {
        demote(confidence.iter_mut());
    }
    let spread_nm =
        standard_deviation(&points.b_nm) * ((points.b_nm.len() as f64 - 1.0) / points.b_nm.len() as f64).sqrt();
    Ok(FrictionFit {
        direction,
        friction: scale.friction(&taken),
        confidence,
        r_squared: 1.0 - (taken.rmse_nm / spread_nm).powi(2),
        why: why(&forms, supported),
        supported,
        a,
        points,
        taken,
        profile,
        forms,
    })
}

/// (18) needs 0 < (r1/r2) G <= A: friction adds to the load that the winch feels on the way up and takes from it on the
/// way down, but a loss factor beyond one, or a signal that falls where gravity rises, is a wrong sign, unit or radius.
fn check_amplitude(a: &Amplitude, direction: Direction, gravity_nm: f64, campaign: &Path) -> Result<()> {
    if gravity_nm != 0.0 && a.a_nm * gravity_nm <= 0.0 {
        let what =
            format!("A = {:.4} N m moving {}, but gravity_nm = {gravity_nm}: opposite signs", a.a_nm, direction.name());
        return Problem::error(campaign, what, "turn torque_sign, or correct gravity_nm or the position's zero")
            .in_column("torque_sign")
            .alone();
    }
    if gravity_nm == 0.0 && a.a_nm.abs() > CONTRADICTION * a.half_width_nm {
        let what = format!(
            "gravity_nm = 0, yet moving {} the torque follows sin(theta) with A = {:.4} N m",
            direction.name(),
            a.a_nm
        );
        return Problem::error(campaign, what, "give the gravity torque at 90 deg").in_column("gravity_nm").alone();
    }
    Ok(())
}

/// Whether `b_nm`, B of the speed |v|, stays sane below the speeds that it was fitted to: every reversal passes there.
pub fn holds_at_rest(b_nm: impl Fn(f64) -> f64, points: &Points) -> bool {
    let largest_nm = points.b_nm.iter().fold(0f64, |m, b| m.max(b.abs()));
    let (slowest, _) = points.speed_range_rad_s();
    let sign = mean(&points.b_nm).signum();
    // It does not turn its sign either, but for what a sensor's offset may do.
    let sane = -0.5 * largest_nm..=EXTRAPOLATION * largest_nm;
    [0.0, 0.25, 0.5].iter().all(|share| sane.contains(&(sign * b_nm(share * slowest))))
}

fn why(forms: &[ExponentialFit], supported: usize) -> String {
    let leave = |fit: &ExponentialFit| {
        let verb = if fit.rates.len() == 2 { "leave" } else { "leaves" };
        format!("{} {verb} {:.2e} N m", exponentials(fit.rates.len()), fit.rmse_nm)
    };
    let compare = |fewer: &ExponentialFit, more: &ExponentialFit| {
        let (k, n) = (more.parameters() as f64, more.points as f64);
        let extra = k - fewer.parameters() as f64;
        let f = (fewer.residual_sum - more.residual_sum) / extra / (more.residual_sum / (n - k));
        let p = fisher_tail(f, extra, n - k);
        let chance = if p < 1e-4 { "p < 0.0001".to_string() } else { format!("p = {p:.4}") };
        format!("{}, {} (F test {chance})", leave(fewer), leave(more))
    };
    let steps: Vec<String> = forms.windows(2).map(|pair| compare(&pair[0], &pair[1])).collect();
    let verdict = format!("the data support {}", exponentials(supported));
    if steps.is_empty() {
        format!("{verdict}: too few speeds for more")
    } else {
        format!("{verdict}: {}", steps.join("; "))
    }
}

/// A word when the torque of the legs does not follow A sin(theta) + B.
pub fn line_warning(fit: &FrictionFit) -> Option<String> {
    (!fit.a.describes()).then(|| {
        format!(
            "moving {}, every leg strays from A sin(theta) + B in the same way ({:.0} times what noise would do): check the zero \
             of the position and what else loads the joint; until then nothing of this direction counts as pinned",
            fit.direction.name(),
            fit.a.misfit
        )
    })
}

/// A word when the model takes fewer exponentials than were asked for, or more than the data support.
pub fn form_warning(fit: &FrictionFit, form: Form) -> Option<String> {
    let wanted = match form {
        Form::Two => 2,
        Form::One => 1,
        Form::Supported => fit.supported,
    };
    let (taken, asked) = (fit.taken.rates.len(), fit.form(wanted));
    let moving = fit.direction.name();
    if taken > fit.supported {
        return Some(format!(
            "B(v) moving {moving} is taken with {} where the data support {}: beyond the speeds of the sweeps it may run \
             away; --form supported is safer there",
            exponentials(taken),
            exponentials(fit.supported)
        ));
    }
    (taken < wanted).then(|| {
        let reason = match asked {
            None => "there are too few speeds for more",
            Some(_) => "more would run away between rest and the slowest sweep, where every reversal passes",
        };
        let (taken, wanted) = (exponentials(taken), exponentials(wanted));
        format!("B(v) moving {moving} is taken with {taken} instead of {wanted}: {reason}")
    })
}
