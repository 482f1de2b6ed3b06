//! The state machine: the way up, what is refused with which code, and falling back.

use super::master::*;

#[test]
fn the_way_up_and_down() {
    let mut master = Master::new();
    master.reach_op();
    assert_eq!(master.ask(DRIVE, 4), (4, 0));
    assert_eq!(master.ask(DRIVE, 1), (1, 0));
    assert_eq!(master.ask(DRIVE, 2), (2, 0));
}

#[test]
fn a_change_takes_its_time() {
    let mut master = Master::new();
    master.address();
    master.write(TERMINAL, 0x0120, &[1, 0]);
    master.sync_manager(TERMINAL, 0, 0x1000, 128, 0x26);
    master.sync_manager(TERMINAL, 1, 0x1080, 128, 0x22);
    master.write(TERMINAL, 0x0120, &[2, 0]);
    assert_eq!(master.read_u16(TERMINAL, 0x0130), 1);
    master.wait(MS);
    assert_eq!(master.read_u16(TERMINAL, 0x0130), 2);
}

#[test]
fn states_cannot_be_skipped_or_invented() {
    let mut master = Master::new();
    master.address();
    assert_eq!(master.ask(DRIVE, 4), (0x11, 0x0011));
    assert_eq!(master.ask(DRIVE, 0x11), (1, 0), "acknowledged");
    assert_eq!(master.ask(DRIVE, 3), (0x11, 0x0013), "no bootstrap");
    assert_eq!(master.ask(DRIVE, 0x11), (1, 0));
    assert_eq!(master.ask(DRIVE, 7), (0x11, 0x0012));
}

#[test]
fn an_error_lets_no_device_up_before_it_is_acknowledged() {
    let mut master = Master::new();
    master.address();
    assert_eq!(master.ask(DRIVE, 2), (0x11, 0x0016), "no mailbox");
    master.sync_manager(DRIVE, 0, 0x1000, 128, 0x26);
    master.sync_manager(DRIVE, 1, 0x1080, 128, 0x22);
    assert_eq!(master.ask(DRIVE, 2), (0x11, 0x0016));
    assert_eq!(master.ask(DRIVE, 0x12), (2, 0));
}

#[test]
fn process_data_of_another_length_are_refused() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.sync_manager(DRIVE, 2, 0x1100, OUT_BYTES as u16 + 1, 0x64);
    master.sync_manager(DRIVE, 3, 0x1400, IN_BYTES as u16, 0x20);
    assert_eq!(master.ask(DRIVE, 4), (0x12, 0x001D));
    master.sync_manager(DRIVE, 2, 0x1100, OUT_BYTES as u16, 0x64);
    master.sync_manager(DRIVE, 3, 0x1400, IN_BYTES as u16 - 1, 0x20);
    assert_eq!(master.ask(DRIVE, 0x14), (0x12, 0x001E));
    master.sync_manager(DRIVE, 3, 0x1400, IN_BYTES as u16, 0x20);
    assert_eq!(master.ask(DRIVE, 0x14), (4, 0));
}

#[test]
fn op_waits_for_outputs_and_gives_up() {
    let mut master = Master::new();
    master.reach_safe_op();
    assert_eq!(master.ask(DRIVE, 8), (4, 0), "no outputs yet");
    master.cycles(3);
    assert_eq!(master.read_u16(DRIVE, 0x0130), 8);
    assert_eq!(master.ask(TERMINAL, 8), (8, 0), "has no outputs");

    let mut silent = Master::new();
    silent.reach_safe_op();
    silent.write(DRIVE, 0x0120, &[8, 0]);
    silent.wait(6_000 * MS);
    assert_eq!((silent.read_u16(DRIVE, 0x0130), silent.read_u16(DRIVE, 0x0134)), (0x14, 0x001B));
}

#[test]
fn outputs_that_stay_away_trip_the_watchdog() {
    let mut master = Master::new();
    master.reach_op();
    assert_eq!(master.read(DRIVE, 0x0440, 1), [1]);
    master.wait(99 * MS);
    assert_eq!(master.read_u16(DRIVE, 0x0130), 8);
    master.wait(2 * MS);
    assert_eq!((master.read_u16(DRIVE, 0x0130), master.read_u16(DRIVE, 0x0134)), (0x14, 0x001B));
    assert_eq!((master.read(DRIVE, 0x0440, 1), master.read(DRIVE, 0x0442, 1)), (vec![0], vec![1]));
    assert_eq!(master.read_u16(TERMINAL, 0x0130), 8, "the terminal has no outputs");
    // Acknowledged, and up again.
    assert_eq!(master.ask(DRIVE, 0x14), (4, 0));
    master.write(DRIVE, 0x0120, &[8, 0]);
    master.cycles(3);
    assert_eq!(master.read_u16(DRIVE, 0x0130), 8);
}

#[test]
fn the_watchdog_is_as_long_as_its_registers_say() {
    let mut master = Master::new();
    master.reach_op();
    master.write(DRIVE, 0x0420, &100u16.to_le_bytes());
    master.cycle();
    master.wait(11 * MS);
    assert_eq!(master.read_u16(DRIVE, 0x0134), 0x001B);

    let mut off = Master::new();
    off.reach_op();
    off.write(DRIVE, 0x0420, &[0, 0]);
    off.wait(1_000 * MS);
    assert_eq!(off.read_u16(DRIVE, 0x0130), 8);
}
