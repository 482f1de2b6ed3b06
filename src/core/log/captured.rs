//! What a live recording says of a trial beside its log.

use crate::document::Section;
use crate::problem::visible;
use toml::Value;

/// How the recording of a trial went.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Captured {
    /// Why it broke off, where it did: its log then ends early, perhaps within a row.
    pub incomplete: Option<String>,
    /// Cycles that began late.
    pub late_cycles: u32,
    /// Cycles that brought no sample.
    pub missed_cycles: u32,
}

impl Captured {
    /// Reads the keys of a trial; nothing where it has none of them.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let count = |key: &str| section.may(key).whole(0, u32::MAX.into());
        let incomplete = section.may("incomplete").such_as("\"power cut\"", "why it broke off").text();
        let (late, missed) = (count("late_cycles"), count("missed_cycles"));
        let is_captured = incomplete.is_some() || late.is_some() || missed.is_some();
        let number = |count: Option<i64>| count.and_then(|count| u32::try_from(count).ok()).unwrap_or(0);
        is_captured.then(|| Self { incomplete, late_cycles: number(late), missed_cycles: number(missed) })
    }

    /// The keys of its trial.
    pub(super) fn pairs(&self) -> Vec<(&'static str, Value)> {
        let incomplete = self.incomplete.as_ref().map(|why| ("incomplete", visible(why).into_owned().into()));
        let counts = [("late_cycles", self.late_cycles), ("missed_cycles", self.missed_cycles)];
        incomplete.into_iter().chain(counts.map(|(key, count)| (key, i64::from(count).into()))).collect()
    }
}
