//! CoE: SDOs expedited, in one piece and in segments, refusals, mappings that change, emergencies.

use super::master::*;
use tautline::bus::Fault;

/// What an SDO came to: the answer's bytes behind the CoE header.
type Answer = Vec<u8>;

impl Master {
    /// Puts a message into the drive's mailbox; whether it was taken.
    fn post(&mut self, kind: u8, body: &[u8]) -> bool {
        let mut message = (body.len() as u16).to_le_bytes().to_vec();
        self.counter = self.counter % 7 + 1;
        message.extend([0, 0, 0, kind | self.counter << 4]);
        message.extend(body);
        message.resize(128, 0);
        self.one(FPWR, place(DRIVE, 0x1000), &message).1 == 1
    }

    /// What stands in the mailbox to the master, without the filling: type, body. None while it is empty.
    fn fetch(&mut self) -> Option<(u8, Vec<u8>)> {
        if self.read(DRIVE, 0x080D, 1)[0] & 8 == 0 {
            return None;
        }
        let data = self.read(DRIVE, 0x1080, 128);
        let length = usize::from(u16::from_le_bytes([data[0], data[1]]));
        Some((data[5] & 0x0F, data[6..6 + length].to_vec()))
    }

    fn sdo(&mut self, request: &[u8]) -> Answer {
        let mut body = vec![0, 0x20];
        body.extend(request);
        assert!(self.post(3, &body));
        for _ in 0..20 {
            self.wait(MS / 10);
            match self.fetch() {
                Some((3, body)) if body[1] >> 4 != 1 => return body[2..].to_vec(),
                _ => {}
            }
        }
        panic!("no answer to {request:02x?}");
    }

    fn upload(&mut self, index: u16, sub: u8) -> Answer {
        let index = index.to_le_bytes();
        self.sdo(&[0x40, index[0], index[1], sub, 0, 0, 0, 0])
    }

    /// Writes up to four bytes; the abort code, 0 for none.
    pub fn set(&mut self, index: u16, sub: u8, value: &[u8]) -> u32 {
        let at = index.to_le_bytes();
        let mut request = vec![0x23 | (4 - value.len() as u8) << 2, at[0], at[1], sub];
        request.extend(value);
        request.resize(8, 0);
        abort(&self.sdo(&request))
    }
}

fn abort(answer: &[u8]) -> u32 {
    let code = u32::from_le_bytes([answer[4], answer[5], answer[6], answer[7]]);
    if answer[0] == 0x80 { code } else { 0 }
}

#[test]
fn short_objects_go_up_expedited() {
    let mut master = Master::new();
    master.reach_pre_op();
    assert_eq!(master.upload(0x1018, 1), [0x43, 0x18, 0x10, 1, 0xBC, 0x0A, 0, 0]);
    assert_eq!(master.upload(0x605A, 0), [0x4B, 0x5A, 0x60, 0, 2, 0, 0, 0]);
    assert_eq!(master.upload(0x1C12, 1), [0x4B, 0x12, 0x1C, 1, 0x00, 0x16, 0, 0]);
    assert_eq!(master.upload(0x1600, 2), [0x43, 0x00, 0x16, 2, 0x20, 0x00, 0x7A, 0x60]);
}

#[test]
fn longer_ones_go_up_in_one_piece_or_in_segments() {
    let mut master = Master::new();
    master.reach_pre_op();
    let name = master.upload(0x1008, 0);
    assert_eq!((name[0], &name[4..8], &name[8..]), (0x41, &20u32.to_le_bytes()[..], &b"Winch drive, CiA 402"[..]));
    let first = master.upload(0x2100, 0);
    assert_eq!((first[0], &first[4..8]), (0x41, &700u32.to_le_bytes()[..]));
    let (mut sheet, mut toggle) = (first[8..].to_vec(), 0);
    loop {
        let segment = master.sdo(&[0x60 | toggle, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(segment[0] & 0xF0, toggle);
        let unused = if segment.len() == 8 { usize::from(segment[0] >> 1 & 7) } else { 0 };
        sheet.extend(&segment[1..segment.len() - unused]);
        toggle ^= 0x10;
        if segment[0] & 1 != 0 {
            break;
        }
    }
    assert_eq!(sheet, (0..700).map(|i| b'A' + (i % 26) as u8).collect::<Vec<u8>>());
    assert_eq!(abort(&master.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])), 0x0504_0001, "nothing is under way");
}

#[test]
fn a_toggle_bit_that_does_not_change_ends_the_transfer() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.upload(0x2100, 0);
    assert_eq!(abort(&master.sdo(&[0x70, 0, 0, 0, 0, 0, 0, 0])), 0x0503_0000);
    assert_eq!(abort(&master.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])), 0x0504_0001);
}

#[test]
fn segments_go_down() {
    let mut master = Master::new();
    master.reach_pre_op();
    let mut request = vec![0x21, 0x00, 0x21, 0, 20, 0, 0, 0];
    request.extend(b"0123456789");
    assert_eq!(master.sdo(&request)[0], 0x60);
    assert_eq!(master.sdo(&[0x00, b'a', b'b', b'c', b'd', b'e', b'f', b'g'])[0], 0x20);
    assert_eq!(master.sdo(&[0x11 | 4 << 1, b'x', b'y', b'z', 0, 0, 0, 0])[0], 0x30);
    assert_eq!(&master.upload(0x2100, 0)[8..], b"0123456789abcdefgxyz");
    // Too few, too many.
    master.sdo(&request);
    assert_eq!(abort(&master.sdo(&[0x01, 1, 2, 3, 4, 5, 6, 7])), 0x0607_0013);
    assert_eq!(abort(&master.sdo(&[0x21, 0x00, 0x21, 0, 0xFF, 0xFF, 0, 0])), 0x0607_0012);
}

#[test]
fn what_cannot_be_is_refused_with_its_code() {
    let mut master = Master::new();
    master.reach_pre_op();
    assert_eq!(abort(&master.upload(0x5FFF, 0)), 0x0602_0000);
    assert_eq!(abort(&master.upload(0x1018, 9)), 0x0609_0011);
    assert_eq!(master.set(0x6041, 0, &[0, 0]), 0x0601_0002);
    assert_eq!(master.set(0x6065, 0, &[0, 0]), 0x0607_0013);
    assert_eq!(master.set(0x6060, 0, &[8, 0]), 0x0607_0012);
    assert_eq!(master.set(0x6060, 0, &[1]), 0x0609_0032, "no profile position mode");
    assert_eq!(master.set(0x605A, 0, &8i16.to_le_bytes()), 0x0609_0031);
    assert_eq!(master.set(0x605A, 0, &(-1i16).to_le_bytes()), 0);
    assert_eq!(abort(&master.sdo(&[0x50, 0x41, 0x60, 0, 0, 0, 0, 0])), 0x0601_0000, "a number is no list");
}

#[test]
fn objects_go_up_and_down_as_a_whole() {
    let mut master = Master::new();
    master.reach_pre_op();
    let identity = master.sdo(&[0x50, 0x18, 0x10, 0, 0, 0, 0, 0]);
    let whole: Vec<u8> = [&[4u8, 0][..], &[0xABC, 0x402, 1, 42u32].map(u32::to_le_bytes).concat()].concat();
    assert_eq!((identity[0], &identity[8..]), (0x41, &whole[..]));
    assert_eq!(master.sdo(&[0x50, 0x18, 0x10, 1, 0, 0, 0, 0])[8..], whole[2..]);
    // An assignment, in one message.
    let mut request = vec![0x31, 0x13, 0x1C, 0, 4, 0, 0, 0];
    request.extend([1, 0, 0x01, 0x1A]);
    assert_eq!(master.sdo(&request)[0], 0x60);
    assert_eq!(master.upload(0x1C13, 1)[4..6], [0x01, 0x1A]);
    // What cannot be leaves everything as it was.
    request.truncate(8);
    request.extend([1, 0, 0x01, 0x16]);
    assert_eq!(abort(&master.sdo(&request)), 0x0604_0041);
    assert_eq!((master.upload(0x1C13, 0)[4], master.upload(0x1C13, 1)[4..6].to_vec()), (1, vec![0x01, 0x1A]));
}

#[test]
fn the_dictionary_tells_what_it_holds() {
    let mut master = Master::new();
    master.reach_pre_op();
    let mut ask = |request: &[u8]| {
        let mut body = vec![0, 0x80];
        body.extend(request);
        assert!(master.post(3, &body));
        let mut parts = Vec::new();
        for _ in 0..40 {
            master.wait(MS / 10);
            if let Some((3, body)) = master.fetch() {
                assert_eq!(body[1] >> 4, 8);
                parts.push(body[2..].to_vec());
                if parts.last().unwrap()[0] & 0x80 == 0 {
                    break;
                }
            }
        }
        parts
    };
    let parts = ask(&[1, 0, 0, 0, 1, 0]);
    assert_eq!(usize::from(parts[0][2]), parts.len() - 1, "fragments that follow");
    let bytes: Vec<u8> = parts.iter().flat_map(|part| part[4..].to_vec()).collect();
    let indexes: Vec<u16> = bytes[2..].chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    assert!(indexes.is_sorted() && indexes.contains(&0x607A) && indexes.contains(&0x1018));
    let counts = ask(&[1, 0, 0, 0, 0, 0]);
    assert_eq!(u16::from_le_bytes([counts[0][6], counts[0][7]]) as usize, indexes.len());
    let object = &ask(&[3, 0, 0, 0, 0x18, 0x10])[0];
    assert_eq!((object[0], &object[4..6], object[8], object[9]), (4, &[0x18, 0x10][..], 4, 9));
    let entry = &ask(&[5, 0, 0, 0, 0x7A, 0x60, 0, 0])[0];
    assert_eq!((entry[0], &entry[8..14]), (6, &[4, 0, 32, 0, 0x7F, 0][..]), "i32, written in every state, an output");
    let refused = &ask(&[3, 0, 0, 0, 0xFF, 0x5F])[0];
    assert_eq!((refused[0], &refused[4..8]), (7, &0x0602_0000u32.to_le_bytes()[..]));
}

/// A message whose answer was not seen is sent again with the same counter: it must not be executed again.
#[test]
fn a_repeated_message_is_not_executed_twice() {
    let mut master = Master::new();
    master.reach_pre_op();
    assert_eq!(master.set(0x6065, 0, &1000u32.to_le_bytes()), 0);
    let at = 0x6065u16.to_le_bytes();
    master.counter -= 1;
    assert!(master.post(3, &[0, 0x20, 0x23, at[0], at[1], 0, 0xFF, 0, 0, 0]));
    master.wait(2 * MS);
    assert_eq!(master.fetch(), None);
    assert_eq!(master.upload(0x6065, 0)[4..6], 1000u16.to_le_bytes());
}

#[test]
fn a_mapping_changes_and_with_it_the_length_of_process_data() {
    let mut master = Master::new();
    master.reach_pre_op();
    assert_eq!(master.set(0x1A00, 1, &0x6041_0010u32.to_le_bytes()), 0x0800_0022, "in use");
    assert_eq!(master.set(0x1A00, 0, &[0]), 0);
    assert_eq!(master.set(0x1A00, 2, &0x60F4_0020u32.to_le_bytes()), 0);
    assert_eq!(master.set(0x1A00, 3, &0x1234_0020u32.to_le_bytes()), 0);
    assert_eq!(master.set(0x1A00, 0, &[3]), 0x0604_0041, "there is no 0x1234");
    assert_eq!(master.set(0x1A00, 0, &[2]), 0);
    master.sync_manager(DRIVE, 2, 0x1100, OUT_BYTES as u16, 0x64);
    master.sync_manager(DRIVE, 3, 0x1400, IN_BYTES as u16, 0x20);
    assert_eq!(master.ask(DRIVE, 4), (0x12, 0x001E));
    master.sync_manager(DRIVE, 3, 0x1400, 6, 0x20);
    assert_eq!(master.ask(DRIVE, 0x14), (4, 0));
    assert_eq!(master.set(0x1A00, 0, &[0]), 0x0800_0022, "not in SAFE-OP");
    assert_eq!(master.read(DRIVE, 0x1400, 2)[0] & 0x6F, 0x40, "the status word");
}

#[test]
fn assignments_hold_pdos_of_their_direction() {
    let mut master = Master::new();
    master.reach_pre_op();
    assert_eq!(master.set(0x1C13, 0, &[0]), 0);
    assert_eq!(master.set(0x1C13, 1, &0x1601u16.to_le_bytes()), 0);
    assert_eq!(master.set(0x1C13, 0, &[1]), 0x0604_0041);
    assert_eq!(master.set(0x1C13, 1, &0x1A01u16.to_le_bytes()), 0);
    assert_eq!(master.set(0x1C13, 0, &[1]), 0);
}

#[test]
fn a_mailbox_takes_one_message_at_a_time_and_answers_a_little_later() {
    let mut master = Master::new();
    master.reach_pre_op();
    let request = [0, 0x20, 0x40, 0x18, 0x10, 1, 0, 0, 0, 0];
    assert!(master.post(3, &request));
    assert!(!master.post(3, &request), "it is full");
    assert_eq!(master.fetch(), None);
    assert_eq!(master.one(FPRD, place(DRIVE, 0x1080), &[0; 128]).1, 0, "an empty mailbox does not count");
    master.wait(MS);
    assert!(master.fetch().is_some());
    assert_eq!(master.fetch(), None);
}

#[test]
fn a_message_that_got_lost_comes_again() {
    let mut master = Master::new();
    master.reach_pre_op();
    let answer = master.upload(0x1018, 1);
    master.write(DRIVE, 0x080E, &[3]);
    assert_eq!(master.read(DRIVE, 0x080F, 1)[0] & 2, 2);
    assert_eq!(master.fetch().unwrap().1[2..], answer);
}

#[test]
fn other_protocols_get_a_mailbox_error() {
    let mut master = Master::new();
    master.reach_pre_op();
    for (kind, body, code) in [(4, vec![0; 10], 2), (3, vec![0, 0x90, 1, 0, 0, 0, 0, 0], 4)] {
        assert!(master.post(kind, &body));
        master.wait(MS);
        assert_eq!(master.fetch(), Some((0, vec![1, 0, code, 0])));
    }
}

#[test]
fn an_emergency_comes_between() {
    let mut master = Master::new();
    master.reach_pre_op();
    master.bus.inject(Fault::Emergency { device: 0, code: 0x4210 }, master.now_ns + MS);
    master.wait(2 * MS);
    assert!(master.post(3, &[0, 0x20, 0x40, 0x18, 0x10, 1, 0, 0, 0, 0]));
    master.wait(MS);
    let (kind, body) = master.fetch().unwrap();
    assert_eq!((kind, body[1] >> 4, &body[2..5]), (3, 1, &[0x10, 0x42, 1][..]));
    master.wait(MS);
    assert_eq!(master.fetch().unwrap().1[2], 0x43, "then the answer");
}
