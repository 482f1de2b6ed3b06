//! A named condition under which runs were recorded, and whether it explains how they differ.

use super::table::Row;
use crate::numerics::statistics::{fisher_tail, student_t};
use std::collections::BTreeMap;

/// A run's place, what it found, and the standard error of that.
pub(super) type Known = (usize, f64, f64);

/// A condition of the runs.
pub(super) enum Condition<'a> {
    /// A number for each run.
    Number(Vec<f64>),
    /// A word for each run.
    Word(Vec<&'a str>),
}

impl<'a> Condition<'a> {
    /// The condition called `name` of every run; `None` where one does not tell it, or all are the same.
    pub fn of(rows: &[&'a Row], name: &str) -> Option<Self> {
        let texts: Option<Vec<&str>> =
            rows.iter().map(|row| row.entry.conditions.get(name).map(String::as_str)).collect();
        let texts = texts.filter(|texts| texts.iter().any(|text| *text != texts[0]))?;
        let numbers: std::result::Result<Vec<f64>, _> = texts.iter().map(|text| text.parse::<f64>()).collect();
        Some(numbers.map_or(Self::Word(texts), Self::Number))
    }

    /// Chance that a condition that does not matter would explain as much of `q`, and the slope with its half width.
    ///
    /// The scatter within equal conditions judges, by Fisher's F, but counts as no less than the intervals claim.
    pub fn explains(&self, known: &[Known], q: f64) -> Option<(f64, Option<(f64, f64)>)> {
        let runs = known.len() as f64;
        match self {
            Self::Number(all) => {
                let weight = |se: f64| se.powi(-2);
                let total: f64 = known.iter().map(|(.., se)| weight(*se)).sum();
                let middle = known.iter().map(|(run, _, se)| weight(*se) * all[*run]).sum::<f64>() / total;
                let spread: f64 = known.iter().map(|(run, _, se)| weight(*se) * (all[*run] - middle).powi(2)).sum();
                let slope =
                    known.iter().map(|(run, x, se)| weight(*se) * (all[*run] - middle) * x).sum::<f64>() / spread;
                let gained = slope * slope * spread;
                let freedom = runs - 2.0;
                let left = (q - gained).max(freedom);
                let chance = if freedom >= 1.0 { fisher_tail(gained / (left / freedom), 1.0, freedom) } else { 1.0 };
                let half = student_t(freedom) * (left / freedom / spread).sqrt();
                (spread > 0.0).then_some((chance, Some((slope, half))))
            }
            Self::Word(all) => {
                let mut groups: BTreeMap<&str, Vec<Known>> = BTreeMap::new();
                known.iter().for_each(|one| groups.entry(all[one.0]).or_default().push(*one));
                let (over, freedom) = (groups.len() as f64 - 1.0, runs - groups.len() as f64);
                let within: f64 = groups.values().map(|group| about_mean(group).1).sum();
                let left = within.max(freedom);
                let enough = over >= 1.0 && freedom >= 1.0;
                enough.then(|| (fisher_tail((q - within) / over / (left / freedom), over, freedom), None))
            }
        }
    }
}

/// Weighted mean and Cochran's Q.
pub(super) fn about_mean(known: &[Known]) -> (f64, f64) {
    let weight: f64 = known.iter().map(|(.., se)| se.powi(-2)).sum();
    let mean = known.iter().map(|(_, x, se)| x * se.powi(-2)).sum::<f64>() / weight;
    (mean, known.iter().map(|(_, x, se)| ((x - mean) / se).powi(2)).sum())
}
