//! A reader over one table: typed values by key, and every fault on the way.

use super::field::Field;
use super::{Table, Value, suggest};
use crate::limits::{FAULTS_LISTED, shown};
use crate::problem::Problem;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

/// One table being read. All sections of a file share one list of problems.
pub struct Section<'a> {
    pub(super) file: &'a Path,
    problems: &'a RefCell<Vec<Problem>>,
    /// Dotted name of the table in its file; empty for the outermost.
    path: String,
    pub(super) row: Option<u64>,
    table: &'a Table,
    asked: RefCell<BTreeSet<String>>,
}

impl<'a> Section<'a> {
    pub(super) fn root(file: &'a Path, table: &'a Table, problems: &'a RefCell<Vec<Problem>>) -> Self {
        Self { file, problems, path: String::new(), row: None, table, asked: RefCell::default() }
    }

    pub(super) fn below(&self, path: String, row: Option<u64>, table: &'a Table) -> Self {
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

    /// The same section, in which keys that are not read are no fault: what else stands there is for people.
    pub fn with_more(&self) -> &Self {
        self.asked.borrow_mut().extend(self.table.keys().cloned());
        self
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

    /// Runs `read`, then reports every key that it did not read.
    pub(super) fn finish_with<T>(self, read: impl FnOnce(&Self) -> Option<T>) -> Option<T> {
        let value = read(&self);
        self.report_unknown();
        value
    }

    /// Reports every key that was not read.
    fn report_unknown(&self) {
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
    }

    fn field<'s>(&'s self, key: &str, required: bool) -> Field<'s, 'a> {
        self.asked.borrow_mut().insert(key.to_string());
        let node = self.table.get(key).filter(|node| node.value != Value::Nothing);
        Field { section: self, key: key.to_string(), node, required, example: None }
    }

    pub(super) fn name_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) }
    }

    pub(super) fn report(&self, column: String, row: Option<u64>, what: impl Into<String>, cure: impl Into<String>) {
        self.problems.borrow_mut().push(Problem::error(self.file, what, cure).at_row(row).in_column(column));
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
