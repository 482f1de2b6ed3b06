//! How probable each answer is: how often verdicts of the kind were right on joints whose answers were withheld, and how often the resamples
//! agree.

use super::answer::{Answer, Kind};
use super::candidates::Cause;
use super::policy::Policy;

/// How blind simulated joints turned out of which a verdict of one kind was given.
#[derive(Debug, Clone, Copy)]
struct Outcomes {
    /// The verdict was right.
    right: f64,
    /// Nothing was missing.
    none: f64,
    /// The cause was none of the library's.
    outside: f64,
    /// Another cause, or further ones.
    other: f64,
}

impl Kind {
    /// What became of verdicts of this kind on simulated joints whose answers were withheld: counts that `scripts/blind/score.py` prints
    /// ("verdict said") for 240 cases of each generator, drawn fresh (seeds 8001 and 9001 of `formula`, 8002 and 9002 of `physical`, 8003 and 9003
    /// of `laboratory`); of an effect and of several causes, by whether they were clear.
    fn outcomes(self, is_clear: bool) -> Outcomes {
        let (right, none, outside, other) = match (self, is_clear) {
            (Self::None, _) => (85.0, 0.0, 5.0, 15.0),
            (Self::Stale, _) => (75.0, 0.0, 2.0, 6.0),
            (Self::Effect, true) => (231.0, 0.0, 2.0, 7.0),
            (Self::Effect, false) => (47.0, 0.0, 1.0, 11.0),
            (Self::Several, true) => (57.0, 0.0, 2.0, 16.0),
            (Self::Several, false) => (5.0, 0.0, 4.0, 7.0),
            (Self::Ambiguous, _) => (58.0, 0.0, 3.0, 9.0),
            (Self::Unknown, _) => (56.0, 0.0, 0.0, 16.0),
        };
        Outcomes { right, none, outside, other }
    }
}

/// The answers with their probabilities, after a verdict of `kind`; `is_clear` says whether it is. What is left for others is shared out as verdicts
/// of this kind turned out when they were wrong; Laplace's rule adds one to each count.
pub fn probabilities(
    policy: &Policy,
    (kind, is_clear): (Kind, bool),
    agreement: f64,
    effects: &[Cause],
) -> Vec<(Answer, f64)> {
    let Outcomes { right, none, outside, other } = kind.outcomes(is_clear);
    let weight = match kind {
        Kind::None | Kind::Unknown => 1.0,
        _ => policy.disagreement_weight,
    };
    let said = (1.0 - weight * (1.0 - agreement)).max(0.0) * (right + 1.0) / (right + none + outside + other + 2.0);
    let wrong = none + outside + other + 3.0;
    let share = |count: f64| (1.0 - said) * (count + 1.0) / wrong;
    let (nothing, unknown) = (Answer::Causes(Vec::new()), Answer::Outside);
    let mut all = match kind {
        Kind::None => vec![(nothing, said), (unknown, share(outside)), (Answer::Other, share(none) + share(other))],
        Kind::Unknown => vec![(unknown, said), (nothing, share(none)), (Answer::Other, share(outside) + share(other))],
        _ => {
            let named = match kind {
                Kind::Ambiguous => effects.iter().map(|cause| vec![*cause]).collect(),
                _ => vec![effects.to_vec()],
            };
            let each = said / named.len().max(1) as f64;
            let named = named.into_iter().map(|causes| (Answer::Causes(causes), each));
            named.chain([(nothing, share(none)), (unknown, share(outside)), (Answer::Other, share(other))]).collect()
        }
    };
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// The probability of what a verdict of `kind` says.
pub fn said(probabilities: &[(Answer, f64)], kind: Kind) -> f64 {
    let is_said = |answer: &Answer| match (answer, kind) {
        (Answer::Causes(causes), Kind::None) => causes.is_empty(),
        (Answer::Causes(causes), _) => kind != Kind::Unknown && !causes.is_empty(),
        (Answer::Outside, _) => kind == Kind::Unknown,
        (Answer::Other, _) => false,
    };
    probabilities.iter().filter(|(answer, _)| is_said(answer)).map(|(_, probability)| probability).sum()
}

#[cfg(test)]
mod tests {
    use super::{Policy, probabilities, said};
    use crate::diagnose::{Cause, Kind};

    #[test]
    fn probabilities_add_up_and_resamples_that_disagree_take_from_what_is_said() {
        let ripple = [Cause::Effect("torque_ripple")];
        let rivals = [Cause::Effect("presliding"), Cause::Effect("reversal_transition")];
        let of = |kind: Kind| match kind {
            Kind::None | Kind::Unknown => &[][..],
            Kind::Ambiguous => &rivals,
            _ => &ripple,
        };
        for kind in [Kind::None, Kind::Effect, Kind::Several, Kind::Stale, Kind::Ambiguous, Kind::Unknown] {
            let confidence = |agreement: f64, is_clear: bool| {
                let all = probabilities(&Policy::default(), (kind, is_clear), agreement, of(kind));
                assert!((all.iter().map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-12, "{kind:?}");
                assert!(all.iter().all(|(_, p)| (0.0..=1.0).contains(p)), "{kind:?}");
                said(&all, kind)
            };
            assert!(confidence(0.5, true) < confidence(1.0, true), "{kind:?}");
            assert!(confidence(1.0, false) <= confidence(1.0, true), "{kind:?}");
        }
    }
}
