//! The SDO server (ETG.1000.6, 5.6.2): up and down, expedited, in one piece, or in segments.

use super::abort::Abort;
use super::dictionary::Dictionary;

/// Bytes of a mailbox's header and of the CoE header behind it.
const HEADERS: usize = 8;
/// Bytes before the data of a first message: command, index, subindex, length.
const INITIATE: usize = 8;
/// More bytes than this no object here takes.
const LONGEST: usize = 4096;
/// Fewest data bytes of a segment.
const SEGMENT: usize = 7;

/// A transfer under way.
#[derive(Debug, Clone)]
enum Transfer {
    Up { left: Vec<u8>, toggle: bool },
    Down { at: (u16, u8), whole: bool, expected: usize, data: Vec<u8>, toggle: bool },
}

/// The server of one device.
#[derive(Debug, Clone, Default)]
pub struct Server {
    transfer: Option<Transfer>,
}

impl Server {
    /// Answers a request, the bytes behind the CoE header; the answer fits a mailbox of `room` bytes. None for an abort.
    pub fn answer(
        &mut self,
        request: &[u8],
        dictionary: &mut Dictionary,
        in_pre_op: bool,
        room: usize,
    ) -> Option<Vec<u8>> {
        let command = *request.first()?;
        let at = (
            u16::from_le_bytes([*request.get(1).unwrap_or(&0), *request.get(2).unwrap_or(&0)]),
            *request.get(3).unwrap_or(&0),
        );
        let answer = match command >> 5 {
            0 => self.download_segment(request, dictionary, in_pre_op),
            1 => self.download(request, at, dictionary, in_pre_op),
            2 => self.upload(command, at, dictionary, room),
            3 => self.upload_segment(command, room),
            4 => {
                self.transfer = None;
                return None;
            }
            _ => Err(Abort::Command),
        };
        Some(answer.unwrap_or_else(|abort| {
            let at = match &self.transfer {
                Some(Transfer::Down { at, .. }) if command >> 5 == 0 => *at,
                _ => at,
            };
            self.transfer = None;
            message(0x80, at, &(abort as u32).to_le_bytes())
        }))
    }

    fn upload(&mut self, command: u8, at: (u16, u8), dictionary: &Dictionary, room: usize) -> Result<Vec<u8>, Abort> {
        let value = match is_whole(command, at)? {
            true => dictionary.whole(at.0, at.1)?,
            false => dictionary.entry(at.0, at.1)?.value.clone(),
        };
        self.transfer = None;
        if (1..=4).contains(&value.len()) {
            let mut four = [0; 4];
            four[..value.len()].copy_from_slice(&value);
            return Ok(message(0x43 | (4 - value.len() as u8) << 2, at, &four));
        }
        let mut bytes = (value.len() as u32).to_le_bytes().to_vec();
        let fits = room.saturating_sub(HEADERS + INITIATE);
        let (now, later) = value.split_at(value.len().min(fits));
        bytes.extend(now);
        if !later.is_empty() {
            self.transfer = Some(Transfer::Up { left: later.to_vec(), toggle: false });
        }
        Ok(message(0x41, at, &bytes))
    }

    fn upload_segment(&mut self, command: u8, room: usize) -> Result<Vec<u8>, Abort> {
        let Some(Transfer::Up { left, toggle }) = &mut self.transfer else { return Err(Abort::Command) };
        if (command & 0x10 != 0) != *toggle {
            return Err(Abort::Toggle);
        }
        let fits = room.saturating_sub(HEADERS + 1).max(SEGMENT);
        let segment: Vec<u8> = left.drain(..left.len().min(fits)).collect();
        let last = left.is_empty();
        let unused = SEGMENT.saturating_sub(segment.len()) as u8;
        let mut answer = vec![u8::from(*toggle) << 4 | unused << 1 | u8::from(last)];
        answer.extend(&segment);
        answer.resize(answer.len().max(1 + SEGMENT), 0);
        *toggle = !*toggle;
        if last {
            self.transfer = None;
        }
        Ok(answer)
    }

    fn download(
        &mut self,
        request: &[u8],
        at: (u16, u8),
        dictionary: &mut Dictionary,
        in_pre_op: bool,
    ) -> Result<Vec<u8>, Abort> {
        let command = request[0];
        let whole = is_whole(command, at)?;
        self.transfer = None;
        let four = request.get(4..8).ok_or(Abort::TooShort)?;
        let expedited = command & 2 != 0;
        if expedited {
            let unused = if command & 1 != 0 { usize::from(command >> 2 & 3) } else { 0 };
            write(dictionary, at, whole, &four[..4 - unused], in_pre_op)?;
            return Ok(message(0x60, at, &[0; 4]));
        }
        let expected = u32::from_le_bytes([four[0], four[1], four[2], four[3]]) as usize;
        let entry = dictionary.entry(at.0, at.1)?;
        if !whole && expected > entry.grows_to.unwrap_or(entry.value.len()) || expected > LONGEST {
            return Err(Abort::TooLong);
        }
        let data = request[8..].iter().copied().take(expected).collect::<Vec<u8>>();
        if data.len() == expected {
            write(dictionary, at, whole, &data, in_pre_op)?;
        } else {
            self.transfer = Some(Transfer::Down { at, whole, expected, data, toggle: false });
        }
        Ok(message(0x60, at, &[0; 4]))
    }

    fn download_segment(
        &mut self,
        request: &[u8],
        dictionary: &mut Dictionary,
        in_pre_op: bool,
    ) -> Result<Vec<u8>, Abort> {
        let command = request[0];
        let Some(Transfer::Down { at, whole, expected, data, toggle }) = &mut self.transfer else {
            return Err(Abort::Command);
        };
        if (command & 0x10 != 0) != *toggle {
            return Err(Abort::Toggle);
        }
        let unused = usize::from(command >> 1 & 7);
        // Only a segment of the fewest bytes can leave some of them unused.
        let length = if request.len() == 1 + SEGMENT { SEGMENT - unused } else { request.len() - 1 };
        data.extend(&request[1..1 + length]);
        if data.len() > *expected {
            return Err(Abort::TooLong);
        }
        let answer = 0x20 | u8::from(*toggle) << 4;
        *toggle = !*toggle;
        if command & 1 != 0 {
            if data.len() < *expected {
                return Err(Abort::TooShort);
            }
            let (at, whole, data) = (*at, *whole, std::mem::take(data));
            write(dictionary, at, whole, &data, in_pre_op)?;
            self.transfer = None;
        }
        let mut bytes = vec![answer];
        bytes.resize(1 + SEGMENT, 0);
        Ok(bytes)
    }
}

/// Whether a request is for the whole object (bit 4 of its command), which begins at subindex 0 or 1.
fn is_whole(command: u8, at: (u16, u8)) -> Result<bool, Abort> {
    match command & 0x10 != 0 {
        true if at.1 > 1 => Err(Abort::Access),
        is_whole => Ok(is_whole),
    }
}

fn write(dictionary: &mut Dictionary, at: (u16, u8), whole: bool, data: &[u8], in_pre_op: bool) -> Result<(), Abort> {
    match whole {
        true => dictionary.write_whole(at.0, at.1, data, in_pre_op),
        false => dictionary.write(at.0, at.1, data, in_pre_op),
    }
}

/// Command, index, subindex, data.
fn message(command: u8, at: (u16, u8), data: &[u8]) -> Vec<u8> {
    let index = at.0.to_le_bytes();
    let mut bytes = vec![command, index[0], index[1], at.1];
    bytes.extend(data);
    bytes
}
