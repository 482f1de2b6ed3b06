//! What is happening on the joint, on a terminal, drawn by a thread that the cycle never waits for.

use super::outcome::Talk;
use super::progress;
use crate::capture::session::Live;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often it is drawn.
const DRAWN: Duration = Duration::from_millis(100);

/// A view until it is dropped.
pub struct View {
    done: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl View {
    /// Draws `live`, if `talk` may.
    pub fn new(talk: &Talk, live: &Arc<Mutex<Live>>) -> Self {
        let (done, talk, live) = (Arc::new(AtomicBool::new(false)), *talk, Arc::clone(live));
        let ended = Arc::clone(&done);
        let thread = std::thread::spawn(move || {
            let bar = progress::bar(&talk, "", 1);
            while !ended.load(Ordering::Relaxed) {
                let seen = live.lock().unwrap_or_else(PoisonError::into_inner).clone();
                bar.set_length(seen.samples.1.max(1) as u64);
                bar.set_position(seen.samples.0 as u64);
                bar.set_message(line(&seen));
                std::thread::sleep(DRAWN);
            }
            bar.finish_and_clear();
        });
        Self { done, thread: Some(thread) }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn line(seen: &Live) -> String {
    let Live { trial, trials, name, state, position_rad, torque_nm, margins, counts, .. } = seen;
    if state.is_empty() {
        return "starting the bus".to_string();
    }
    let torque = torque_nm.map_or("no torque".to_string(), |torque| format!("{torque:+.3} N m"));
    let (room_rad, room_nm) = margins;
    format!(
        "{trial}/{trials} {name} {state} {position_rad:+.3} rad (room {room_rad:.3}) {torque} (room {room_nm:.2}) \
         late {} missed {}",
        counts.late, counts.missed
    )
}
