//! What `diagnose` writes.

mod json;
pub mod motion;

pub use json::to_json;

use super::output::Output;
use super::{json_text, plots, unmade};
use crate::diagnose::Diagnosis;
use crate::problem::Result;
use std::io::{self, Write};
use std::path::Path;

/// All that `diagnose` writes.
pub const DIAGNOSIS_FILES: &[&str] =
    &["diagnosis.json", "model.json", "next_experiment.toml", "report.html", "plots/*.svg", "plots/*.png"];

/// Writes the diagnosis of `campaign` with `model`.
///
/// Errors: a file that cannot be written.
pub fn write_diagnosis(found: &Diagnosis, campaign: &str, model: &str, output: &Output, _png: bool) -> Result<()> {
    output.write("diagnosis.json", json_text(&to_json(found, campaign, model)))?;
    output.write("model.json", json_text(&found.after.to_json()))?;
    let motion = found.motion.as_ref().map(|gap| plots::diagnosis::motion::draw(gap, found.before.joint.kind));
    match motion.transpose().or_else(|error| unmade(output, "plots", error))?.flatten() {
        Some(drawing) => output.write(&format!("plots/{}.svg", drawing.name), drawing.svg),
        None => Ok(()),
    }
}

/// The verdict in a few lines.
pub fn write_summary(out: &mut impl Write, found: &Diagnosis, campaign: &str, folder: &Path) -> io::Result<()> {
    let names: Vec<&str> = found.verdict.effects.iter().map(|cause| cause.name()).collect();
    writeln!(out, "{campaign}: {} {}", found.verdict.kind.name(), names.join(", "))?;
    for line in found.motion.iter().flat_map(|gap| motion::lines(gap, found.before.joint.kind)) {
        writeln!(out, "  {line}")?;
    }
    writeln!(out, "{}", folder.display())
}
