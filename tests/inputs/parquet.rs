//! Parquet: checksums of pages, and what they unpack to.

use crate::import::HEAD;
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};
use polars_parquet_format::thrift::protocol::{TCompactInputProtocol, TCompactOutputProtocol};
use polars_parquet_format::{FileMetaData, PageHeader};
use tautline::log::{Campaign, Log, read_trial};
use tautline::problem::Result;
use tempfile::TempDir;

const COLUMNS: &str = r#"[columns]
time = { name = "t", unit = "s" }
position = { name = "pos", unit = "deg" }
torque = { name = "trq", unit = "N m" }
[[trials]]
file = "a.parquet"
protocol = "free"
"#;

fn trial(bytes: &[u8]) -> Result<Log> {
    trial_with(COLUMNS, bytes)
}

fn trial_with(columns: &str, bytes: &[u8]) -> Result<Log> {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("a.parquet"), bytes).unwrap();
    std::fs::write(folder.path().join("campaign.toml"), format!("{HEAD}{columns}")).unwrap();
    Campaign::read(folder.path()).and_then(|campaign| read_trial(&campaign, 0))
}

fn table(columns: Vec<Column>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut frame = DataFrame::new(columns[0].len(), columns).unwrap();
    ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
    bytes
}

fn motion() -> Vec<u8> {
    let column = |name: &str, of: fn(f64) -> f64| -> Column {
        Series::new(name.into(), (0..2000).map(|i| of(f64::from(i) * 0.001)).collect::<Vec<f64>>()).into_column()
    };
    table(vec![column("t", |t| t), column("pos", |t| 30.0 + 20.0 * t.sin()), column("trq", |t| 0.3 * (3.0 * t).cos())])
}

fn header(rest: &mut &[u8]) -> PageHeader {
    PageHeader::read_from_in_protocol(&mut TCompactInputProtocol::new(rest, 1 << 20)).unwrap()
}

/// The same file with the CRC of every page, as other writers put it there.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    let length = u32::from_le_bytes(bytes[bytes.len() - 8..bytes.len() - 4].try_into().unwrap()) as usize;
    let mut footer = &bytes[bytes.len() - 8 - length..bytes.len() - 8];
    let mut about = FileMetaData::read_from_in_protocol(&mut TCompactInputProtocol::new(&mut footer, 1 << 24)).unwrap();
    let mut out = b"PAR1".to_vec();
    for chunk in about.row_groups.iter_mut().flat_map(|group| &mut group.columns) {
        let data = chunk.meta_data.as_mut().unwrap();
        let from = data.dictionary_page_offset.unwrap_or(data.data_page_offset) as usize;
        let mut rest = &bytes[from..from + data.total_compressed_size as usize];
        let begin = out.len() as i64;
        let has_dictionary = data.dictionary_page_offset.is_some();
        let mut pages = 0;
        while !rest.is_empty() {
            let mut page = header(&mut rest);
            let (stored, later) = rest.split_at(page.compressed_page_size as usize);
            page.crc = Some(crc32fast::hash(stored).cast_signed());
            if pages == usize::from(has_dictionary) {
                data.data_page_offset = out.len() as i64;
            }
            page.write_to_out_protocol(&mut TCompactOutputProtocol::new(&mut out)).unwrap();
            out.extend(stored);
            (rest, pages) = (later, pages + 1);
        }
        data.dictionary_page_offset = has_dictionary.then_some(begin);
        data.total_compressed_size = out.len() as i64 - begin;
        chunk.file_offset = begin;
    }
    let begin = out.len();
    about.write_to_out_protocol(&mut TCompactOutputProtocol::new(&mut out)).unwrap();
    let length = (out.len() - begin) as u32;
    out.extend(length.to_le_bytes());
    out.extend(b"PAR1");
    out
}

#[test]
fn checksums_of_pages_are_verified_where_there_are_any() {
    let plain = trial(&motion()).unwrap();
    let whole = with_checksums(&motion());
    let same = trial(&whole).unwrap();
    assert_eq!((&plain.position_rad, &plain.torque_nm), (&same.position_rad, &same.torque_nm));
    let first = whole.len() / 3;
    for at in (first..first + 4000).step_by(97) {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        match trial(&damaged) {
            Ok(read) => panic!("bit {} of byte {at} went unseen: {}", at % 8, read.torque_nm == plain.torque_nm),
            Err(said) => assert!(said.to_string().contains("a.parquet"), "{said}"),
        }
    }
    let mut damaged = whole;
    damaged[first] ^= 1;
    let said = trial(&damaged).unwrap_err().to_string();
    assert!(said.contains("`pos`: is damaged: page") && said.contains("does not match its checksum"), "{said}");
}

#[test]
fn constant_columns_without_end_are_refused() {
    let zeros = |name: &str| -> Column { Series::new(name.into(), vec![0i32; 12_000_000]).into_column() };
    let bomb = table(vec![zeros("t"), zeros("pos"), zeros("trq")]);
    assert!(bomb.len() < 5_000_000, "{}", bomb.len());
    let said = trial(&bomb).unwrap_err().to_string();
    assert!(said.contains("unpacks to more than"), "{said}");
}

/// Found by fuzzing: room was made for 2^64 - 1 rows, and the program aborted.
#[test]
fn a_page_of_a_negative_number_of_rows_is_refused() {
    let bytes = std::fs::read("tests/fuzz/corpus/parquet/page_of_negative_rows").unwrap();
    let columns =
        COLUMNS.replace("\"t\"", "\"time\"").replace("\"pos\"", "\"position\"").replace("\"trq\"", "\"torque\"");
    let said = trial_with(&columns, &bytes).unwrap_err().to_string();
    assert!(said.contains("number of values"), "{said}");
}
