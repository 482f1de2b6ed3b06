//! A named condition under which runs were recorded, and whether it explains how they differ.

use super::table::Row;
use crate::numerics::statistics::{chi_squared_tail, fisher_tail, student_t};
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

/// What a condition explains of the scatter of a quantity.
pub(super) struct Explained {
    /// Chance that a condition that does not matter explains as much.
    pub chance: f64,
    /// Chance that the intervals alone leave as much as it leaves.
    left_by_chance: f64,
    /// The change per unit with its 95 % half width; `None` of a condition in words.
    pub slope: Option<(f64, f64)>,
}

impl Explained {
    /// Whether it is one of `conditions` that may be named.
    ///
    /// A condition that matters leaves what the intervals claim; one that fits by accident leaves a part of whatever else scatters, and
    /// with few runs its share hardly shows which of the two it is. So a condition that leaves more than the intervals claim needs stronger
    /// evidence.
    pub fn is_cause(&self, conditions: usize) -> bool {
        /// The intervals leave as much less often than this: there is more.
        const MORE_LEFT: f64 = 0.01;
        /// False-alarm rate over all conditions, where nothing but the intervals makes the runs scatter.
        const ALL: f64 = 0.05;
        /// The same where the runs scatter by more than their intervals claim.
        const PART: f64 = 0.002;
        let allowed = if self.left_by_chance < MORE_LEFT { PART } else { ALL };
        self.chance < allowed / conditions as f64
    }
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

    /// What it explains of `q`; `None` where there are too few runs.
    ///
    /// Tested by Fisher's F against the scatter within equal conditions, which counts as no less than the intervals claim.
    pub fn explains(&self, known: &[Known], q: f64) -> Option<Explained> {
        let runs = known.len() as f64;
        let explained = |left: f64, over: f64, freedom: f64, slope| Explained {
            chance: fisher_tail((q - left) / over / (left.max(freedom) / freedom), over, freedom),
            left_by_chance: chi_squared_tail(left, freedom),
            slope,
        };
        match self {
            Self::Number(all) => {
                let weight = |se: f64| se.powi(-2);
                let total: f64 = known.iter().map(|(.., se)| weight(*se)).sum();
                let middle = known.iter().map(|(run, _, se)| weight(*se) * all[*run]).sum::<f64>() / total;
                let spread: f64 = known.iter().map(|(run, _, se)| weight(*se) * (all[*run] - middle).powi(2)).sum();
                let slope =
                    known.iter().map(|(run, x, se)| weight(*se) * (all[*run] - middle) * x).sum::<f64>() / spread;
                let (left, freedom) = (q - slope * slope * spread, runs - 2.0);
                let half = student_t(freedom) * (left.max(freedom) / freedom / spread).sqrt();
                (spread > 0.0 && freedom >= 1.0).then(|| explained(left, 1.0, freedom, Some((slope, half))))
            }
            Self::Word(all) => {
                let mut groups: BTreeMap<&str, Vec<Known>> = BTreeMap::new();
                known.iter().for_each(|one| groups.entry(all[one.0]).or_default().push(*one));
                let (over, freedom) = (groups.len() as f64 - 1.0, runs - groups.len() as f64);
                let left: f64 = groups.values().map(|group| about_mean(group).1).sum();
                (over >= 1.0 && freedom >= 1.0).then(|| explained(left, over, freedom, None))
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
