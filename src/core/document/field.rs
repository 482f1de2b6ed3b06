//! What stands under one key of a table, and how it is read.

use super::section::Section;
use super::{Node, Table, Value, suggest};
use crate::limits::shown;
use crate::problem::acts;
use std::collections::BTreeMap;

/// What stands under one key, not yet given a type. Every reading gives None for what is absent, and for what is
/// missing or of the wrong type after reporting it.
pub struct Field<'s, 'a> {
    pub(super) section: &'s Section<'a>,
    pub(super) key: String,
    pub(super) node: Option<&'a Node>,
    pub(super) required: bool,
    /// What to write where it is missing, and what that means.
    pub(super) example: Option<(String, String)>,
}

impl<'a> Field<'_, 'a> {
    /// Says what to write where the key is missing: a `value` (a table's heading, for a table) and what it `means`.
    pub fn such_as(self, value: &str, means: &str) -> Self {
        Self { example: Some((value.to_string(), format!(": {means}"))), ..self }
    }

    /// A text.
    pub fn text(self) -> Option<String> {
        let (section, key) = (self.section, self.key.clone());
        let text = self.take("a text in quotes", |value| match value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        })?;
        // Names come out again on terminals, in pages, XML and code.
        if let Some(acts) = text.chars().find(|c| acts(*c)) {
            let what = format!(
                "holds the character U+{:04X}, which is not shown but acts on terminals and pages",
                acts as u32
            );
            section.reject(&key, what, "write it without control characters and marks of direction");
            return None;
        }
        Some(text)
    }

    /// A day, with or without the time of day, without quotes: as ISO 8601 writes it.
    pub fn date(self) -> Option<String> {
        self.take("a date such as 2026-03-02, without quotes", |value| match value {
            Value::Date(date) => Some(date.clone()).filter(|date| date.as_bytes().get(4) == Some(&b'-')),
            _ => None,
        })
    }

    /// A finite number.
    pub fn number(self) -> Option<f64> {
        self.take("a number", finite)
    }

    /// A finite number above zero.
    pub fn positive(self) -> Option<f64> {
        self.take("a number above 0", |value| finite(value).filter(|number| *number > 0.0))
    }

    /// A finite number, zero or above.
    pub fn not_negative(self) -> Option<f64> {
        self.take("a number, 0 or above", |value| finite(value).filter(|number| *number >= 0.0))
    }

    /// true or false.
    pub fn flag(self) -> Option<bool> {
        self.take("true or false", |value| match value {
            Value::Flag(flag) => Some(*flag),
            _ => None,
        })
    }

    /// A text or a number, as text.
    pub fn word(self) -> Option<String> {
        self.take("a text in quotes or a number", |value| match value {
            Value::Text(text) if !text.chars().any(acts) => Some(text.clone()),
            Value::Text(_) | Value::List(_) => None,
            value => finite(value).map(|number| number.to_string()),
        })
    }

    /// A number without fraction, between `low` and `high`.
    pub fn whole(self, low: i64, high: i64) -> Option<i64> {
        self.take(&format!("a whole number from {low} to {high}"), |value| match value {
            Value::Whole(whole) if (low..=high).contains(whole) => Some(*whole),
            _ => None,
        })
    }

    /// A list of numbers without fraction, each between `low` and `high`.
    pub fn wholes(self, low: i64, high: i64) -> Option<Vec<i64>> {
        let whole = |node: &Node| match node.value {
            Value::Whole(whole) if (low..=high).contains(&whole) => Some(whole),
            _ => None,
        };
        self.take(&format!("a list of whole numbers from {low} to {high}"), |value| match value {
            Value::List(list) => list.iter().map(whole).collect::<Option<Vec<i64>>>(),
            _ => None,
        })
    }

    /// One of `choices`, by its name.
    pub fn choice<T: Clone>(self, choices: &[(&str, T)]) -> Option<T> {
        let at = self.one_of(choices.iter().map(|(name, _)| *name).collect())?;
        choices.get(at).map(|(_, choice)| choice.clone())
    }

    /// Which of `names` it is.
    fn one_of(mut self, names: Vec<&str>) -> Option<usize> {
        self.example = self.example.or_else(|| first_of(&names));
        let (section, key) = (self.section, self.key.clone());
        let text = self.text()?;
        let found = names.iter().position(|name| *name == text);
        if found.is_none() {
            let what = format!("is `{}`; expected one of {}", shown(&text), names.join(", "));
            section.reject(&key, what, suggest(&text, "name one of", names));
        }
        found
    }

    /// A table, read by `read`, which reads every key before it returns early for a missing one.
    pub fn section<T>(self, read: impl FnOnce(&Section<'a>) -> Option<T>) -> Option<T> {
        let (parent, path, row) = (self.section, self.name(), self.row());
        let table = self.take("a table", table)?;
        parent.below(path, row, table).finish_with(read)
    }

    /// A list of tables (TOML's `[[...]]`), each read by `read`; those that cannot be read are left out, reported.
    pub fn sections<T>(self, mut read: impl FnMut(&Section<'a>) -> Option<T>) -> Option<Vec<T>> {
        let (parent, path) = (self.section, self.name());
        let list = self.take("a list of tables", |value| match value {
            Value::List(list) => Some(list),
            _ => None,
        })?;
        let one = |(index, node): (usize, &'a Node)| {
            let path = format!("{path}[{index}]");
            let Some(table) = table(&node.value) else {
                parent.report(path, node.row, format!("is {}", node.value.describe()), "expected a table");
                return None;
            };
            parent.below(path, node.row, table).finish_with(&mut read)
        };
        Some(list.iter().enumerate().filter_map(one).collect())
    }

    /// A table of free-form keys, each holding a table read by `read`.
    pub fn sections_by_name<T>(
        self,
        mut read: impl FnMut(&str, &Section<'a>) -> Option<T>,
    ) -> Option<BTreeMap<String, T>> {
        self.section(|all| {
            let one = |name: &'a str| Some((name.to_string(), all.need(name).section(|section| read(name, section))?));
            Some(all.keys().filter_map(one).collect())
        })
    }

    /// Whatever it is, known but not looked at.
    pub fn ignore(self) {}

    fn take<T>(self, expected: &str, take: impl FnOnce(&'a Value) -> Option<T>) -> Option<T> {
        let value = self.node.and_then(|node| take(&node.value));
        if value.is_none() {
            self.report_not(expected);
        }
        value
    }

    /// Reports that it is not what was `expected`, if it is there or had to be.
    fn report_not(&self, expected: &str) {
        match self.node {
            Some(node) => {
                self.section.reject(&self.key, format!("is {}", node.value.describe()), format!("expected {expected}"));
            }
            None if self.required => {
                self.section.report(self.name(), self.section.row, "missing", self.what_to_write(expected));
            }
            None => (),
        }
    }

    fn what_to_write(&self, expected: &str) -> String {
        let key = &self.key;
        let is_json = self.section.file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        match &self.example {
            Some((value, means)) if is_json => format!("write `\"{key}\": {value}`{means}"),
            Some((value, means)) if value.starts_with('[') => format!("write `{value}`{means}"),
            Some((value, means)) => format!("write `{key} = {value}`{means}"),
            None => format!("add `{key}`, {expected}"),
        }
    }

    fn name(&self) -> String {
        self.section.name_of(&self.key)
    }

    fn row(&self) -> Option<u64> {
        self.node.and_then(|node| node.row)
    }
}

/// The first of `names` as a value, and the others that it may be.
fn first_of(names: &[&str]) -> Option<(String, String)> {
    let (first, others) = names.split_first()?;
    let means = if others.is_empty() { String::new() } else { format!(", or one of {}", others.join(", ")) };
    Some((format!("\"{first}\""), means))
}

fn finite(value: &Value) -> Option<f64> {
    match value {
        Value::Whole(whole) => Some(*whole as f64),
        Value::Number(number) => Some(*number).filter(|number| number.is_finite()),
        _ => None,
    }
}

fn table(value: &Value) -> Option<&Table> {
    match value {
        Value::Table(table) => Some(table),
        _ => None,
    }
}
