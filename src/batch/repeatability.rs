//! Several recordings of one joint under nominally the same conditions: which of its parameters, and of the functions of these, are
//! repeatable; which scatter more than their intervals claim; which depend on a named condition.
//!
//! Each run gives a value with its standard error s. With weights 1 / s^2, the sum of squares about their mean, Q, is chi squared with one
//! degree less than there are runs if the intervals account for the whole scatter (Cochran's Q). What exceeds it is a variance between runs
//! tau^2 by the method of moments of DerSimonian and Laird (Controlled Clinical Trials 7:177, 1986).

use super::condition::{Condition, Known, about_mean};
use super::quantities;
use super::table::Row;
use crate::model::Model;
use crate::numerics::statistics::{HALF_WIDTH, chi_squared_tail, mean, student_t};
use std::collections::BTreeMap;

/// Fewest runs that can be judged.
pub const RUNS_MIN: usize = 3;
/// Family-wise false-alarm rate: share of the joints whose intervals account for the whole scatter that have any quantity called otherwise.
const MORE_THAN_CLAIMED: f64 = 0.02;
/// Pairs that absorb each other are correlated over the runs by more than this ...
const ABSORBED: f64 = 0.9;
/// ... in at least this many runs.
const ABSORBED_RUNS: usize = 5;

/// Runs of one joint, judged.
#[derive(Debug, Clone)]
pub struct Repeatability {
    /// The joint's name.
    pub joint: String,
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Each parameter and function.
    pub quantities: Vec<Quantity>,
    /// Pairs of parameters that change against or with each other from run to run, with their correlation.
    pub absorbed: Vec<(String, String, f64)>,
}

/// One parameter or function over the runs.
#[derive(Debug, Clone)]
pub struct Quantity {
    /// Its dotted name, or the function's.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Value and standard error of each run; `None` where that run does not show it.
    pub values: Vec<Option<(f64, f64)>>,
    /// Weighted mean over the runs; NaN where fewer than two show it.
    pub mean: f64,
    /// Half width of a single run's 95 % interval as the runs claim it: the median.
    pub claimed: f64,
    /// The same as the scatter shows it; NaN where it is not identifiable.
    pub honest: f64,
    /// What can be said.
    pub verdict: Verdict,
}

/// What can be said of a quantity over the runs.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Its scatter is what its intervals claim.
    Repeatable,
    /// It scatters more than its intervals claim.
    Scatters,
    /// It follows a condition, by so much per unit of it or, of words, between its values.
    DependsOn {
        /// The condition's name.
        condition: String,
        /// The change per unit with its 95 % half width; `None` of a condition in words.
        slope: Option<(f64, f64)>,
    },
    /// Most runs do not show it.
    NotIdentifiable,
}

impl Verdict {
    /// The name used in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Repeatable => "repeatable",
            Self::Scatters => "scatters_more_than_claimed",
            Self::DependsOn { .. } => "depends_on_condition",
            Self::NotIdentifiable => "not_identifiable",
        }
    }
}

impl Repeatability {
    /// Of each joint of which `rows` hold enough runs.
    pub fn of(rows: &[Row]) -> Vec<Self> {
        let mut joints: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.model.is_some()) {
            joints.entry(row.joint()).or_default().push(row);
        }
        joints.into_iter().filter(|(_, of)| of.len() >= RUNS_MIN).map(|(joint, of)| Self::new(joint, &of)).collect()
    }

    fn new(joint: &str, rows: &[&Row]) -> Self {
        let models: Vec<&Model> = rows.iter().filter_map(|row| row.model.as_ref()).collect();
        let mut names: BTreeMap<&String, ()> = BTreeMap::new();
        rows.iter().for_each(|row| names.extend(row.entry.conditions.keys().map(|name| (name, ()))));
        let conditions: Vec<(&String, Condition)> =
            names.into_keys().filter_map(|name| Some((name, Condition::of(rows, name)?))).collect();
        let all = quantities::of(&models);
        let by_chance = MORE_THAN_CLAIMED / all.len() as f64;
        let quantities: Vec<Quantity> = all.into_iter().map(|of| Quantity::new(of, &conditions, by_chance)).collect();
        let absorbed = absorbed(&quantities);
        Self {
            joint: joint.to_string(),
            runs: rows.iter().map(|row| row.entry.name.clone()).collect(),
            quantities,
            absorbed,
        }
    }
}

impl Quantity {
    /// Of `of`, whose scatter is more than its intervals claim where chance would give it less often than `by_chance`.
    fn new(of: quantities::Quantity, conditions: &[(&String, Condition)], by_chance: f64) -> Self {
        let quantities::Quantity { name, unit, values } = of;
        let known: Vec<Known> =
            values.iter().enumerate().filter_map(|(run, value)| value.map(|(x, se)| (run, x, se))).collect();
        if known.len() < RUNS_MIN || 2 * known.len() <= values.len() {
            let nan = f64::NAN;
            return Self {
                name,
                unit,
                values,
                mean: nan,
                claimed: nan,
                honest: nan,
                verdict: Verdict::NotIdentifiable,
            };
        }
        let runs = known.len() as f64;
        let (mean, q) = about_mean(&known);
        let mut claimed: Vec<f64> = known.iter().map(|(.., se)| HALF_WIDTH * se).collect();
        claimed.sort_by(f64::total_cmp);
        let claimed = claimed[claimed.len() / 2];
        let excess = between(&known, q);
        let honest = if excess > 0.0 { claimed.hypot(student_t(runs - 1.0) * excess.sqrt()) } else { claimed };
        let scatters = chi_squared_tail(q, runs - 1.0) < by_chance;
        let explained = || {
            let fits = conditions.iter().filter_map(|(name, condition)| Some((name, condition.explains(&known, q)?)));
            fits.min_by(|a, b| a.1.chance.total_cmp(&b.1.chance))
        };
        let verdict = match scatters.then(explained).flatten() {
            Some((condition, explained)) if explained.is_cause(conditions.len()) => {
                Verdict::DependsOn { condition: condition.to_string(), slope: explained.slope }
            }
            _ if scatters => Verdict::Scatters,
            _ => Verdict::Repeatable,
        };
        Self { name, unit, values, mean, claimed, honest: if scatters { honest } else { claimed }, verdict }
    }

    /// By how much the honest interval is wider than the claimed one.
    pub fn wider(&self) -> f64 {
        self.honest / self.claimed
    }
}

/// Variance between runs beyond what their standard errors explain.
fn between(known: &[Known], q: f64) -> f64 {
    let weights: Vec<f64> = known.iter().map(|(.., se)| se.powi(-2)).collect();
    let total: f64 = weights.iter().sum();
    let scale = total - weights.iter().map(|w| w * w).sum::<f64>() / total;
    ((q - (known.len() as f64 - 1.0)) / scale).max(0.0)
}

/// Pairs of parameters that scatter together.
fn absorbed(quantities: &[Quantity]) -> Vec<(String, String, f64)> {
    let is_parameter = |quantity: &&Quantity| quantity.name.contains('.') && !quantity.name.starts_with("B(");
    let parameters: Vec<&Quantity> = quantities.iter().filter(is_parameter).collect();
    let mut pairs = Vec::new();
    for (i, a) in parameters.iter().enumerate() {
        for b in &parameters[i + 1..] {
            let both: Vec<(f64, f64)> =
                a.values.iter().zip(&b.values).filter_map(|(a, b)| Some((a.as_ref()?.0, b.as_ref()?.0))).collect();
            let r = correlation(&both);
            if both.len() >= ABSORBED_RUNS && r.abs() > ABSORBED {
                pairs.push((a.name.clone(), b.name.clone(), r));
            }
        }
    }
    pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    pairs
}

/// Pearson's correlation.
fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let (xs, ys): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let (x, y) = (mean(&xs), mean(&ys));
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let product = sum(&|p| (p.0 - x) * (p.1 - y));
    product / (sum(&|p| (p.0 - x).powi(2)) * sum(&|p| (p.1 - y).powi(2))).sqrt()
}
