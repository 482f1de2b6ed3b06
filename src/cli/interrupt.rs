//! Ctrl-C and other requests to end leave nothing half-written behind.

use crate::problem::Result;
use crate::report::Output;
use console::Term;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// The folders in which outputs are being written.
static STAGING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Whether Ctrl-C is only noted, and whether it came.
static GENTLE: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C, `kill` and a closed terminal take away what is half-written before the program ends.
///
/// Without a handler they still end the program; the hidden folder that is then left behind goes with the next output beside it.
#[cfg(unix)]
pub fn catch() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
    std::thread::spawn(move || signals.forever().for_each(end));
}

/// The same, of Ctrl-C alone.
#[cfg(not(unix))]
pub fn catch() {
    /// As shells number Ctrl-C.
    const INTERRUPT: i32 = 2;
    let _ = ctrlc::set_handler(|| end(INTERRUPT));
}

/// Ends the program as shells expect of one ended by `signal`: 130 after Ctrl-C, 143 after `kill`.
fn end(signal: i32) {
    ASKED.store(true, Ordering::Relaxed);
    if GENTLE.load(Ordering::Relaxed) {
        return;
    }
    for folder in STAGING.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        let _ = std::fs::remove_dir_all(folder);
    }
    // A progress bar may stand on the line, its cursor hidden.
    let terminal = Term::stderr();
    if terminal.is_term() {
        let _ = terminal.clear_line().and_then(|()| terminal.show_cursor());
    }
    std::process::exit(128 + signal);
}

/// From now on Ctrl-C only sets what this gives: something must be stopped before the program may end.
pub fn noted() -> &'static AtomicBool {
    GENTLE.store(true, Ordering::Relaxed);
    &ASKED
}

/// `Output::begin`, known to the handler.
pub fn output(path: &Path, force: bool, command: &'static str) -> Result<Output> {
    let output = Output::begin(path, force, command)?;
    STAGING.lock().unwrap_or_else(PoisonError::into_inner).push(output.staging().to_path_buf());
    Ok(output)
}
