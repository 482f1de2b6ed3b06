//! Where the files lie that a campaign names: in its folder, by their path from there.

use std::path::{Component, Path, PathBuf};

/// Where a named file is.
#[derive(Debug, PartialEq)]
pub(super) enum Found {
    /// In the folder.
    Here,
    /// In the folder is a link to it; it lies elsewhere. Read all the same: laboratories link large recordings.
    Linked(PathBuf),
    /// Its path leaves the folder.
    Outside,
    /// Nowhere, or it is no file: what is there instead.
    Absent(&'static str),
}

/// Where `file` is, by its path from `folder`.
pub(super) fn find(folder: &Path, file: &str) -> Found {
    let is_inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let path = folder.join(file);
    if !Path::new(file).components().all(is_inside) {
        return Found::Outside;
    }
    if !path.is_file() {
        return Found::Absent(match () {
            () if path.is_dir() => "is a folder, not a file",
            () if path.is_symlink() => "is a link to what is not there",
            () if path.exists() => "is no file",
            () => "does not exist",
        });
    }
    // An empty path is the current folder's.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(real), Ok(folder)) if !real.starts_with(&folder) => Found::Linked(real),
        _ => Found::Here,
    }
}

/// What a reader should know of a link to `real`, and what to do.
pub(super) fn of_link(file: &str, real: &Path) -> (String, &'static str) {
    let what = format!("`{file}` is a link to {}, outside the campaign", real.display());
    (what, "it is read; copy it into the campaign before you move or share the folder")
}
