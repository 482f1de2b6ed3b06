//! Parquet <-> columns as arrays, of which no data frame is made: Polars' reader and writer of pages without the rest of it.

use polars_arrow::array::{Array, PrimitiveArray};
use polars_arrow::datatypes::{ArrowDataType, ArrowSchema, Field};
use polars_arrow::record_batch::RecordBatchT;
use polars_arrow::types::NativeType;
use polars_parquet::parquet::metadata::FileMetadata;
use polars_parquet::read::{BasicDecompressor, Filter, PageReader, column_iter_to_arrays};
use polars_parquet::write::{
    CompressionOptions, FileWriter, RowGroupIterator, StatisticsOptions, Version, WriteOptions, get_dtype_encoding,
};
use std::fmt::Display;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::sync::Arc;

/// Rows of a group: what a reader must hold of a column at once.
const GROUP_ROWS: usize = 1 << 18;
/// Pages compress to a fifth in little time.
const WRITTEN_AS: WriteOptions = WriteOptions {
    statistics: StatisticsOptions {
        min_value: true,
        max_value: true,
        distinct_count: false,
        null_count: true,
        binary_statistics_truncate_length: None,
    },
    version: Version::V1,
    compression: CompressionOptions::Zstd(None),
    data_page_size: None,
};

/// What Parquet's reader and writer say went wrong, in words.
type Said<T> = Result<T, String>;

fn said(error: impl Display) -> String {
    error.to_string()
}

/// The arrays of the column `field` of `source`, one or several for each group of rows; none of a group that lacks it.
///
/// Errors: its pages are damaged.
pub(super) fn read(source: &mut File, metadata: &FileMetadata, field: &Field) -> Said<Vec<Box<dyn Array>>> {
    let mut all = Vec::new();
    for group in &metadata.row_groups {
        let chunks = group.columns_under_root_iter(&field.name).into_iter().flatten();
        let mut pages = Vec::new();
        let mut types = Vec::new();
        for chunk in chunks {
            let range = chunk.byte_range();
            let mut bytes = vec![0; usize::try_from(range.end.saturating_sub(range.start)).map_err(said)?];
            source.seek(SeekFrom::Start(range.start)).and_then(|_| source.read_exact(&mut bytes)).map_err(said)?;
            let reader = PageReader::new(Cursor::new(bytes.into()), chunk, Vec::new(), usize::MAX);
            pages.push(BasicDecompressor::new(reader, Vec::new()));
            types.push(&chunk.descriptor().descriptor.primitive_type);
        }
        let rows = Filter::new_ranged(0, group.num_rows());
        let (arrays, _) = column_iter_to_arrays(pages, types, field.clone(), Some(rows)).map_err(said)?;
        if arrays.iter().map(|array| array.len()).sum::<usize>() != group.num_rows() {
            return Err("its pages do not hold what its footer says".to_string());
        }
        all.extend(arrays);
    }
    Ok(all)
}

/// The numbers of `array`, NaN where there is none; `None` of an array of another type.
pub(super) fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    fn of<T: NativeType>(array: &dyn Array, number: impl Fn(T) -> f64) -> Option<Vec<f64>> {
        let array = array.as_any().downcast_ref::<PrimitiveArray<T>>()?;
        Some(array.iter().map(|value| value.map_or(f64::NAN, |value| number(*value))).collect())
    }
    match array.dtype() {
        ArrowDataType::Float64 => of(array, |x: f64| x),
        ArrowDataType::Float32 => of(array, |x: f32| f64::from(x)),
        ArrowDataType::Int64 => of(array, |x: i64| x as f64),
        ArrowDataType::UInt64 => of(array, |x: u64| x as f64),
        ArrowDataType::Int32 => of(array, |x: i32| f64::from(x)),
        ArrowDataType::UInt32 => of(array, |x: u32| f64::from(x)),
        ArrowDataType::Int16 => of(array, |x: i16| f64::from(x)),
        ArrowDataType::UInt16 => of(array, |x: u16| f64::from(x)),
        ArrowDataType::Int8 => of(array, |x: i8| f64::from(x)),
        ArrowDataType::UInt8 => of(array, |x: u8| f64::from(x)),
        _ => None,
    }
}

/// Whether `numbers` reads a column of this type.
pub(super) fn is_numeric(kind: &ArrowDataType) -> bool {
    use ArrowDataType::{Float32, Float64, Int8, Int16, Int32, Int64, UInt8, UInt16, UInt32, UInt64};
    matches!(kind, Float64 | Float32 | Int64 | UInt64 | Int32 | UInt32 | Int16 | UInt16 | Int8 | UInt8)
}

/// What a column of another type than numbers holds, for people.
pub(super) fn kind(of: &ArrowDataType) -> String {
    use ArrowDataType::{Boolean, Date32, Date64, LargeUtf8, Time32, Time64, Timestamp, Utf8, Utf8View};
    match of {
        Utf8 | LargeUtf8 | Utf8View => "text".to_string(),
        Boolean => "true or false".to_string(),
        Date32 | Date64 => "dates".to_string(),
        Timestamp(..) | Time32(_) | Time64(_) => "times".to_string(),
        other => format!("{other:?}"),
    }
}

/// `columns` with their names, all alike in length, as the bytes of a Parquet file.
///
/// Errors: what cannot be written.
pub fn write(columns: Vec<(&str, Box<dyn Array>)>) -> Said<Vec<u8>> {
    let field = |(name, array): &(&str, Box<dyn Array>)| Field::new((*name).into(), array.dtype().clone(), true);
    let fields: Vec<Field> = columns.iter().map(field).collect();
    let encodings = fields.iter().map(|field| get_dtype_encoding(&field.dtype)).collect();
    let schema: Arc<ArrowSchema> = Arc::new(fields.into_iter().map(|field| (field.name.clone(), field)).collect());
    let rows = columns.first().map_or(0, |(_, array)| array.len());
    let group = |from: usize| {
        let number = GROUP_ROWS.min(rows - from);
        let arrays = columns.iter().map(|(_, array)| array.sliced(from, number)).collect();
        RecordBatchT::try_new(number, schema.clone(), arrays)
    };
    let groups = (0..rows).step_by(GROUP_ROWS).map(group);
    let groups = RowGroupIterator::try_new(groups, &schema, WRITTEN_AS, encodings).map_err(said)?;
    let mut writer = FileWriter::try_new(Vec::new(), (*schema).clone(), WRITTEN_AS).map_err(said)?;
    for (group, from) in groups.zip((0..rows).step_by(GROUP_ROWS)) {
        writer.write(GROUP_ROWS.min(rows - from) as u64, group.map_err(said)?).map_err(said)?;
    }
    writer.end(None).map_err(said)?;
    Ok(writer.into_inner())
}
