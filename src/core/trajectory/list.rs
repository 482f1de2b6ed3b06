//! Motions as they are named: files, or folders of them.

use super::Trajectory;
use crate::problem::{Problem, Problems, Result};
use std::path::{Path, PathBuf};

/// All motions that `paths` name, those of a folder in the order of their files' names.
///
/// Errors: everything that is wrong with any of them; a folder without any.
pub fn read_all(paths: &[PathBuf]) -> Result<Vec<Trajectory>> {
    let (mut trajectories, mut problems) = (Vec::new(), Vec::new());
    for path in paths {
        match files(path) {
            Ok(files) => files.iter().for_each(|file| match Trajectory::read(file) {
                Ok(read) => trajectories.push(read),
                Err(Problems(found)) => problems.extend(found),
            }),
            Err(Problems(found)) => problems.extend(found),
        }
    }
    Problems(problems).unless_errors(trajectories)
}

/// `path` itself, or the TOML files in it.
fn files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let entries = std::fs::read_dir(path)
        .or_else(|error| Problem::error(path, format!("cannot be read: {error}"), "check its permissions").alone())?;
    let is_toml = |file: &PathBuf| file.extension().is_some_and(|extension| extension == "toml");
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_toml).collect();
    files.sort();
    if files.is_empty() {
        return Problem::error(path, "holds no motion", "name a folder that `excite` wrote, or a trajectory's file")
            .alone();
    }
    Ok(files)
}
