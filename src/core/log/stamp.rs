//! Dates and times of day as time stamps: ISO 8601 and the forms that spreadsheets write, as texts; Parquet's timestamps.
//!
//! A stamp counts in seconds since 2020 (since 1970 a double would hold them to 0.2 us only), a time of day since midnight; what zone
//! a clock was set to does not matter within a campaign.

use super::columns::Wanted;
use crate::units::Quantity;
use chrono::{DateTime, NaiveDateTime, NaiveTime, Timelike};
use polars::io::parquet::metadata::FileMetadataRef;
use polars_parquet::parquet::metadata::{FileMetadata, SchemaDescriptor};
use polars_parquet::parquet::schema::types::{
    ParquetType, PrimitiveConvertedType, PrimitiveLogicalType, PrimitiveType, TimeUnit,
};
use std::sync::Arc;

/// From 1970 to 2020, s.
const ORIGIN_S: i64 = 1_577_836_800;
/// The longest text that can be a stamp: `2025-03-04T12:00:00.123456789+01:00`.
const LONGEST: usize = 40;
/// Forms without a zone.
const FORMS: [&str; 5] = [
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%m/%d/%Y %H:%M:%S%.f",
];
/// A key in which Arrow's writers store the types of their own.
const OF_ARROW: &str = "ARROW:schema";

/// What `field` holds as a reading of `want`, if that is a time and it is a stamp.
pub(super) fn reading(field: &[u8], want: &Wanted) -> Option<f64> {
    (want.quantity == Quantity::Time).then(|| Some(seconds(field)? / want.column.unit.factor())).flatten()
}

/// The seconds of a date with a time, or of a time of day.
pub(super) fn seconds(field: &[u8]) -> Option<f64> {
    let field = field.trim_ascii();
    if field.len() > LONGEST || field.iter().filter(|byte| **byte == b':').count() < 2 {
        return None;
    }
    let text = std::str::from_utf8(field).ok()?.replace(',', ".");
    let of_date = |at: NaiveDateTime| at.and_utc();
    let in_zone = || DateTime::parse_from_rfc3339(&text.replacen(' ', "T", 1)).ok().map(|at| at.to_utc());
    let date = FORMS.iter().find_map(|form| NaiveDateTime::parse_from_str(&text, form).ok()).map(of_date);
    if let Some(date) = date.or_else(in_zone) {
        return Some((date.timestamp() - ORIGIN_S) as f64 + 1e-9 * f64::from(date.timestamp_subsec_nanos()));
    }
    let of_day = NaiveTime::parse_from_str(&text, "%H:%M:%S%.f").ok()?;
    Some(f64::from(of_day.num_seconds_from_midnight()) + 1e-9 * f64::from(of_day.nanosecond()))
}

/// What a count of a Parquet column of dates or times is in s, and what is to be taken from it then; `None` of a column of another type.
pub(super) fn counted_in_s(metadata: &FileMetadata, name: &str) -> Option<(f64, f64)> {
    let of = metadata.schema_descr.fields().iter().find(|field| field.get_field_info().name == name)?;
    let ParquetType::PrimitiveType(PrimitiveType { logical_type, converted_type, .. }) = of else { return None };
    use PrimitiveConvertedType::{TimeMicros, TimeMillis, TimestampMicros, TimestampMillis};
    match (logical_type, converted_type) {
        (Some(PrimitiveLogicalType::Timestamp { unit, .. }), _) => Some((in_s(unit), ORIGIN_S as f64)),
        (Some(PrimitiveLogicalType::Time { unit, .. }), _) => Some((in_s(unit), 0.0)),
        (None, Some(TimestampMillis)) => Some((1e-3, ORIGIN_S as f64)),
        (None, Some(TimestampMicros)) => Some((1e-6, ORIGIN_S as f64)),
        (None, Some(TimeMillis)) => Some((1e-3, 0.0)),
        (None, Some(TimeMicros)) => Some((1e-6, 0.0)),
        _ => None,
    }
}

fn in_s(unit: &TimeUnit) -> f64 {
    match unit {
        TimeUnit::Milliseconds => 1e-3,
        TimeUnit::Microseconds => 1e-6,
        TimeUnit::Nanoseconds => 1e-9,
    }
}

/// `metadata` in which dates and times are the whole numbers that they are stored as.
pub(super) fn as_counts(metadata: &FileMetadataRef) -> FileMetadataRef {
    let plain = |field: &ParquetType| match field {
        ParquetType::PrimitiveType(of) if counted_in_s(metadata, &of.field_info.name).is_some() => {
            ParquetType::PrimitiveType(PrimitiveType { logical_type: None, converted_type: None, ..of.clone() })
        }
        other => other.clone(),
    };
    let schema = &metadata.schema_descr;
    let mut changed = FileMetadata::clone(metadata);
    changed.schema_descr = SchemaDescriptor::new(schema.name().into(), schema.fields().iter().map(plain).collect());
    // A duration is stored as a whole number too, and only this key says what it is.
    if let Some(pairs) = &mut changed.key_value_metadata {
        pairs.retain(|pair| pair.key != OF_ARROW);
    }
    Arc::new(changed)
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn stamps_are_read_however_they_are_written() {
        let noon = 163_252_800.25;
        for text in [
            "2025-03-04 12:00:00.25",
            "2025-03-04T12:00:00.250Z",
            "2025-03-04T13:00:00,25+01:00",
            "04.03.2025 12:00:00,25",
            " 2025/03/04 12:00:00.250000 ",
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(noon), "{text}");
        }
        assert_eq!(seconds(b"12:00:00.5"), Some(43_200.5));
        for text in ["", "12:00", "a:b:c", "1.5", "2025-13-04 12:00:00"] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
