//! What stands out from a fleet: values far from where most campaigns are.

use super::table::{Row, parameter_names};
use crate::model::Status;
use crate::numerics::statistics::quantile;

/// Standard deviations, from the median's absolute deviation, beyond which a campaign stands out.
const FAR: f64 = 6.0;
/// The median absolute deviation of a normal distribution, in standard deviations.
const MAD_OF_NORMAL: f64 = 0.6745;
/// With fewer campaigns nothing can be said to stand out.
const FEW: usize = 8;
/// Figures looked at beside the parameters: known well even where parameters trade off.
const FIGURES: [&str; 5] = ["a_up_nm", "a_down_nm", "level_up_nm", "level_down_nm", "rmse_nm"];

/// A value that stands out from the fleet's.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Place of the campaign in `Fleet::rows`.
    pub row: usize,
    /// The parameter's dotted name, or the figure's.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The fleet's median.
    pub median: f64,
    /// How far it is from there, in standard deviations of the fleet's middle.
    pub deviations: f64,
}

/// What lies far from the middle of the fleet: parameters that are known by themselves, levels, and how well models predict.
pub(super) fn outliers(rows: &[Row]) -> Vec<Outlier> {
    let pinned = |row: &Row, name: &str| {
        let known = row.model.as_ref()?.confidence.get(name)?;
        row.value(name).filter(|_| known.status == Status::Pinned)
    };
    let figures = FIGURES.into_iter().map(|name| (name.to_string(), rows.iter().map(|row| row.figure(name)).collect()));
    let parameters = parameter_names().into_iter().map(|name| {
        let values = rows.iter().map(|row| pinned(row, &name)).collect();
        (name, values)
    });
    let mut found: Vec<Outlier> = figures.chain(parameters).flat_map(|(name, values)| far(&name, values)).collect();
    found.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    found
}

fn far(name: &str, values: Vec<Option<f64>>) -> Vec<Outlier> {
    let mut known: Vec<f64> = values.iter().flatten().copied().collect();
    if known.len() < FEW {
        return Vec::new();
    }
    let median = quantile(&mut known, 0.5);
    known.iter_mut().for_each(|value| *value = (*value - median).abs());
    let deviation = quantile(&mut known, 0.5) / MAD_OF_NORMAL;
    let one = |(row, value): (usize, Option<f64>)| {
        let value = value?;
        let deviations = (value - median) / deviation;
        (deviation > 0.0 && deviations.abs() > FAR).then(|| Outlier {
            row,
            name: name.to_string(),
            value,
            median,
            deviations,
        })
    };
    values.into_iter().enumerate().filter_map(one).collect()
}
