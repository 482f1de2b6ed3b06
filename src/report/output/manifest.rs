//! The list of what a command wrote to a folder, kept in the folder: what `--force` may delete.
//!
//! A file that is not on the list, or not as it was written, belongs to somebody else and is never deleted.

use crate::problem::{Problem, Result};
use serde_json::{Map, Value, json};
use std::fs::File;
use std::hash::{DefaultHasher, Hasher};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The list's file, hidden: no reader of an output needs it.
pub const MANIFEST: &str = ".tautline.json";
const FORMAT: &str = "output/1";
/// Bytes read at a time.
const CHUNK: usize = 1 << 16;

/// One file as it was written.
///
/// SipHash of 64 bits: it detects changed files, not forged ones. Should a later compiler's standard library hash in another way, the file
/// counts as changed and is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    bytes: u64,
    digest: String,
}

impl Written {
    /// Of what was written from memory.
    pub fn of(bytes: &[u8]) -> Self {
        let mut hasher = DefaultHasher::new();
        hasher.write(bytes);
        Self { bytes: bytes.len() as u64, digest: format!("{:016x}", hasher.finish()) }
    }

    /// Of what stands in `file`.
    fn in_file(file: &Path) -> io::Result<Self> {
        let (mut hasher, mut length, mut chunk) = (DefaultHasher::new(), 0, vec![0; CHUNK]);
        let mut file = File::open(file)?;
        loop {
            match file.read(&mut chunk)? {
                0 => return Ok(Self { bytes: length, digest: format!("{:016x}", hasher.finish()) }),
                read => {
                    hasher.write(&chunk[..read]);
                    length += read as u64;
                }
            }
        }
    }
}

/// The list's text, of `files` by name that `command` wrote.
pub fn text<'a>(command: &str, files: impl Iterator<Item = (&'a String, &'a Written)>) -> String {
    let one = |(name, written): (&String, &Written)| {
        (name.clone(), json!({ "bytes": written.bytes, "digest": written.digest }))
    };
    let files: Map<String, Value> = files.map(one).collect();
    let provenance = json!({ "tautline": env!("CARGO_PKG_VERSION") });
    super::super::json_text(&json!({ "format": FORMAT, "command": command, "files": files, "provenance": provenance }))
}

/// Whether the folder `path` may be replaced by what `command` writes: it is empty, or holds nothing but what `command` wrote.
///
/// Errors: what it holds beside, by name.
pub fn check(path: &Path, command: &str) -> Result<()> {
    /// What may be replaced, for every refusal.
    const ONLY: &str = "--force replaces only what the same command wrote and nobody changed";
    let found =
        below(path, Path::new("")).or_else(|error| Problem::unwritable(path, "cannot be read", &error).alone())?;
    if found.is_empty() {
        return Ok(());
    }
    let Some((wrote, files)) = read(path) else {
        let what = format!("holds no {MANIFEST}, the list of what a command wrote there");
        return Problem::error(path, what, format!("name another output, or delete the folder yourself: {ONLY}"))
            .alone();
    };
    if wrote != command {
        let what = format!("holds what `tautline {wrote}` wrote");
        return Problem::error(path, what, format!("name another output: {ONLY}")).alone();
    }
    for (name, is_file) in found.iter().filter(|(name, _)| name != Path::new(MANIFEST)) {
        let listed = name.to_str().and_then(|name| files.get(&name.replace(std::path::MAIN_SEPARATOR, "/")));
        let Some(listed) = listed.filter(|_| *is_file) else {
            let what = format!("holds `{}`, which `tautline {command}` did not write", name.display());
            return Problem::error(path, what, format!("move it elsewhere, or name another output: {ONLY}")).alone();
        };
        let now = Written::in_file(&path.join(name))
            .or_else(|error| Problem::unwritable(path.join(name), "cannot be read", &error).alone())?;
        if (json!(now.bytes), json!(now.digest)) != (listed["bytes"].clone(), listed["digest"].clone()) {
            let what = format!("holds `{}`, which was changed since `tautline {command}` wrote it", name.display());
            return Problem::error(path, what, format!("keep it elsewhere, or name another output: {ONLY}")).alone();
        }
    }
    Ok(())
}

/// The command and the files of the list in `path`, if there is one that can be read.
fn read(path: &Path) -> Option<(String, Map<String, Value>)> {
    let bytes = std::fs::read(path.join(MANIFEST)).ok()?;
    let mut list: Value = serde_json::from_slice(&bytes).ok()?;
    let command = list["command"].as_str().filter(|_| list["format"] == FORMAT)?.to_string();
    match list["files"].take() {
        Value::Object(files) => Some((command, files)),
        _ => None,
    }
}

/// Everything in `folder` from `inner` on, in order, and whether it is a plain file; of folders only those without a file.
fn below(folder: &Path, inner: &Path) -> io::Result<Vec<(PathBuf, bool)>> {
    let mut entries = std::fs::read_dir(folder.join(inner))?.collect::<io::Result<Vec<_>>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    let mut found = Vec::new();
    for entry in entries {
        let (name, kind) = (inner.join(entry.file_name()), entry.file_type()?);
        match kind.is_dir() {
            true => {
                let held = below(folder, &name)?;
                found.extend(if held.is_empty() { vec![(name, false)] } else { held });
            }
            false => found.push((name, kind.is_file())),
        }
    }
    Ok(found)
}
