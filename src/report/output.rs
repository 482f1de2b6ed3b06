//! An output folder that appears whole or not at all.
//!
//! Everything is written to a hidden folder beside the wanted one; the last act is one rename. Whatever fails before
//! leaves nothing behind.

use crate::problem::{Problem, Result};
use std::ffi::OsString;
use std::io;
use std::path::{Component, Path, PathBuf};
use tempfile::{Builder, TempDir};

/// An output folder being written.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    force: bool,
    names: &'static [&'static str],
    staging: TempDir,
    /// Parents made for it, the deepest first; taken away again unless the output is finished.
    made: Vec<PathBuf>,
}

impl Output {
    /// Starts an output that will stand at `path`.
    ///
    /// `names` lists all that the command writes, relative to `path`; `*` stands for any beginning of a file's name
    /// (`plots/*.svg`). With `force` an existing folder is replaced if it holds the first of them and nothing that is not among
    /// them: nothing but a former output is ever deleted.
    ///
    /// Errors: `path` exists and may not be replaced, or its parent cannot be written.
    pub fn begin(path: &Path, force: bool, names: &'static [&'static str]) -> Result<Self> {
        if path.file_name().is_none() {
            return Problem::error(path, "is no name for an output folder", "name a folder that does not exist")
                .alone();
        }
        check_replaceable(path, force, names)?;
        let parent = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let made: Vec<PathBuf> = parent
            .ancestors()
            .take_while(|p| !p.as_os_str().is_empty() && !p.exists())
            .map(Path::to_path_buf)
            .collect();
        let staged = std::fs::create_dir_all(parent).and_then(|()| staging_in(parent));
        match staged {
            Ok(staging) => Ok(Self { path: path.to_path_buf(), force, names, staging, made }),
            Err(error) => {
                made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
                failed(parent, "cannot be written", &error)
            }
        }
    }

    /// Where it is being written meanwhile.
    pub fn staging(&self) -> &Path {
        self.staging.path()
    }

    /// Where the output will stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `bytes` to `name`, a path relative to the output; makes the folders on the way.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        let shown = self.path.join(name);
        if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_))) {
            return Problem::error(shown, "lies outside the output folder", "rename what it is called after").alone();
        }
        let file = self.staging.path().join(name);
        let folder = file.parent().unwrap_or(self.staging.path());
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&file, bytes))
            .or_else(|error| failed(&shown, "cannot be written", &error))
    }

    /// Puts the output in its place.
    ///
    /// Errors: the folder has come into being meanwhile and may not be replaced, or the file system refuses.
    pub fn finish(mut self) -> Result<()> {
        check_replaceable(&self.path, self.force, self.names)?;
        let staged = self.staging.path().to_path_buf();
        self.replace(&staged).or_else(|error| failed(&self.path, "cannot be put in place", &error))?;
        self.staging.disable_cleanup(true);
        self.made.clear();
        Ok(())
    }

    /// One rename; an older output is moved aside first and deleted last, so that one of the two always stands.
    fn replace(&self, staged: &Path) -> io::Result<()> {
        if !self.path.exists() {
            return std::fs::rename(staged, &self.path);
        }
        let aside = staging_in(staged.parent().unwrap_or(Path::new(".")))?;
        let old = aside.path().join("old");
        std::fs::rename(&self.path, &old)?;
        std::fs::rename(staged, &self.path).inspect_err(|_| drop(std::fs::rename(&old, &self.path)))
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if !self.made.is_empty() {
            // The parents can only go once they are empty.
            let _ = std::fs::remove_dir_all(self.staging.path());
            self.made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
        }
    }
}

/// A hidden folder in `parent`, with the permissions that any new folder gets rather than a private one's.
fn staging_in(parent: &Path) -> io::Result<TempDir> {
    let mut builder = Builder::new();
    builder.prefix(".tautline-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(parent)
}

/// Whether `path` is free, or may be replaced.
fn check_replaceable(path: &Path, force: bool, names: &[&str]) -> Result<()> {
    let Ok(found) = std::fs::symlink_metadata(path) else { return Ok(()) };
    if !found.is_dir() {
        return Problem::error(path, "exists and is no folder", "name another output").alone();
    }
    if !force {
        return Problem::error(path, "the folder exists", "name another, or replace it with --force").alone();
    }
    match first_stranger(path, Path::new(""), names) {
        Ok(None) if is_former_output(path, names) => Ok(()),
        Ok(None) => {
            let what = format!("lacks the `{}` that this command would have written", names.first().unwrap_or(&""));
            Problem::error(path, what, "name another output: --force replaces only former outputs").alone()
        }
        Ok(Some(name)) => {
            let what = format!("holds `{}`, which this command does not write", name.display());
            Problem::error(path, what, "name another output: --force replaces only former outputs").alone()
        }
        Err(error) => failed(path, "cannot be read", &error),
    }
}

/// Whether `path` is empty or holds the first of `names`: a recorded campaign looks like a simulated one but for its mark.
fn is_former_output(path: &Path, names: &[&str]) -> bool {
    let empty = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
    empty || names.first().is_some_and(|mark| path.join(mark).is_file())
}

/// Something in `folder`/`below` that matches none of `names`, if there is anything.
fn first_stranger(folder: &Path, below: &Path, names: &[&str]) -> io::Result<Option<PathBuf>> {
    let mut entries: Vec<(OsString, bool)> = Vec::new();
    for entry in std::fs::read_dir(folder.join(below))? {
        let entry = entry?;
        entries.push((entry.file_name(), entry.file_type()?.is_dir()));
    }
    entries.sort();
    for (name, is_folder) in entries {
        let inner = below.join(name);
        if is_folder && names.iter().any(|known| Path::new(known).parent() == Some(&inner)) {
            if let Some(stranger) = first_stranger(folder, &inner, names)? {
                return Ok(Some(stranger));
            }
        } else if is_folder || !names.iter().any(|known| matches(known, &inner)) {
            return Ok(Some(inner));
        }
    }
    Ok(None)
}

/// Whether `path` is `known`, whose file name may begin with `*`.
fn matches(known: &str, path: &Path) -> bool {
    let known = Path::new(known);
    let name = |p: &Path| p.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let same_name = match name(known).strip_prefix('*') {
        Some(ending) => name(path).ends_with(ending),
        None => name(path) == name(known),
    };
    known.parent() == path.parent() && same_name
}

fn failed<T>(path: &Path, what: &str, error: &io::Error) -> Result<T> {
    Problem::error(path, format!("{what}: {error}"), "check the path, its permissions and the free space").alone()
}
