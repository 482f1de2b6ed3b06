//! What to do next.

use super::experiment::sentences;
use super::names::{bounds, family, means, place};
use super::words::{compensates, taken};
use crate::diagnose::{Candidate, Cause, Diagnosis, Kind, signature};
use crate::effects::{Family, Region};
use crate::report::number::counted;
use crate::report::wording::Units;

/// What to do next, a sentence each, the first thing first.
pub fn next_steps(found: &Diagnosis) -> Vec<String> {
    let mut steps = by_verdict(found);
    steps.extend(standing_out(found));
    steps.extend(sentences(found));
    steps
}

fn by_verdict(found: &Diagnosis) -> Vec<String> {
    match found.verdict.kind {
        Kind::Ambiguous if found.next.is_some() => Vec::new(),
        Kind::None => vec![
            "Keep the model. To detect smaller effects, lower the noise floor (more repeats, less noise) or record motions that \
             these trials do not include."
                .to_string(),
        ],
        Kind::Ambiguous => vec![ambiguous(found)],
        Kind::Unknown => unknown(found),
        Kind::Stale | Kind::Effect | Kind::Several => mend(found),
    }
}

/// Stretches in which the residual stands out, where contact is not among the causes.
fn standing_out(found: &Diagnosis) -> Option<String> {
    let largest_nm = found.contacts.iter().map(|contact| contact.peak_nm.abs()).reduce(f64::max)?;
    let stretches = counted(found.contacts.len(), "short stretch", "short stretches");
    let largest = Units::of(&found.before.joint).torque(largest_nm);
    (!found.verdict.effects.contains(&Cause::CONTACT)).then(|| {
        format!(
            "Look at {stretches} with a large residual, up to {largest}: too short to raise the RMS above the floor, and not repeated with \
             the motion."
        )
    })
}

/// What to do about each cause of the verdict: the measurement first, because a model fitted to its faults is valid for nothing else.
fn mend(found: &Diagnosis) -> Vec<String> {
    let causes = &found.verdict.effects;
    let of = |wanted: Option<Family>| causes.iter().copied().filter(move |cause| family(*cause) == wanted);
    let mut steps: Vec<String> = of(Some(Family::Fault)).map(|cause| mend_measurement(cause).to_string()).collect();
    let faults: Vec<&str> = of(Some(Family::Fault)).map(Cause::name).collect();
    if !faults.is_empty() {
        steps.push(format!(
            "The model.json written here includes {}: it predicts these recordings, not the joint. For the joint delete {} from its \"effects\".",
            faults.join(" and "),
            if faults.len() == 1 { "it" } else { "them" }
        ));
    }
    if of(Some(Family::Outside)).next().is_some() {
        let step = "Leave the stretches of contact out, or record again without anybody touching the joint; contact is no reason to change \
                    the model.";
        steps.push(step.to_string());
    }
    let is_makeshift = |cause: &Cause| taken(found).any(|one| one.cause == *cause && compensates(one));
    let (makeshift, stale): (Vec<Cause>, Vec<Cause>) = of(None).partition(is_makeshift);
    let names = |causes: &[Cause]| causes.iter().map(|cause| means(*cause)).collect::<Vec<&str>>().join(" and ");
    let added: Vec<&str> = of(Some(Family::Physics)).map(Cause::name).collect();
    let holds: Vec<String> = [
        (!added.is_empty()).then(|| format!("with {} added", added.join(" and "))),
        (!stale.is_empty() || !makeshift.is_empty()).then(|| "with its own parameters refitted".to_string()),
    ]
    .into_iter()
    .flatten()
    .collect();
    let is_doubtful = taken(found).any(compensates);
    if !holds.is_empty() {
        let model = if faults.is_empty() { "Use the model.json written here" } else { "Then use it" };
        let within = if is_doubtful { ", within the recorded motion only" } else { "" };
        steps.push(format!("{model}, {}{within}; validate it on a new recording.", holds.join(" and ")));
    }
    if !stale.is_empty() {
        let what = names(&stale);
        steps.push(format!(
            "Find out why {what} changed (cable tension, wear, temperature, load), or identify the joint again."
        ));
    }
    if is_doubtful {
        let doubtful: Vec<Cause> = taken(found).filter(|one| compensates(one)).map(|one| one.cause).collect();
        let names: Vec<&str> = doubtful.iter().map(|cause| cause.name()).collect();
        steps.push(format!(
            "Do not interpret {}: a coefficient comes out negative, so it stands for an effect that is still missing.",
            names.join(" and ")
        ));
    }
    steps.extend(rivals(found));
    steps
}

/// What else would explain as well in the place of what was taken.
fn rivals(found: &Diagnosis) -> Option<String> {
    let of = |one: &Candidate| {
        let rivals: Vec<&str> = one.trades_with.iter().map(|rival| rival.name()).collect();
        (!rivals.is_empty()).then(|| format!("{} instead of {}", rivals.join(" or "), one.cause.name()))
    };
    let all: Vec<String> = taken(found).filter_map(of).collect();
    (!all.is_empty()).then(|| {
        let what = all.join("; ");
        format!("These data are explained about equally well with {what}: before you rely on the name, record a motion on which they differ.")
    })
}

fn mend_measurement(fault: Cause) -> &'static str {
    let remedy = fault.effect().and_then(|effect| effect.about().remedy);
    remedy.unwrap_or("Correct the measurement, then record again; it is no reason to change the model.")
}

/// Where each rival would show: a motion that separates these regions separates the rivals.
fn ambiguous(found: &Diagnosis) -> String {
    let how = |cause: Cause| found.candidates.iter().find(|c| c.cause == cause).map_or("", |candidate| candidate.how);
    let shows: Vec<(Cause, Region)> =
        found.verdict.effects.iter().map(|cause| (*cause, signature(*cause, how(*cause)))).collect();
    let alike = shows.windows(2).all(|pair| pair[0].1 == pair[1].1);
    let until = "Until then the choice between them is a guess.";
    match shows.first() {
        Some((_, region)) if alike => {
            format!(
                "Record a motion on which they differ; all of them show {}, so vary the motion widely there. {until}",
                place(*region)
            )
        }
        _ => {
            let one = |(cause, region): &(Cause, Region)| format!("{} shows {}", cause.name(), place(*region));
            let signs: Vec<String> = shows.iter().map(one).collect();
            format!("Record a motion on which they differ: {}. {until}", signs.join(", "))
        }
    }
}

fn unknown(found: &Diagnosis) -> Vec<String> {
    if found.verdict.differing().is_some() {
        return vec![
            "Compare the residuals of repeats: the speeds at which they differ most tell stick-slip from a rumble and from a torque that comes at \
             any time."
                .to_string(),
            "Record the joint at rest, too: what differs there as well is not friction.".to_string(),
        ];
    }
    let at = found.places.first().map_or("time".to_string(), bounds);
    vec![
        format!(
            "Look at the residual where most of it lies ({at}): its shape there is the best clue to the missing effect."
        ),
        "Check that joint, sensor and campaign.toml belong together: sign, radii, low-pass, units.".to_string(),
    ]
}
