//! The operator at the keyboard, asked while the bus goes on: whoever types is read in a thread of its own.

use crate::capture::operator::Operator;
use std::io::{self, BufRead, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// The answer to what was asked last, once there is one.
#[derive(Debug, Default)]
pub struct Keyboard {
    answer: Arc<Mutex<Option<bool>>>,
}

impl Operator for Keyboard {
    fn ask(&self, lines: &[String], word: &str) {
        *self.answer.lock().unwrap_or_else(PoisonError::into_inner) = None;
        let (answer, word) = (Arc::clone(&self.answer), word.to_string());
        let asked = format!("{}\nType `{word}`: ", lines.join("\n"));
        // Nothing here may keep the cycle waiting, not even a terminal that is slow.
        std::thread::spawn(move || {
            let mut out = anstream::stderr().lock();
            let _ = write!(out, "{asked}").and_then(|()| out.flush());
            drop(out);
            let mut typed = String::new();
            let read = io::stdin().lock().read_line(&mut typed);
            *answer.lock().unwrap_or_else(PoisonError::into_inner) = Some(read.is_ok() && typed.trim() == word);
        });
    }

    fn answer(&self) -> Option<bool> {
        // The thread holds it for no longer than an assignment takes.
        self.answer.try_lock().ok().and_then(|answer| *answer)
    }
}
