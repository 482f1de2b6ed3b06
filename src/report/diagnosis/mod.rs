//! What `diagnose` writes.

mod json;
mod next;

pub use json::to_json;
pub use next::{next_lines, next_toml};

use super::json_text;
use super::output::Output;
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
    next_toml(found).map_or(Ok(()), |text| output.write(next::FILE, text))
}

/// The verdict in a few lines.
pub fn write_summary(out: &mut impl Write, found: &Diagnosis, campaign: &str, folder: &Path) -> io::Result<()> {
    let names: Vec<&str> = found.verdict.effects.iter().map(|cause| cause.name()).collect();
    writeln!(out, "{campaign}: {} {}", found.verdict.kind.name(), names.join(", "))?;
    next_lines(found).iter().try_for_each(|line| writeln!(out, "{line}"))?;
    writeln!(out, "{}", folder.display())
}
