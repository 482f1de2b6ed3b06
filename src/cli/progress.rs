//! A progress bar on standard error, on a terminal only.

use super::outcome::Talk;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `length` steps called `what`; hidden with `--quiet` or where standard error is not a terminal.
pub fn bar(talk: &Talk, what: &'static str, length: usize) -> ProgressBar {
    // indicatif itself hides a bar on standard error that is no terminal.
    let target = if talk.shows_progress() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(length as u64), target).with_message(what);
    match ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// One step on; after the last, the bar says what goes on behind it.
pub fn step(bar: &ProgressBar, then: &'static str) {
    bar.inc(1);
    if Some(bar.position()) == bar.length() {
        bar.set_style(ProgressStyle::default_spinner());
        bar.set_message(then);
        bar.enable_steady_tick(std::time::Duration::from_millis(100));
    }
}
