//! Files that are damaged, that lie about their size, or that no program wrote: refused in good time, and never read as something else.

mod bombs;
mod import;
mod makers;
mod parquet;
mod text;

use std::path::{Path, PathBuf};
use tautline::import::{Series, read};
use tempfile::TempDir;

/// Processor time that an input of under 10 MB may take, s: the goal is 2 s on one idle core, and tests run beside each other.
const IN_GOOD_TIME_S: f64 = 6.0;

/// What `read` gives, which must not take long. What other threads do at the same time does not count.
fn in_good_time<T>(read: impl FnOnce() -> T) -> T {
    let spent_s = || -> Option<f64> {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        Some(told.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
    };
    let start_s = spent_s();
    let result = read();
    let took_s = spent_s().zip(start_s).map_or(0.0, |(end_s, start_s)| end_s - start_s);
    assert!(took_s < IN_GOOD_TIME_S, "{took_s} s");
    result
}

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
    in_good_time(|| read(&file)).map(Option::unwrap_or_default).map_err(|problems| problems.to_string())
}

fn values<'a>(all: &'a [Series], name: &str) -> &'a [f64] {
    &all.iter().find(|series| series.name == name).unwrap_or_else(|| panic!("{name} of {all:?}")).values
}

fn reference(name: &str) -> Vec<u8> {
    std::fs::read(Path::new("tests/reference/import").join(name)).unwrap()
}
