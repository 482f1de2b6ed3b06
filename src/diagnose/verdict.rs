//! What is said in the end, and how sure that is.

use super::bootstrap::{Numbers, Resamples, Shrink, above};
use super::candidates::Cause;
use super::choose::{Choice, Found};
use super::perturbation::{DOWN_ONLY, UP_ONLY};
use crate::effects::Region;
use crate::model::groups::LOAD_COEFFICIENT;

/// A gap above this many floors that no cause closes is one from outside the library ...
const UNKNOWN_FLOORS: f64 = 1.0;
/// ... if more than this share of what the base leaves is still there after the causes that were found.
const UNKNOWN_SHARE: f64 = 0.4;
/// Where no contact is among them a form that is right leaves less: not so many floors, slow noise in them, and not this share.
const FORM_FLOORS: f64 = 0.75;
const FORM_SHARE: f64 = 0.25;

/// What kind of answer it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Nothing above the floor, beyond what the model's confidence allows.
    None,
    /// The model's own parameters, refitted, close the gap.
    Stale,
    /// One effect.
    Effect,
    /// Several causes.
    Several,
    /// Causes that these data cannot tell apart.
    Ambiguous,
    /// A gap that nothing in the library closes.
    Unknown,
}

impl Kind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Stale => "stale_parameters",
            Self::Effect => "effect",
            Self::Several => "several",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
        }
    }
}

impl Kind {
    /// Share of right ones among verdicts of this kind on simulated joints whose answers were withheld, one more right and one more wrong
    /// counted (Laplace's rule). The counts are what `scripts/blind/score.py` prints for 60 cases of the generator `formula` (seeds 71 and
    /// 501) and 95 of `physical` (seeds 1001 and 2002).
    fn right_share(self) -> f64 {
        let (right, cases) = match self {
            Self::None => (12.0, 21.0),
            Self::Stale => (11.0, 13.0),
            Self::Effect => (57.0, 65.0),
            Self::Several => (12.0, 20.0),
            Self::Ambiguous => (9.0, 9.0),
            Self::Unknown => (12.0, 27.0),
        };
        (right + 1.0) / (cases + 2.0)
    }
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Its kind.
    pub kind: Kind,
    /// What it names: the causes, or the rivals among them; of an unknown gap those that explain a part of it.
    pub effects: Vec<Cause>,
    /// Share of resamplings that come to the same.
    pub agreement: f64,
    /// Probability that it is right: [`Self::agreement`] times the share of blind simulated verdicts of this kind that were right.
    pub confidence: f64,
    /// What the model leaves above the floor, N m.
    pub gap_before_nm: f64,
    /// What is left of it with the causes added, on held-out units, N m.
    pub gap_after_nm: f64,
    /// How far it shrinks.
    pub shrink: Shrink,
}

/// What the verdict is drawn from: squares left in each unit over its rows.
pub struct Evidence<'e> {
    /// Rows that count in each unit, events and all.
    pub rows: Vec<f64>,
    /// By the model as delivered.
    pub delivered: Vec<f64>,
    /// By the base within its confidence, held out; events and all.
    pub rest: Vec<f64>,
    /// By the causes that were found, held out, events explained.
    pub last: Vec<f64>,
    /// Whether events are among the causes.
    pub contact: bool,
    /// How to resample.
    pub resamples: &'e Resamples,
    /// The floor's square with its error, (N m)^2.
    pub floor_square: f64,
    /// That of its quick part alone: what is open is judged by it, lest slow noise hide a cause.
    pub quick_square: f64,
    /// What the numbers of the causes that were found, and of the base, cost on unseen units.
    pub numbers: Numbers,
}

impl Evidence<'_> {
    /// How far the gap shrinks where `left` squares are left in each unit by a fit of so many `numbers`.
    pub fn shrink(&self, left: &[f64], numbers: Numbers) -> Shrink {
        self.resamples.shrink(&self.delivered, left, &self.rows, self.floor_square, numbers)
    }
}

/// Resamples the verdict.
pub fn verdict(choice: &Choice<'_>, evidence: &Evidence<'_>) -> Verdict {
    let floor_square = evidence.floor_square;
    let rows: f64 = evidence.rows.iter().sum::<f64>().max(1.0);
    let mean = |squares: &[f64]| squares.iter().sum::<f64>() / rows;
    let mut effects: Vec<Cause> = choice.found.iter().map(|found| found.cause).collect();
    if evidence.contact {
        effects.push(Cause::CONTACT);
    }
    let is_open = |rest: f64, last: f64| {
        let exceeds = |floor_square: f64, floors: f64, share: f64| {
            let left = above(last, floor_square);
            left > floors * floor_square.sqrt() && left > share * above(rest, floor_square)
        };
        let misses_form = !evidence.contact && exceeds(floor_square, FORM_FLOORS, FORM_SHARE);
        misses_form || exceeds(evidence.quick_square, UNKNOWN_FLOORS, UNKNOWN_SHARE)
    };
    let (rest, last) = (mean(&evidence.rest), mean(&evidence.last));
    let kind = if is_open(rest, last) {
        Kind::Unknown
    } else {
        match (&choice.found[..], evidence.contact) {
            ([], false) => Kind::None,
            ([], true) => Kind::Effect,
            ([one], false) if !one.rivals.is_empty() => Kind::Ambiguous,
            ([one], false) => kind_of(one.cause),
            (all, false) if all.iter().all(|found| matches!(found.cause, Cause::Stale(_))) => Kind::Stale,
            _ => Kind::Several,
        }
    };
    let (rests, lasts) = (
        evidence.resamples.mean_squares(&evidence.rest, &evidence.rows),
        evidence.resamples.mean_squares(&evidence.last, &evidence.rows),
    );
    let open = |i: usize| is_open(rests[i], lasts[i]);
    let agreement = match kind {
        Kind::Unknown => evidence.resamples.share(open),
        Kind::None => evidence.resamples.share(|i| !open(i)),
        _ => stands(&choice.found, evidence).min(evidence.resamples.share(|i| !open(i))),
    };
    match kind {
        Kind::None => effects.clear(),
        Kind::Ambiguous => effects.extend(choice.found[0].rivals.iter().copied()),
        _ => {}
    }
    let delivered = mean(&evidence.delivered);
    Verdict {
        kind,
        effects,
        agreement,
        confidence: agreement * kind.right_share(),
        gap_before_nm: above(delivered, floor_square),
        gap_after_nm: above(last, floor_square).max(evidence.numbers.square().sqrt()),
        shrink: evidence.shrink(&evidence.last, evidence.numbers),
    }
}

fn kind_of(cause: Cause) -> Kind {
    match cause {
        Cause::Effect(_) => Kind::Effect,
        Cause::Stale(_) => Kind::Stale,
    }
}

/// Share of the resamplings in which every cause that was taken, or a rival that the verdict names with it, still does best.
fn stands(found: &[Found<'_>], evidence: &Evidence<'_>) -> f64 {
    let holds = |found: &Found<'_>| {
        let named = |cause: Cause| cause == found.cause || found.rivals.contains(&cause);
        let squares = |wanted: bool| -> Vec<Vec<f64>> {
            let of = found.tried.iter().filter(|t| named(t.cause) == wanted);
            of.map(|t| {
                let factor = t.fit.prior_factor();
                evidence.resamples.mean_squares(&t.fit.held_out, &evidence.rows).iter().map(|s| factor * s).collect()
            })
            .collect()
        };
        let (ours, theirs) = (squares(true), squares(false));
        let least = |all: &[Vec<f64>], i: usize| all.iter().map(|s| s[i]).fold(f64::INFINITY, f64::min);
        evidence.resamples.share(|i| least(&ours, i) <= least(&theirs, i))
    };
    found.iter().map(holds).fold(1.0, f64::min)
}

/// Where a cause shows by its nature.
pub fn signature(cause: Cause, how: &str) -> Region {
    match (cause, how) {
        (Cause::Stale(name), UP_ONLY) if name != LOAD_COEFFICIENT.name => Region::Up,
        (Cause::Stale(name), DOWN_ONLY) if name != LOAD_COEFFICIENT.name => Region::Down,
        _ => cause.signature(),
    }
}
