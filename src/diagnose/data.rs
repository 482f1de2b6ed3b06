//! The recordings as models are compared with them: read once, never changed.

use super::extent;
use super::folds::Folds;
use super::record::Records;
use crate::effects::Extent;
use crate::log::Campaign;
use crate::model::{Combination, Model};
use crate::problem::Result;

/// What does not change while causes are sought.
#[derive(Debug)]
pub struct DataSet {
    /// The recordings, thinned.
    pub records: Records,
    /// Measured y at the rows, N m.
    pub measured_nm: Vec<f64>,
    /// Units of resampling, and the folds that are held out.
    pub folds: Folds,
    /// Over what range the campaign moves.
    pub extent: Extent,
}

impl DataSet {
    /// Reads the trials of `campaign`; `progress` hears of each.
    ///
    /// Errors: as [`Records::read`].
    pub fn read(campaign: &Campaign, model: &Model, progress: &(dyn Fn() + Sync)) -> Result<Self> {
        let records = Records::read(campaign, model, progress)?;
        let (measured_nm, folds) = (records.measured_nm(), Folds::new(&records));
        let extent = extent::of(&records, model);
        Ok(Self { records, measured_nm, folds, extent })
    }

    /// The rows on which `model` can be scored: friction that jumps at a reversal is undetermined at rest.
    pub fn scored(&self, model: &Model) -> Vec<bool> {
        let jumps = model.combination == Combination::Sign;
        self.records.rows(|record, i| !(jumps && record.rests[i]))
    }

    /// Measured less `predicted_nm`, N m.
    pub fn residual_nm(&self, predicted_nm: &[f64]) -> Vec<f64> {
        self.measured_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect()
    }
}

#[cfg(test)]
pub mod tests {
    use super::DataSet;
    use crate::log::Campaign;
    use crate::model::Model;
    use std::path::Path;

    /// The bundled recording of a surgical tool with a model that lacks its transition.
    pub fn bundled() -> (DataSet, Model) {
        let campaign = Campaign::read(Path::new("data/davinci_l4")).unwrap();
        let model = Model::read(Path::new("data/davinci_l4/base_model.json")).unwrap();
        (DataSet::read(&campaign, &model, &|| ()).unwrap(), model)
    }
}
