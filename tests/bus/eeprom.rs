//! The EEPROM through its registers, and what its categories say.

use super::master::*;
use tautline::bus::{Bus, Terminal};

impl Master {
    fn words(&mut self, station: u16, address: u32) -> [u8; 8] {
        let address = address.to_le_bytes();
        self.write(station, 0x0502, &[0x00, 0x01, address[0], address[1], address[2], address[3]]);
        assert_eq!(self.read_u16(station, 0x0502) & 0x8700, 0, "neither busy nor at work");
        self.read(station, 0x0508, 8).try_into().unwrap()
    }

    /// The data of a category.
    fn category(&mut self, station: u16, wanted: u16) -> Option<Vec<u8>> {
        let mut at = 0x40;
        loop {
            let head = self.words(station, at);
            let (kind, words) =
                (u16::from_le_bytes([head[0], head[1]]), u32::from(u16::from_le_bytes([head[2], head[3]])));
            if kind == 0xFFFF {
                return None;
            }
            if kind == wanted {
                let all = (0..words.div_ceil(4)).flat_map(|i| self.words(station, at + 2 + 4 * i));
                return Some(all.take(2 * words as usize).collect());
            }
            at += 2 + words;
        }
    }
}

#[test]
fn identity_and_mailboxes_stand_in_the_fixed_part() {
    let mut master = Master::new();
    master.address();
    assert_eq!(master.words(DRIVE, 0x08), [0xBC, 0x0A, 0, 0, 0x02, 0x04, 0, 0]);
    assert_eq!(master.words(TERMINAL, 0x08), [0xBC, 0x0A, 0, 0, 0x01, 0x03, 0, 0]);
    assert_eq!(master.words(DRIVE, 0x18), [0x00, 0x10, 128, 0, 0x80, 0x10, 128, 0]);
    assert_eq!(master.words(DRIVE, 0x1C)[..2], [4, 0], "CoE");
    assert_eq!(master.words(DRIVE, 0x3E)[..4], [15, 0, 1, 0], "16 kbit, version 1");
}

#[test]
fn categories_tell_strings_fmmus_sync_managers_and_pdos() {
    let mut master = Master::new();
    master.address();
    let strings = master.category(DRIVE, 10).unwrap();
    assert_eq!((strings[0], &strings[2..8]), (3, &b"TL7402"[..]));
    let general = master.category(DRIVE, 30).unwrap();
    assert_eq!((general.len(), general[2], general[3]), (32, 1, 3));
    assert_eq!(master.category(DRIVE, 40).unwrap()[..3], [1, 2, 3]);
    let managers = master.category(DRIVE, 41).unwrap();
    let kinds: Vec<(u8, u8)> = managers.chunks(8).map(|manager| (manager[2], manager[7])).collect();
    assert_eq!(kinds, [(128, 1), (128, 2), (OUT_BYTES as u8, 3), (IN_BYTES as u8, 4)]);
    let inputs = master.category(TERMINAL, 50).unwrap();
    assert_eq!((&inputs[..4], inputs[8 + 5], inputs[16 + 5]), (&[0x00, 0x1A, 2, 3][..], 16, 16));
    assert_eq!(master.category(TERMINAL, 51), None, "no outputs");
}

#[test]
fn without_a_mailbox_it_says_so_and_process_data_come_first() {
    let terminal = Terminal { mailbox: false, ..Terminal::default() };
    let mut master = Master::at(Bus::new(vec![terminal.device(0)]));
    assert_eq!(master.one(APWR, place(0, 0x0010), &TERMINAL.to_le_bytes()).1, 1);
    assert_eq!(master.words(TERMINAL, 0x18), [0; 8]);
    let managers = master.category(TERMINAL, 41).unwrap();
    assert_eq!(managers.chunks(8).map(|m| (m[2], m[7])).collect::<Vec<_>>(), [(0, 3), (4, 4)]);
    assert_eq!(master.ask(TERMINAL, 2), (2, 0), "no mailbox, none to be set up");
    master.sync_manager(TERMINAL, 1, 0x1400, 4, 0x20);
    assert_eq!(master.ask(TERMINAL, 4), (4, 0));
}

#[test]
fn a_word_is_written_only_where_writing_is_enabled_with_it() {
    let mut master = Master::new();
    master.address();
    master.write(DRIVE, 0x0508, &[0x34, 0x12]);
    master.write(DRIVE, 0x0502, &[0x00, 0x02, 0x04, 0, 0, 0]);
    assert_ne!(master.read_u16(DRIVE, 0x0502) & 0x4000, 0, "refused");
    assert_eq!(master.words(DRIVE, 4)[..2], [0, 0]);
    master.write(DRIVE, 0x0508, &[0x34, 0x12]);
    master.write(DRIVE, 0x0502, &[0x01, 0x02, 0x04, 0, 0, 0]);
    assert_eq!(master.words(DRIVE, 4)[..2], [0x34, 0x12]);
}
