//! The hidden folder in which an output is made, beside the place where it will stand.
//!
//! It is locked for as long as its process lives, so that another can tell what a killed process left behind and take it away.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;
use tempfile::{Builder, TempDir};

/// Beginning of the names of folders being written; what begins so and is not locked was left behind.
const NEW: &str = ".tautline-new-";
/// Beginning of the names of folders that hold a former output for the moment of its replacement: never swept, because after a
/// crash at that moment one holds the only copy.
const OLD: &str = ".tautline-old-";
/// Another process may remove a folder between its creation and its locking: then another is made, up to this many times.
const TRIES: usize = 10;

/// A folder being filled.
#[derive(Debug)]
pub struct Staging {
    folder: TempDir,
    /// Released when the process ends, however it ends.
    _lock: Option<File>,
}

impl Staging {
    /// A new one in `parent`, with the permissions that any new folder gets; those that killed processes left there go.
    pub fn new_in(parent: &Path) -> io::Result<Self> {
        sweep(parent);
        for _ in 0..TRIES {
            let folder = hidden(parent, NEW)?;
            let lock = match lock(folder.path()) {
                Ok(lock) => lock,
                Err(()) => continue,
            };
            if folder.path().is_dir() {
                return Ok(Self { folder, _lock: lock });
            }
        }
        Err(io::Error::other("another process takes away every folder that is made there"))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Puts it in the place of `path`; an older output there goes. One of the two always stands.
    pub fn put(mut self, path: &Path) -> io::Result<()> {
        if !path.exists() {
            std::fs::rename(self.path(), path)?;
            self.folder.disable_cleanup(true);
        } else if !exchange(self.path(), path) {
            let aside = hidden(self.path().parent().unwrap_or(Path::new(".")), OLD)?;
            let old = aside.path().join("old");
            std::fs::rename(path, &old)?;
            std::fs::rename(self.path(), path).inspect_err(|_| drop(std::fs::rename(&old, path)))?;
            self.folder.disable_cleanup(true);
        }
        // After an exchange the hidden folder holds the older output, and goes with `self`.
        Ok(())
    }
}

fn hidden(parent: &Path, prefix: &str) -> io::Result<TempDir> {
    let mut builder = Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(parent)
}

/// Takes away the folders in `parent` whose process is gone. What cannot be locked, or cannot be deleted, stays.
fn sweep(parent: &Path) {
    let Ok(entries) = std::fs::read_dir(parent) else { return };
    for entry in entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(NEW)) {
        if entry.file_type().is_ok_and(|kind| kind.is_dir())
            && let Ok(Some(_lock)) = lock(&entry.path())
        {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

/// The lock on `folder`; `None` where the file system knows none. Errors: another process holds it, or the folder is gone.
#[cfg(unix)]
fn lock(folder: &Path) -> Result<Option<File>, ()> {
    let file = File::open(folder).map_err(drop)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(()),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Folders cannot be locked here: nothing is swept.
#[cfg(not(unix))]
fn lock(_: &Path) -> Result<Option<File>, ()> {
    Ok(None)
}

/// Exchanges two folders in one step, where the system can.
#[cfg(target_os = "linux")]
fn exchange(one: &Path, other: &Path) -> bool {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE).is_ok()
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> bool {
    false
}
