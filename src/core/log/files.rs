//! `[files]`: how text logs are written, as far as a campaign says so; the rest is found from each file.

use crate::document::Section;
use encoding_rs::Encoding;
use toml::Value;

/// Lines before the header at most.
const SKIPPED_MAX: i64 = 10_000;
/// Separators of fields, and their names.
const DELIMITERS: [(&str, u8); 6] = [(",", b','), (";", b';'), ("\t", b'\t'), ("tab", b'\t'), ("|", b'|'), (" ", b' ')];

/// What a campaign says of its text logs; what is `None` is found from each file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Files {
    /// What separates fields.
    pub delimiter: Option<u8>,
    /// The decimal sign, a point or a comma.
    pub decimal: Option<u8>,
    /// How characters are encoded.
    pub encoding: Option<&'static Encoding>,
    /// Lines before the header.
    pub skip_rows: Option<usize>,
    /// Sample rate where no column holds time, Hz.
    pub rate_hz: Option<f64>,
}

impl Files {
    /// Reads `[files]`; faults go to the section.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let delimiter = section.may("delimiter").choice(&DELIMITERS);
        let decimal = section.may("decimal").choice(&[(".", b'.'), (",", b',')]);
        if delimiter.is_some() && delimiter == decimal {
            section.reject("decimal", "is the delimiter too", "one sign cannot be both");
        }
        let encoding = section.may("encoding").text().and_then(|label| {
            let found = Encoding::for_label(label.as_bytes());
            if found.is_none() {
                let cure = "expected a label such as utf-8, windows-1252, latin-1 or utf-16le";
                section.reject("encoding", format!("`{label}` is no known encoding"), cure);
            }
            found
        });
        let skip_rows = section.may("skip_rows").whole(0, SKIPPED_MAX).and_then(|rows| usize::try_from(rows).ok());
        let rate_hz = section.may("rate_hz").positive();
        Some(Self { delimiter, decimal, encoding, skip_rows, rate_hz })
    }

    /// Keys and values of what is said.
    pub(super) fn pairs(&self) -> Vec<(&'static str, Value)> {
        let sign = |byte: u8| Value::from(char::from(byte).to_string());
        let mut pairs = Vec::new();
        pairs.extend(self.delimiter.map(|delimiter| ("delimiter", sign(delimiter))));
        pairs.extend(self.decimal.map(|decimal| ("decimal", sign(decimal))));
        pairs.extend(self.encoding.map(|encoding| ("encoding", encoding.name().to_ascii_lowercase().into())));
        pairs.extend(self.skip_rows.map(|rows| ("skip_rows", (rows as i64).into())));
        pairs.extend(self.rate_hz.map(|rate_hz| ("rate_hz", rate_hz.into())));
        pairs
    }
}
