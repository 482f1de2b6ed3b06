//! The verdict of a diagnosis in plain words with its numbers.

use super::names::{bounds, claim, claim_as, family, means};
use super::parameters::{Shown, shown};
use crate::diagnose::{BELOW_ZERO, Candidate, Cause, Diagnosis, Form, Kind, Shrink};
use crate::effects::Family;
use crate::report::number::{counted, significant};
use crate::report::wording::Units;

/// A flexible fit that recovers less than this share of the gap says that it does not follow the recorded motion.
const FOLLOWS: f64 = 0.5;
/// Most fitted parameters told in the page's first sentences; the table has them all.
const SIZES: usize = 3;

/// The verdict in a sentence or three: the cause, and how far the gap shrinks with it.
pub fn verdict(found: &Diagnosis) -> String {
    let units = Units::of(&found.before.joint);
    let outside = found.verdict.effects.iter().all(|cause| family(*cause) == Some(Family::Outside));
    let shrinks = match found.verdict.kind {
        Kind::None | Kind::Unknown => String::new(),
        Kind::Stale => shrinks("Refitted, the gap", found, &units),
        Kind::Effect if outside => shrinks("Without these the gap", found, &units),
        Kind::Effect => shrinks("With it the gap", found, &units),
        Kind::Several => shrinks("With all of them the gap", found, &units),
        Kind::Ambiguous => shrinks("With the first the gap", found, &units),
    };
    sentences(&[cause(found, &units), shrinks, approximate(found, &units)])
}

/// The same for the page, whose numbers stand beside it: the cause, how much of the gap it explains, and how sure that is.
pub fn short(found: &Diagnosis) -> String {
    let units = Units::of(&found.before.joint);
    let explains = match found.verdict.kind {
        Kind::None | Kind::Unknown => None,
        Kind::Stale => Some("Refitting them explains"),
        Kind::Effect => Some("It explains"),
        Kind::Several => Some("Together they explain"),
        Kind::Ambiguous => Some("The first explains"),
    };
    let explained = explains.map_or(String::new(), |what| match found.verdict.gap_before_nm > 0.0 {
        true => format!("{what} {} of the gap between model and recordings.", percent(found.verdict.shrink.value)),
        false => within_the_floor(found, &units),
    });
    let sure = format!(
        "Confidence in this verdict: {}, the share of such verdicts that was right on simulated joints.",
        percent(found.verdict.confidence)
    );
    sentences(&[cause(found, &units), sizes(found), explained, approximate(found, &units), sure])
}

/// The fitted parameters of the effects that the verdict names, where they are few enough for a sentence; stale parameters stand in
/// the sentence before.
fn sizes(found: &Diagnosis) -> String {
    let is_told = matches!(found.verdict.kind, Kind::Effect | Kind::Several);
    let all = taken(found).flat_map(|candidate| shown(candidate, found)).filter(|p| !p.interval.is_empty());
    let all: Vec<String> = all.map(|p| p.sentence()).collect();
    match all.len() {
        1..=SIZES if is_told => format!("Fitted: {}.", all.join("; ")),
        _ => String::new(),
    }
}

/// Those of `all` that are not empty, as one text.
fn sentences(all: &[String]) -> String {
    kept_together(&all.iter().filter(|one| !one.is_empty()).map(String::as_str).collect::<Vec<_>>().join(" "))
}

/// The cause.
fn cause(found: &Diagnosis, units: &Units) -> String {
    match found.verdict.kind {
        Kind::None => nothing(found, units),
        Kind::Stale => stale(found),
        Kind::Effect => effect(found),
        Kind::Several => several(found),
        Kind::Ambiguous => ambiguous(found),
        Kind::Unknown => not_repeating(found, units).unwrap_or_else(|| unknown(found, units)),
    }
}

/// What is left where a cause is named and its formula fits only approximately; nothing where it fits.
fn approximate(found: &Diagnosis, units: &Units) -> String {
    let verdict = &found.verdict;
    if verdict.form != Some(Form::Approximate) {
        return String::new();
    }
    let share = (verdict.gap_after_nm / verdict.gap_before_nm.max(f64::MIN_POSITIVE)).min(1.0);
    let lies = found.remainder.first().map_or(String::new(), |at| format!(", mostly at {}", bounds(at)));
    format!("{} of the gap, {}, remains unexplained{lies}.", percent(share), units.torque(verdict.gap_after_nm))
}

/// `text` with spaces that do not break between a number and what belongs to it.
pub fn kept_together(text: &str) -> String {
    const FIXED: [(&str, &str); 6] = [
        ("N m", "N\u{a0}m"),
        (" mN", "\u{a0}mN"),
        (" N\u{a0}m", "\u{a0}N\u{a0}m"),
        (" mm", "\u{a0}mm"),
        (" deg", "\u{a0}deg"),
        (" %", "\u{a0}%"),
    ];
    let text = FIXED.iter().fold(text.to_string(), |text, (from, to)| text.replace(from, to)).replace(" [", "\u{a0}[");
    // An interval stays in one piece.
    let mut inside = false;
    let keep = |c: char| {
        inside = c == '[' || inside && c != ']';
        if inside && c == ' ' { '\u{a0}' } else { c }
    };
    text.chars().map(keep).collect()
}

/// A share in whole percent.
pub fn percent(share: f64) -> String {
    format!("{} %", whole(share))
}

/// "97 % [95, 98]".
pub fn shrink(shrink: Shrink) -> String {
    format!("{} [{}, {}]", percent(shrink.value), whole(shrink.low), whole(shrink.high))
}

fn whole(share: f64) -> String {
    let rounded = (100.0 * share).round();
    format!("{:.0}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// What the flexible fit recovers, as a shrink of the RMS above the floor: the measure by which causes are judged.
pub fn flexible_shrink(found: &Diagnosis) -> f64 {
    let share = found.gap.recoverable_nm / found.gap.explainable_nm.max(f64::MIN_POSITIVE);
    1.0 - (1.0 - share * share).max(0.0).sqrt()
}

/// Whether one of its parameters is negative although its name forbids that: it then stands for an effect that is still missing.
pub fn compensates(candidate: &Candidate) -> bool {
    candidate.parameters.iter().any(|parameter| parameter.doubt == Some(BELOW_ZERO))
}

/// The causes that were taken.
pub fn taken(found: &Diagnosis) -> impl Iterator<Item = &Candidate> {
    found.candidates.iter().filter(|candidate| candidate.taken)
}

fn shrinks(what: &str, found: &Diagnosis, units: &Units) -> String {
    let verdict = &found.verdict;
    if verdict.gap_before_nm <= 0.0 {
        return within_the_floor(found, units);
    }
    format!(
        "{what} shrinks by {}, from {} to {} (RMS above the noise floor, which is at most {}).",
        shrink(verdict.shrink),
        units.torque(verdict.gap_before_nm),
        units.torque(verdict.gap_after_nm),
        units.torque(found.gap.floor.upper_nm()),
    )
}

fn within_the_floor(found: &Diagnosis, units: &Units) -> String {
    format!(
        "The whole residual, {} RMSE, is within the noise floor of at most {} all the same: there is no gap that could shrink.",
        units.torque(found.gap.rmse_nm),
        units.torque(found.gap.floor.upper_nm())
    )
}

fn nothing(found: &Diagnosis, units: &Units) -> String {
    let (gap, above_nm) = (&found.gap, found.verdict.gap_before_nm);
    let rest = match above_nm > 0.0 {
        true => format!(
            "; the {} (RMS) above it are within the model's own confidence, or too little to name a cause",
            units.torque(above_nm)
        ),
        false => String::new(),
    };
    format!(
        "These data show nothing that the model lacks: its RMSE is {}, the noise floor at most {}{rest}.",
        units.torque(gap.rmse_nm),
        units.torque(gap.floor.upper_nm())
    )
}

/// "Coulomb friction (both directions alike): friction.up.a_j 37.5 -> 42.1 N [41, 43]".
fn moved(candidate: &Candidate, found: &Diagnosis) -> String {
    let how = if candidate.how.is_empty() { String::new() } else { format!(", {}", candidate.how) };
    let values: Vec<String> = shown(candidate, found).iter().map(Shown::sentence).collect();
    let values = if values.is_empty() { String::new() } else { format!(": {}", values.join("; ")) };
    format!("{} ({}{how}){values}", means(candidate.cause), candidate.cause.name())
}

fn stale(found: &Diagnosis) -> String {
    let all: Vec<String> = taken(found).map(|candidate| moved(candidate, found)).collect();
    format!("The model has the right form, but is out of date in {}.", all.join(", and in "))
}

fn effect(found: &Diagnosis) -> String {
    let Some(cause) = found.verdict.effects.first().copied() else { return String::new() };
    match family(cause) {
        Some(Family::Fault) => format!("The measurement is at fault, not the joint: {}.", claim(cause)),
        Some(Family::Outside) => {
            let stretches = counted(found.contacts.len(), "stretch", "stretches");
            format!("Something outside acts on the joint: {}, in {stretches}.", claim(cause))
        }
        _ => format!("The joint has an effect that the model lacks: {}.", claim(cause)),
    }
}

fn several(found: &Diagnosis) -> String {
    format!("{} causes together: {}.", found.verdict.effects.len(), named(found))
}

/// The causes that the verdict names, numbered where they are several; their parameters stand in the table.
fn named(found: &Diagnosis) -> String {
    let one = |cause: &Cause| match taken(found).find(|candidate| candidate.cause == *cause) {
        Some(candidate) => {
            let doubt = if compensates(candidate) { ", but negative, so in place of an unmodelled effect" } else { "" };
            format!("{}{doubt}", claim_as(*cause, candidate.how))
        }
        None => claim(*cause),
    };
    let all: Vec<String> = found.verdict.effects.iter().map(one).collect();
    match &all[..] {
        [one] => one.clone(),
        all => all.iter().enumerate().map(|(at, one)| format!("({}) {one}", at + 1)).collect::<Vec<_>>().join(", "),
    }
}

fn ambiguous(found: &Diagnosis) -> String {
    let all: Vec<String> = found.verdict.effects.iter().map(|cause| claim(*cause)).collect();
    format!("{} causes explain these data about equally well: {}.", all.len(), all.join(", or "))
}

/// Of repeats that differ by more than noise, where no gap is named.
fn not_repeating(found: &Diagnosis, units: &Units) -> Option<String> {
    let factor = found.verdict.differing()?;
    Some(format!(
        "No gap that repeats with the motion is named, but repeats of one motion differ, at the speeds where that is most, by {} times (RMS) \
         what the noise beyond the low-pass and the encoder would give: something acts that no model of the motion describes, such as stick-slip, \
         a rumble or a torque from outside. The RMSE is {}, what does not repeat at most {}.",
        significant(factor, 2),
        units.torque(found.gap.rmse_nm),
        units.torque(found.gap.floor.upper_nm())
    ))
}

fn unknown(found: &Diagnosis, units: &Units) -> String {
    let (verdict, gap) = (&found.verdict, &found.gap);
    let shrink = percent(flexible_shrink(found));
    let nature = match gap.recoverable_nm > FOLLOWS * gap.explainable_nm {
        true => format!("A flexible fit shrinks it by {shrink}, so it depends on the recorded motion"),
        false => format!("A flexible fit shrinks it by only {shrink}, so it hardly depends on the recorded motion"),
    };
    let lies = if found.places.is_empty() { String::new() } else { format!(" Where it lies: {}.", location(found)) };
    format!(
        "No cause of the library explains the gap: of {} (RMS above the noise floor, which is at most {}), {} remain at best.{} \
         {nature}.{lies}",
        units.torque(verdict.gap_before_nm),
        units.torque(gap.floor.upper_nm()),
        units.torque(verdict.gap_after_nm),
        in_part(found),
    )
}

/// Of a gap that stays open, what explains a part of it.
fn in_part(found: &Diagnosis) -> String {
    match found.verdict.effects.is_empty() {
        true => String::new(),
        false => format!(" It shrinks by {} with {}.", shrink(found.verdict.shrink), named(found)),
    }
}

/// "travel since the reversal 0 to 2.1 deg (71 % of its mean square goes with it; 6 % of the samples lie there)".
pub fn location(found: &Diagnosis) -> String {
    let one = |at: &crate::diagnose::Place| {
        let samples = if at.share_of_samples < 0.995 {
            format!("; {} % of the samples lie there", significant(100.0 * at.share_of_samples, 2))
        } else {
            String::new()
        };
        format!("{} ({} of its mean square goes with it{samples})", bounds(at), percent(at.share_of_gap))
    };
    found.places.first().map_or(String::new(), one)
}
