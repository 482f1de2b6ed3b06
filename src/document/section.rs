//! A reader over one table: typed values by key, and every fault on the way.

use super::{Node, Table, Value, suggest};
use crate::limits::{FAULTS_LISTED, shown};
use crate::problem::{Problem, acts};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// One table being read. All sections of a file share one list of problems.
pub struct Section<'a> {
    file: &'a Path,
    problems: &'a RefCell<Vec<Problem>>,
    /// Dotted name of the table in its file; empty for the outermost.
    path: String,
    row: Option<u64>,
    table: &'a Table,
    asked: RefCell<BTreeSet<String>>,
}

impl<'a> Section<'a> {
    pub(super) fn root(file: &'a Path, table: &'a Table, problems: &'a RefCell<Vec<Problem>>) -> Self {
        Self { file, problems, path: String::new(), row: None, table, asked: RefCell::default() }
    }

    fn below(&self, path: String, row: Option<u64>, table: &'a Table) -> Self {
        Self { file: self.file, problems: self.problems, path, row, table, asked: RefCell::default() }
    }

    /// A key that must be there.
    pub fn need<'s>(&'s self, key: &str) -> Field<'s, 'a> {
        self.field(key, true)
    }

    /// A key that may be absent.
    pub fn may<'s>(&'s self, key: &str) -> Field<'s, 'a> {
        self.field(key, false)
    }

    /// The keys that are there, in alphabetical order, asked for or not.
    pub fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.table.keys().map(String::as_str)
    }

    /// Row at which the section begins; none in JSON and for the outermost.
    pub fn row(&self) -> Option<u64> {
        self.row
    }

    /// Reports a fault in what stands under `key`, which had the right type but makes no sense.
    pub fn reject(&self, key: &str, what: impl Into<String>, cure: impl Into<String>) {
        self.push(key, Problem::error(self.file, what, cure));
    }

    /// Reports what the reader should know of what stands under `key`, though it can be used.
    pub fn doubt(&self, key: &str, what: impl Into<String>, cure: impl Into<String>) {
        self.push(key, Problem::warning(self.file, what, cure));
    }

    fn push(&self, key: &str, problem: Problem) {
        let row = self.table.get(key).map_or(self.row, |node| node.row);
        self.problems.borrow_mut().push(problem.at_row(row).in_column(self.name_of(key)));
    }

    /// Runs `read`, then reports every key that it did not ask for.
    pub(super) fn finish_with<T>(self, read: impl FnOnce(&Self) -> Option<T>) -> Option<T> {
        let value = read(&self);
        let asked = self.asked.borrow();
        let mut unknown = self.table.iter().filter(|(key, _)| !asked.contains(*key));
        for (key, node) in unknown.by_ref().take(FAULTS_LISTED) {
            let cure = suggest(key, "known here", asked.iter().map(String::as_str));
            self.report(self.name_of(&shown(key)), node.row, format!("unknown key `{}`", shown(key)), cure);
        }
        if let (Some((_, node)), more) = (unknown.next(), unknown.count()) {
            let what = format!("and {} more unknown keys", more + 1);
            self.problems.borrow_mut().push(Problem::error(self.file, what, "").at_row(node.row));
        }
        value
    }

    fn field<'s>(&'s self, key: &str, required: bool) -> Field<'s, 'a> {
        self.asked.borrow_mut().insert(key.to_string());
        let node = self.table.get(key).filter(|node| node.value != Value::Nothing);
        Field { section: self, key: key.to_string(), node, required, example: None }
    }

    fn name_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) }
    }

    fn report(&self, column: String, row: Option<u64>, what: impl Into<String>, cure: impl Into<String>) {
        self.problems.borrow_mut().push(Problem::error(self.file, what, cure).at_row(row).in_column(column));
    }
}

/// What stands under one key, not yet given a type. Every reading gives None for what is absent, and for what is
/// missing or of the wrong type after reporting it.
pub struct Field<'s, 'a> {
    section: &'s Section<'a>,
    key: String,
    node: Option<&'a Node>,
    required: bool,
    /// What to write where it is missing, and what that means.
    example: Option<(String, String)>,
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
    pub fn choice<T: Clone>(mut self, choices: &[(&str, T)]) -> Option<T> {
        let names = choices.iter().map(|(name, _)| *name);
        self.example = self.example.or_else(|| first_of(names.clone()));
        let (section, key) = (self.section, self.key.clone());
        let text = self.text()?;
        let found = choices.iter().find(|(name, _)| *name == text).map(|(_, choice)| choice.clone());
        if found.is_none() {
            let all = names.clone().collect::<Vec<_>>().join(", ");
            section.reject(
                &key,
                format!("is `{}`; expected one of {all}", shown(&text)),
                suggest(&text, "name one of", names),
            );
        }
        found
    }

    /// A table, read by `read`, which asks for every key before it gives up on one.
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
        let Some(node) = self.node else {
            if self.required {
                self.section.report(self.name(), self.section.row, "missing", self.what_to_write(expected));
            }
            return None;
        };
        let value = take(&node.value);
        if value.is_none() {
            self.section.reject(&self.key, format!("is {}", node.value.describe()), format!("expected {expected}"));
        }
        value
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
fn first_of<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<(String, String)> {
    let first = names.next()?;
    let others: Vec<&str> = names.collect();
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

#[cfg(test)]
mod tests {
    use crate::document::Document;
    use crate::problem::Result;

    const TEXT: &str = r#"{ "name": "elbow", "gain": null, "limits": { "low": -1, "high": 2.5 },
                            "parts": { "up": { "mu": 0.4 }, "down": { "mu": 1e-1, "nu": true } } }"#;

    fn document() -> Document {
        Document::from_json("m.json".as_ref(), TEXT).expect("is JSON")
    }

    /// The messages of a failed reading, one a line.
    fn messages<T: std::fmt::Debug>(result: Result<T>) -> String {
        result.expect_err("fails").to_string()
    }

    #[test]
    fn free_form_tables_are_read_by_name() {
        let read = document().read(|root| {
            root.need("limits").ignore();
            assert_eq!((root.need("name").text().as_deref(), root.may("gain").number()), (Some("elbow"), None));
            root.need("parts").sections_by_name(|_, part| {
                part.may("nu").ignore();
                part.need("mu").number()
            })
        });
        assert_eq!(read.map(|parts| parts.into_values().collect::<Vec<_>>()), Ok(vec![0.1, 0.4]));
    }

    #[test]
    fn faults_carry_their_dotted_path() {
        let found = messages(document().read(|root| {
            root.need("name").number();
            root.need("gain").positive();
            root.need("kind").choice(&[("turns", 1), ("slides", 2)]);
            root.need("sign").such_as("-1", "1 or -1").number();
            root.may("limit").ignore();
            root.need("parts").sections_by_name(|_, part| part.need("mu").text())
        }));
        let expected = "m.json, `gain`: missing; add `gain`, a number above 0
m.json, `kind`: missing; write `\"kind\": \"turns\"`, or one of slides
m.json, `limits`: unknown key `limits`; did you mean `limit`?
m.json, `name`: is the text `elbow`; expected a number
m.json, `parts.down.mu`: is the number 0.1; expected a text in quotes
m.json, `parts.down.nu`: unknown key `nu`; known here: mu
m.json, `parts.up.mu`: is the number 0.4; expected a text in quotes
m.json, `sign`: missing; write `\"sign\": -1`: 1 or -1";
        let mut lines: Vec<&str> = found.lines().collect();
        lines.sort_unstable();
        assert_eq!(lines.join("\n"), expected);
    }
}
