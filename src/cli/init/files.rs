//! The logs that the arguments of `init` name.

use crate::import;
use crate::init::Source;
use crate::problem::{Problem, Result};
use crate::report::output::MANIFEST;
use std::path::{Path, PathBuf};

/// The files that the arguments name, sorted, each once.
pub(super) struct Named {
    /// What may be a log, going by its ending, or by its being named itself.
    pub logs: Vec<PathBuf>,
    /// What else lies in the folders.
    pub others: Vec<PathBuf>,
}

/// Every file that the arguments name: files, those in folders at any depth, those that patterns match.
pub(super) fn named(named: &[PathBuf]) -> Result<Named> {
    let mut all: Vec<PathBuf> = Vec::new();
    for path in named {
        if path.is_dir() {
            all.extend(files_in(path)?);
        } else if path.exists() {
            all.push(path.clone());
        } else {
            let matched: Vec<PathBuf> = glob::glob(&path.to_string_lossy()).into_iter().flatten().flatten().collect();
            if matched.is_empty() {
                return Problem::error(path, "there is no such file", "name logs, their folder or a pattern").alone();
            }
            all.extend(matched.into_iter().filter(|file| file.is_file()));
        }
    }
    all.sort();
    all.dedup();
    let (logs, others): (Vec<PathBuf>, Vec<PathBuf>) =
        all.into_iter().partition(|file| import::is_log(file) || named.contains(file));
    match (logs.is_empty(), others.first()) {
        (false, _) => Ok(Named { logs, others }),
        (true, Some(other)) => import::unsupported(other).alone(),
        (true, None) => Problem::error(&named[0], "holds no log", "name files with a column for each signal").alone(),
    }
}

/// The files below `folder`, except hidden ones and folders that hold a campaign or the output of a command.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).or_else(|error| {
        Problem::error(folder, format!("cannot be read: {error}"), "check the path and its permissions").alone()
    })?;
    let is_own = |inner: &Path| [MANIFEST, "campaign.toml"].iter().any(|own| inner.join(own).exists());
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let name = entry.file_name();
        match entry.path() {
            _ if name.to_string_lossy().starts_with('.') || name == "campaign.toml" => {}
            inner if inner.is_dir() && is_own(&inner) => {}
            inner if inner.is_dir() => found.extend(files_in(&inner)?),
            file => found.push(file),
        }
    }
    Ok(found)
}

/// Whether a file with a log's ending may be none: a text, or one that holds nothing.
pub(super) fn is_perhaps_no_log(file: &Path) -> bool {
    let is_empty = || file.metadata().is_ok_and(|about| about.len() == 0);
    let is_table = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    import::is_text(file) && !is_table || is_empty()
}

/// The folder that all files lie in, at whatever depth.
pub(super) fn common_folder(files: &[PathBuf]) -> PathBuf {
    let mut folder = files[0].parent().unwrap_or(Path::new("")).to_path_buf();
    while !files.iter().all(|file| file.starts_with(&folder)) && folder.pop() {}
    folder
}

/// What `file` is called relative to `base`.
pub(super) fn name_from(base: &Path, file: &Path) -> String {
    file.strip_prefix(base).unwrap_or(file).to_string_lossy().into_owned()
}

/// Whether the campaign's folder is the logs' own, and the logs can stay as they are.
pub(super) fn is_in_place(output: &Path, base: &Path, sources: &[Source]) -> bool {
    let base = if base.as_os_str().is_empty() { Path::new(".") } else { base };
    let is_same = matches!((output.canonicalize(), base.canonicalize()), (Ok(a), Ok(b)) if a == b);
    is_same && sources.iter().all(Source::stays)
}
