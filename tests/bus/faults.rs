//! What goes wrong in devices, at the joint and in its sensor: each shows as it would on real ones.

use super::master::*;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, drive};

/// An enabled drive in motion at 0.4 rad/s, and 300 cycles more, `fault` striking with the hundredth.
fn struck(fault: Fault) -> (Master, Vec<Told>) {
    struck_at(Master::new(), fault)
}

fn struck_at(mut master: Master, fault: Fault) -> (Master, Vec<Told>) {
    master.reach_enabled();
    let (begin, cycle) = (master.wanted.position, master.bus.cycles());
    master.bus.inject(fault, When::Cycle(cycle + 400));
    let mut told = Vec::new();
    for i in 0..600 {
        master.wanted.position = begin + counts(4e-4 * f64::from(i));
        told.push(master.cycle());
    }
    (master, told.split_off(300))
}

/// The first cycle after the fault's at which something holds.
fn first(told: &[Told], holds: impl Fn(&Told) -> bool) -> usize {
    assert!(!told[..100].iter().any(&holds), "before the fault");
    told.iter().position(holds).expect("it never shows") - 100
}

/// Whether the motor stood before its power went.
fn stopped_by_itself(told: &[Told]) -> bool {
    let powerless = told.iter().position(|told| matches!(told.status & 0x4F, 0x08 | 0x40)).unwrap();
    rad(told[99].velocity) > 0.39 && powerless > 110 && rad(told[powerless - 1].velocity).abs() < 2e-3
}

#[test]
fn a_device_falls_to_safe_op_with_its_code_and_the_drive_stops() {
    let (mut master, told) = struck(Fault::SafeOp { device: 0, code: 0x001A });
    assert!(first(&told, |told| told.states[0] == 0x14) <= 1);
    assert!(told.iter().all(|told| told.counter == 4), "the working counter does not tell");
    assert_eq!(master.read_u16(DRIVE, 0x0134), 0x001A);
    assert_eq!((told[299].status & 0x4F, told[299].error), (0x08, 0x7500));
    assert!(stopped_by_itself(&told));

    let (_, told) = struck(Fault::SafeOp { device: 1, code: 0x001A });
    assert!(first(&told, |told| told.states[1] == 0x14) <= 1);
    assert_eq!(told[299].status & 0x6F, 0x27, "the drive knows nothing of it");
}

#[test]
fn a_watchdog_expires_while_frames_come() {
    let (mut master, told) = struck(Fault::Watchdog { device: 0 });
    assert!(first(&told, |told| told.states[0] == 0x14) <= 1);
    assert_eq!(master.read_u16(DRIVE, 0x0134), 0x001B);
}

#[test]
fn an_emergency_waits_in_the_mailbox_and_the_drive_goes_on() {
    let (mut master, told) = struck(Fault::Emergency { device: 0, code: 0x4210 });
    assert_eq!(told[299].status & 0x6F, 0x27);
    assert_eq!(master.read(DRIVE, 0x080D, 1)[0] & 8, 8);
    let message = master.read(DRIVE, 0x1080, 128);
    assert_eq!((message[5] & 0x0F, message[7] >> 4, &message[8..10]), (3, 1, &[0x10, 0x42][..]));
}

#[test]
fn a_drive_fault_stops_the_motor_and_sends_an_emergency() {
    let (mut master, told) = struck(Fault::Drive { code: 0x2310 });
    assert!(first(&told, |told| told.status & 8 != 0) <= 1, "fault bit");
    assert!(first(&told, |told| told.status & 0x4F == 0x0F) <= 1, "reacting");
    assert_eq!((told[299].status & 0x4F, told[299].error), (0x08, 0x2310));
    assert_eq!(&master.read(DRIVE, 0x1080, 128)[8..10], &[0x10, 0x23]);
}

#[test]
fn the_drive_stops_by_itself() {
    let (_, told) = struck(Fault::QuickStop);
    assert!(first(&told, |told| told.status & 1 << 5 == 0) <= 1);
    assert!(stopped_by_itself(&told));
    assert_eq!(told[299].error, 0);
}

#[test]
fn an_inhibited_drive_gives_no_torque_and_cannot_be_enabled() {
    let (mut master, told) = struck(Fault::Inhibit);
    assert!(first(&told, |told| told.status & 0x4F == 0x40) <= 1);
    assert_eq!((told[299].torque, told[299].status & 1 << 4), (0, 0));
    for control in [0x06, 0x07, 0x0F] {
        master.wanted.control = control;
        assert_eq!(master.cycles(3)[2].status & 0x4F, 0x40);
    }
}

#[test]
fn an_internal_limit_shows() {
    let (_, told) = struck(Fault::InternalLimit);
    assert!(first(&told, |told| told.status & 1 << 11 != 0) <= 1);
}

#[test]
fn a_blocked_joint_stands_and_its_torque_rises() {
    let (master, told) = struck(Fault::Blocked);
    assert!(first(&told, |told| told.velocity == 0) <= 2);
    assert!(told[140].sensor > 2 * told[95].sensor, "{} after {}", told[140].sensor, told[95].sensor);
    assert_eq!(master.bus.truth().velocity_rad_s, 0.0);
}

#[test]
fn a_broken_cable_leaves_the_sensor_at_nothing() {
    let (_, told) = struck(Fault::CableBreak);
    let nothing = |told: &Told| told.sensor.abs() < 10;
    assert!(first(&told, nothing) <= 1);
    assert!(told[105..].iter().all(nothing));
    assert_eq!(told[299].status & 0x6F, 0x27, "the drive goes on turning its winch");
}

#[test]
fn an_encoder_jumps_and_the_motor_believes_it() {
    let (master, told) = struck(Fault::EncoderJump { by_rad: 0.03 });
    let jumps: Vec<usize> = (1..300).filter(|&i| rad(told[i].position - told[i - 1].position).abs() > 0.01).collect();
    assert!(jumps.len() == 1 && (100..103).contains(&jumps[0]), "{jumps:?}");
    let (shown, is) = (rad(told[299].position), master.bus.truth().position_rad);
    assert!((shown - is - 0.03).abs() < 1e-3, "{shown} shown, {is} true");
}

#[test]
fn a_stale_sensor_keeps_its_value_and_its_toggle() {
    let (_, told) = struck(Fault::StaleSensor);
    assert!(told[..100].windows(2).all(|pair| (pair[0].sensor_status ^ pair[1].sensor_status) & 0x8000 != 0));
    assert!(
        told[102..].iter().all(|now| (now.sensor, now.sensor_status) == (told[102].sensor, told[102].sensor_status))
    );
}

#[test]
fn a_saturated_sensor_is_at_the_end_of_its_range() {
    let (_, told) = struck(Fault::SaturatedSensor);
    assert!(first(&told, |told| told.sensor == i16::MAX && told.sensor_status & 0x42 == 0x42) <= 1);
}

#[test]
fn a_reading_that_is_no_number_has_its_error_bit_set() {
    let (_, told) = struck(Fault::NotANumber);
    assert!(first(&told, |told| told.sensor_status & 0x40 != 0) <= 1);
}

#[test]
fn a_float_terminal_gives_the_torque_itself_and_then_no_number() {
    let terminal = Terminal { float: true, ..Terminal::default() };
    let mut bus = Bus::new(vec![drive(0), terminal.device(0)]).with_joint(Joint::new(truth(), 0.3, 0.0, 1));
    bus.inject(Fault::NotANumber, 50 * MS);
    bus.inject(Fault::StaleSensor, 1);
    let value = |bus: &Bus| f32::from_le_bytes(bus.devices()[1].object(0x6000, 0x11).unwrap().try_into().unwrap());
    let read = frame(&[Datagram(BRD, 0, vec![0])]);
    bus.send(0, &read);
    assert!(value(&bus).is_finite());
    bus.send(60 * MS, &read);
    assert!(value(&bus).is_nan());
}
