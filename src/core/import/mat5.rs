//! MATLAB `.mat` of versions 5 to 7: the arrays of numbers among its variables (MAT-File Format, The MathWorks, chapter 1).
//!
//! A file is a header of 128 bytes and then elements, each a tag (its type and length) and data; `save -v7` packs every variable
//! by zlib. Values may be stored in a smaller type than their class (a double array of small whole numbers as int8): both kinds
//! are read. The zlib stream's Adler-32 is verified; variables saved by `-v6` have no checksum. Of complex arrays the real part
//! is read. Text, structures, cells, objects and sparse arrays are passed over.

use super::Series;
use super::matlab::add;
use crate::limits::Budget;
use crate::problem::{Problem, Result};
use flate2::read::ZlibDecoder;
use std::io::{self, Read};
use std::path::Path;

const HEADER_BYTES: usize = 128;
/// Of the tags' types.
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Types of elements end here; a larger one is damage.
const TYPE_MAX: u32 = 18;
/// Classes of arrays of numbers: double, single, then int8 to uint64.
const CLASSES: std::ops::RangeInclusive<u32> = 6..=15;
/// MATLAB's longest name takes 63 bytes; other writers go somewhat beyond.
const NAME_BYTES: usize = 4096;
/// Bytes read at a time.
const PIECE_BYTES: usize = 1 << 16;

/// The variables of `file`.
///
/// Errors: it is no such file; an element is damaged, cut off, or unpacks to too much.
pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Vec<Series>> {
    if !bytes.starts_with(b"MATLAB 5.0") {
        let cure = "save it from MATLAB with `save -v7`; v4 is not read";
        return Problem::error(file, "does not begin as a .mat of version 5 or 7", cure).alone();
    }
    let mut all = Vec::new();
    elements(bytes, &mut all).or_else(|Fault { variable, what }| {
        let cure = "save it again from MATLAB with `save -v7`, only what the campaign needs";
        let problem = Problem::error(file, format!("cannot be read as MATLAB's: {what}"), cure);
        match variable {
            Some(name) => problem.in_column(name).alone(),
            None => problem.alone(),
        }
    })?;
    Ok(all)
}

/// What is wrong, and with which variable.
struct Fault {
    variable: Option<String>,
    what: String,
}

impl<T: Into<String>> From<T> for Fault {
    fn from(what: T) -> Self {
        Self { variable: None, what: what.into() }
    }
}

fn elements(bytes: &[u8], all: &mut Vec<Series>) -> std::result::Result<(), Fault> {
    let is_little = match bytes.get(HEADER_BYTES - 2..HEADER_BYTES) {
        Some(b"IM") => true,
        Some(b"MI") => false,
        _ => return Err("its header does not tell the order of bytes".into()),
    };
    let mut budget = Budget::of_file(bytes.len() as u64);
    let mut rest = &bytes[HEADER_BYTES..];
    while !rest.is_empty() {
        let mut from = Stream { source: &mut rest, is_little };
        let (kind, length) = (from.word(), from.word());
        let (kind, length) = kind.and_then(|kind| Ok((kind, length? as usize))).map_err(told)?;
        if length > rest.len() || kind == 0 || kind > TYPE_MAX {
            let cut = if length > rest.len() { "an element is cut off" } else { "an element is of no known type" };
            return Err(format!("{cut}, {} bytes before the end", rest.len()).into());
        }
        let element;
        (element, rest) = rest.split_at(length);
        let read = match kind {
            COMPRESSED => {
                let mut unpacked = ZlibDecoder::new(element);
                let mut from = Stream { source: &mut unpacked, is_little };
                let kind = from.word().map_err(told)?;
                from.word().map_err(told)?;
                // Nothing is packed twice.
                if kind == MATRIX { array(from, &mut budget)? } else { None }
            }
            MATRIX => array(Stream { source: &mut &*element, is_little }, &mut budget)?,
            _ => None,
        };
        if let Some(Array { name, rows, columns, values }) = read {
            add(all, &name, values, rows, columns);
        }
    }
    Ok(())
}

fn told(error: io::Error) -> Fault {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "an element is cut off".into(),
        _ => format!("its packed data are damaged ({error})").into(),
    }
}

struct Array {
    name: String,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

/// The array that follows, where it is one of numbers in two dimensions.
fn array(mut from: Stream<'_>, budget: &mut Budget) -> std::result::Result<Option<Array>, Fault> {
    let (kind, flags) = from.small(UINT32, 8)?;
    let class = kind.filter(|_| flags.len() == 8).map(|_| from.number(&flags[..4]) & 0xff);
    if !class.is_some_and(|class| CLASSES.contains(&class)) {
        return Ok(None);
    }
    let (kind, sides) = from.small(INT32, 4 * 32)?;
    let sides: Vec<usize> = sides.chunks_exact(4).map(|side| from.number(side) as usize).collect();
    let (_, name) = from.small(1, NAME_BYTES)?;
    let name = String::from_utf8_lossy(&name).into_owned();
    let fault = |what: String| Fault { variable: Some(name.clone()), what };
    let count = sides.iter().try_fold(1usize, |count, side| count.checked_mul(*side)).filter(|_| kind.is_some());
    let count = count.ok_or(fault("its size makes no sense".to_string()))?;
    let [rows, columns] = sides[..] else { return Ok(None) };
    budget.take_numbers(count as u64).map_err(fault)?;
    let values = from.numbers(count).and_then(|values| {
        // To the end, where the checksum stands.
        from.pass_over(budget)?;
        Ok(values)
    });
    let values = values.map_err(|found| fault(found.what))?;
    Ok(Some(Array { name, rows, columns, values }))
}

/// An element being read.
struct Stream<'a> {
    source: &'a mut dyn Read,
    is_little: bool,
}

/// A subelement's tag.
struct Tag {
    kind: u32,
    length: usize,
    /// Data of up to 4 bytes stand in the tag itself.
    within: Option<[u8; 4]>,
}

impl Stream<'_> {
    fn number(&self, bytes: &[u8]) -> u32 {
        let bytes = [bytes[0], bytes[1], bytes[2], bytes[3]];
        if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }

    fn word(&mut self) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.source.read_exact(&mut bytes)?;
        Ok(self.number(&bytes))
    }

    fn tag(&mut self) -> std::result::Result<Tag, Fault> {
        let first = self.word().map_err(told)?;
        let mut second = [0; 4];
        self.source.read_exact(&mut second).map_err(told)?;
        match first >> 16 {
            0 => Ok(Tag { kind: first, length: self.number(&second) as usize, within: None }),
            length @ 1..=4 => Ok(Tag { kind: first & 0xffff, length: length as usize, within: Some(second) }),
            _ => Err("a tag makes no sense".into()),
        }
    }

    /// The bytes of a subelement of at most so many, and its type if that is `expected`.
    fn small(&mut self, expected: u32, most: usize) -> std::result::Result<(Option<u32>, Vec<u8>), Fault> {
        let tag = self.tag()?;
        if tag.length > most {
            return Err(format!("a part of {} bytes stands where {most} are the most", tag.length).into());
        }
        let bytes = match tag.within {
            Some(bytes) => bytes[..tag.length].to_vec(),
            None => {
                let mut bytes = vec![0; tag.length.next_multiple_of(8)];
                self.source.read_exact(&mut bytes).map_err(told)?;
                bytes.truncate(tag.length);
                bytes
            }
        };
        Ok((Some(tag.kind).filter(|kind| *kind == expected), bytes))
    }

    /// A subelement of `count` numbers of any type, and what fills it up to a multiple of 8 bytes.
    fn numbers(&mut self, count: usize) -> std::result::Result<Vec<f64>, Fault> {
        let tag = self.tag()?;
        let (size, parse) = parser(tag.kind, self.is_little).ok_or("it holds no numbers")?;
        if count.checked_mul(size) != Some(tag.length) {
            return Err(format!("its {count} numbers do not fill its {} bytes", tag.length).into());
        }
        if let Some(bytes) = tag.within {
            return Ok(bytes[..tag.length].chunks_exact(size).map(parse).collect());
        }
        let mut values = Vec::new();
        let mut piece = vec![0; PIECE_BYTES];
        let mut left = tag.length;
        while left > 0 {
            let now = left.min(PIECE_BYTES);
            self.source.read_exact(&mut piece[..now]).map_err(told)?;
            values.extend(piece[..now].chunks_exact(size).map(parse));
            left -= now;
        }
        Ok(values)
    }

    fn pass_over(&mut self, budget: &mut Budget) -> std::result::Result<(), Fault> {
        let mut piece = vec![0; PIECE_BYTES];
        loop {
            match self.source.read(&mut piece).map_err(told)? {
                0 => return Ok(()),
                count => budget.take(count as u64)?,
            }
        }
    }
}

/// The number that so many bytes are.
type Parser = fn(&[u8]) -> f64;

/// How many bytes a number of this type takes, and how it is read.
fn parser(kind: u32, is_little: bool) -> Option<(usize, Parser)> {
    fn bytes<const N: usize>(of: &[u8]) -> [u8; N] {
        // Only ever called on pieces of this length.
        of.try_into().unwrap_or([0; N])
    }
    Some(match (kind, is_little) {
        (1, _) => (1, |of| f64::from(i8::from_le_bytes(bytes(of)))),
        (2, _) => (1, |of| f64::from(u8::from_le_bytes(bytes(of)))),
        (3, true) => (2, |of| f64::from(i16::from_le_bytes(bytes(of)))),
        (3, false) => (2, |of| f64::from(i16::from_be_bytes(bytes(of)))),
        (4, true) => (2, |of| f64::from(u16::from_le_bytes(bytes(of)))),
        (4, false) => (2, |of| f64::from(u16::from_be_bytes(bytes(of)))),
        (INT32, true) => (4, |of| f64::from(i32::from_le_bytes(bytes(of)))),
        (INT32, false) => (4, |of| f64::from(i32::from_be_bytes(bytes(of)))),
        (UINT32, true) => (4, |of| f64::from(u32::from_le_bytes(bytes(of)))),
        (UINT32, false) => (4, |of| f64::from(u32::from_be_bytes(bytes(of)))),
        (7, true) => (4, |of| f64::from(f32::from_le_bytes(bytes(of)))),
        (7, false) => (4, |of| f64::from(f32::from_be_bytes(bytes(of)))),
        (9, true) => (8, |of| f64::from_le_bytes(bytes(of))),
        (9, false) => (8, |of| f64::from_be_bytes(bytes(of))),
        (12, true) => (8, |of| i64::from_le_bytes(bytes(of)) as f64),
        (12, false) => (8, |of| i64::from_be_bytes(bytes(of)) as f64),
        (13, true) => (8, |of| u64::from_le_bytes(bytes(of)) as f64),
        (13, false) => (8, |of| u64::from_be_bytes(bytes(of)) as f64),
        _ => return None,
    })
}
