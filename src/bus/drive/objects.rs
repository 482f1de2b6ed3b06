//! The drive's object dictionary (CiA 402), and its units.

use crate::bus::coe::{Access, Dictionary};
use std::f64::consts::TAU;

/// Counts of the encoder per revolution of the joint.
pub const COUNTS_PER_REVOLUTION: f64 = 1_048_576.0;
/// The same per rad.
pub const COUNTS_PER_RAD: f64 = COUNTS_PER_REVOLUTION / TAU;
/// Rated torque at the winch, mN m; torques are per mille of it.
pub const RATED_TORQUE_MNM: i64 = 2000;
/// One per mille of it, N m.
pub const NM_PER_MILLE: f64 = RATED_TORQUE_MNM as f64 * 1e-6;
/// Length of the data sheet in 0x2100: more than any mailbox here holds.
const DATA_SHEET: usize = 700;

/// Position mode, speed mode, torque mode, each cyclic and synchronous, as 0x6060 has them.
pub const CSP: i64 = 8;
/// Speed.
pub const CSV: i64 = 9;
/// Torque.
pub const CST: i64 = 10;

/// The history of faults (ETG.1020): messages from the sixth subindex on.
const HISTORY: u16 = 0x10F3;
const FIRST_MESSAGE: u8 = 6;
const MESSAGES: u8 = 4;

/// Notes the fault `code` (CiA 402) at `now_ns` in the history, in the place of the oldest.
pub fn remember(d: &mut Dictionary, code: u16, now_ns: u64) {
    let newest = d.unsigned(HISTORY, 2) as u8;
    let next = if (FIRST_MESSAGE..FIRST_MESSAGE + MESSAGES - 1).contains(&newest) { newest + 1 } else { FIRST_MESSAGE };
    let diagnosis = u32::from(code) << 16 | 0xE800;
    let message = [&diagnosis.to_le_bytes()[..], &[2, 0, 0, 0], &now_ns.to_le_bytes()].concat();
    if let Some(value) = d.value_mut(HISTORY, next) {
        *value = message;
    }
    d.set(HISTORY, 2, next.into());
}

/// All objects at their defaults.
pub fn dictionary() -> Dictionary {
    use Access::{Read, Write};
    let whole = (i64::from(i32::MIN), i64::from(i32::MAX));
    let rad = |rad: f64| (rad * COUNTS_PER_RAD).round() as i64;
    let mut d = Dictionary::default();
    d.number((0x1000, 0), Read, 4, 0x0002_0192).number((0x1001, 0), Read, 1, 0);
    mappings(&mut d);
    d.bytes((0x2100, 0), (0..DATA_SHEET).map(|i| b'A' + (i % 26) as u8).collect(), 1024);
    d.number((0x603F, 0), Read, 2, 0).number((0x6040, 0), Write, 2, 0).number((0x6041, 0), Read, 2, 0);
    // -1 leaves the quick stop out, as some makers allow; 0 coasts, 1 to 3 stop and disable, 5 to 7 stop and hold.
    d.within((0x605A, 0), 2, 2, (-1, 7)).within((0x605B, 0), 2, 0, (0, 0)).within((0x605C, 0), 2, 0, (0, 0));
    d.within((0x605E, 0), 2, 2, (0, 2)).within((0x6060, 0), 1, CSP, (CSP, CST)).number((0x6061, 0), Read, 1, CSP);
    d.number((0x6064, 0), Read, 4, 0).number((0x606C, 0), Read, 4, 0).number((0x60F4, 0), Read, 4, 0);
    d.within((0x6065, 0), 4, rad(0.1), (0, i64::from(u32::MAX))).within((0x6066, 0), 2, 10, (0, 65535));
    d.within((0x6071, 0), 2, 0, (-3000, 3000)).within((0x6072, 0), 2, 1500, (0, 3000));
    d.number((0x6076, 0), Read, 4, RATED_TORQUE_MNM).number((0x6077, 0), Read, 2, 0);
    d.within((0x607A, 0), 4, 0, whole).within((0x60FF, 0), 4, 0, whole);
    d.number((0x607D, 0), Read, 1, 2).within((0x607D, 1), 4, rad(-0.7), whole).within((0x607D, 2), 4, rad(2.8), whole);
    d.within((0x607F, 0), 4, rad(10.0), (1, i64::from(u32::MAX)));
    d.within((0x6084, 0), 4, rad(5.0), (1, i64::from(u32::MAX)));
    d.within((0x6085, 0), 4, rad(20.0), (1, i64::from(u32::MAX)));
    d.number((0x60C2, 0), Read, 1, 2).within((0x60C2, 1), 1, 1, (1, 255)).within((0x60C2, 2), 1, -3, (-6, 0));
    d.number((HISTORY, 0), Read, 1, i64::from(FIRST_MESSAGE + MESSAGES - 1));
    d.number((HISTORY, 1), Read, 1, MESSAGES.into()).number((HISTORY, 2), Read, 1, 0);
    d.within((HISTORY, 3), 1, 0, (0, 255)).number((HISTORY, 4), Read, 1, 0).within((HISTORY, 5), 2, 0, (0, 0xFFFF));
    for sub in FIRST_MESSAGE..FIRST_MESSAGE + MESSAGES {
        d.bytes((HISTORY, sub), vec![0; 16], 16);
    }
    // Digital outputs: bit 0 lets the brake go.
    let bits = (0, i64::from(u32::MAX));
    d.number((0x60FE, 0), Read, 1, 2).within((0x60FE, 1), 4, 0, bits).within((0x60FE, 2), 4, bits.1, bits);
    d.number((0x6502, 0), Read, 4, 0x0380);
    d
}

fn mappings(d: &mut Dictionary) {
    use Access::{Read, WritePreOp};
    let out = [0x6040_0010, 0x607A_0020, 0x6060_0008, 0x60FF_0020, 0x6071_0010];
    let into = [0x6041_0010, 0x6064_0020, 0x606C_0020, 0x6077_0010, 0x6061_0008, 0x603F_0010];
    // Room for eight entries each, those not used 0.
    for (index, entries) in [(0x1600, &out[..]), (0x1A00, &into[..])] {
        let mut eight = [0; 8];
        eight[..entries.len()].copy_from_slice(entries);
        d.list(index, WritePreOp, 4, &eight).number((index, 0), WritePreOp, 1, entries.len() as i64);
    }
    d.list(0x1601, Read, 4, &[0x6040_0010, 0x607A_0020]).list(0x1A01, Read, 4, &[0x6041_0010, 0x6064_0020]);
    for (index, pdo) in [(0x1C12, 0x1600), (0x1C13, 0x1A00)] {
        d.list(index, WritePreOp, 2, &[pdo, 0]).number((index, 0), WritePreOp, 1, 1);
    }
}
