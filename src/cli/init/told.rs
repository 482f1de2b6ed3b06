//! What `init` tells of its draft.

use super::Arguments;
use crate::init::{self, Draft, DraftTrial, Question, Source, Survey};
use crate::trajectory::Protocol;
use serde_json::{Value, json};
use std::io::Write;

/// For programs.
pub(super) fn to_json(arguments: &Arguments, survey: &Survey, draft: &Draft) -> Value {
    let column = |choice: &init::Choice| json!({ "key": choice.key, "name": choice.name, "unit": choice.measure.unit.name(), "scale": choice.measure.scale, "why": choice.why });
    let trial = |trial: &DraftTrial| {
        let speed = match trial.protocol {
            Protocol::Uniform { speed_rad_s } => Some(speed_rad_s),
            _ => None,
        };
        json!({
            "file": survey.sources[trial.source].log_name(),
            "rows": trial.rows.as_ref().map(|rows| [rows.start, rows.end]),
            "protocol": trial.protocol.name(),
            "speed_rad_s": speed,
            "repeat": trial.repeat,
            "trajectory": trial.trajectory,
            "found": trial.found,
        })
    };
    let question =
        |question: &Question| json!({ "key": question.key, "asks": question.asks, "suggested": question.suggested });
    let source = |source: &Source| json!({ "file": source.path, "form": source.form, "repeated_rows": source.repeated, "missing_rows": source.missing });
    json!({
        "format": "init/1",
        "campaign": arguments.output,
        "kind": survey.chosen.kind.name(),
        "rate_hz": survey.rate_hz,
        "joints": survey.chosen.joints,
        "files": survey.sources.iter().map(source).collect::<Vec<_>>(),
        "columns": survey.chosen.columns.iter().map(column).collect::<Vec<_>>(),
        "trials": survey.trials.iter().map(trial).collect::<Vec<_>>(),
        "questions": draft.questions.iter().map(question).collect::<Vec<_>>(),
        "notes": survey.chosen.notes,
    })
}

/// For people.
pub(super) fn tell(out: &mut Vec<u8>, arguments: &Arguments, survey: &Survey, draft: &Draft) -> std::io::Result<()> {
    let file = arguments.output.join("campaign.toml");
    let rate = match survey.rate_hz {
        0.0 => "an unknown rate".to_string(),
        rate_hz => format!("{rate_hz:.6} Hz"),
    };
    writeln!(out, "{} files at {rate}, {} trials", survey.sources.len(), survey.trials.len())?;
    for choice in &survey.chosen.columns {
        writeln!(out, "  {:<12} `{}`, {}", choice.key, choice.name, choice.measure)?;
    }
    for note in &survey.chosen.notes {
        writeln!(out, "  {note}")?;
    }
    if draft.questions.is_empty() {
        return writeln!(out, "{}: complete; `tautline validate` checks it", file.display());
    }
    writeln!(out, "{}: {} questions are open, marked `# ?`:", file.display(), draft.questions.len())?;
    for question in &draft.questions {
        writeln!(out, "  {}: {}", question.key, question.asks)?;
    }
    Ok(())
}
