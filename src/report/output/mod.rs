//! An output folder that appears whole or not at all.
//!
//! Everything is written to a hidden folder beside the wanted one; the last act is one rename. Whatever fails before
//! leaves nothing behind. Everything that a command writes passes through here, so here stand the two gates: what is not a
//! number ends as an error (`gate`), and no text holds characters that act on a terminal or make XML ill-formed.

mod manifest;
mod staging;

pub use manifest::MANIFEST;

use super::gate;
use crate::problem::{Problem, Result, visible_lines};
use manifest::Written;
use staging::Staging;
use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// An output folder being written.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    force: bool,
    command: &'static str,
    staging: Option<Staging>,
    /// What was written so far, by name.
    written: Mutex<BTreeMap<String, Written>>,
    /// What it is made from, by name.
    sources: Mutex<Vec<(&'static str, PathBuf)>>,
    /// Parents made for it, the deepest first; taken away again unless the output is finished.
    made: Vec<PathBuf>,
}

impl Output {
    /// Starts an output of `command` that will stand at `path`.
    ///
    /// With `force` an existing folder is replaced if it holds only what the same command wrote there (`manifest`).
    ///
    /// Errors: `path` exists and may not be replaced, or its parent cannot be written.
    pub fn begin(path: &Path, force: bool, command: &'static str) -> Result<Self> {
        if path.file_name().is_none() {
            return Problem::error(path, "is no name for an output folder", "name a folder that does not exist")
                .alone();
        }
        check_replaceable(path, force, command)?;
        let parent = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let made: Vec<PathBuf> = parent
            .ancestors()
            .take_while(|p| !p.as_os_str().is_empty() && !p.exists())
            .map(Path::to_path_buf)
            .collect();
        let staged = std::fs::create_dir_all(parent).and_then(|()| Staging::new_in(parent));
        match staged {
            Ok(staging) => {
                let (path, written, sources) = (path.to_path_buf(), Mutex::default(), Mutex::default());
                Ok(Self { path, force, command, staging: Some(staging), written, sources, made })
            }
            Err(error) => {
                made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
                Problem::unwritable(parent, "cannot be written", &error).alone()
            }
        }
    }

    /// Where it is being written meanwhile.
    pub fn staging(&self) -> &Path {
        self.staging.as_ref().map_or(&self.path, Staging::path)
    }

    /// Where the output will stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Notes that it is made from the file at `path`, which reports call `name`.
    pub fn made_from(&self, name: &'static str, path: &Path) {
        self.sources.lock().unwrap_or_else(PoisonError::into_inner).push((name, path.to_path_buf()));
    }

    /// What it is made from.
    pub fn sources(&self) -> Vec<(&'static str, PathBuf)> {
        self.sources.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Writes `bytes` that this program made to `name`, a path relative to the output; makes the folders on the way.
    ///
    /// Errors: something is not a number where a figure is meant; it cannot be written.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        let bytes = bytes.as_ref();
        match std::str::from_utf8(bytes) {
            Ok(text) if !name.ends_with(".parquet") && !name.ends_with(".png") => {
                gate::file(&self.path.join(name), text)?;
                self.copy(name, visible_lines(text).as_bytes())
            }
            _ => self.copy(name, bytes),
        }
    }

    /// Writes `bytes` of somebody else's file to `name`, as they are.
    pub fn copy(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let shown = self.path.join(name);
        if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_))) {
            return Problem::error(shown, "lies outside the output folder", "rename what it is called after").alone();
        }
        let file = self.staging().join(name);
        let folder = file.parent().unwrap_or(self.staging());
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&file, bytes))
            .or_else(|error| failed(&shown, "cannot be written", &error))?;
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        written.insert(name.to_string(), Written::of(bytes));
        Ok(())
    }

    /// Puts the output in its place.
    ///
    /// Errors: the folder has come into being meanwhile and may not be replaced, or the file system refuses.
    pub fn finish(mut self) -> Result<()> {
        check_replaceable(&self.path, self.force, self.command)?;
        let list = manifest::text(self.command, self.written.lock().unwrap_or_else(PoisonError::into_inner).iter());
        let Some(staging) = self.staging.take() else { return Ok(()) };
        std::fs::write(staging.path().join(MANIFEST), list)
            .and_then(|()| staging.put(&self.path))
            .or_else(|error| failed(&self.path, "cannot be put in place", &error))?;
        self.made.clear();
        Ok(())
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        // The parents can only go once they are empty.
        drop(self.staging.take());
        self.made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
    }
}

/// Whether `path` is free, or may be replaced by what `command` writes.
pub fn check_replaceable(path: &Path, force: bool, command: &str) -> Result<()> {
    let found = match std::fs::symlink_metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == io::ErrorKind::InvalidFilename => {
            return failed(path, "cannot be written", &error);
        }
        Err(_) => return Ok(()),
    };
    if !found.is_dir() {
        return Problem::error(path, "exists and is no folder", "name another output").alone();
    }
    if !force {
        return Problem::error(path, "the folder exists", "name another, or replace it with --force").alone();
    }
    manifest::check(path, command)
}

fn failed<T>(path: &Path, what: &str, error: &io::Error) -> Result<T> {
    Problem::unwritable(path, what, error).alone()
}
