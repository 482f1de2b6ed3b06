//! Columns aligned by blanks -> one blank between fields, as the CSV parser takes them.

use std::io::{self, Read};

/// A stream in which runs of blanks and tabs are one blank, and none stands at either end of a line.
/// To be read in buffers of two bytes or more.
pub(super) struct Squeezed<R> {
    text: R,
    /// Whether a blank is due before the next sign that is none.
    is_due: bool,
    /// Whether nothing of the line was given yet.
    at_start: bool,
}

impl<R> Squeezed<R> {
    pub fn new(text: R) -> Self {
        Self { text, is_due: false, at_start: true }
    }
}

impl<R: Read> Read for Squeezed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // A blank that is due may be given before each sign read: half of the buffer is read, at least one sign.
        let mut read = vec![0; (buffer.len() / 2).max(1)];
        loop {
            let count = self.text.read(&mut read)?;
            let mut given = 0;
            for byte in &read[..count] {
                let is_end = matches!(byte, b'\n' | b'\r');
                if matches!(byte, b' ' | b'\t') {
                    self.is_due = !self.at_start;
                    continue;
                }
                if std::mem::take(&mut self.is_due) && !is_end {
                    buffer[given] = b' ';
                    given += 1;
                }
                buffer[given] = *byte;
                given += 1;
                self.at_start = is_end;
            }
            if given > 0 || count == 0 {
                return Ok(given);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_parted_by_one_blank() {
        let text = "   1.0    2.0\t 3.0  \r\n\n  4 5\n".as_bytes();
        for size in [2, 3, 64] {
            let mut squeezed = Squeezed::new(text);
            let (mut all, mut buffer) = (Vec::new(), vec![0; size]);
            loop {
                match squeezed.read(&mut buffer).unwrap() {
                    0 => break,
                    given => all.extend_from_slice(&buffer[..given]),
                }
            }
            assert_eq!(String::from_utf8(all).unwrap(), "1.0 2.0 3.0\r\n\n4 5\n", "{size}");
        }
    }
}
