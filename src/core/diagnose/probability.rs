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

/// By what verdicts that name causes were right more often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// The causes close a gap that stands out of the floor.
    pub is_clear: bool,
    /// No other cause explains nearly as much in the place of one of them.
    pub is_distinct: bool,
}

impl Kind {
    /// What became of verdicts of this kind on simulated joints whose answers were withheld: counts that `scripts/blind/score.py` prints
    /// ("verdict said") for 240 cases of each generator, drawn fresh (seeds 24001 and 25001 of `formula`, 24002 and 25002 of `physical`, 24003 and
    /// 25003 of `laboratory`); of an effect and of several causes, by their standing.
    fn outcomes(self, Standing { is_clear, is_distinct }: Standing) -> Outcomes {
        let (right, none, outside, other) = match (self, is_clear, is_distinct) {
            (Self::None, ..) => (84.0, 0.0, 4.0, 12.0),
            (Self::Stale, ..) => (75.0, 0.0, 2.0, 1.0),
            (Self::Effect, true, true) => (150.0, 0.0, 1.0, 2.0),
            (Self::Effect, true, false) => (109.0, 0.0, 0.0, 4.0),
            (Self::Effect, false, _) => (46.0, 0.0, 4.0, 5.0),
            (Self::Several, true, true) => (15.0, 0.0, 0.0, 2.0),
            (Self::Several, true, false) => (44.0, 0.0, 0.0, 9.0),
            (Self::Several, false, true) => (4.0, 0.0, 1.0, 3.0),
            (Self::Several, false, false) => (2.0, 0.0, 5.0, 5.0),
            (Self::Ambiguous, ..) => (52.0, 0.0, 0.0, 11.0),
            (Self::Unknown, ..) => (59.0, 0.0, 0.0, 9.0),
        };
        Outcomes { right, none, outside, other }
    }
}

/// The answers with their probabilities, after a verdict of `kind` that has this `standing`. What is left for others is shared out as verdicts
/// of this kind turned out when they were wrong; Laplace's rule adds one to each count.
pub fn probabilities(
    policy: &Policy,
    (kind, standing): (Kind, Standing),
    agreement: f64,
    effects: &[Cause],
) -> Vec<(Answer, f64)> {
    let Outcomes { right, none, outside, other } = kind.outcomes(standing);
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
    use super::{Policy, Standing, probabilities, said};
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
                let standing = Standing { is_clear, is_distinct: is_clear };
                let all = probabilities(&Policy::default(), (kind, standing), agreement, of(kind));
                assert!((all.iter().map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-12, "{kind:?}");
                assert!(all.iter().all(|(_, p)| (0.0..=1.0).contains(p)), "{kind:?}");
                said(&all, kind)
            };
            assert!(confidence(0.5, true) < confidence(1.0, true), "{kind:?}");
            assert!(confidence(1.0, false) <= confidence(1.0, true), "{kind:?}");
        }
    }
}
