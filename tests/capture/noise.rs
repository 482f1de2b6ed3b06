//! A wire that damages frames at random, the whole way from the first to the last: whatever the stack makes of them, nothing hangs,
//! nothing crashes, and the drive is left without torque.

use super::{SWEEP, demo, plan, rig};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tautline::capture::drive::Condition;
use tautline::capture::in_process::InProcess;
use tautline::capture::operator::Agrees;
use tautline::capture::session::{Task, capture};

/// Numbers by chance, repeatable (a 64-bit linear congruential generator with Knuth's constants).
struct Chance(u64);

impl Chance {
    /// The next, below `end`.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }
}

/// Runs a capture in which one answer of `one_in` is damaged; whether it started, and how long it took on the bus, ns.
fn noisy(seed: u64, one_in: usize) -> (bool, u64) {
    let (rig, plan, interrupted) = (rig(), plan(SWEEP), AtomicBool::new(false));
    let (mut bus, mut chance, mut last_ns) = (demo(), Chance(seed), 0);
    let answers = |now_ns: u64, frame: &[u8]| {
        last_ns = now_ns;
        let mut replies: Vec<(u64, Vec<u8>)> =
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect();
        for (_, bytes) in &mut replies {
            // Behind the Ethernet header: what the stack reads.
            if chance.below(one_in) == 0 {
                let at = 14 + chance.below(bytes.len() - 14);
                match chance.below(4) {
                    0 => bytes.truncate(at),
                    _ => bytes[at] ^= 1 << chance.below(8),
                }
            }
        }
        replies
    };
    let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let started = capture(InProcess::new(answers), &task, None, &Arc::default()).is_ok();
    bus.advance(last_ns + 1_000_000_000);
    let condition = Condition::of(bus.drive_status().unwrap());
    assert!(!condition.has_torque(), "seed {seed}, one in {one_in}: {condition}");
    (started, last_ns)
}

#[test]
fn damaged_frames_leave_no_torque() {
    let mut started = 0;
    for seed in 0..8 {
        for one_in in [50, 1_000, 4_000] {
            let (has_started, took_ns) = noisy(seed, one_in);
            started += usize::from(has_started);
            assert!(took_ns < 120_000_000_000, "seed {seed}, one in {one_in}: {took_ns} ns");
        }
    }
    assert!((1..24).contains(&started), "{started} of 24 started: both must be tried");
}
