//! Text -> tree, with rows where the parser tells them.

use super::{Node, Table, Value};
use crate::problem::{Problem, Result};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The outermost table of a TOML text.
pub(super) fn toml(file: &Path, text: &str) -> Result<Table> {
    let rows = Rows::of(text);
    match DeTable::parse(text) {
        Ok(table) => Ok(toml_table(table.get_ref(), &rows)),
        Err(error) => {
            let row = error.span().map(|span| rows.at(span.start));
            syntax(file, "TOML", error.message(), row)
        }
    }
}

/// The outermost object of a JSON text.
pub(super) fn json(file: &Path, text: &str) -> Result<Table> {
    match serde_json::from_str(text) {
        Ok(serde_json::Value::Object(object)) => Ok(json_table(object)),
        Ok(other) => {
            Problem::error(file, format!("holds {}", json_value(other).describe()), "expected { ... }").alone()
        }
        Err(error) => syntax(file, "JSON", &error.to_string(), Some(error.line() as u64)),
    }
}

fn syntax<T>(file: &Path, language: &str, message: &str, row: Option<u64>) -> Result<T> {
    Problem::error(file, format!("is not valid {language}: {message}"), "mend the syntax there").at_row(row).alone()
}

fn toml_table(table: &DeTable<'_>, rows: &Rows) -> Table {
    // The key's row serves for what stands under it: a value may span many rows, its key stands on one.
    let entry = |(key, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| {
        let key: &Spanned<std::borrow::Cow<'_, str>> = key;
        let row = match value.get_ref() {
            DeValue::Table(_) => rows.at(value.span().start),
            _ => rows.at(key.span().start),
        };
        (key.get_ref().to_string(), Node { row: Some(row), value: toml_value(value.get_ref(), rows) })
    };
    table.iter().map(entry).collect()
}

fn toml_value(value: &DeValue<'_>, rows: &Rows) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(whole) => match i64::from_str_radix(whole.as_str(), whole.radix()) {
            Ok(whole) => Value::Whole(whole),
            // Too large for a whole number here, but perhaps meant as any number.
            Err(_) => Value::Number(whole.as_str().parse().unwrap_or(f64::NAN)),
        },
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
        DeValue::Array(list) => Value::List(list.iter().map(|item| toml_item(item, rows)).collect()),
        DeValue::Table(table) => Value::Table(toml_table(table, rows)),
    }
}

fn toml_item(item: &Spanned<DeValue<'_>>, rows: &Rows) -> Node {
    Node { row: Some(rows.at(item.span().start)), value: toml_value(item.get_ref(), rows) }
}

fn json_table(object: serde_json::Map<String, serde_json::Value>) -> Table {
    object.into_iter().map(|(key, value)| (key, Node { row: None, value: json_value(value) })).collect()
}

fn json_value(value: serde_json::Value) -> Value {
    match value {
        serde_json::Value::Null => Value::Nothing,
        serde_json::Value::Bool(flag) => Value::Flag(flag),
        serde_json::Value::Number(number) => match number.as_i64() {
            Some(whole) => Value::Whole(whole),
            None => Value::Number(number.as_f64().unwrap_or(f64::NAN)),
        },
        serde_json::Value::String(text) => Value::Text(text),
        serde_json::Value::Array(list) => {
            Value::List(list.into_iter().map(|item| Node { row: None, value: json_value(item) }).collect())
        }
        serde_json::Value::Object(object) => Value::Table(json_table(object)),
    }
}

/// Where each row of a text ends, to turn a byte's place into its row.
struct Rows(Vec<usize>);

impl Rows {
    fn of(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(place, _)| place).collect())
    }

    /// Row of the byte at `place`, counted from 1.
    fn at(&self, place: usize) -> u64 {
        1 + self.0.partition_point(|&end| end < place) as u64
    }
}
