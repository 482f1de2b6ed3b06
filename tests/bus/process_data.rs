//! Logical addresses: working counters of each command, sync managers that are shut, single bits.

use super::master::*;

#[test]
fn every_command_counts_as_it_should() {
    let mut master = Master::new();
    master.reach_safe_op();
    assert_eq!(master.one(LRW, OUT, &[0; ALL]).1, 4, "drive 1 + 2, terminal 1");
    assert_eq!(master.one(LRD, OUT, &[0; ALL]).1, 2);
    assert_eq!(master.one(LWR, OUT, &[0; ALL]).1, 1);
    assert_eq!(master.one(LRW, OUT, &[0; OUT_BYTES]).1, 2, "the drive's outputs alone");
    assert_eq!(master.one(LRW, OUT + OUT_BYTES as u32, &[0; IN_BYTES]).1, 1);
    assert_eq!(master.one(LRW, 0x0900_0000, &[0; 8]).1, 0);
}

#[test]
fn what_is_not_mapped_passes_untouched() {
    let mut master = Master::new();
    master.reach_safe_op();
    let (data, _) = master.one(LRD, OUT - 2, &[0xEE; ALL + 4]);
    assert_eq!((&data[..2 + OUT_BYTES], &data[ALL + 2..]), (&[0xEE; 2 + OUT_BYTES][..], &[0xEE; 2][..]));
}

#[test]
fn before_safe_op_and_after_it_nothing_is_exchanged() {
    let mut master = Master::new();
    master.reach_safe_op();
    assert_eq!(master.ask(TERMINAL, 2), (2, 0));
    assert_eq!(master.one(LRW, OUT, &[0; ALL]).1, 3);
    assert_eq!(master.ask(DRIVE, 1), (1, 0));
    assert_eq!(master.one(LRW, OUT, &[0; ALL]).1, 0);
}

#[test]
fn a_device_that_fell_to_safe_op_still_counts() {
    let mut master = Master::new();
    master.reach_op();
    assert_eq!(master.ask(DRIVE, 4), (4, 0));
    let told = master.cycle();
    assert_eq!((told.counter, told.states), (4, [4, 8]), "the counter alone does not tell");
}

#[test]
fn outputs_count_in_op_only() {
    let mut master = Master::new();
    master.reach_safe_op();
    master.wanted.control = 0x06;
    assert_eq!(master.cycles(3)[2].status & 0x6F, 0x40);
    master.write(DRIVE, 0x0120, &[8, 0]);
    assert_eq!(master.cycles(4)[3].status & 0x6F, 0x21);
}

#[test]
fn a_sync_manager_is_written_and_read_its_own_way() {
    let mut master = Master::new();
    master.reach_safe_op();
    assert_eq!(master.one(FPWR, place(DRIVE, 0x1400), &[1; 4]).1, 0, "inputs are not written");
    assert_eq!(master.one(FPRD, place(DRIVE, 0x1100), &[0; 4]).1, 0, "outputs are not read");
    assert_eq!(master.one(FPRD, place(DRIVE, 0x1400 + IN_BYTES as u16 - 1), &[0; 2]).1, 0, "nor over their end");
    assert_eq!(master.one(FPWR, place(DRIVE, 0x1800), &[1; 4]).1, 1, "the rest is memory");
    assert_eq!(master.read(DRIVE, 0x1800, 4), [1; 4]);
}

#[test]
fn single_bits_are_mapped() {
    let mut master = Master::new();
    master.reach_safe_op();
    // Bit 3 of the drive's mailbox status (a message waits) as bit 5 of a logical byte.
    let mut bytes = 0x0002_0000u32.to_le_bytes().to_vec();
    bytes.extend([1, 0, 5, 5, 0x0D, 0x08, 3, 1, 1, 0, 0, 0]);
    master.write(DRIVE, 0x0620, &bytes);
    assert_eq!(master.one(LRD, 0x0002_0000, &[0x81]), (vec![0x81], 1));
    let now = master.now_ns;
    master.bus.inject(tautline::bus::Fault::Emergency { device: 0, code: 1 }, now);
    master.wait(MS);
    assert_eq!(master.one(LRD, 0x0002_0000, &[0x81]), (vec![0xA1], 1));
}

/// D7: it went unnoticed.
#[test]
fn outputs_whose_sync_manager_is_switched_off_in_op_end_op() {
    let mut master = Master::new();
    master.reach_op();
    master.write(DRIVE, 0x0816, &[0]);
    assert_eq!((master.read_u16(DRIVE, 0x0130), master.read_u16(DRIVE, 0x0134)), (0x14, 0x1D));
}
