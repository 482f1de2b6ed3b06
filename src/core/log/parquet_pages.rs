//! Parquet's pages, looked at before they are unpacked: their checksums, and what they would unpack to.
//!
//! A page may carry the CRC-32 of its bytes as stored (Parquet format, `PageHeader.crc`); Polars neither writes nor verifies it.
//! Verified here: the CRC of every page of the wanted columns that carries one; that pages fill their column exactly and hold no
//! more values than it has rows; that columns do not overlap. Not verified: the footer and page headers, which have no checksum,
//! and pages without one.

use crate::limits::{Budget, PAGE_HEADER_BYTES};
use polars_parquet_format::PageHeader;
use polars_parquet_format::thrift::protocol::TCompactInputProtocol;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

/// Checks on the pages of one file, column by column.
pub(super) struct Pages {
    source: File,
    /// Bytes of the file that no column was found in yet.
    left: u64,
    unpacked: Budget,
}

impl Pages {
    pub fn of(source: File) -> std::io::Result<Self> {
        let length = source.metadata()?.len();
        Ok(Self { source, left: length, unpacked: Budget::of_file(length) })
    }

    /// Checks the pages that stand in `range` and hold a column of so many `rows`. Errors: what is wrong with them.
    pub fn check(&mut self, range: Range<u64>, rows: usize) -> Result<(), String> {
        let length = range.end.saturating_sub(range.start);
        // Every byte belongs to one column: that bounds what is read.
        self.left = self.left.checked_sub(length).ok_or("its columns are larger than the file")?;
        let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
        let found = self.source.seek(SeekFrom::Start(range.start)).and_then(|_| self.source.read_exact(&mut bytes));
        found.map_err(|error| error.to_string())?;
        let (mut rest, mut page, mut rows_left) = (&bytes[..], 0, rows);
        while !rest.is_empty() {
            page += 1;
            let header =
                PageHeader::read_from_in_protocol(&mut TCompactInputProtocol::new(&mut rest, PAGE_HEADER_BYTES))
                    .map_err(|error| format!("page {page}: {error}"))?;
            let size = usize::try_from(header.compressed_page_size).ok().filter(|size| *size <= rest.len());
            let stored;
            (stored, rest) = rest.split_at(size.ok_or(format!("page {page} does not end within its column"))?);
            if header.crc.is_some_and(|crc| crc.cast_unsigned() != crc32fast::hash(stored)) {
                return Err(format!("page {page} does not match its checksum: it was changed after it was written"));
            }
            let unpacked =
                u64::try_from(header.uncompressed_page_size).map_err(|_| format!("page {page} has no size"))?;
            self.unpacked.take(unpacked)?;
            let values = values(&header).and_then(|values| rows_left.checked_sub(values));
            rows_left = values.ok_or(format!("page {page} holds another number of values than its column has rows"))?;
        }
        Ok(())
    }
}

/// Rows of a column without lists that a page holds: none in a dictionary. `None` where the number is invalid; memory is reserved for that
/// many before they are read.
fn values(header: &PageHeader) -> Option<usize> {
    let rows = match (&header.data_page_header, &header.data_page_header_v2, &header.dictionary_page_header) {
        (Some(page), None, None) => page.num_values,
        (None, Some(page), None) => page.num_values,
        (None, None, Some(dictionary)) => return usize::try_from(dictionary.num_values).ok().map(|_| 0),
        _ => 0,
    };
    usize::try_from(rows).ok()
}
