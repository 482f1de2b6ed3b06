//! What the verdict of a diagnosis rests on: the gap, the floor, the probabilities.

use super::names::floor_source;
use super::words::{flexible_shrink, kept_together, location, percent};
use crate::diagnose::{Answer, Diagnosis, Floor, Kind};
use crate::report::plots::diagnosis::budget::added;
use crate::report::wording::Units;

/// More than this share of the gap within the model's own confidence is worth a sentence.
const MUCH: f64 = 0.1;
/// Reported from this ratio on: the simulated part of the encoder over the part that is counted.
const MORE_THAN_COUNTED: f64 = 1.05;

/// The evidence for the verdict, a sentence each.
pub fn evidence(found: &Diagnosis) -> Vec<String> {
    let units = Units::of(&found.before.joint);
    let gap = &found.gap;
    let mut all = vec![format!(
        "RMSE of the model as delivered: {}. Noise floor, which no model of the recorded quantities could explain: {} ({}), or {} with its \
         standard error. The gap is the RMS above that, sqrt(RMSE² - floor²): {}. A flexible fit to the recorded motion shrinks it by {} on \
         held-out {}.",
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
    if found.verdict.tells_of_a_gap() {
        all.extend(found.places.first().map(|_| format!("Where the gap lies: {}.", location(found))));
    }
    let (sure, agree) = (percent(found.verdict.confidence), percent(found.verdict.agreement));
    all.push(format!("Probabilities: {}.", probabilities(&found.verdict.probabilities)));
    all.push(format!(
        "The confidence in the verdict, {sure}, is the share of right verdicts among those of its kind{} on simulated joints with withheld \
         answers, reduced where the bootstrap resamples disagree: of those of whole {}, {agree} give the same verdict.",
        clearness(found).map_or(String::new(), |clearness| format!(" ({clearness})")),
        found.resampled,
    ));
    all.iter().map(|sentence| kept_together(sentence)).collect()
}

/// Which verdicts the probability comes from; nothing where that of its kind does for all.
fn clearness(found: &Diagnosis) -> Option<&'static str> {
    let mut clear = found.verdict.decisions.iter().filter(|decision| decision.rule == "clear").peekable();
    clear.peek().filter(|_| found.verdict.kind != Kind::Unknown)?;
    Some(match clear.all(|decision| decision.outcome == "clear") {
        true => "those that close a gap as large as the floor to a tenth",
        false => "those that leave more than a tenth of the gap, or whose gap is below the floor",
    })
}

/// "presliding 87 %; nothing missing 4 %; ...".
fn probabilities(of: &[(Answer, f64)]) -> String {
    let name = |answer: &Answer| match answer {
        Answer::Causes(causes) if causes.is_empty() => "nothing missing".to_string(),
        Answer::Causes(causes) => causes.iter().map(|cause| cause.name()).collect::<Vec<_>>().join(" and "),
        Answer::Outside => "a cause outside the library".to_string(),
        Answer::Other => "other causes of the library".to_string(),
    };
    let one = |(answer, probability): &(Answer, f64)| format!("{} {}", name(answer), percent(*probability));
    of.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// What of a floor is the encoder's, and whether more was simulated than can be counted.
fn encoder_part(floor: &Floor, units: Units) -> Option<String> {
    let most = match floor.encoder_simulated_nm > MORE_THAN_COUNTED * floor.encoder_nm {
        true => format!(
            " The simulation predicts {} from the encoder, more than the residual without its noise; only what the residual has room for is \
             counted, so the gap is a lower bound.",
            units.torque(floor.encoder_simulated_nm)
        ),
        false => String::new(),
    };
    (floor.encoder_nm > 0.0).then(|| {
        format!(
            "Of the floor, {} come from the encoder: the residual that its steps and noise alone give a perfect model, simulated on the \
             recorded motion.{most}",
            units.torque(floor.encoder_nm)
        )
    })
}

/// The share of the gap that the model's own parameters absorb within their confidence, where it is large.
fn own_confidence(found: &Diagnosis) -> Option<String> {
    let share = added(None, found).unwrap_or(0.0);
    (share > MUCH).then(|| {
        format!(
            "{} of the gap could also be absorbed by the model's own parameters within their confidence; only the rest needs what was \
             found. Parameters identified more precisely would decide.",
            percent(share)
        )
    })
}
