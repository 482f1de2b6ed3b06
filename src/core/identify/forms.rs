//! Which form of (19) the model takes: how many exponentials the points support, and how many are fit for use.
//!
//! More exponentials always fit the points better. But the model has to predict between the points and below the slowest sweep, where every
//! reversal passes; there a form with hardly more points than parameters diverges. So the larger form must stay bounded towards rest, and
//! must be no worse than the smaller one on the whole series. The criterion depends on the speeds: where they are too few to determine the
//! form, the larger one must be much better; with the full protocol, whose parameters are of interest themselves, it may be slightly worse.

use super::branch::Branch;
use super::stribeck::{ExponentialFit, Points, exponentials};
use crate::model::{Both, Direction, Friction};
use crate::numerics::statistics::{fisher_tail, mean};

/// Friction between rest and the slowest sweep may be this many times the largest that the sweeps saw: static friction is
/// seldom over twice the sliding one.
const EXTRAPOLATION: f64 = 2.5;
/// A form beyond what the data support needs this many speeds for each of its parameters ...
const FEW_SPEEDS: usize = 2;
/// ... and of the full protocol has this many: 20 for two exponentials, with two to spare.
const FULL_SPEEDS: usize = 3;
/// With too few points for Akaike's criterion an F test decides at this level: the search over rates makes it optimistic.
const LEVEL: f64 = 0.01;
/// A form is no worse when its RMSE is at most this multiple of the smaller form's: the effect of noise on an RMSE.
const NO_WORSE: f64 = 1.01;
/// A form on the full protocol's speeds may leave at most this share of it over all samples.
const LITTLE_WORSE: f64 = 1.1;
/// A form that has too few speeds must leave less than this share.
const BETTER_BY_FAR: f64 = 0.9;

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

/// What the friction of both directions leaves of the series: RMSE over all samples and after reversals, N m.
pub type Judge<'a> = dyn Fn(&Both<Friction>) -> [f64; 2] + 'a;

/// Why the model takes fewer exponentials than were asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// There are too few speeds.
    Speeds,
    /// More would run away between rest and the slowest sweep.
    AtRest,
    /// More would leave more of the series: RMSE with more and with those taken, N m.
    Series([f64; 2]),
}

/// A form and why it is no larger.
pub(super) struct Taken {
    /// The form.
    pub form: ExponentialFit,
    /// Why it is no larger; `None` where it is as large as asked for.
    pub cut: Option<Cut>,
}

/// How many exponentials `forms` of the same points support, by Akaike's corrected criterion or, with too few points for
/// it, an F test.
pub(super) fn supported(forms: &[ExponentialFit]) -> usize {
    let better = |best: &'_ ExponentialFit, more: &ExponentialFit| match more.aicc().is_finite() {
        true => more.aicc() < best.aicc(),
        false => chance(best, more) < LEVEL,
    };
    let Some(smallest) = forms.first() else { return 0 };
    forms.iter().fold(smallest, |best, more| if better(best, more) { more } else { best }).rates.len()
}

/// Chance that noise alone makes `more` leave as much less than `fewer` as it does; 1 where it is exactly determined.
fn chance(fewer: &ExponentialFit, more: &ExponentialFit) -> f64 {
    let extra = more.parameters() as f64 - fewer.parameters() as f64;
    if more.freedom() < 1.0 || extra <= 0.0 {
        return 1.0;
    }
    let f = (fewer.residual_sum - more.residual_sum) / extra / (more.residual_sum / more.freedom());
    if f.is_nan() { 1.0 } else { fisher_tail(f, extra, more.freedom()) }
}

/// Takes a form for each direction: the largest asked for that is fit for use.
///
/// From the smallest upwards, both directions at each size, for each is judged with the other's branch in the model.
pub(super) fn choose(branches: &Both<Branch>, judge: Option<&Judge>) -> Both<Taken> {
    let ladders = Both::make(|direction| ladder(branches.of(direction), judge.is_some()));
    let mut places = Both::make(|direction| if judge.is_some() { 0 } else { ladders.of(direction).len() - 1 });
    let mut lost: Both<Option<[f64; 2]>> = Both::default();
    if let Some(judge) = judge {
        let left_by =
            |places: &Both<usize>| judge(&Both::make(|d| branches.of(d).friction(ladders.of(d)[*places.of(d)])));
        let mut here = None;
        for (place, direction) in (1..=2).flat_map(|place| Direction::BOTH.map(|direction| (place, direction))) {
            let Some(larger) = ladders.of(direction).get(place) else { continue };
            let left = here.unwrap_or_else(|| left_by(&places));
            let mut higher = places;
            *higher.of_mut(direction) = place;
            let then = left_by(&higher);
            if is_fit(branches.of(direction), larger, left, then) {
                (places, here) = (higher, Some(then));
            } else {
                (*lost.of_mut(direction), here) = (Some([then[0], left[0]]), Some(left));
            }
        }
    }
    Both::make(|direction| {
        let form = ladders.of(direction)[*places.of(direction)].clone();
        let cut = cut(branches.of(direction), &form, *lost.of(direction));
        Taken { form, cut }
    })
}

/// The forms worth comparing, the smallest first; at least one.
fn ladder(branch: &Branch, judged: bool) -> Vec<&ExponentialFit> {
    let usable = |form: &&ExponentialFit| {
        form.rates.is_empty()
            || form.rates.len() <= branch.wanted
                && holds_at_rest(|u| form.b_nm(u), &branch.points)
                && (judged || has_speeds(branch, form))
    };
    let mut ladder: Vec<&ExponentialFit> = branch.forms.iter().filter(usable).collect();
    // Where the points support an exponential, the form without one is not an alternative.
    if branch.supported > 0 && ladder.get(1).is_some_and(|form| has_speeds(branch, form)) {
        ladder.remove(0);
    }
    // What the full protocol's points support needs no comparison with less.
    let settled = |form: &&ExponentialFit| form.rates.len() == branch.supported && is_full(branch, form);
    if let Some(at) = ladder.iter().position(settled) {
        ladder.drain(..at);
    }
    ladder
}

/// Whether the points are as many as the full protocol's for `form`.
fn is_full(branch: &Branch, form: &ExponentialFit) -> bool {
    branch.points.distinct_speeds() >= FULL_SPEEDS * form.parameters()
}

/// Whether the points can tell that `form` is a good one: they support it, or there are enough of them to take it even so.
fn has_speeds(branch: &Branch, form: &ExponentialFit) -> bool {
    form.rates.len() <= branch.supported || branch.points.distinct_speeds() >= FEW_SPEEDS * form.parameters()
}

/// Whether `larger`, which leaves `then` of the series where a smaller form leaves `here`, is fit for use.
fn is_fit(branch: &Branch, larger: &ExponentialFit, here: [f64; 2], then: [f64; 2]) -> bool {
    // Where nothing could be compared, NaN, nothing speaks against it.
    let worse = match is_full(branch, larger) {
        true => then[0] > LITTLE_WORSE * here[0],
        false => here.iter().zip(&then).any(|(here, then)| *then > NO_WORSE * here),
    };
    !worse && (has_speeds(branch, larger) || then[0] < BETTER_BY_FAR * here[0])
}

/// Why `taken` is smaller than what was asked for; `lost` is what a larger one left of the series beside the one taken.
fn cut(branch: &Branch, taken: &ExponentialFit, lost: Option<[f64; 2]>) -> Option<Cut> {
    if taken.rates.len() >= branch.wanted {
        return None;
    }
    let asked = branch.forms.iter().find(|form| form.rates.len() == branch.wanted);
    Some(match (asked, lost) {
        (Some(asked), lost) if has_speeds(branch, asked) => lost.map_or(Cut::AtRest, Cut::Series),
        _ => Cut::Speeds,
    })
}

/// Whether `b_nm`, B of the speed |v|, stays sane below the speeds that it was fitted to: every reversal passes there.
pub(super) fn holds_at_rest(b_nm: impl Fn(f64) -> f64, points: &Points) -> bool {
    let largest_nm = points.b_nm.iter().fold(0f64, |m, b| m.max(b.abs()));
    let (slowest, _) = points.speed_range_rad_s();
    let sign = mean(&points.b_nm).signum();
    // Nor does its sign change, except by as much as a sensor's offset may cause.
    let sane = -0.5 * largest_nm..=EXTRAPOLATION * largest_nm;
    [0.0, 0.25, 0.5].iter().all(|share| sane.contains(&(sign * b_nm(share * slowest))))
}

/// Why `supported`, in words.
pub(super) fn why(forms: &[ExponentialFit], supported: usize) -> String {
    let leave = |fit: &ExponentialFit| {
        let verb = if fit.rates.len() == 2 { "leave" } else { "leaves" };
        format!("{} {verb} {:.2e} N m", exponentials(fit.rates.len()), fit.rmse_nm)
    };
    let step = |pair: &[ExponentialFit]| {
        let (fewer, more) = (&pair[0], &pair[1]);
        let change = more.aicc() - fewer.aicc();
        if more.freedom() < 1.0 {
            return format!("{} would be exactly determined by the points", exponentials(more.rates.len()));
        }
        let by = match chance(fewer, more) {
            _ if change.is_finite() => {
                format!("AICc {} by {:.1}", if change < 0.0 { "falls" } else { "rises" }, change.abs())
            }
            p if p < 1e-4 => "F test p < 0.0001".to_string(),
            p => format!("F test p = {p:.4}"),
        };
        format!("{} ({by})", leave(more))
    };
    let verdict = format!("the data support {}", exponentials(supported));
    match forms {
        [only] if only.freedom() < 1.0 => "B(v) is exactly determined: as many parameters as points".to_string(),
        [_] => format!("{verdict}: too few speeds for more"),
        [smallest, ..] => {
            let steps: Vec<String> = forms.windows(2).map(step).collect();
            format!("{verdict}: {}; {}", leave(smallest), steps.join("; "))
        }
        [] => verdict,
    }
}
