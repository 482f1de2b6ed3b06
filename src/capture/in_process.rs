//! A wire to a bus in this process: in virtual time, which passes only as it is waited for, or paced by the clock on the wall.

use super::wire::Wire;
use std::collections::BTreeMap;
use std::io;
use std::time::{Duration, Instant};

/// What a frame sent at a time (ns) brings back, and when.
pub trait Answers: FnMut(u64, &[u8]) -> Vec<(u64, Vec<u8>)> {}
impl<F: FnMut(u64, &[u8]) -> Vec<(u64, Vec<u8>)>> Answers for F {}

/// A wire to whatever answers.
#[derive(Debug)]
pub struct InProcess<F> {
    answers: F,
    /// Frames under way by arrival and order.
    coming: BTreeMap<(u64, u64), Vec<u8>>,
    sent: u64,
    now_ns: u64,
    wall: Option<Instant>,
}

impl<F: Answers> InProcess<F> {
    /// In virtual time.
    pub fn new(answers: F) -> Self {
        Self { answers, coming: BTreeMap::new(), sent: 0, now_ns: 0, wall: None }
    }

    /// Paced by the clock on the wall.
    pub fn in_real_time(answers: F) -> Self {
        Self { wall: Some(Instant::now()), ..Self::new(answers) }
    }
}

impl<F: Answers> Wire for InProcess<F> {
    fn now_ns(&self) -> u64 {
        self.wall.map_or(self.now_ns, |began| began.elapsed().as_nanos() as u64)
    }

    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        let now_ns = self.now_ns();
        for (at_ns, reply) in (self.answers)(now_ns, frame) {
            self.sent += 1;
            self.coming.insert((at_ns, self.sent), reply);
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], until_ns: u64) -> io::Result<Option<usize>> {
        let due = self.coming.first_entry().filter(|next| next.key().0 <= until_ns.max(self.now_ns));
        let Some(frame) = due else {
            self.sleep(until_ns);
            return Ok(None);
        };
        let ((at_ns, _), bytes) = frame.remove_entry();
        self.sleep(at_ns);
        let length = bytes.len().min(buffer.len());
        buffer[..length].copy_from_slice(&bytes[..length]);
        Ok(Some(length))
    }

    fn sleep(&mut self, until_ns: u64) {
        let now_ns = self.now_ns();
        if self.wall.is_some() && until_ns > now_ns {
            std::thread::sleep(Duration::from_nanos(until_ns - now_ns));
        }
        self.now_ns = now_ns.max(until_ns);
    }

    fn is_real_time(&self) -> bool {
        self.wall.is_some()
    }
}
