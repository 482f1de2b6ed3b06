//! Logical addresses: the memory that FMMUs map into a datagram, whole bytes or single bits (ETG.1000.4, 6.6).

use super::memory::{Memory, Touched};
use super::registers::FMMU;

/// One mapping.
#[derive(Debug, Clone, Copy)]
struct Mapping {
    logical: u32,
    length: u16,
    /// First and last bit within the first and the last byte.
    bits: (u8, u8),
    physical: u16,
    physical_bit: u8,
    reads: bool,
    writes: bool,
}

fn mapping(memory: &Memory, index: usize) -> Option<Mapping> {
    let at = FMMU + 16 * index as u16;
    let kind = memory.u8(at + 11);
    (memory.u8(at + 12) & 1 != 0 && memory.u16(at + 4) > 0).then(|| Mapping {
        logical: memory.u32(at),
        length: memory.u16(at + 4),
        bits: (memory.u8(at + 6) & 7, memory.u8(at + 7) & 7),
        physical: memory.u16(at + 8),
        physical_bit: memory.u8(at + 10) & 7,
        reads: kind & 1 != 0,
        writes: kind & 2 != 0,
    })
}

impl Mapping {
    /// Of a datagram of `length` bytes at `logical`: where the common bytes begin in it and in memory, and how many they are.
    fn common(&self, logical: u32, length: usize) -> Option<(usize, u16, usize)> {
        let (from, to) = (u64::from(logical), u64::from(logical) + length as u64);
        let (first, last) = (u64::from(self.logical), u64::from(self.logical) + u64::from(self.length));
        let (begin, end) = (from.max(first), to.min(last));
        (begin < end).then(|| {
            ((begin - from) as usize, self.physical.wrapping_add((begin - first) as u16), (end - begin) as usize)
        })
    }

    fn is_whole(&self) -> bool {
        self.bits == (0, 7) && self.physical_bit == 0
    }

    /// Its bits: place in logical memory and in the device's, each in bits.
    fn each_bit(&self) -> impl Iterator<Item = (u64, u32)> {
        let first = u64::from(self.logical) * 8 + u64::from(self.bits.0);
        let count = (u32::from(self.length) - 1) * 8 + u32::from(self.bits.1) + 1;
        let physical = u32::from(self.physical) * 8 + u32::from(self.physical_bit);
        (0..count.saturating_sub(u32::from(self.bits.0))).map(move |i| (first + u64::from(i), physical + i))
    }
}

/// Passes a logical datagram through the device's FMMUs: what comes in is written before anything is put in its place.
/// Whether memory was read, and whether it was written.
pub fn pass(
    memory: &mut Memory,
    (logical, data): (u32, &mut [u8]),
    (reads, writes): (bool, bool),
    touched: &mut Touched,
) -> (bool, bool) {
    let (mut was_read, mut was_written) = (false, false);
    for index in 0..memory.fmmus() {
        let Some(mapping) = mapping(memory, index).filter(|m| writes && m.writes) else { continue };
        let Some((at, physical, count)) = mapping.common(logical, data.len()) else { continue };
        was_written |= if mapping.is_whole() {
            memory.write(physical, &data[at..at + count], touched)
        } else {
            write_bits(memory, &mapping, logical, data, touched)
        };
    }
    for index in 0..memory.fmmus() {
        let Some(mapping) = mapping(memory, index).filter(|m| reads && m.reads) else { continue };
        let Some((at, physical, count)) = mapping.common(logical, data.len()) else { continue };
        was_read |= if mapping.is_whole() {
            memory.read(physical, &mut data[at..at + count], false, touched)
        } else {
            read_bits(memory, &mapping, logical, data, touched)
        };
    }
    (was_read, was_written)
}

fn write_bits(memory: &mut Memory, mapping: &Mapping, logical: u32, data: &[u8], touched: &mut Touched) -> bool {
    let mut any = false;
    for (from, to) in mapping.each_bit() {
        let Some(bit) = from.checked_sub(u64::from(logical) * 8).filter(|bit| *bit < data.len() as u64 * 8) else {
            continue;
        };
        let (address, mask) = ((to / 8) as u16, 1u8 << (to % 8));
        let set = data[(bit / 8) as usize] >> (bit % 8) & 1 != 0;
        let byte = memory.u8(address) & !mask | if set { mask } else { 0 };
        any |= memory.write(address, &[byte], touched);
    }
    any
}

fn read_bits(memory: &mut Memory, mapping: &Mapping, logical: u32, data: &mut [u8], touched: &mut Touched) -> bool {
    let mut any = false;
    for (to, from) in mapping.each_bit() {
        let Some(bit) = to.checked_sub(u64::from(logical) * 8).filter(|bit| *bit < data.len() as u64 * 8) else {
            continue;
        };
        let mut byte = [0];
        if memory.read((from / 8) as u16, &mut byte, false, touched) {
            let mask = 1u8 << (bit % 8);
            let set = byte[0] >> (from % 8) & 1 != 0;
            let out = &mut data[(bit / 8) as usize];
            *out = *out & !mask | if set { mask } else { 0 };
            any = true;
        }
    }
    any
}
