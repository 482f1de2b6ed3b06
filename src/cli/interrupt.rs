//! Ctrl-C leaves nothing half-written behind.

use crate::problem::Result;
use crate::report::Output;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Exit status of a program ended by Ctrl-C, as shells have it.
const INTERRUPTED: i32 = 130;

/// The folders in which outputs are being written.
static STAGING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Whether Ctrl-C is only noted, and whether it came.
static GENTLE: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C takes away what is half-written before the program ends.
pub fn catch() {
    // Without a handler Ctrl-C still ends the program; a hidden folder may then be left behind.
    let _ = ctrlc::set_handler(|| {
        ASKED.store(true, Ordering::Relaxed);
        if GENTLE.load(Ordering::Relaxed) {
            return;
        }
        for folder in STAGING.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            let _ = std::fs::remove_dir_all(folder);
        }
        std::process::exit(INTERRUPTED);
    });
}

/// From now on Ctrl-C only sets what this gives: something must be stopped before the program may end.
pub fn noted() -> &'static AtomicBool {
    GENTLE.store(true, Ordering::Relaxed);
    &ASKED
}

/// `Output::begin`, known to the handler.
pub fn output(path: &Path, force: bool, names: &'static [&'static str]) -> Result<Output> {
    let output = Output::begin(path, force, names)?;
    STAGING.lock().unwrap_or_else(PoisonError::into_inner).push(output.staging().to_path_buf());
    Ok(output)
}
