//! The drive after CiA 402: every transition, every mode, how it stops, and what its limits do. Behind it the simulated joint.

use super::master::*;
use tautline::bus::{Bus, Fault, When};

const SWITCH_ON_DISABLED: u16 = 0x40;
const READY: u16 = 0x21;
const SWITCHED_ON: u16 = 0x23;
const ENABLED: u16 = 0x27;
const QUICK_STOP: u16 = 0x07;
const FAULT: u16 = 0x08;

/// The state in a status word, with the mask that it needs.
fn state(status: u16) -> u16 {
    if matches!(status & 0x4F, 0x40 | 0x08 | 0x0F | 0x00) { status & 0x4F } else { status & 0x6F }
}

impl Master {
    /// The state after a control word had three cycles' time.
    fn control(&mut self, control: u16) -> u16 {
        self.wanted.control = control;
        (0..3).for_each(|_| self.hold());
        state(self.cycle().status)
    }

    /// From where the joint is at `speed_rad_s` for `cycles`, in position mode.
    fn glide(&mut self, speed_rad_s: f64, cycles: usize) -> Vec<Told> {
        let begin = rad(self.wanted.position);
        let step = |i: usize| counts(begin + speed_rad_s * (i + 1) as f64 * 1e-3);
        let mut all = Vec::new();
        for i in 0..cycles {
            self.wanted.position = step(i);
            all.push(self.cycle());
        }
        all
    }

    fn set_object(&mut self, index: u16, value: &[u8]) {
        assert_eq!(self.set(index, 0, value), 0);
    }
}

#[test]
fn every_control_word_leads_where_cia_402_says() {
    let mut master = Master::new();
    master.reach_op();
    let steps = [
        (0x00, SWITCH_ON_DISABLED),
        (0x0F, SWITCH_ON_DISABLED),
        (0x07, SWITCH_ON_DISABLED),
        (0x06, READY),
        (0x00, SWITCH_ON_DISABLED), // disable voltage
        (0x06, READY),
        (0x02, SWITCH_ON_DISABLED), // quick stop
        (0x06, READY),
        (0x07, SWITCHED_ON),
        (0x06, READY),
        (0x07, SWITCHED_ON),
        (0x00, SWITCH_ON_DISABLED),
        (0x06, READY),
        (0x0F, ENABLED), // by way of switched on
        (0x07, SWITCHED_ON),
        (0x0F, ENABLED),
        (0x06, READY),
        (0x0F, ENABLED),
        (0x00, SWITCH_ON_DISABLED),
    ];
    for (i, (control, wanted)) in steps.into_iter().enumerate() {
        assert_eq!(master.control(control), wanted, "step {i}, control word {control:#04x}");
    }
}

#[test]
fn position_mode_follows_and_the_torque_is_what_the_model_asks() {
    let mut master = Master::new();
    master.reach_enabled();
    let told = master.glide(0.4, 2000);
    let last = told.last().unwrap();
    let behind = rad(master.wanted.position - last.position);
    assert!((0.0..0.01).contains(&behind), "{behind} rad behind");
    assert!((rad(last.velocity) - 0.4).abs() < 0.002, "{} rad/s", rad(last.velocity));
    assert_eq!((last.status & 0x3800, last.error), (0x1000, 0), "follows, no limit, no following error");
    // At constant speed, long after the reversal: (17) with K~ = 1; the mean, as targets in whole counts shake the joint.
    let truth = truth();
    let steady = &told[1500..];
    let mean = |value: &dyn Fn(&Told) -> f64| steady.iter().map(value).sum::<f64>() / steady.len() as f64;
    let gravity_nm = |told: &Told| truth.dynamics.gravity_nm * rad(told.position).sin();
    let asked = mean(&|told| truth.torque_nm(gravity_nm(told), 0.4, 1.0).torque_nm);
    let sensed = mean(&|told| f64::from(told.sensor) / 32767.0 * 5.0);
    assert!((sensed - asked).abs() < 5e-4, "{sensed} N m for {asked}");
    let given = mean(&|told| f64::from(told.torque) * 0.002);
    assert!((given - asked).abs() < 2e-3, "the drive's own: {given} N m");
}

#[test]
fn speed_mode_runs_and_torque_mode_pushes() {
    let mut master = Master::new();
    master.wanted.mode = 9;
    master.reach_enabled();
    master.wanted.velocity = counts(0.3);
    let told = master.cycles(1000);
    assert!((rad(told[999].velocity) - 0.3).abs() < 0.003, "{} rad/s", rad(told[999].velocity));

    let mut master = Master::new();
    master.wanted.mode = 10;
    master.reach_enabled();
    master.wanted.torque = 300; // 0.6 N m are within what friction holds
    let still = master.cycles(200)[199];
    assert_eq!(still.torque, 300);
    master.wanted.torque = 900;
    let moves = master.cycles(200)[199];
    assert!(rad(moves.velocity) > 0.1 && rad(still.velocity).abs() < 0.1, "{still:?} {moves:?}");
}

#[test]
fn modes_that_it_lacks_are_ignored() {
    let mut master = Master::new();
    master.reach_enabled();
    master.wanted.mode = 1;
    master.cycles(3);
    let now = master.now_ns;
    master.bus.advance(now);
    assert_eq!(master.bus.devices()[0].object(0x6061, 0), Some(&[8][..]));
}

#[test]
fn quick_stop_comes_to_rest_by_its_ramp_and_then_does_as_its_option_says() {
    for (option, rests_in) in [(2i16, SWITCH_ON_DISABLED), (6, QUICK_STOP)] {
        let mut master = Master::new();
        master.reach_pre_op();
        master.set_object(0x605A, &option.to_le_bytes());
        master.set_object(0x6085, &(counts(8.0) as u32).to_le_bytes());
        let mut master = restart(master);
        master.reach_enabled();
        master.glide(0.4, 500);
        master.wanted.control = 0x02;
        let told = master.cycles(200);
        assert_eq!(state(told[2].status), QUICK_STOP);
        // 0.4 rad/s at 8 rad/s^2 take 50 ms.
        let speed_at = |i: usize| rad(told[i].velocity);
        assert!(speed_at(15) > 0.2 && speed_at(20) < 0.3, "{} {}", speed_at(15), speed_at(20));
        let stands = told.iter().position(|told| rad(told.velocity).abs() < 0.02).unwrap();
        assert!((45..70).contains(&stands), "stood after {stands} ms");
        let rests = told.iter().position(|told| state(told.status) == rests_in).unwrap();
        assert!(option == 6 || rad(told[rests - 1].velocity).abs() < 0.002, "power goes once the motor stands");
        assert_eq!(state(told[199].status), rests_in, "option {option}");
    }
}

/// The same bus with its devices back in INIT, their objects as they were set.
fn restart(mut master: Master) -> Master {
    for station in [DRIVE, TERMINAL] {
        assert_eq!(master.ask(station, 1), (1, 0));
    }
    master
}

#[test]
fn a_stopped_drive_goes_on_only_where_it_holds() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.set_object(0x605A, &6i16.to_le_bytes());
    let mut master = restart(master);
    master.reach_enabled();
    assert_eq!(master.control(0x02), QUICK_STOP);
    assert_eq!(master.control(0x0F), ENABLED);
    assert_eq!(master.control(0x02), QUICK_STOP);
    assert_eq!(master.control(0x00), SWITCH_ON_DISABLED);
}

#[test]
fn a_quick_stop_that_is_switched_off_does_nothing() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.set_object(0x605A, &(-1i16).to_le_bytes());
    let mut master = restart(master);
    master.reach_enabled();
    assert_eq!(master.control(0x02), ENABLED);
}

#[test]
fn a_joint_in_the_way_is_a_following_error_after_its_time() {
    let mut master = Master::new();
    master.reach_enabled();
    master.glide(0.4, 300);
    let cycle = master.bus.cycles();
    master.bus.inject(Fault::Blocked, When::Cycle(cycle));
    let told = master.glide(0.4, 400);
    let first = told.iter().position(|told| told.status & 1 << 13 != 0).unwrap();
    let fault = told.iter().position(|told| state(told.status) == FAULT).unwrap();
    // 0.1 rad at 0.4 rad/s take 250 ms; the window's time is 10 ms.
    assert!((235..260).contains(&first) && (9..16).contains(&(fault - first)), "{first} {fault}");
    assert_eq!((told[399].error, told[399].status & 1 << 13), (0x8611, 1 << 13));
    let limited = told.iter().position(|told| told.status & 1 << 11 != 0).unwrap();
    assert!(limited < first, "the motor gave all it may before");
    assert!(told[fault - 5].torque >= 1499, "1500 per mille: {}", told[fault - 5].torque);
}

#[test]
fn a_target_out_of_reach_is_a_following_error_at_any_pace_of_the_master() {
    for cycles in [1, 2, 3] {
        let mut master = Master::new();
        master.reach_enabled();
        master.wanted.position += counts(1.0);
        let fault = (0..500).position(|_| {
            master.wait((cycles - 1) * MS);
            state(master.cycle().status) == FAULT
        });
        assert!(fault.is_some(), "a cycle every {cycles} ms: {fault:?}");
    }
}

#[test]
fn the_most_torque_is_what_0x6072_says() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.set_object(0x6072, &200u16.to_le_bytes());
    let mut master = restart(master);
    master.reach_enabled();
    let told = master.glide(0.2, 300);
    assert!(told.iter().all(|told| told.torque.abs() <= 200));
    assert!(told[200].status & 1 << 11 != 0, "{:#x}", told[200].status);
}

#[test]
fn positions_beyond_its_own_limits_are_not_gone_to() {
    let mut master = Master::new();
    master.reach_enabled();
    let told = master.glide(-0.8, 1100);
    assert!(rad(told[1099].position) > -0.71, "{}", rad(told[1099].position));
    assert!(told[1099].status & 1 << 11 != 0);
}

#[test]
fn a_fault_is_left_by_a_rising_edge_once() {
    let mut master = Master::new();
    master.reach_enabled();
    let now = master.now_ns;
    master.bus.inject(Fault::Drive { code: 0x2310 }, now + MS / 2);
    let told = master.cycles(50);
    assert_eq!((state(told[49].status), told[49].error), (FAULT, 0x2310));
    assert_eq!(master.control(0x0F), FAULT);
    assert_eq!(master.control(0x80), SWITCH_ON_DISABLED);
    assert_eq!(master.cycle().error, 0);
    assert_eq!(master.control(0x06), READY);
}

#[test]
fn without_power_the_joint_hangs_and_falls() {
    let mut master = Master::new();
    master.reach_enabled();
    master.glide(0.5, 2400);
    master.control(0x00);
    master.wait(3_000 * MS);
    let after = master.bus.truth();
    assert!(after.position_rad < 1.15, "{} rad", after.position_rad);
    assert_eq!(after.torque_nm, 0.0_f64.max(after.torque_nm).min(0.02), "nothing pulls");
}

#[test]
fn one_seed_one_course_another_seed_other_noise() {
    let run = |seed: u64| {
        let mut master = Master::at(Bus::demo(truth(), 0.02, seed));
        master.reach_enabled();
        master.glide(0.3, 300)
    };
    assert_eq!(run(3), run(3));
    let noise = |told: &[Told]| told.iter().map(|told| told.sensor).collect::<Vec<i16>>();
    assert_ne!(noise(&run(3)), noise(&run(4)));
}
