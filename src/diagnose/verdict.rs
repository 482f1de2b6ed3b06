//! What is said in the end, and how sure that is.

use super::bootstrap::{Numbers, Resamples, Shrink, above};
use super::candidates::Cause;
use super::choose::{Choice, Found};
use super::perturbation::{DOWN_ONLY, UP_ONLY};
use super::probability::{Answer, probabilities, said};
use crate::effects::Region;
use crate::model::groups::LOAD_COEFFICIENT;

/// What is left after the causes is material above this many floors ...
const OPEN_FLOORS: f64 = 1.0;
/// ... and this share of what the base leaves (RMS).
const OPEN_SHARE: f64 = 0.4;
/// Where no contact is among the causes a form that is right leaves less: not so many floors, slow noise in them, and not this share.
const FORM_FLOORS: f64 = 0.75;
const FORM_SHARE: f64 = 0.25;
/// Causes that leave more than this share of what the base leaves (RMS) do not name the gap: a fifth of its energy.
const UNNAMED_SHARE: f64 = 0.45;
/// Where the base leaves less than so many floors a cause is named only if this share of the resamples agrees.
const WEAK_FLOORS: f64 = 0.6;
const WEAK_AGREEMENT: f64 = 0.5;

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

/// Whether the formulas of the named causes fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// They leave nothing material of what can be explained.
    Fits,
    /// The causes are named rightly as far as can be told; their formulas leave a material part.
    Approximate,
}

impl Form {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::Approximate => "approximate",
        }
    }
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
    /// The answers with their probabilities, which add up to 1.
    pub probabilities: Vec<(Answer, f64)>,
    /// Whether the formulas of the named causes fit; nothing where no cause is named.
    pub form: Option<Form>,
    /// Every rule that decided, in order.
    pub decisions: Vec<Decision>,
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
    /// Whether what the causes leave (`last`, of `rest` by the base; mean squares) is material, and by which rule.
    fn open(&self, rest: f64, last: f64) -> (bool, Vec<Decision>) {
        let exceeds = |rule: &'static str, floor_square: f64, floors: f64, share: f64| {
            let value = above(last, floor_square);
            let limit = (floors * floor_square.sqrt()).max(share * above(rest, floor_square));
            let outcome = if value > limit { "material" } else { "immaterial" };
            Decision { rule, subject: "remainder", value, limit, outcome }
        };
        let form = exceeds("form", self.floor_square, FORM_FLOORS, FORM_SHARE);
        let open = exceeds("open", self.quick_square, OPEN_FLOORS, OPEN_SHARE);
        let rules = if self.contact { vec![open] } else { vec![form, open] };
        (rules.iter().any(|rule| rule.value > rule.limit), rules)
    }

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
    let names = !effects.is_empty();
    let (rest, last) = (mean(&evidence.rest), mean(&evidence.last));
    let (is_open, mut decisions) = evidence.open(rest, last);
    let is_unnamed = |rest: f64, last: f64| {
        let (is_open, _) = evidence.open(rest, last);
        is_open && !(names && above(last, floor_square) <= UNNAMED_SHARE * above(rest, floor_square))
    };
    let is_unknown = is_unnamed(rest, last);
    if is_open && names {
        let (value, limit) = (above(last, floor_square), UNNAMED_SHARE * above(rest, floor_square));
        let outcome = if is_unknown { "causes do not name the gap" } else { "causes named, form approximate" };
        decisions.push(Decision { rule: "named", subject: "all causes", value, limit, outcome });
    }
    let mut kind = if is_unknown {
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
    let unnamed = |i: usize| is_unnamed(rests[i], lasts[i]);
    let mut agreement = match kind {
        Kind::Unknown => evidence.resamples.share(unnamed),
        Kind::None => evidence.resamples.share(|i| !unnamed(i)),
        _ => stands(&choice.found, evidence).min(evidence.resamples.share(|i| !unnamed(i))),
    };
    let is_weak = above(rest, floor_square) < WEAK_FLOORS * floor_square.sqrt();
    if is_weak && !matches!(kind, Kind::None | Kind::Unknown) && agreement < WEAK_AGREEMENT {
        let (value, limit, outcome) = (agreement, WEAK_AGREEMENT, "too weak to be named");
        decisions.push(Decision { rule: "agreement", subject: "all causes", value, limit, outcome });
        (kind, agreement) = (Kind::None, 1.0 - agreement);
    }
    match kind {
        Kind::None => effects.clear(),
        Kind::Ambiguous => effects.extend(choice.found[0].rivals.iter().copied()),
        _ => {}
    }
    let form = match kind {
        Kind::None | Kind::Unknown => None,
        _ if is_open => Some(Form::Approximate),
        _ => Some(Form::Fits),
    };
    let probabilities = probabilities(kind, agreement, &effects);
    let delivered = mean(&evidence.delivered);
    Verdict {
        kind,
        effects,
        agreement,
        confidence: said(&probabilities, kind),
        probabilities,
        form,
        decisions: choice.decisions.iter().cloned().chain(decisions).collect(),
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
