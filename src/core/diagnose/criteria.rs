//! When a cause is enough to be named, and which others are its rivals.

use super::candidates::{Cause, FittedCause, Hypothesis, Set};
use super::compare::{clusters, error_of_sum, is_tie, leaves_more, penalty_apart};
use super::fit::Fit;
use super::folds::Folds;
use super::policy::Policy;
use super::stale::SAME_TORQUE;
use crate::model::groups;

/// Whether friction would have to grow in one direction by exactly as much as it falls in the other: unlikely, if another cause explains as
/// much.
pub fn is_makeshift((cause, how): (Cause, &str)) -> bool {
    cause == Cause::Stale(groups::COULOMB.name) && how == SAME_TORQUE
}

/// The simplest of those that do as well as the best.
pub fn simplest(tried: &[FittedCause], start: f64) -> Option<usize> {
    let best = tried.first()?;
    let equals = tried.iter().enumerate().filter(|(_, t)| is_tie(&best.fit, &t.fit, start));
    equals.min_by_key(|(_, t)| simplicity(t)).map(|(at, _)| at)
}

/// The best of several `forms` of one thing, best first: the simplest of those that do as well as far as noise shows. All that any of them gains is
/// the same thing, and what sets them apart is small beside it: to be simpler by a number says less than to be nearer.
pub fn best_form<'t, 'd>(forms: &'t [FittedCause<'d>]) -> Option<&'t FittedCause<'d>> {
    let best = forms.first()?;
    let (policy, floor_square) = (&best.fit.mask.data.policy, best.fit.mask.floor_square());
    let does_as_well = |form: &&FittedCause<'d>| !is_beyond_noise(policy, form.score() - best.score(), floor_square);
    forms.iter().filter(does_as_well).min_by_key(|form| simplicity(form))
}

/// The less, the simpler: numbers, and whether it is a makeshift.
pub fn simplicity(tried: &FittedCause) -> (usize, bool) {
    (tried.count(), is_makeshift((tried.cause, tried.how)))
}

/// The simplest of the sets `all` that do as well as the best; to contain what was `chosen` is worth one parameter.
pub fn simplest_set<'d>(all: Vec<Set<'d>>, chosen: &[Hypothesis], start: f64) -> Option<Set<'d>> {
    let best = all.iter().min_by(|a, b| a.1.score().total_cmp(&b.1.score()))?.1.clone();
    let contains = |set: &[Hypothesis]| {
        let is_in = |one: &Hypothesis| set.iter().any(|other| (other.cause, other.how) == (one.cause, one.how));
        chosen.iter().all(is_in)
    };
    let makeshifts = |set: &[Hypothesis]| set.iter().filter(|one| is_makeshift((one.cause, one.how))).count();
    let equals = all.into_iter().filter(|(_, fit)| is_tie(&best, fit, start));
    equals.min_by_key(|(set, fit)| (fit.moves.len() + usize::from(!contains(set)), makeshifts(set), !contains(set)))
}

/// A rule that was applied to something.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// What is asked.
    pub rule: &'static str,
    /// Of what.
    pub subject: &'static str,
    /// What was found there.
    pub value: f64,
    /// What it was compared with.
    pub limit: f64,
    /// What followed.
    pub outcome: &'static str,
}

/// Which share of the gap a cause must explain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// That of the first.
    First,
    /// That of a further one.
    Further,
    /// That of a further one whose gain falls to no other cause.
    Distinct,
}

impl Share {
    /// The smallest gain that counts where `gap` of `whole` remains above a floor of `floor_square`, (N m)^2.
    fn least(self, policy: &Policy, (gap, whole, floor_square): (f64, f64, f64)) -> f64 {
        let misfit = policy.further_explained_share * (whole - gap);
        let closing = (policy.further_closing_share * gap).max(policy.further_floors.powi(2) * floor_square);
        let further = |share: f64| (share * gap).max(misfit).min(policy.further_gap_share * whole).min(closing);
        match self {
            Self::First => policy.first_gap_share * gap,
            Self::Further => further(policy.further_remainder_share),
            Self::Distinct => further(policy.distinct_remainder_share),
        }
    }

    /// The smallest change of the prediction that counts, as a share of the floor, RMS.
    fn least_of_floor(self, policy: &Policy) -> f64 {
        if self == Self::First { policy.first_floors } else { policy.further_floors }
    }

    /// That of a further `cause`, if none falls short of its gain by less than this share of it. A function of time can be anything: it
    /// is not distinct.
    pub fn of(policy: &Policy, cause: Cause, distinctness: f64) -> Self {
        if distinctness >= policy.distinct_share { Self::at_best(cause) } else { Self::Further }
    }

    /// That of a further `cause` of which it has yet to show whether it is distinct.
    pub fn at_best(cause: Cause) -> Self {
        if cause.is_of_time() { Self::Further } else { Self::Distinct }
    }
}

/// The share of the gain of `taken` on what is left `without` it, (N m)^2, in which it is ahead of every other cause of `tried`, other forms
/// of the same aside.
pub fn distinctness(taken: &FittedCause, tried: &[FittedCause], without: f64) -> f64 {
    let is_other = |other: &&FittedCause| other.cause != taken.cause && !taken.cause.is_alike(other.cause);
    let second = tried.iter().filter(is_other).map(FittedCause::score).fold(without, f64::min);
    (second - taken.score()) / (without - taken.score()).max(f64::MIN_POSITIVE)
}

/// What a cause must reach to be named.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Its name.
    pub rule: &'static str,
    /// What the cause reaches.
    pub value: f64,
    /// The least that it must reach.
    pub least: f64,
}

impl Requirement {
    /// Whether it is met.
    pub fn is_met(&self) -> bool {
        self.value >= self.least
    }

    /// As a decision about `subject`.
    pub fn decision(self, subject: &'static str, outcome: &'static str) -> Decision {
        Decision { rule: self.rule, subject, value: self.value, limit: self.least, outcome }
    }
}

/// What a fit with one cause more must reach for that to be named, up to the first that it does not; `of_encoder` is what the same would
/// gain from the encoder's errors alone, (N m)^2.
pub fn requirements(
    with: &Fit,
    without: &Fit,
    start: f64,
    share: Share,
    of_encoder: impl FnOnce() -> f64,
) -> Vec<Requirement> {
    let (floor_square, policy) = (with.mask.floor_square(), &with.mask.data.policy);
    let now = without.score();
    let value = now - with.score();
    let gap = (now - floor_square).max(0.0);
    let whole = (start - floor_square).max(0.0);
    let least = share.least(policy, (gap, whole, floor_square));
    let mut all = vec![Requirement { rule: "share of the gap", value, least }];
    let of_floor = Requirement { rule: "floors", value, least: share.least_of_floor(policy).powi(2) * floor_square };
    let penalty_spared = without.prior_penalty - with.prior_penalty;
    let of_base = Requirement { rule: "prior penalty", value: penalty_spared, least: penalty_apart(with, without) };
    let is_imitated = share == Share::First && !of_floor.is_met() && of_base.is_met();
    let sure = || sureness((policy, &with.mask.data.folds), &without.held_out, &with.held_out);
    let beyond_encoder =
        || Requirement { rule: "encoder", value, least: policy.gain_over_encoder * of_encoder().max(0.0) };
    // What the base imitates to within the floor, if only by improbable moves of several of its parameters together, is not seen from cluster to
    // cluster, either: the evidence is its prior.
    let further: Vec<Box<dyn FnOnce() -> Requirement>> = match is_imitated {
        true => vec![Box::new(|| of_base), Box::new(beyond_encoder)],
        false => vec![Box::new(|| of_floor), Box::new(sure), Box::new(beyond_encoder)],
    };
    for requirement in further {
        if all.iter().all(Requirement::is_met) {
            all.push(requirement());
        }
    }
    all
}

/// How surely the squares left fall from `before` to `after`: by several standard errors over clusters, or, where only a few clusters
/// show the cause, with hardly any that it harms.
fn sureness((policy, folds): (&Policy, &Folds), before: &[f64], after: &[f64]) -> Requirement {
    let gains = clusters(folds, before.iter().zip(after).map(|(b, a)| b - a));
    let won: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    let lost: f64 = -gains.iter().filter(|g| **g < 0.0).sum::<f64>();
    let errors = (won - lost) / error_of_sum(&gains).max(1e-9 * won).max(f64::MIN_POSITIVE);
    let (errors_min, lost_share) = (policy.gain_errors, policy.gain_lost_share);
    match errors <= errors_min && lost < lost_share * won {
        true => Requirement { rule: "clusters that gain", value: won / (won + lost), least: 1.0 / (1.0 + lost_share) },
        false => Requirement { rule: "standard errors", value: errors, least: errors_min },
    }
}

/// Causes other than `taken` that do as well with no more numbers (one that a spring over a short way is mistaken for may have one
/// less), as far as noise and the clusters tell, and other forms of it that explain as much within the accuracy of any formula, however many numbers they have; where the joint
/// confirms it, only those that do as well as far as noise shows. Of a parameter out of date that has none of these, the effect known to be
/// mistaken for it that does better by one number more.
pub fn rivals(taken: &FittedCause, tried: &[FittedCause], (start, without): (f64, f64)) -> Vec<Cause> {
    let (mask, policy) = (&taken.fit.mask, &taken.fit.mask.data.policy);
    let spare = |cause: Cause| {
        usize::from(taken.cause.effect().is_some_and(|effect| effect.about().outnumbered_by.contains(&cause.name())))
    };
    let is_rival = |other: &&FittedCause| {
        let behind = other.score() - taken.score();
        // A cause that is surely behind by what no exact formula leaves is no rival, however large the gap is beside which that is little.
        let is_surely_behind = || {
            behind > policy.form_exact_floor_share * mask.floor_square()
                && leaves_more(&taken.fit, &other.fit, policy.gain_errors)
                && !taken.cause.is_alike(other.cause)
        };
        let does_as_well = || {
            other.count() <= taken.count() + spare(other.cause)
                && is_tie(&taken.fit, &other.fit, start)
                && !is_surely_behind()
        };
        let is_confirmed = || taken.is_confirmed() && is_beyond_noise(policy, behind, mask.floor_square());
        other.cause != taken.cause && (does_as_well() || (!is_confirmed() && is_other_form(taken, other, without)))
    };
    let mut found: Vec<Cause> = Vec::new();
    for other in tried.iter().filter(is_rival) {
        if !found.contains(&other.cause) {
            found.push(other.cause);
        }
    }
    let does_better = |other: &&FittedCause| {
        let is_one_more = other.count() == taken.count() + 1 && names(other.cause, taken.cause);
        is_one_more && other.score() < taken.score() && is_tie(&other.fit, &taken.fit, start)
    };
    if found.is_empty() && matches!(taken.cause, Cause::Stale(_)) {
        found.extend(tried.iter().find(does_better).map(|other| other.cause));
    }
    found
}

/// Whether a cause that leaves more by `behind`, (N m)^2, does worse than noise explains: that the joint confirms some numbers of a form says
/// nothing against another that does as well or better.
fn is_beyond_noise(policy: &Policy, behind: f64, floor_square: f64) -> bool {
    behind > policy.tie_floor_share * floor_square
}

/// Whether `other` is the same effect in another form, and explains as much: as far as the clusters can tell, or within what the form of
/// `taken` itself leaves, which is misfit as the other's may be; where `taken` came out in a form that suits the other as well, most of what it
/// gains on what is left `without` it, (N m)^2.
fn is_other_form(taken: &FittedCause, other: &FittedCause, without: f64) -> bool {
    let (mask, policy) = (&taken.fit.mask, &taken.fit.mask.data.policy);
    let misfit = taken.score() - (1.0 + policy.form_exact_floor_share) * mask.floor_square();
    let is_behind = leaves_more(&taken.fit, &other.fit, policy.gain_errors);
    let behind = other.score() - taken.score();
    let is_near = || taken.suits_its_like() && is_indistinct(policy, behind, without - taken.score());
    taken.cause.is_alike(other.cause) && (!is_behind || behind <= misfit || is_near())
}

/// Whether a cause that leaves more by `behind` than one that gains `gain`, (N m)^2, is too near to it to be told from it by that.
fn is_indistinct(policy: &Policy, behind: f64, gain: f64) -> bool {
    behind < policy.distinct_share * gain
}

/// Causes that `taken` is known to be mistaken for and that do as well: only their number of parameters speaks against them.
pub fn seconds(taken: &FittedCause, tried: &[FittedCause], (start, without): (f64, f64)) -> Vec<Cause> {
    let known = rivals(taken, tried, (start, without));
    let mut found: Vec<Cause> = Vec::new();
    for other in tried.iter().filter(|other| other.cause != taken.cause && is_tie(&taken.fit, &other.fit, start)) {
        let is_new = !known.contains(&other.cause) && !found.contains(&other.cause);
        if is_new && (names(taken.cause, other.cause) || names(other.cause, taken.cause)) {
            found.push(other.cause);
        }
    }
    found
}

/// Whether `cause`, an effect, says that it can be mistaken for `other`.
fn names(cause: Cause, other: Cause) -> bool {
    cause.effect().is_some_and(|effect| effect.about().trades_with.contains(&other.name()))
}

#[cfg(test)]
mod tests {
    use super::{Cause, Policy, Share, is_beyond_noise, is_indistinct};

    #[test]
    fn a_form_that_the_joint_confirms_has_the_other_as_a_rival_where_that_does_as_well() {
        let is_beyond = |behind: f64| is_beyond_noise(&Policy::default(), behind, 1.0);
        assert!(is_beyond(0.04) && !is_beyond(0.003) && !is_beyond(-0.03));
    }

    #[test]
    fn of_a_form_that_suits_both_the_other_is_a_rival_if_it_gains_most_of_the_same() {
        let policy = &Policy::default();
        let is_rival = |behind: f64| is_indistinct(policy, behind, 1.0);
        assert!(is_rival(0.99 * policy.distinct_share) && !is_rival(1.01 * policy.distinct_share));
        assert!(!is_rival(1.0), "it gains nothing");
    }

    #[test]
    fn a_weak_cause_is_named_where_no_other_explains_the_same_and_time_explains_anything() {
        let (policy, ripple) = (&Policy::default(), Cause::Effect("torque_ripple"));
        assert_eq!(Share::of(policy, ripple, policy.distinct_share), Share::Distinct);
        assert_eq!(Share::of(policy, ripple, policy.distinct_share - 0.01), Share::Further);
        for of_time in ["sensor_drift", "warm_up"] {
            assert_eq!(Share::of(policy, Cause::Effect(of_time), 1.0), Share::Further);
        }
        // A tenth of a gap of which half remains: enough for a distinct cause, not for any other.
        let floor_square = 1e-3;
        let least = |share: Share| share.least(policy, (0.5, 1.0, floor_square));
        assert!(least(Share::Distinct) < 0.1 && least(Share::Further) > 0.1);
        assert!(Share::First.least_of_floor(policy) < Share::Distinct.least_of_floor(policy));
        // Of what the misfit of a formula explains no share is enough.
        assert!(Share::Distinct.least(policy, (0.03, 1.0, 0.05)) > 0.03);
        // But one that closes a gap of more than a floor is no misfit.
        assert!(Share::Distinct.least(policy, (0.03, 1.0, floor_square)) < 0.03);
    }
}
