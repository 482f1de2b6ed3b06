//! Step 5 of the protocol: mu_c from A (18), the other six parameters from B(v) (19), each with what the data know of it.

use super::branch::Branch;
use super::check::few_speeds;
use super::confidence::{demote, merged, spanning};
use super::covariance::Covariance;
use super::forms::{self, Cut, Judge, Taken};
use super::legs::{Amplitude, LegFit, weights};
use super::scale::{CONSPIRING, Scale};
use super::stribeck::{ExponentialFit, Points, Profile, exponentials};
use crate::log::Uncertainty;
use crate::model::{Both, Confidence, Direction, Friction, Joint, SharedError, Term};
use crate::numerics::statistics::{mean, standard_deviation};
use crate::problem::{Problem, Result};
use std::path::Path;

pub use super::forms::Form;

/// Exponentials of (19).
const FULL: usize = 2;
/// Speeds at which the confidence band of B is drawn.
const BAND_POINTS: usize = 60;

/// The fit of one direction.
#[derive(Debug, Clone)]
pub struct FrictionFit {
    /// The direction.
    pub direction: Direction,
    /// Its amplitude A.
    pub a: Amplitude,
    /// The seven parameters.
    pub friction: Friction,
    /// What is known of each, in the order of [`Term::ALL`].
    pub confidence: [Confidence; Term::COUNT],
    /// What is known of them together, or in words why that cannot be said.
    pub covariance: std::result::Result<Covariance, &'static str>,
    /// The points B(v).
    pub points: Points,
    /// The fit that the model took.
    pub taken: ExponentialFit,
    /// Its intervals and the band of B; `None` with no more points than parameters.
    pub profile: Option<Profile>,
    /// All forms that the speeds can hold, by their number of exponentials.
    pub forms: Vec<ExponentialFit>,
    /// How many exponentials the data support.
    pub supported: usize,
    /// Why, in words.
    pub why: String,
    /// How many exponentials were asked for.
    pub wanted: usize,
    /// Why the model takes fewer exponentials than were asked for; `None` when it does not.
    pub cut: Option<Cut>,
    /// What A's own error and that of the position's zero add to A and to all points B.
    pub shared: [SharedError; 2],
    /// Share of the variance of B that the taken fit explains; NaN where it is exactly determined.
    pub r_squared: f64,
}

/// What B(v) is fitted to.
pub struct Data<'a> {
    /// Every leg, with B.
    pub legs: &'a [LegFit],
    /// A of each direction.
    pub a: &'a Both<Amplitude>,
    /// The joint's geometry.
    pub joint: &'a Joint,
    /// How far what is declared may be off.
    pub uncertainty: &'a Uncertainty,
    /// The load at the joint that A belongs to, N m (`legs::load_of_a_nm`).
    pub load_nm: f64,
    /// The file named when the data contradict the geometry.
    pub campaign: &'a Path,
}

/// Fits both directions at once, in the form asked for or, where it is not fit for use, a smaller one.
///
/// `judge` compares forms on the whole series; without it B(v) alone decides.
pub fn fit_friction(data: &Data, form: Form, judge: Option<&Judge>) -> Result<Both<FrictionFit>> {
    let (up, down) = rayon::join(|| branch(data, Direction::Up, form), || branch(data, Direction::Down, form));
    let branches = Both { up: up?, down: down? };
    let taken = forms::choose(&branches, judge);
    let (up, down) = rayon::join(|| take(&branches.up, &taken.up), || take(&branches.down, &taken.down));
    Ok(Both { up, down })
}

/// The points and forms of one direction.
fn branch(data: &Data, direction: Direction, form: Form) -> Result<Branch> {
    let a = *data.a.of(direction);
    let mine: Vec<&LegFit> = data.legs.iter().filter(|leg| leg.direction == direction).collect();
    if let Some(few) = few_speeds(direction, mine.iter().map(|leg| leg.speed_rad_s), data.campaign) {
        return few.alone();
    }
    let weights = weights(&mine);
    let weighted = mine.iter().zip(&weights.each).map(|(leg, weight)| (leg.speed_rad_s, leg.b_nm, *weight));
    let points = Points::new(weighted.collect()).claiming(weights.variance_nm2);
    let forms: Vec<ExponentialFit> = (0..=2).filter_map(|n| points.fit(n)).collect();
    if forms.first().is_none_or(|form| !form.rates.is_empty()) {
        return Problem::error(data.campaign, "B(v) has no solution", "check the sweeps' speeds").alone();
    }
    let supported = forms::supported(&forms);
    let wanted = match form {
        Form::Two => 2,
        Form::One => 1,
        Form::Supported => supported,
    };
    let over_legs = |of: fn(&LegFit) -> f64| mean(&mine.iter().map(|leg| of(leg)).collect::<Vec<f64>>());
    let means = [over_legs(|leg| leg.mean_sine), over_legs(|leg| leg.zero.mean_slope)];
    let scale = Scale::new(&a, direction, data.joint, data.load_nm, means, data.uncertainty);
    Ok(Branch { direction, a, scale, points, forms, supported, wanted })
}

/// Confidence of the parameters of (19), which has two exponentials, from that of the parameters of `form`, `known`.
///
/// The exponential of a smaller form stands for two. Its a_j and d are those of (19) as far as the two exponentials determine them: their
/// intervals span those of that form, and where the speeds are too few for it they are merged too.
fn of_the_paper(
    branch: &Branch,
    form: &ExponentialFit,
    mut known: [Confidence; Term::COUNT],
) -> [Confidence; Term::COUNT] {
    if form.rates.len() == FULL {
        return known;
    }
    let full = branch.forms.iter().find(|other| other.rates.len() == FULL).and_then(|full| {
        let profile = branch.points.profile(full, form, Vec::new(), CONSPIRING)?;
        Some(branch.scale.confidence(full, Some(&profile), &branch.points))
    });
    for (at, term) in Term::ALL.into_iter().enumerate() {
        let known = &mut known[at];
        match (term, &full) {
            (Term::JointStribeck | Term::JointDecay, _) if !form.rates.is_empty() => *known = merged(*known),
            (Term::Coulomb | Term::Viscous, Some(full)) => *known = spanning(*known, full[at]),
            (Term::Coulomb | Term::Viscous, None) => *known = merged(*known),
            _ => {}
        }
    }
    known
}

/// The fit with the form that was taken.
fn take(branch: &Branch, Taken { form, cut }: &Taken) -> FrictionFit {
    let (slow, fast) = branch.points.speed_range_rad_s();
    let band = (0..BAND_POINTS).map(|i| slow * (fast / slow).powf(i as f64 / (BAND_POINTS - 1) as f64)).collect();
    let profile = branch.points.profile(form, form, band, CONSPIRING);
    let known = branch.scale.confidence(form, profile.as_ref(), &branch.points);
    let mut confidence = of_the_paper(branch, form, known);
    if !branch.a.describes() {
        demote(confidence.iter_mut());
    }
    // mu_c does not depend on the form.
    if form.rates.len() < branch.supported || cut.is_some_and(|cut| cut == Cut::Speeds) {
        demote(confidence.iter_mut().skip(1));
    }
    FrictionFit {
        direction: branch.direction,
        a: branch.a,
        friction: branch.scale.friction(form),
        confidence,
        covariance: Covariance::new(&branch.scale, form, &branch.points),
        shared: branch.scale.errors(),
        r_squared: r_squared(form, &branch.points.b_nm),
        why: forms::why(&branch.forms, branch.supported),
        supported: branch.supported,
        wanted: branch.wanted,
        cut: *cut,
        points: branch.points.clone(),
        taken: form.clone(),
        profile,
        forms: branch.forms.clone(),
    }
}

fn r_squared(form: &ExponentialFit, b_nm: &[f64]) -> f64 {
    if form.freedom() < 1.0 {
        return f64::NAN;
    }
    let spread_nm = standard_deviation(b_nm) * ((b_nm.len() as f64 - 1.0) / b_nm.len() as f64).sqrt();
    1.0 - (form.rmse_nm / spread_nm).powi(2)
}

/// Warnings about the friction of one direction.
pub fn warnings(fit: &FrictionFit) -> Vec<String> {
    let moving = fit.direction.name();
    let mut words: Vec<String> = warning(fit).into_iter().collect();
    if fit.a.fixed {
        words.push(format!(
            "gravity_nm = 0, no load is measured, and moving {moving} the torque does not follow sin(theta): A is fixed at 0 \
             and mu_c left out"
        ));
    }
    if !fit.a.describes() {
        words.push(format!(
            "moving {moving}, every leg strays from A sin(theta + zero) + B in the same way ({:.0} times what noise would do): look \
             for what else loads the joint (a spring, a ripple over the position); until then nothing of this direction counts as pinned",
            fit.a.misfit
        ));
    }
    if fit.friction.d < 0.0 {
        let [.., of_d] = fit.confidence;
        let doubt = if of_d.high > 0.0 { "; its interval includes zero" } else { "" };
        words.push(format!(
            "d = {:.3} N s/rad moving {moving} is viscous friction that helps the motion{doubt}: beyond the fastest sweep do \
             not use B(v)",
            fit.friction.d
        ));
    }
    words
}

/// A word when the form that the model takes is not the one asked for, or not one that the data support.
fn warning(fit: &FrictionFit) -> Option<String> {
    let (taken, supported) = (fit.taken.rates.len(), fit.supported);
    let b = format!("B(v) moving {} is taken with {}", fit.direction.name(), exponentials(taken));
    let speeds = fit.points.distinct_speeds();
    if fit.taken.freedom() < 1.0 {
        let why = if taken > supported { ", because the whole series supports it" } else { "" };
        return Some(format!(
            "{b}{why}; {speeds} speeds determine it exactly and leave no estimate of its errors: record more"
        ));
    }
    if taken > supported {
        return Some(format!(
            "{b} where the data support {}: beyond the speeds of the sweeps it may diverge; --form supported is safer there",
            exponentials(supported)
        ));
    }
    let reason = match fit.cut? {
        Cut::Speeds => {
            format!("{speeds} speeds are too few to determine more; no parameter of this form counts as pinned")
        }
        Cut::AtRest => {
            "a larger form would diverge between rest and the slowest sweep, where every reversal passes".to_string()
        }
        Cut::Series([larger_nm, taken_nm]) => format!(
            "a larger form would have an RMSE of {:.1} mN m over the whole series, this one {:.1}",
            1e3 * larger_nm,
            1e3 * taken_nm
        ),
    };
    Some(format!("{b}, {} being asked for: {reason}", exponentials(fit.wanted)))
}
