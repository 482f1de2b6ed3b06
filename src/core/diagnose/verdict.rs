//! The verdict and its probability.

use super::answer::{Answer, Form, Kind};
use super::bootstrap::{Numbers, Resamples, Shrink, above};
use super::candidates::Cause;
use super::choose::{Choice, Found};
use super::criteria::Decision;
use super::oscillation::Oscillation;
use super::policy::Policy;
use super::probability::{Standing, probabilities, said};
use super::stale::{DOWN_ONLY, UP_ONLY};
use crate::effects::Region;
use crate::model::groups::LOAD_COEFFICIENT;

/// What the rule says of a verdict that belongs to those that were right more often.
const CLEAR: &str = "clear";
/// What it says of causes that the gap is not put down to.
const UNNAMED: &str = "causes do not name the gap";
/// What the rule says of repeats that noise would not make differ so much.
const NOT_NOISE: &str = "no noise";
/// Most of the resamples: so many must agree on the causes of a weak gap.
const MOST: f64 = 0.5;

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Its kind.
    pub kind: Kind,
    /// What it names: the causes, or the rivals among them; of an unknown gap those that explain a part of it.
    pub effects: Vec<Cause>,
    /// Share of resamplings that come to the same.
    pub agreement: f64,
    /// Probability that it is right: how many blind simulated verdicts of its kind were, less where the resamples do not agree.
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

impl Verdict {
    /// What repeats of one motion differ by over what noise would give, where that is the whole verdict: no gap is named or placed.
    pub fn differing(&self) -> Option<f64> {
        let decides = |decision: &&Decision| decision.rule == "repeats" && decision.outcome == NOT_NOISE;
        self.decisions.iter().find(decides).map(|decision| decision.value)
    }

    /// Whether it speaks of a gap between the model and what repeats with the motion.
    pub fn tells_of_a_gap(&self) -> bool {
        self.kind != Kind::None && self.differing().is_none()
    }
}

/// What the verdict is drawn from: squares left in each unit over its rows.
pub struct Evidence<'e> {
    /// By which thresholds it is judged.
    pub policy: &'e Policy,
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
    /// That of its fast part alone, by which an open remainder is judged, so that slow noise does not hide a cause.
    pub quick_square: f64,
    /// See [`Floor::found_again_nm`](super::floor::Floor::found_again_nm).
    pub found_again_nm: f64,
    /// See [`Floor::differing`](super::floor::Floor::differing).
    pub differing: Option<f64>,
    /// Mean square that the model left of the recordings that it was identified from, (N m)^2; 0 where that is not known.
    pub own_square: f64,
    /// Oscillations of the remainder.
    pub oscillations: &'e [Oscillation],
    /// What the numbers of the causes that were found, and of the base, cost on unseen units.
    pub numbers: Numbers,
}

impl Evidence<'_> {
    /// Mean square over all rows of what has `squares` in each unit.
    fn mean(&self, squares: &[f64]) -> f64 {
        squares.iter().sum::<f64>() / self.rows.iter().sum::<f64>().max(1.0)
    }

    /// Whether what the causes leave (`last`, of `rest` by the base; mean squares) is material, and by which rule.
    fn open(&self, rest: f64, last: f64) -> (bool, Vec<Decision>) {
        let decision = |rule: &'static str, value: f64, limit: f64| {
            let outcome = if value > limit { "material" } else { "immaterial" };
            Decision { rule, subject: "remainder", value, limit, outcome }
        };
        let exceeds = |rule: &'static str, floor_square: f64, floors: f64, share: f64| {
            let limit = (floors * floor_square.sqrt()).max(share * above(rest, floor_square));
            decision(rule, above(last, floor_square), limit)
        };
        let Policy { form_floors, form_share, open_floors, open_share, first_floors, .. } = *self.policy;
        let form = exceeds("form", self.floor_square, form_floors, form_share);
        let open = exceeds("open", self.quick_square, open_floors, open_share);
        let again = decision("found again", self.found_again_nm, first_floors * self.floor_square.sqrt());
        let rules = if self.contact { vec![open, again] } else { vec![form, open, again] };
        (rules.iter().any(|rule| rule.value > rule.limit), rules)
    }

    /// Whether causes that leave `last` of `rest` name the gap, however well their formulas fit.
    fn naming(&self, rest: f64, last: f64) -> Decision {
        let is_news = rest > self.policy.news_factor.powi(2) * self.own_square;
        let known_square = if is_news { self.floor_square.max(self.own_square) } else { self.floor_square };
        let (value, limit) = (above(last, known_square), self.policy.unnamed_share * above(rest, known_square));
        let outcome = if value > limit { UNNAMED } else { "causes named, form approximate" };
        Decision { rule: "named", subject: "all causes", value, limit, outcome }
    }

    /// Whether something material is left that no cause names.
    fn is_unknown(&self, rest: f64, last: f64, has_causes: bool) -> bool {
        let naming = self.naming(rest, last);
        self.open(rest, last).0 && (!has_causes || naming.value > naming.limit)
    }

    /// How far the gap shrinks where a fit of `numbers` parameters leaves the squares `left` in each unit.
    pub fn shrink(&self, left: &[f64], numbers: Numbers) -> Shrink {
        self.resamples.shrink(&self.delivered, left, &self.rows, self.floor_square, numbers)
    }
}

/// The causes of `choice`, and contact where it is one.
fn causes(choice: &Choice<'_>, evidence: &Evidence<'_>) -> Vec<Cause> {
    let contact = evidence.contact.then_some(Cause::CONTACT);
    choice.found.iter().map(|found| found.cause).chain(contact).collect()
}

/// What the causes of `choice` amount to, and the share of the resamples that come to the same.
fn judged(choice: &Choice<'_>, evidence: &Evidence<'_>) -> (Kind, f64) {
    let has_causes = !causes(choice, evidence).is_empty();
    let is_unknown = evidence.is_unknown(evidence.mean(&evidence.rest), evidence.mean(&evidence.last), has_causes);
    let kind = match (&choice.found[..], evidence.contact) {
        _ if is_unknown => Kind::Unknown,
        ([], false) => Kind::None,
        ([], true) => Kind::Effect,
        ([one], false) if !one.rivals.is_empty() => Kind::Ambiguous,
        ([one], false) => kind_of(one.cause),
        (all, false) if all.iter().all(|found| matches!(found.cause, Cause::Stale(_))) => Kind::Stale,
        _ => Kind::Several,
    };
    let [rests, lasts] =
        [&evidence.rest, &evidence.last].map(|squares| evidence.resamples.mean_squares(squares, &evidence.rows));
    let unknown = evidence.resamples.share(|i| evidence.is_unknown(rests[i], lasts[i], has_causes));
    let shares = choice.found.iter().map(|found| {
        let stands = stands(found, evidence);
        evidence.resamples.share(|i| stands[i])
    });
    let agreement = match kind {
        Kind::Unknown => unknown,
        Kind::None => 1.0 - unknown,
        _ => shares.fold(1.0 - unknown, f64::min),
    };
    (kind, agreement)
}

/// The share of the resamples that agree on causes of a gap that is too weak for so few.
pub fn too_weak(choice: &Choice<'_>, evidence: &Evidence<'_>) -> Option<f64> {
    let (kind, agreement) = judged(choice, evidence);
    let is_named = !matches!(kind, Kind::None | Kind::Unknown);
    let weak_floors = evidence.policy.weak_floors;
    let is_weak =
        above(evidence.mean(&evidence.rest), evidence.floor_square) < weak_floors * evidence.floor_square.sqrt();
    (is_named && is_weak && agreement < MOST).then_some(agreement)
}

/// Resamples the verdict.
pub fn verdict(choice: &Choice<'_>, evidence: &Evidence<'_>) -> Verdict {
    let Evidence { policy, floor_square, .. } = *evidence;
    let [delivered, rest, last] = [&evidence.delivered, &evidence.rest, &evidence.last].map(|s| evidence.mean(s));
    let mut effects = causes(choice, evidence);
    let (mut kind, mut agreement) = judged(choice, evidence);
    let (is_open, open) = evidence.open(rest, last);
    let oscillating = evidence.oscillations.iter().map(|o| o.decision(policy)).collect();
    let mut decisions = [choice.decisions.clone(), oscillating, open].concat();
    if is_open && !effects.is_empty() {
        decisions.push(evidence.naming(rest, last));
    }
    if kind == Kind::None
        && let Some(repeats) = repeats(policy, evidence.differing)
    {
        if repeats.outcome == NOT_NOISE {
            // What repeats differ by is the same in every resample.
            (kind, agreement) = (Kind::Unknown, 1.0);
        }
        decisions.push(repeats);
    }
    if let Some(value) = choice.given_up {
        let (limit, outcome) = (MOST, "too weak to be named");
        decisions.push(Decision { rule: "agreement", subject: "all causes", value, limit, outcome });
        agreement = agreement.min(1.0 - value);
    }
    if kind == Kind::Ambiguous {
        effects.extend(choice.found[0].rivals.iter().copied());
    }
    let gap_before_nm = above(delivered, floor_square);
    let gap_after_nm = above(last, floor_square).max(evidence.numbers.square().sqrt());
    let clear = clear(policy, kind, (gap_before_nm, gap_after_nm, floor_square.sqrt()));
    let standing = Standing {
        is_clear: clear.iter().all(|decision| decision.outcome == CLEAR),
        is_distinct: choice.found.iter().all(|found| found.is_distinct(policy)),
    };
    decisions.extend(clear);
    let form = form(kind, is_open);
    let probabilities = probabilities(policy, (kind, standing), agreement, &effects);
    Verdict {
        kind,
        effects,
        agreement,
        confidence: said(&probabilities, kind),
        probabilities,
        form,
        decisions,
        gap_before_nm,
        gap_after_nm,
        shrink: evidence.shrink(&evidence.last, evidence.numbers),
    }
}

/// Whether a verdict belongs to those that were right more often: its causes close a gap that stands out of the floor, N m.
fn clear(policy: &Policy, kind: Kind, (gap_before_nm, gap_after_nm, floor_nm): (f64, f64, f64)) -> Vec<Decision> {
    if !matches!(kind, Kind::Effect | Kind::Several) {
        return Vec::new();
    }
    let decision = |subject, value, limit, holds| {
        let outcome = if holds { CLEAR } else { "not clear" };
        Decision { rule: "clear", subject, value, limit, outcome }
    };
    let (least_nm, most_nm) = (policy.clear_floors * floor_nm, policy.clear_share * gap_before_nm);
    vec![
        decision("gap", gap_before_nm, least_nm, gap_before_nm >= least_nm),
        decision("remainder", gap_after_nm, most_nm, gap_after_nm <= most_nm),
    ]
}

/// Whether repeats differ by noise where they do by `differing` times, RMS, what that beyond the low-pass tells: it need not be white.
fn repeats(policy: &Policy, differing: Option<f64>) -> Option<Decision> {
    let (value, limit) = (differing?, policy.floor_coloured_max);
    let outcome = if value > limit { NOT_NOISE } else { "noise" };
    Some(Decision { rule: "repeats", subject: "remainder", value, limit, outcome })
}

/// How well the formulas of the causes that a verdict of `kind` names fit.
fn form(kind: Kind, is_open: bool) -> Option<Form> {
    match kind {
        Kind::None | Kind::Unknown => None,
        _ if is_open => Some(Form::Approximate),
        _ => Some(Form::Fits),
    }
}

fn kind_of(cause: Cause) -> Kind {
    match cause {
        Cause::Effect(_) => Kind::Effect,
        Cause::Stale(_) => Kind::Stale,
    }
}

/// In which of the resamples the cause that was taken, or a rival that the verdict names with it, still does best in its place.
fn stands(found: &Found<'_>, evidence: &Evidence<'_>) -> Vec<bool> {
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
    (0..evidence.resamples.count()).map(|i| least(&ours, i) <= least(&theirs, i)).collect()
}

/// Where a cause shows by its nature.
pub fn signature(cause: Cause, how: &str) -> Region {
    match (cause, how) {
        (Cause::Stale(name), UP_ONLY) if name != LOAD_COEFFICIENT.name => Region::Up,
        (Cause::Stale(name), DOWN_ONLY) if name != LOAD_COEFFICIENT.name => Region::Down,
        _ => cause.signature(),
    }
}

#[cfg(test)]
mod tests {
    use super::{CLEAR, Evidence, Kind, Numbers, Policy, Resamples, clear};
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::floor::{Floor, FloorSource};

    #[test]
    fn what_a_fit_without_physics_finds_again_is_material_however_weak() {
        let (policy, (data, _)) = (&Policy::default(), bundled());
        let resamples = &Resamples::new(&data.folds, &Floor::of_noise(1.0, FloorSource::Repeats, 0.0));
        let units = data.folds.units.len();
        let above_floor = |floors: f64| vec![1.0 + floors * floors; units];
        // What is left is too weak to count by itself.
        let is_unknown = |left: f64, found_again_nm: f64, has_causes: bool| {
            let evidence = Evidence {
                policy,
                rows: vec![1.0; units],
                delivered: above_floor(1.2),
                rest: above_floor(1.2),
                last: above_floor(left),
                contact: false,
                resamples,
                floor_square: 1.0,
                quick_square: 1.0,
                found_again_nm,
                differing: None,
                own_square: 0.0,
                oscillations: &[],
                numbers: Numbers { effective_dof: 0.0, each_square: 0.0 },
            };
            evidence.is_unknown(evidence.mean(&evidence.rest), evidence.mean(&evidence.last), has_causes)
        };
        assert!(!is_unknown(0.6, 0.0, true) && !is_unknown(0.6, 0.9 * policy.first_floors, false));
        assert!(is_unknown(0.6, 1.1 * policy.first_floors, false) && is_unknown(0.6, 1.1 * policy.first_floors, true));
        // Causes that leave little of the gap name it, even if their formulas do not fit.
        assert!(!is_unknown(0.45, 1.1 * policy.first_floors, true));
    }

    #[test]
    fn a_verdict_is_clear_where_its_causes_close_a_gap_above_the_floor() {
        let policy = &Policy::default();
        let is_clear =
            |kind, before, after, floor| clear(policy, kind, (before, after, floor)).iter().all(|d| d.outcome == CLEAR);
        assert!(is_clear(Kind::Effect, 2.0, 0.1, 1.0));
        assert!(!is_clear(Kind::Effect, 2.0, 0.3, 1.0));
        assert!(!is_clear(Kind::Several, 0.9, 0.0, 1.0));
        // Others have no such rule.
        assert!(clear(policy, Kind::None, (0.0, 0.0, 1.0)).is_empty());
    }
}
