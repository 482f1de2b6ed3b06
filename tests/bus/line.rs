//! What goes wrong on the wire: late, lost, doubled, damaged, short of a count, gone.

use super::master::*;
use tautline::bus::{Fault, Reply, When};

/// An enabled drive, and the replies of ten cycles, `fault` striking with the fifth.
fn struck(fault: Fault) -> (Master, Vec<Vec<Reply>>) {
    let mut master = Master::new();
    master.reach_enabled();
    let cycle = master.bus.cycles();
    master.bus.inject(fault, When::Cycle(cycle + 4));
    let replies = (0..10).map(|_| master.cycle_replies()).collect();
    (master, replies)
}

/// How many came back in each cycle.
fn counts_of(replies: &[Vec<Reply>]) -> Vec<usize> {
    replies.iter().map(Vec::len).collect()
}

#[test]
fn a_reply_takes_as_long_as_its_bytes_and_devices() {
    let mut master = Master::new();
    master.reach_op();
    let reply = master.cycle_replies().remove(0);
    let takes_ns = reply.at_ns - master.now_ns;
    assert_eq!(takes_ns, (reply.frame.len() as u64 + 24) * 80 + 4 * 700);
    assert_eq!(reply.frame[6], 0x12, "the bit by which a master tells its own frames from replies");
}

#[test]
fn late_frames_come_later() {
    let (_, replies) = struck(Fault::Late { frames: 2, by_ns: 3 * MS });
    let times: Vec<u64> = replies.iter().map(|replies| replies[0].at_ns).collect();
    let steps: Vec<u64> = times.windows(2).map(|pair| (pair[1] + 10 * MS - pair[0]) / MS).collect();
    assert_eq!(steps, [11, 11, 11, 14, 11, 8, 11, 11, 11], "ms and ten");
}

#[test]
fn lost_frames_reached_the_devices_and_unsent_ones_did_not() {
    for (fault, reaches) in [(Fault::Lost { frames: 3 }, true), (Fault::Unsent { frames: 3 }, false)] {
        let mut master = Master::new();
        master.reach_enabled();
        let cycle = master.bus.cycles();
        master.bus.inject(fault, When::Cycle(cycle));
        master.wanted.control = 0x06;
        assert_eq!(counts_of(&(0..3).map(|_| master.cycle_replies()).collect::<Vec<_>>()), [0, 0, 0]);
        master.wait(2 * MS);
        assert_eq!(master.bus.drive_status().unwrap() & 0x6F, if reaches { 0x21 } else { 0x27 });
    }
}

#[test]
fn one_missing_target_is_bridged_and_two_stop_the_motor() {
    for (frames, least) in [(1, 0.39), (3, 0.0)] {
        let mut master = Master::new();
        master.reach_enabled();
        let (begin, cycle) = (master.wanted.position, master.bus.cycles());
        master.bus.inject(Fault::Unsent { frames }, When::Cycle(cycle + 300));
        let mut slowest = f64::MAX;
        for i in 0..400 {
            master.wanted.position = begin + counts(4e-4 * f64::from(i));
            master.cycle_replies();
            slowest = if i > 290 { slowest.min(master.bus.truth().velocity_rad_s) } else { slowest };
        }
        assert!(slowest > least && (frames == 1 || slowest < 0.35), "{frames} frames: {slowest} rad/s");
    }
}

#[test]
fn unsent_frames_starve_the_watchdog() {
    let mut master = Master::new();
    master.reach_enabled();
    let now = master.now_ns;
    master.bus.inject(Fault::Unsent { frames: 120 }, now);
    (0..120).for_each(|_| assert!(master.cycle_replies().is_empty()));
    let told = master.cycle();
    assert_eq!((told.states, told.counter), ([0x14, 8], 4));
    assert_eq!((told.status & 0x4F, told.error), (0x08, 0x7500), "the drive stopped by itself");
}

#[test]
fn doubled_frames_come_twice() {
    let (_, replies) = struck(Fault::Duplicated { frames: 1 });
    assert_eq!(counts_of(&replies), [1, 1, 1, 1, 2, 1, 1, 1, 1, 1]);
    assert_eq!(replies[4][0].frame, replies[4][1].frame);
    assert!(replies[4][0].at_ns < replies[4][1].at_ns);
}

#[test]
fn damaged_frames_differ_where_a_master_can_tell() {
    let (_, replies) = struck(Fault::Corrupted { frames: 4 });
    let sound = &replies[3][0].frame;
    let first = &replies[4][0].frame;
    assert_ne!(first[17], sound[17], "a datagram's number");
    assert_ne!(replies[5][0].frame[22], sound[22], "its length");
    assert_ne!(replies[6][0].frame.last(), sound.last(), "a working counter");
    assert!(replies[7][0].frame.len() < sound.len());
    assert_eq!(replies[8][0].frame.len(), sound.len());
}

#[test]
fn a_working_counter_falls_short_of_one_device() {
    for (device, left) in [(0, 1), (1, 3)] {
        let (_, replies) = struck(Fault::WorkingCounterShort { device, frames: 2 });
        let counters: Vec<u16> = replies.iter().map(|replies| told(&replies[0]).counter).collect();
        assert_eq!(counters, [4, 4, 4, 4, left, left, 4, 4, 4, 4]);
    }
}

#[test]
fn a_device_that_is_gone_takes_those_behind_it_along() {
    for (device, left) in [(1, 3), (0, 0)] {
        let (mut master, replies) = struck(Fault::Gone { device });
        assert_eq!(counts_of(&replies)[3..5], [1, usize::from(device > 0)]);
        if device > 0 {
            assert_eq!(told(&replies[5][0]).counter, left);
            assert_eq!(master.read_u16(DRIVE, 0x0110) & 0x00F0, 0x10, "no link behind it");
            assert_eq!(master.one(FPRD, place(TERMINAL, 0x0130), &[0; 2]).1, 0);
        }
    }
}
