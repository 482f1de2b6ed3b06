//! How probable each answer is: how often the resamples agree, and how often verdicts of the kind were right on joints whose answers were
//! withheld.

use super::answer::{Answer, Kind};
use super::candidates::Cause;

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
    /// ("verdict said") for 102 cases of the generator `formula` (seeds 71, 501, 601 and 701) and 179 of `physical` (seeds 1001, 2002, 3003
    /// and 4004); of verdicts that name a cause, by whether they were clear.
    fn outcomes(self, is_clear: bool) -> Outcomes {
        let (right, none, outside, other) = match (self, is_clear) {
            (Self::None, _) => (30.0, 0.0, 3.0, 6.0),
            (Self::Stale, true) => (6.0, 0.0, 0.0, 1.0),
            (Self::Stale, false) => (22.0, 0.0, 0.0, 2.0),
            (Self::Effect, true) => (67.0, 0.0, 1.0, 1.0),
            (Self::Effect, false) => (42.0, 1.0, 1.0, 1.0),
            (Self::Several, true) => (23.0, 0.0, 3.0, 10.0),
            (Self::Several, false) => (1.0, 1.0, 2.0, 5.0),
            (Self::Ambiguous, _) => (23.0, 0.0, 0.0, 2.0),
            (Self::Unknown, _) => (19.0, 1.0, 0.0, 7.0),
        };
        Outcomes { right, none, outside, other }
    }
}

/// The answers with their probabilities; `is_clear` says whether the verdict is. What the resamples do not agree on is shared out as verdicts
/// of this kind turned out when they were wrong; Laplace's rule adds one to each count.
pub fn probabilities(kind: Kind, agreement: f64, effects: &[Cause], is_clear: bool) -> Vec<(Answer, f64)> {
    let Outcomes { right, none, outside, other } = kind.outcomes(is_clear);
    let said = agreement * (right + 1.0) / (right + none + outside + other + 2.0);
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
