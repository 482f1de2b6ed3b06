//! What `init` writes: a draft beside the logs, or a folder of its own.

use super::Arguments;
use crate::cli::interrupt;
use crate::import::Series;
use crate::init::{Draft, Survey};
use crate::log::table::{Numbers, parquet_bytes};
use crate::problem::{Problem, Result};
use std::io::Write;
use std::path::Path;

/// Digits kept after the point in logs that are written anew: float64 has 15 to 17 significant ones.
const DECIMALS: usize = 15;

/// Writes campaign.toml beside the logs.
pub(super) fn write_beside(folder: &Path, text: &str, force: bool) -> Result<()> {
    let file = folder.join("campaign.toml");
    if file.exists() && !force {
        return Problem::error(&file, "exists", "name another folder, or replace it with --force").alone();
    }
    let written = tempfile::NamedTempFile::new_in(folder).and_then(|mut new| {
        new.write_all(text.as_bytes())?;
        new.persist(&file).map_err(|error| error.error)?;
        Ok(())
    });
    written.or_else(|error| Problem::unwritable(&file, "cannot be written", &error).alone())
}

/// Writes a new folder with campaign.toml and the logs: tables as they are, others as Parquet.
pub(super) fn write_new(arguments: &Arguments, survey: &Survey, draft: &Draft) -> Result<()> {
    let output = interrupt::output(&arguments.output, arguments.force, "init")?;
    for source in &survey.sources {
        let name = source.log_name();
        if source.stays() {
            let bytes = std::fs::read(&source.path)
                .or_else(|error| Problem::error(&source.path, format!("cannot be read: {error}"), "").alone())?;
            output.copy(&name, &bytes)?;
            continue;
        }
        let named = |series: &&Series| survey.chosen.columns.iter().any(|choice| choice.name == series.name);
        let numbers: Vec<Numbers<'_>> = source
            .columns
            .iter()
            .filter(named)
            .map(|series| Numbers { name: &series.name, values: &series.values, decimals: DECIMALS })
            .collect();
        output.write(&name, parquet_bytes(Path::new(&name), &numbers)?)?;
    }
    output.write("campaign.toml", &draft.text)?;
    output.finish()
}
