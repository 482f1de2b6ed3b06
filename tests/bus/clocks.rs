//! Distributed clocks: receive times, system time that is followed, pulses.

use super::master::*;
use tautline::bus::Bus;

impl Master {
    fn system_ns(&mut self, station: u16) -> u64 {
        u64::from_le_bytes(self.read(station, 0x0910, 8).try_into().unwrap())
    }

    /// Offsets that bring both clocks to the bus's time, as a master computes them from the receive times.
    fn align(&mut self) {
        assert_eq!(self.one(BWR, place(0, 0x0900), &[0; 4]).1, 2);
        let latched_ns = self.now_ns;
        for station in [DRIVE, TERMINAL] {
            let local_ns = u64::from_le_bytes(self.read(station, 0x0918, 8).try_into().unwrap());
            self.write(station, 0x0920, &latched_ns.wrapping_sub(local_ns).to_le_bytes());
        }
    }

    fn pulses(&mut self, station: u16, start_ns: u64, cycle_ns: u32) {
        self.write(station, 0x0981, &[0]);
        self.write(station, 0x0990, &start_ns.to_le_bytes());
        self.write(station, 0x09A0, &cycle_ns.to_le_bytes());
        self.write(station, 0x0981, &[3]);
    }
}

#[test]
fn receive_times_tell_how_long_the_wire_is() {
    let mut master = Master::new();
    master.address();
    master.one(BWR, place(0, 0x0900), &[0; 4]);
    let times: Vec<u32> =
        master.read(DRIVE, 0x0900, 16).chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(times[1].wrapping_sub(times[0]), 2100, "there and back");
    assert_eq!(times[2..], [0, 0]);
    let local_ns = master.read(DRIVE, 0x0918, 8);
    assert_eq!(local_ns[..4], times[0].to_le_bytes());
}

#[test]
fn clocks_follow_the_reference() {
    let mut master = Master::new();
    master.address();
    master.align();
    master.wait(1_000 * MS);
    let apart = |master: &mut Master| {
        let (a, b) = (master.system_ns(DRIVE), master.system_ns(TERMINAL));
        b as i64 - a as i64 - 20_700 // the second read comes 20 us and a hop later
    };
    let before = apart(&mut master);
    assert!((-12_200..-11_200).contains(&before), "11 ppm in a second, and a hop: {before} ns");
    for _ in 0..100 {
        master.one(FRMW, place(DRIVE, 0x0910), &[0; 8]);
    }
    let after = apart(&mut master);
    assert!(after.abs() < 1_000, "{after} ns apart");
    let difference = u32::from_le_bytes(master.read(TERMINAL, 0x092C, 4).try_into().unwrap());
    assert!(difference & 0x7FFF_FFFF < 1_000, "{difference:#x}");
}

#[test]
fn pulses_let_a_device_sample_and_their_absence_keeps_it_from_op() {
    let mut master = Master::new();
    master.address();
    master.align();
    let start_ns = master.system_ns(TERMINAL) + 5 * MS;
    master.pulses(TERMINAL, start_ns, MS as u32);
    let past_ns = master.system_ns(DRIVE).wrapping_sub(5 * MS);
    master.pulses(DRIVE, past_ns, MS as u32);
    master.reach_safe_op();
    // The terminal converts with each pulse: its toggle bit turns every cycle.
    let toggles: Vec<bool> = master.cycles(10).iter().map(|told| told.sensor_status & 0x8000 != 0).collect();
    assert!(toggles.windows(2).all(|pair| pair[0] != pair[1]), "{toggles:?}");
    assert_eq!(master.ask(TERMINAL, 8), (8, 0));
    // A start that had passed never comes.
    assert_eq!(master.ask(DRIVE, 8), (0x14, 0x002D));
}

#[test]
fn a_clock_without_a_period_is_refused() {
    let mut master = Master::new();
    master.reach_safe_op();
    assert_eq!(master.ask(DRIVE, 2), (2, 0));
    master.write(DRIVE, 0x09A0, &[0; 4]);
    master.write(DRIVE, 0x0981, &[3]);
    assert_eq!(master.ask(DRIVE, 4), (0x12, 0x0030));
}

#[test]
fn a_device_without_a_clock_does_not_answer_for_one() {
    use tautline::bus::{Application, Description, Device, Dictionary, Emergency, Moment, World};
    #[derive(Debug)]
    struct Nothing;
    impl Application for Nothing {
        fn work(&mut self, _: &mut Dictionary, _: &mut World, _: Moment) -> Option<Emergency> {
            None
        }
        fn fail(&mut self, _: tautline::bus::Fault) {}
    }
    let description = Description {
        identity: [1, 2, 3, 4],
        names: ["A", "B", "C"],
        dictionary: Dictionary::default(),
        mailbox: false,
        clock: None,
        feeds_watchdog: true,
    };
    let devices = vec![tautline::bus::drive(0), Device::new(description, Box::new(Nothing))];
    let mut master = Master::at(Bus::new(devices));
    assert_eq!(master.one(BWR, place(0, 0x0900), &[0; 4]).1, 1);
    assert_eq!(master.one(BRD, 0, &[0; 1]).1, 2);
}
