//! What is wrong with an input: where it stands, what was expected, how to mend it.

mod visible;

pub use visible::{acts, visible, visible_lines, visible_styled};

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Whether work can go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The input cannot be used.
    Error,
    /// The input can be used, but the reader should know.
    Warning,
}

/// One fault in one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Whether work can go on.
    pub severity: Severity,
    /// The file at fault.
    pub file: PathBuf,
    /// Row (line) in the file, counted from 1, the header of a table being row 1.
    pub row: Option<u64>,
    /// Name of the column or key at fault.
    pub column: Option<String>,
    /// What was found and what was expected.
    pub what: String,
    /// How to mend it.
    pub cure: String,
}

impl Problem {
    /// A fault that makes `file` unusable.
    pub fn error(file: impl AsRef<Path>, what: impl Into<String>, cure: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            file: file.as_ref().to_path_buf(),
            row: None,
            column: None,
            what: what.into(),
            cure: cure.into(),
        }
    }

    /// A fault that the reader should know of, though work goes on.
    pub fn warning(file: impl AsRef<Path>, what: impl Into<String>, cure: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(file, what, cure) }
    }

    /// The same, at a row (counted from 1).
    pub fn at_row(mut self, row: impl Into<Option<u64>>) -> Self {
        self.row = row.into();
        self
    }

    /// The same, in a named column or key.
    pub fn in_column(mut self, column: impl Into<String>) -> Self {
        self.column = Some(column.into());
        self
    }

    /// `file` cannot be written, because of `error`; `what` says what was to be done to it.
    pub fn unwritable(file: impl AsRef<Path>, what: &str, error: &io::Error) -> Self {
        Self::error(file, format!("{what}: {error}"), cure_of(error))
    }

    /// This problem alone, as the error of a `Result`.
    pub fn alone<T>(self) -> Result<T> {
        Err(Problems(vec![self]))
    }
}

/// What to do about `error`, by its kind.
fn cure_of(error: &io::Error) -> &'static str {
    use io::ErrorKind::*;
    match error.kind() {
        InvalidFilename => "give it a shorter name, of letters that the file system allows",
        StorageFull | QuotaExceeded => "free some space, or write to another disk",
        FileTooLarge => "write to a file system that allows larger files",
        PermissionDenied => "check the permissions of the folder, or write to another",
        ReadOnlyFilesystem => "write to a folder that is not mounted read-only",
        NotFound => "check the path",
        NotADirectory | AlreadyExists | IsADirectory => {
            "name another path: a file or folder of that name is in the way"
        }
        _ => "check the path, its permissions and the disk",
    }
}

/// Whatever the file, the column and the quoted values hold, a message is one line that does nothing to a terminal.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", visible(&self.file.to_string_lossy()))?;
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", `{}`", visible(column))?;
        }
        write!(f, ": {}", visible(&self.what))?;
        if !self.cure.is_empty() {
            write!(f, "; {}", visible(&self.cure))?;
        }
        Ok(())
    }
}

/// All faults found in one go; never empty when it is an error.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// `value` if no problem is an error, else all of them.
    pub fn unless_errors<T>(self, value: T) -> Result<T> {
        if self.0.iter().any(|p| p.severity == Severity::Error) { Err(self) } else { Ok(value) }
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self(vec![problem])
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(Problem::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for Problems {}

/// A value, or all that is wrong with the input it was to come from.
pub type Result<T> = std::result::Result<T, Problems>;
