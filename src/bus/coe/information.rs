//! SDO information (ETG.1000.6, 5.6.3): which objects there are, and what each of them is.

use super::abort::Abort;
use super::dictionary::{Access, Dictionary, Entry};

/// Bytes of the mailbox's header, of the CoE header, and of the header of this service.
const HEADERS: usize = 6 + 2 + 4;
/// What is asked for.
const LIST: u8 = 1;
const OBJECT: u8 = 3;
const ENTRY: u8 = 5;
/// The answer that refuses.
const ERROR: u8 = 7;
/// Bit of the operation code: more fragments follow.
const INCOMPLETE: u8 = 0x80;
/// Object codes: a single number, or several.
const VARIABLE: u8 = 7;
const RECORD: u8 = 9;

/// The answers to a request, the bytes behind the CoE header; each fits a mailbox of `room` bytes.
pub fn answers(request: &[u8], dictionary: &Dictionary, room: usize) -> Vec<Vec<u8>> {
    let word = |at: usize| Some(u16::from_le_bytes([*request.get(at)?, *request.get(at + 1)?]));
    let operation = request.first().map_or(0, |byte| byte & 0x7F);
    let answer = match (operation, word(4)) {
        (LIST, Some(kind)) => list(dictionary, kind),
        (OBJECT, Some(index)) => object(dictionary, index),
        (ENTRY, Some(index)) => entry(dictionary, index, request.get(6).copied().unwrap_or(0)),
        _ => Err(Abort::Command),
    };
    match answer {
        Ok(data) => fragments(operation + 1, &data, room),
        Err(abort) => fragments(ERROR, &(abort as u32).to_le_bytes(), room),
    }
}

/// Operation code, one byte to fill, fragments that follow, data.
fn fragments(operation: u8, data: &[u8], room: usize) -> Vec<Vec<u8>> {
    let parts: Vec<&[u8]> = data.chunks(room.saturating_sub(HEADERS).max(2)).collect();
    let one = |(number, part): (usize, &&[u8])| {
        let left = (parts.len() - 1 - number) as u16;
        let more = if left > 0 { INCOMPLETE } else { 0 };
        [&[operation | more, 0], &left.to_le_bytes()[..], part].concat()
    };
    parts.iter().enumerate().map(one).collect()
}

/// The list of a kind: 0 how many each list holds, 1 all objects, 2 and 3 those that outputs and inputs may hold, 4 and 5 those to be
/// stored, always empty.
fn list(dictionary: &Dictionary, kind: u16) -> Result<Vec<u8>, Abort> {
    let all = dictionary.indexes();
    let mappable = |is_output: bool| {
        let can = |index: &&u16| {
            let is_data = **index >= 0x6000;
            is_data && dictionary.entry(**index, 0).is_ok_and(|entry| (entry.access != Access::Read) == is_output)
        };
        all.iter().filter(can).copied().collect::<Vec<u16>>()
    };
    let listed = match kind {
        0 => [all.len(), mappable(true).len(), mappable(false).len(), 0, 0].map(|count| count as u16).to_vec(),
        1 => all,
        2 => mappable(true),
        3 => mappable(false),
        4 | 5 => Vec::new(),
        _ => return Err(Abort::Command),
    };
    Ok([kind].into_iter().chain(listed).flat_map(u16::to_le_bytes).collect())
}

/// Index, data type, highest subindex, object code, name.
fn object(dictionary: &Dictionary, index: u16) -> Result<Vec<u8>, Abort> {
    let first = dictionary.entry(index, 0)?;
    let highest = dictionary.highest_sub(index).unwrap_or(0);
    let code = if highest == 0 { VARIABLE } else { RECORD };
    let kind = if highest == 0 { data_type(first) } else { 0 };
    let (index_bytes, kind) = (index.to_le_bytes(), kind.to_le_bytes());
    let name = format!("Object {index:#06x}");
    Ok([&index_bytes, &kind, &[highest, code][..], name.as_bytes()].concat())
}

/// Index, subindex, value information (none), data type, bits, access, name.
fn entry(dictionary: &Dictionary, index: u16, sub: u8) -> Result<Vec<u8>, Abort> {
    let found = dictionary.entry(index, sub)?;
    // Bits 0 to 2 reading in PRE-OP, SAFE-OP, OP; 3 to 5 writing; 6 and 7 outputs and inputs.
    let access: u16 = match found.access {
        Access::Read => 0b00_000_111,
        Access::WritePreOp => 0b00_001_111,
        Access::Write => 0b00_111_111,
    };
    let maps: u16 = match (index >= 0x6000, found.access) {
        (true, Access::Read) => 0x80,
        (true, _) => 0x40,
        _ => 0,
    };
    let bits = (8 * found.value.len()) as u16;
    let words = [data_type(found), bits, access | maps].map(u16::to_le_bytes);
    let name = format!("SubIndex {sub:03}");
    Ok([&index.to_le_bytes()[..], &[sub, 0], &words.concat(), name.as_bytes()].concat())
}

/// The type of an entry as its length tells, and its range where it may be negative (CiA 301, table 44).
fn data_type(entry: &Entry) -> u16 {
    let is_signed = entry.range.is_some_and(|(low, _)| low < 0);
    match (entry.value.len(), is_signed) {
        (1, true) => 0x0002,
        (2, true) => 0x0003,
        (4, true) => 0x0004,
        (1, false) => 0x0005,
        (2, false) => 0x0006,
        (4, false) => 0x0007,
        (8, false) => 0x001B,
        _ if entry.grows_to.is_some() => 0x000A,
        _ => 0x0009,
    }
}
