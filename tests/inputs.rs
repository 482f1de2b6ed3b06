//! Files that are damaged, that lie about their size, or that no program wrote: refused, and never read as something else.
//! How long the refusal of texts takes, `scripts/refusals.py` measures.

mod bombs;
mod import;
mod makers;
mod parquet;
mod text;

use std::path::{Path, PathBuf};
use tautline::import::{Series, read};
use tempfile::TempDir;

/// A file of these bytes, in a folder of its own.
fn written(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, bytes).unwrap();
    (folder, file)
}

/// What is imported from a file of these bytes, or why not.
fn imported(name: &str, bytes: &[u8]) -> Result<Vec<Series>, String> {
    let (_folder, file) = written(name, bytes);
    read(&file).map(Option::unwrap_or_default).map_err(|problems| problems.to_string())
}

fn values<'a>(all: &'a [Series], name: &str) -> &'a [f64] {
    &all.iter().find(|series| series.name == name).unwrap_or_else(|| panic!("{name} of {all:?}")).values
}

fn reference(name: &str) -> Vec<u8> {
    std::fs::read(Path::new("tests/reference/import").join(name)).unwrap()
}
