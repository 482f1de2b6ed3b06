//! TOML and JSON as one tree that remembers its rows, and a reader over it that knows which keys were asked for.
//!
//! ```
//! use std::path::Path;
//! use tautline_core::document::Document;
//!
//! let document = Document::from_toml(Path::new("m.toml"), "[motor]\ngain = 2.0")?;
//! let gain = document.read(|root| root.need("motor").section(|motor| motor.need("gain").positive()))?;
//! assert_eq!(gain, 2.0);
//! # Ok::<(), tautline_core::problem::Problems>(())
//! ```
//!
//! There is no list of known keys: a key is known once it was read. So a reader first reads every key, and only then returns early if one
//! is missing; the section then reports the keys that were never read.

mod field;
mod parse;
mod section;
mod write;

pub use field::Field;
pub use section::Section;
pub use write::write_pairs;

use crate::limits::{DOCUMENT_BYTES, NAME_CHARS, NAMES_COMPARED, listed, shown};
use crate::problem::{Problem, Problems, Result};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Keys and what they hold.
pub type Table = BTreeMap<String, Node>;

/// One value and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Row (line), counted from 1; none in JSON.
    pub row: Option<u64>,
    /// What stands there.
    pub value: Value,
}

/// What TOML and JSON can hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// JSON's null: as good as absent.
    Nothing,
    /// true or false.
    Flag(bool),
    /// A number written without point or exponent.
    Whole(i64),
    /// Any other number; TOML can hold infinities and NaN.
    Number(f64),
    /// A text.
    Text(String),
    /// TOML's date, as written.
    Date(String),
    /// A list.
    List(Vec<Node>),
    /// A table (TOML) or object (JSON).
    Table(Table),
}

impl Value {
    /// What it is, for a message: "the text `abc`".
    pub fn describe(&self) -> String {
        match self {
            Self::Nothing => "null".to_string(),
            Self::Flag(flag) => flag.to_string(),
            Self::Whole(whole) => format!("the number {whole}"),
            Self::Number(number) => format!("the number {number:?}"),
            Self::Text(text) => format!("the text `{}`", shown(text)),
            Self::Date(date) => format!("the date {date}"),
            Self::List(_) => "a list".to_string(),
            Self::Table(_) => "a table".to_string(),
        }
    }
}

/// A file as a tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Where it came from, for messages.
    pub file: PathBuf,
    /// Its outermost table.
    pub root: Table,
}

impl Document {
    /// Reads `file`, as JSON if its name ends so and as TOML otherwise.
    ///
    /// Errors: the file cannot be read, is too large, is no UTF-8, or breaks the syntax (with the row).
    pub fn open(file: &Path) -> Result<Self> {
        let bytes = bytes(file, DOCUMENT_BYTES)?;
        let text = std::str::from_utf8(&bytes).or_else(|error| {
            let before = &bytes[..error.valid_up_to()];
            let row = 1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64;
            Problem::error(file, "holds bytes that are no UTF-8 text", "save the file as UTF-8").at_row(row).alone()
        })?;
        let is_json = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        if is_json { Self::from_json(file, text) } else { Self::from_toml(file, text) }
    }

    /// Reads TOML from `text`; `file` only serves messages.
    ///
    /// Errors: the first breach of the syntax, with its row.
    pub fn from_toml(file: &Path, text: &str) -> Result<Self> {
        Ok(Self { file: file.to_path_buf(), root: parse::toml(file, text)? })
    }

    /// Reads JSON from `text`; `file` only serves messages.
    ///
    /// Errors: the first breach of the syntax, with its row; anything but an object outermost.
    pub fn from_json(file: &Path, text: &str) -> Result<Self> {
        Ok(Self { file: file.to_path_buf(), root: parse::json(file, text)? })
    }

    /// The value that `read` returns for the outermost table, or all faults of the file, by row.
    ///
    /// `read` gives None only where a problem was reported. Doubts alone are dropped: `examine` tells them.
    pub fn read<T>(&self, read: impl FnOnce(&Section<'_>) -> Option<T>) -> Result<T> {
        let (value, problems) = self.examine(read);
        match value {
            Some(value) => Problems(problems).unless_errors(value),
            None if problems.is_empty() => Problem::error(&self.file, "was not understood", "").alone(),
            None => Err(Problems(problems)),
        }
    }

    /// The value that `read` returns for the outermost table, if any, and all faults of the file, by row.
    pub fn examine<T>(&self, read: impl FnOnce(&Section<'_>) -> Option<T>) -> (Option<T>, Vec<Problem>) {
        let problems = RefCell::new(Vec::new());
        let value = Section::root(&self.file, &self.root, &problems).finish_with(read);
        let mut problems = problems.into_inner();
        problems.sort_by_key(|problem| problem.row);
        (value, problems)
    }
}

/// The bytes of `file`, at most `most` of them.
///
/// Errors: it cannot be read, or is larger.
pub fn bytes(file: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One more than allowed, so that a file that never ends (a device) is refused too.
    let read = std::fs::File::open(file).and_then(|source| source.take(most + 1).read_to_end(&mut bytes));
    match read {
        Err(error) => {
            Problem::error(file, format!("cannot be read: {error}"), "check the path and its permissions").alone()
        }
        Ok(length) if length as u64 > most => {
            let what = format!("is larger than {} MB", most >> 20);
            Problem::error(file, what, "name the file that was meant, or shorten it").alone()
        }
        Ok(_) => Ok(bytes),
    }
}

/// The one of `known` that `asked` was most likely meant to be, if any comes near. Long names, and names after the first
/// thousand, are not searched: a comparison takes the product of both lengths.
pub fn nearest<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    nearest_of(asked, known.into_iter().take(NAMES_COMPARED).collect())
}

fn nearest_of<'a>(asked: &str, known: Vec<&'a str>) -> Option<&'a str> {
    /// 1 is equal, 0 has nothing in common; at 0.6 `Nm` still finds `N m`, and unrelated words are left alone.
    const NEAR: f64 = 0.6;
    let is_comparable = |name: &str| name.len() <= NAME_CHARS;
    if !is_comparable(asked) {
        return None;
    }
    let known = known.into_iter().filter(|name| is_comparable(name) && *name != asked);
    let asked = asked.trim().to_lowercase();
    let likeness = |name: &str| {
        let name = name.to_lowercase();
        let (short, long) = if name.len() < asked.len() { (&name, &asked) } else { (&asked, &name) };
        // A beginning of three letters or more is telling, however long the rest: `degrees`, `speed`.
        let beginning = if short.len() >= 3 && long.starts_with(short.as_str()) { NEAR } else { 0.0 };
        strsim::normalized_damerau_levenshtein(&asked, &name).max(strsim::sorensen_dice(&asked, &name)).max(beginning)
    };
    let scored = known.map(|name| (likeness(name), name)).filter(|(score, _)| *score >= NEAR);
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// The cure for a name that does not exist: "did you mean ...?" or those that there are, as "`WHAT`: a, b, c".
pub fn suggest<'a>(asked: &str, what: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match nearest(asked, known.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("{what}: {}", listed(known)),
    }
}
