//! The folder of results: a file for each campaign, there whole or not at all, whatever kills the program.

use super::digest::of_text;
use super::record::{FORMAT, Record};
use crate::problem::{Problem, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Beginning of the names of files that are being written.
const WRITING: &str = ".writing-";
/// Letters of a campaign's name that its file is called after.
const LETTERS: usize = 60;

/// The folder of results.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The results in `output`, which is made if it is not there.
    ///
    /// Errors: `output` holds something, and not results; it cannot be written.
    pub fn open(output: &Path) -> Result<Self> {
        let folder = output.join("campaigns");
        let is_strange = match std::fs::read_dir(output) {
            Ok(mut entries) => !folder.is_dir() && entries.next().is_some(),
            Err(_) => output.exists(),
        };
        if is_strange {
            return Problem::error(output, "exists and is no batch's output", "name another folder").alone();
        }
        match std::fs::create_dir_all(&folder) {
            Ok(()) => Ok(Self { folder }),
            Err(error) => failed(&folder, &error),
        }
    }

    /// The result of the campaign called `name`, if there is one that can be read.
    pub fn read(&self, name: &str) -> Option<Record> {
        let bytes = std::fs::read(self.file(name)).ok()?;
        let record: Record = serde_json::from_slice(&bytes).ok()?;
        (record.format == FORMAT && record.name == name).then_some(record)
    }

    /// Keeps `record`, in place of what there was.
    pub fn write(&self, record: &Record) -> Result<()> {
        let file = self.file(&record.name);
        let mut builder = tempfile::Builder::new();
        builder.prefix(WRITING);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let written = serde_json::to_vec_pretty(record).map_err(std::io::Error::from).and_then(|bytes| {
            let mut being_written = builder.tempfile_in(&self.folder)?;
            being_written.write_all(&bytes)?;
            being_written.persist(&file).map_err(|error| error.error)
        });
        written.map(drop).or_else(|error| failed(&file, &error))
    }

    /// Takes away what a killed program was writing. Nobody else may be writing.
    pub fn sweep(&self) {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return };
        let left = entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(WRITING));
        left.for_each(|entry| drop(std::fs::remove_file(entry.path())));
    }

    /// The file of the campaign called `name`: the name's letters for people, its digest so that no two share one.
    fn file(&self, name: &str) -> PathBuf {
        let letter = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        let letters: String = name.chars().map(letter).take(LETTERS).collect();
        self.folder.join(format!("{}-{}.json", letters.trim_start_matches('.'), of_text(name)))
    }
}

fn failed<T>(path: &Path, error: &std::io::Error) -> Result<T> {
    let problem = Problem::unwritable(path, "cannot be written", error);
    Problem { cure: format!("{}; what is done is kept", problem.cure), ..problem }.alone()
}
