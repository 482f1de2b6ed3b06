//! An EtherCAT frame (ETG.1000.4, 5.3): Ethernet header, length and type, datagrams one after the other.

use std::ops::Range;

/// Ethernet header, and the two bytes of length and type after it.
const HEADERS: usize = 16;
/// A datagram's header, and the working counter behind its data.
const DATAGRAM_HEADER: usize = 10;
const COUNTER: usize = 2;

/// What a datagram asks for: who is meant, and whether to read, write or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Command {
    /// Who is meant.
    pub to: Addressing,
    /// Whether memory comes into the datagram.
    pub reads: bool,
    /// Whether the datagram goes into memory.
    pub writes: bool,
    /// The one who is meant reads, all others write: how a clock's time is spread.
    pub multiple: bool,
}

/// Who a datagram is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Addressing {
    /// Nobody.
    Nobody,
    /// The device at a place on the wire.
    Position,
    /// The device with a station address.
    Station,
    /// All.
    Broadcast,
    /// Whose FMMUs map the logical address.
    Logical,
}

impl Command {
    /// Command number 0 to 14; none beyond.
    fn numbered(number: u8) -> Option<Self> {
        use Addressing::{Broadcast, Logical, Nobody, Position, Station};
        let (to, reads, writes) = match number {
            0 => (Nobody, false, false),
            1 => (Position, true, false),
            2 => (Position, false, true),
            3 => (Position, true, true),
            4 => (Station, true, false),
            5 => (Station, false, true),
            6 => (Station, true, true),
            7 => (Broadcast, true, false),
            8 => (Broadcast, false, true),
            9 => (Broadcast, true, true),
            10 => (Logical, true, false),
            11 => (Logical, false, true),
            12 => (Logical, true, true),
            13 => (Position, true, false),
            14 => (Station, true, false),
            _ => return None,
        };
        Some(Self { to, reads, writes, multiple: number > 12 })
    }
}

/// One datagram as it stands in a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Datagram {
    /// What it asks for.
    pub command: Command,
    /// Where its header begins.
    at: usize,
    /// Where its data are.
    pub data: Range<usize>,
}

impl Datagram {
    /// Position (counted up on its way) or station address.
    pub fn device(&self, frame: &[u8]) -> u16 {
        word(frame, self.at + 2)
    }

    /// Where in the device's memory.
    pub fn offset(&self, frame: &[u8]) -> u16 {
        word(frame, self.at + 4)
    }

    /// Logical address: both in one.
    pub fn logical(&self, frame: &[u8]) -> u32 {
        u32::from(self.device(frame)) | u32::from(self.offset(frame)) << 16
    }

    /// Counts the position up, as every device does.
    pub fn pass(&self, frame: &mut [u8]) {
        put(frame, self.at + 2, self.device(frame).wrapping_add(1));
    }

    /// Adds to its event field.
    pub fn signal(&self, frame: &mut [u8], events: u16) {
        put(frame, self.data.start - 2, word(frame, self.data.start - 2) | events);
    }

    /// Adds to the working counter.
    pub fn count(&self, frame: &mut [u8], more: u16) {
        put(frame, self.data.end, word(frame, self.data.end).wrapping_add(more));
    }
}

fn word(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn put(bytes: &mut [u8], at: usize, word: u16) {
    bytes[at..at + 2].copy_from_slice(&word.to_le_bytes());
}

/// The datagrams of a whole Ethernet frame; nothing if it is no EtherCAT or breaks its own lengths, as a device passes it on.
pub fn datagrams(frame: &[u8]) -> Option<Vec<Datagram>> {
    if frame.len() < HEADERS || frame[12..14] != [0x88, 0xA4] || word(frame, 14) >> 12 != 1 {
        return None;
    }
    let end = HEADERS + usize::from(word(frame, 14) & 0x07FF);
    let (mut at, mut found) = (HEADERS, Vec::with_capacity(4));
    loop {
        let data_at = at + DATAGRAM_HEADER;
        if data_at + COUNTER > end.min(frame.len()) {
            return None;
        }
        let length = word(frame, at + 6);
        let data = data_at..data_at + usize::from(length & 0x07FF);
        let next = data.end + COUNTER;
        if next > end.min(frame.len()) {
            return None;
        }
        found.push(Datagram { command: Command::numbered(frame[at])?, at, data });
        if length & 0x8000 == 0 {
            return Some(found);
        }
        at = next;
    }
}
