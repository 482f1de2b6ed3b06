//! Process data: objects to bytes and back, as a mapping has them one after the other.

use super::coe::Dictionary;

/// Index, subindex and bits of each, in order.
pub type Mapping = Vec<(u16, u8, u8)>;

/// How many bytes a mapping takes.
pub fn length(mapping: &Mapping) -> usize {
    mapping.iter().map(|(_, _, bits)| usize::from(*bits)).sum::<usize>().div_ceil(8)
}

/// Writes what came in `bytes` into the objects that `mapping` names.
pub fn unpack(mapping: &Mapping, bytes: &[u8], dictionary: &mut Dictionary) {
    let mut at = 0;
    for (index, sub, bits) in mapping {
        let number = (0..usize::from(*bits).min(64)).step_by(8).fold(0u64, |number, shift| {
            let taken = (usize::from(*bits) - shift).min(8);
            number | (bits_at(bytes, at + shift, taken) << shift)
        });
        dictionary.set(*index, *sub, number as i64);
        at += usize::from(*bits);
    }
}

/// Writes the objects that `mapping` names into `bytes`.
pub fn pack(mapping: &Mapping, dictionary: &Dictionary, bytes: &mut [u8]) {
    bytes.fill(0);
    let mut at = 0;
    for (index, sub, bits) in mapping {
        let number = dictionary.unsigned(*index, *sub);
        for shift in (0..usize::from(*bits).min(64)).step_by(8) {
            let taken = (usize::from(*bits) - shift).min(8);
            let part = number >> shift & ((1 << taken) - 1);
            let (byte, bit) = ((at + shift) / 8, (at + shift) % 8);
            let spread = (part as u16) << bit;
            for (to, part) in bytes.iter_mut().skip(byte).zip(spread.to_le_bytes()) {
                *to |= part;
            }
        }
        at += usize::from(*bits);
    }
}

/// Up to 8 bits at bit `at`.
fn bits_at(bytes: &[u8], at: usize, count: usize) -> u64 {
    let byte = |i: usize| u16::from(bytes.get(i).copied().unwrap_or(0));
    let both = byte(at / 8) | byte(at / 8 + 1) << 8;
    u64::from(both >> (at % 8)) & ((1 << count) - 1)
}
