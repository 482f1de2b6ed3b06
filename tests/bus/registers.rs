//! Frames and registers: who is meant, who may write, and what the working counter says.

use super::master::*;
use tautline::bus::{Bus, Fault, When};

#[test]
fn a_broadcast_counts_the_devices_and_ors_their_registers() {
    let mut master = Master::new();
    let (data, counter) = master.one(BRD, 0, &[0; 10]);
    assert_eq!((data[0], counter), (0x11, 2));
    master.address();
    let (data, counter) = master.one(BRD, place(0, 0x0010), &[0; 2]);
    assert_eq!((u16::from_le_bytes([data[0], data[1]]), counter), (DRIVE | TERMINAL, 2));
}

#[test]
fn position_station_and_alias_find_their_device() {
    let mut master = Master::new();
    master.address();
    let (data, counter) = master.one(APRD, place(0xFFFF, 0x0010), &[0; 2]);
    assert_eq!((data, counter), (TERMINAL.to_le_bytes().to_vec(), 1));
    assert_eq!(master.one(FPRD, place(0x1234, 0x0010), &[0; 2]).1, 0);
    assert_eq!(master.one(APRD, place(5, 0x0010), &[0; 2]).1, 0);
    // The alias counts once data link control says so, here 0 as the EEPROM has it, of both devices.
    assert_eq!(master.one(FPRD, place(0, 0x0010), &[0; 2]).1, 0);
    assert_eq!(master.one(BWR, place(0, 0x0100), &[1, 0, 0, 1]).1, 2);
    assert_eq!(master.one(FPRD, place(0, 0x0010), &[0; 2]).1, 2);
}

#[test]
fn a_multiple_write_reads_one_and_writes_the_others() {
    let mut master = Master::new();
    master.address();
    assert_eq!(master.one(FRMW, place(DRIVE, 0x0010), &[0; 2]), (DRIVE.to_le_bytes().to_vec(), 2));
    let (_, counter) = master.one(FPRD, place(DRIVE, 0x0010), &[0; 2]);
    assert_eq!(counter, 2, "both now have the first one's station");
    assert_eq!(master.one(ARMW, place(0, 0x0420), &[0; 2]).1, 2);
}

#[test]
fn read_only_registers_stay_and_do_not_count() {
    let mut master = Master::new();
    master.address();
    for register in [0x0000, 0x0012, 0x0110, 0x0130, 0x0134, 0x0440] {
        assert_eq!(master.one(FPWR, place(DRIVE, register), &[0xAA, 0xAA]).1, 0, "{register:#x}");
        assert_ne!(master.read_u16(DRIVE, register), 0xAAAA);
    }
    // Beyond what there is of sync managers and FMMUs nothing answers; a broadcast over all of them goes on regardless.
    assert_eq!(master.one(FPRD, place(DRIVE, 0x0820), &[0; 8]).1, 0);
    assert_eq!(master.one(FPRD, place(DRIVE, 0x0640), &[0; 16]).1, 0);
    assert_eq!(master.one(BWR, place(0, 0x0600), &[0; 16]).1, 2);
}

#[test]
fn links_show_where_the_wire_ends() {
    let mut master = Master::new();
    master.address();
    assert_eq!(master.read_u16(DRIVE, 0x0110) & 0x00F0, 0x30);
    assert_eq!(master.read_u16(TERMINAL, 0x0110) & 0x00F0, 0x10);
}

#[test]
fn what_is_no_sound_ethercat_frame_gets_no_answer() {
    let mut bus = Bus::demo(truth(), 0.0, 1);
    let sound = frame(&[Datagram(BRD, 0, vec![0; 4])]);
    assert_eq!(bus.send(0, &sound).len(), 1);
    for length in 0..sound.len() {
        assert!(bus.send(1, &sound[..length]).is_empty(), "{length} bytes");
    }
    let mut other_type = sound.clone();
    other_type[12] = 0x08;
    assert!(bus.send(2, &other_type).is_empty());
    let mut unknown_command = sound.clone();
    unknown_command[16] = 77;
    assert!(bus.send(3, &unknown_command).is_empty());
}

#[test]
fn no_bytes_make_it_panic() {
    use rand::{RngExt, SeedableRng};
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut master = Master::new();
    master.reach_op();
    for _ in 0..20_000 {
        let command = random.random_range(0..15u8);
        let device = [DRIVE, TERMINAL, 0, random.random::<u16>()][random.random_range(0..4)];
        let register = if random.random::<bool>() { random.random::<u16>() % 0x1200 } else { random.random::<u16>() };
        let data = (0..random.random_range(0..200)).map(|_| random.random::<u8>()).collect();
        master.replies(&[Datagram(command, place(device, register), data)]);
    }
    master.wait(50 * MS);
}

/// The event field of a datagram tells of a change of state until that is read, where the mask lets it.
#[test]
fn the_event_field_tells_of_a_change_of_state() {
    const EVENT: std::ops::Range<usize> = 24..26;
    let mut master = Master::new();
    master.address();
    let events = |master: &mut Master| {
        let replies = master.replies(&[Datagram(FPRD, place(DRIVE, 0x0110), vec![0; 2])]);
        u16::from_le_bytes(replies[0].frame[EVENT].try_into().unwrap())
    };
    assert_eq!(events(&mut master), 0);
    master.write(DRIVE, 0x0200, &0xFFFFu16.to_le_bytes());
    master.ask(DRIVE, 0x02);
    master.read_u16(DRIVE, 0x0130);
    assert_eq!(events(&mut master), 0);
    // Nothing is set up for PRE-OP, which was refused with an error: that is acknowledged.
    master.write(DRIVE, 0x0120, &0x11u16.to_le_bytes());
    master.wait(2_000_000);
    assert_eq!(events(&mut master) & 4, 4);
    assert_eq!(master.read_u16(DRIVE, 0x0210) & 4, 4);
    master.read_u16(DRIVE, 0x0130);
    assert_eq!(events(&mut master), 0);
}

#[test]
fn an_eeprom_that_is_lent_to_the_device_does_not_obey_the_master() {
    let mut master = Master::new();
    master.address();
    master.write(DRIVE, 0x0500, &[1, 0]);
    assert_eq!(master.one(FPWR, place(DRIVE, 0x0502), &[0, 1, 8, 0, 0, 0]).1, 0);
    master.write(DRIVE, 0x0500, &[0, 0]);
    assert_eq!(master.one(FPWR, place(DRIVE, 0x0502), &[0, 1, 8, 0, 0, 0]).1, 1);
}

/// Damage and a lost link are counted where they are seen: at the port of the first device behind which the terminal hangs.
#[test]
fn ports_count_damaged_frames_and_lost_links() {
    let mut master = Master::new();
    master.reach_op();
    let next = master.bus.cycles();
    master.bus.inject(Fault::Corrupted { frames: 3 }, When::Cycle(next));
    (0..5).for_each(|_| drop(master.cycle_replies()));
    assert_eq!((master.read(DRIVE, 0x0300, 4), master.read(DRIVE, 0x0310, 2)), (vec![0, 0, 3, 3], vec![0, 0]));
    master.bus.inject(Fault::Gone { device: 1 }, master.now_ns);
    master.wait(1_000_000);
    assert_eq!(master.read(DRIVE, 0x0310, 2), [0, 1]);
}
