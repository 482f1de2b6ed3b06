//! A diagnosis in plain words with its numbers: the verdict, and its grounds.

use super::names::{bounds, claim, family, floor_source, means};
use super::parameters::shown;
use crate::diagnose::{Answer, BELOW_ZERO, Candidate, Cause, Diagnosis, Floor, Form, Kind, Shrink};
use crate::effects::Family;
use crate::report::number::{counted, significant};
use crate::report::plots::diagnosis::budget::added;
use crate::report::wording::Units;

/// A flexible fit that recovers less than this share of the gap says that it does not follow the recorded motion.
const FOLLOWS: f64 = 0.5;
/// More than this share of the gap within the model's own confidence is worth a sentence.
const MUCH: f64 = 0.1;
/// What is simulated of the encoder beyond this multiple of what is counted is told.
const MORE_THAN_COUNTED: f64 = 1.05;

/// The verdict in a sentence or three.
pub fn verdict(found: &Diagnosis) -> String {
    let units = Units::of(&found.before.joint);
    let answer = match found.verdict.kind {
        Kind::None => nothing(found, &units),
        Kind::Stale => format!("{} {}", stale(found), shrinks("Refitted, the gap", found, &units)),
        Kind::Effect => {
            let outside = found.verdict.effects.iter().all(|cause| family(*cause) == Some(Family::Outside));
            let what = if outside { "Without these the gap" } else { "With it the gap" };
            format!("{} {}", effect(found), shrinks(what, found, &units))
        }
        Kind::Several => format!("{} {}", several(found), shrinks("With all of them the gap", found, &units)),
        Kind::Ambiguous => format!("{} {}", ambiguous(found), shrinks("With the first the gap", found, &units)),
        Kind::Unknown => unknown(found, &units),
    };
    kept_together(&match found.verdict.form {
        Some(Form::Approximate) => format!("{answer} {}", approximate(found, &units)),
        _ => answer,
    })
}

/// What is left where a cause is named and its formula does not fit.
fn approximate(found: &Diagnosis, units: &Units) -> String {
    let verdict = &found.verdict;
    let share = (verdict.gap_after_nm / verdict.gap_before_nm.max(f64::MIN_POSITIVE)).min(1.0);
    let lies = found.remainder.first().map_or(String::new(), |at| format!(", mostly at: {}", bounds(at)));
    format!(
        "{} only approximately: {}, {} of the gap, are left{lies}.",
        if verdict.kind == Kind::Several { "The formulas fit" } else { "The formula fits" },
        units.torque(verdict.gap_after_nm),
        percent(share)
    )
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

/// What the verdict rests on, a sentence each.
pub fn grounds(found: &Diagnosis) -> Vec<String> {
    let units = Units::of(&found.before.joint);
    let gap = &found.gap;
    let mut all = vec![format!(
        "As delivered the model leaves {} RMSE. The floor, what no model could explain, is {}, {}; with its standard error {}. Above that \
         lies a gap of {}, which a flexible fit to the recorded motion shrinks by {} on held-out {}.",
        units.torque(gap.rmse_nm),
        units.torque(gap.floor.rms_nm),
        floor_source(&gap.floor),
        units.torque(gap.floor.upper_nm()),
        units.torque(found.verdict.gap_before_nm),
        percent(flexible_shrink(found)),
        found.held_out,
    )];
    all.extend(encoder_part(&gap.floor, units));
    all.extend(own_confidence(found));
    if found.verdict.kind != Kind::None {
        all.extend(found.places.first().map(|_| format!("Where the gap lies: {}.", location(found))));
    }
    let (sure, agree) = (percent(found.verdict.confidence), percent(found.verdict.agreement));
    all.push(format!("Probabilities: {}.", probabilities(found)));
    all.push(format!(
        "{agree} of the bootstrap resamples of whole {} give this verdict; weighted by how often verdicts of its kind{} were right on \
         simulated joints with withheld answers, it is right with a probability of {sure}.",
        found.held_out,
        clearness(found).map_or(String::new(), |clearness| format!(" ({clearness})")),
    ));
    all.iter().map(|sentence| kept_together(sentence)).collect()
}

/// Which verdicts the probability comes from; nothing where the verdict names no cause.
pub fn clearness(found: &Diagnosis) -> Option<&'static str> {
    let clear = found.verdict.decisions.iter().find(|decision| decision.rule == "clear")?;
    Some(match clear.value >= clear.limit {
        true => "those whose causes stand well apart from all others",
        false => "those whose causes have close competitors",
    })
}

/// "presliding 87 %; nothing missing 4 %; ...".
fn probabilities(found: &Diagnosis) -> String {
    let name = |answer: &Answer| match answer {
        Answer::Causes(causes) if causes.is_empty() => "nothing missing".to_string(),
        Answer::Causes(causes) => causes.iter().map(|cause| cause.name()).collect::<Vec<_>>().join(" and "),
        Answer::Outside => "a cause outside the library".to_string(),
        Answer::Other => "other causes of the library".to_string(),
    };
    let one = |(answer, probability): &(Answer, f64)| format!("{} {}", name(answer), percent(*probability));
    found.verdict.probabilities.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// What of a floor is the encoder's, and whether more was simulated than can be counted.
fn encoder_part(floor: &Floor, units: Units) -> Option<String> {
    let most = match floor.encoder_simulated_nm > MORE_THAN_COUNTED * floor.encoder_nm {
        true => format!(
            " The simulation predicts {} from the encoder, but the residual leaves room for no more beside the noise, so only that much is \
             counted, and what remains above the floor is a lower bound.",
            units.torque(floor.encoder_simulated_nm)
        ),
        false => String::new(),
    };
    (floor.encoder_nm > 0.0).then(|| {
        format!(
            "Of the floor, {} are what the encoder's steps and noise alone leave of a perfect model: simulated on the recorded motion.{most}",
            units.torque(floor.encoder_nm)
        )
    })
}

/// How much of the gap goes while the model stays what it is, where that is much.
fn own_confidence(found: &Diagnosis) -> Option<String> {
    let share = added(None, found).unwrap_or(0.0);
    (share > MUCH).then(|| {
        format!(
            "{} of the gap could also be absorbed by the model's own parameters within their confidence; only the rest needs what was \
             found. Identify them more precisely to tell.",
            percent(share)
        )
    })
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

/// Whether one of its parameters came out as no friction can be: it stands for an effect that the library lacks.
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
        return format!(
            "All that the model leaves, {} RMSE, is within the noise floor of at most {} even so: there is no gap that could shrink.",
            units.torque(found.gap.rmse_nm),
            units.torque(found.gap.floor.upper_nm())
        );
    }
    format!(
        "{what} shrinks by {}: {} before, {} after, above a floor of at most {}.",
        shrink(verdict.shrink),
        units.torque(verdict.gap_before_nm),
        units.torque(verdict.gap_after_nm),
        units.torque(found.gap.floor.upper_nm()),
    )
}

fn nothing(found: &Diagnosis, units: &Units) -> String {
    let (gap, above_nm) = (&found.gap, found.verdict.gap_before_nm);
    let rest = match above_nm > 0.0 {
        true => format!(
            "; the {} above it are within the model's own confidence, or too little to name a cause",
            units.torque(above_nm)
        ),
        false => String::new(),
    };
    format!(
        "The model lacks nothing that these data show: it leaves {} RMSE over a floor of at most {}{rest}.",
        units.torque(gap.rmse_nm),
        units.torque(gap.floor.upper_nm())
    )
}

/// "Coulomb friction (both directions alike): friction.up.a_j 37.5 -> 42.1 N [41, 43]".
fn moved(candidate: &Candidate, found: &Diagnosis) -> String {
    let how = if candidate.how.is_empty() { String::new() } else { format!(", {}", candidate.how) };
    let values: Vec<String> = shown(candidate, found).iter().map(super::parameters::Shown::sentence).collect();
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
        _ => format!("The joint has what the model lacks: {}.", claim(cause)),
    }
}

fn several(found: &Diagnosis) -> String {
    format!("Several causes together: {}.", named(found))
}

/// The causes that the verdict names and how each is taken; their parameters stand in the table.
fn named(found: &Diagnosis) -> String {
    let one = |cause: &Cause| match taken(found).find(|candidate| candidate.cause == *cause) {
        Some(candidate) => {
            let how = if candidate.how.is_empty() { String::new() } else { format!(", {}", candidate.how) };
            let doubt =
                if compensates(candidate) { ", below zero, so it compensates for an unmodelled effect" } else { "" };
            format!("{}{how}{doubt}", claim(*cause))
        }
        None => claim(*cause),
    };
    found.verdict.effects.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn ambiguous(found: &Diagnosis) -> String {
    let all: Vec<String> = found.verdict.effects.iter().map(|cause| claim(*cause)).collect();
    format!("These data cannot tell apart: {}.", all.join(", or "))
}

fn unknown(found: &Diagnosis, units: &Units) -> String {
    let (verdict, gap) = (&found.verdict, &found.gap);
    let recovered = units.torque(gap.recoverable_nm);
    let nature = match gap.recoverable_nm > FOLLOWS * gap.explainable_nm {
        true => format!("A flexible fit recovers {recovered} of it, so it follows the recorded motion"),
        false => format!("A flexible fit recovers only {recovered} of it, so it hardly follows the recorded motion"),
    };
    let lies = if found.places.is_empty() { String::new() } else { format!(" Where it lies: {}.", location(found)) };
    format!(
        "Nothing in the library closes the gap: of {} above a floor of at most {}, {} are left at best.{} {nature}.{lies}",
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

/// "travel since the reversal 0 to 2.1 deg (71 % of its mean square, in 6 % of the samples)".
fn location(found: &Diagnosis) -> String {
    let one = |at: &crate::diagnose::Place| {
        let samples = if at.share_of_samples < 0.995 {
            format!(", in {} % of the samples", significant(100.0 * at.share_of_samples, 2))
        } else {
            String::new()
        };
        format!("{} ({} of its mean square{samples})", bounds(at), percent(at.share_of_gap))
    };
    found.places.first().map_or(String::new(), one)
}
