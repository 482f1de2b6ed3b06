//! The recordings as models are compared with them: read once, never changed.

use super::extent;
use super::folds::Folds;
use super::policy::Policy;
use super::progress::Listener;
use super::records::Records;
use crate::effects::Extent;
use crate::log::Campaign;
use crate::model::{Combination, Model};
use crate::problem::Result;
use std::sync::Arc;

/// What does not change while causes are sought.
#[derive(Debug)]
pub struct DataSet {
    /// The recordings, thinned.
    pub records: Arc<Records>,
    /// Measured y at the rows, N m.
    pub measured_nm: Vec<f64>,
    /// The motions without their encoder, and as it would have read them once more with what a joint like the model would have shown.
    again: Option<(Arc<Records>, Box<DataSet>)>,
    /// Units of resampling, and the folds that are held out.
    pub folds: Folds,
    /// Over what range the campaign moves.
    pub extent: Extent,
    /// The thresholds by which is decided.
    pub policy: Policy,
    /// How many effects the model as delivered has: they come first in every model of a search.
    pub delivered: usize,
}

impl DataSet {
    /// Reads the trials of `campaign`, to be judged by `policy`; `listener` hears of each.
    ///
    /// Errors: as [`Records::read`].
    pub fn read(campaign: &Campaign, model: &Model, policy: &Policy, listener: Listener<'_>) -> Result<Self> {
        let (records, beside) = Records::read(campaign, model, listener)?;
        let (measured_nm, folds) = (records.measured_nm(), Folds::new(&records));
        let (extent, delivered) = (extent::of(&records, campaign, model), model.effects.len());
        let again = beside.map(|(smooth, records)| {
            let (folds, extent, policy) = (folds.clone(), extent.clone(), policy.clone());
            let measured_nm = smooth.predicted_by(model);
            (
                Arc::new(smooth),
                Box::new(Self {
                    records: Arc::new(records),
                    measured_nm,
                    again: None,
                    folds,
                    extent,
                    policy,
                    delivered,
                }),
            )
        });
        let (records, policy) = (Arc::new(records), policy.clone());
        Ok(Self { records, measured_nm, again, folds, extent, policy, delivered })
    }

    /// The same with motion cycles held out; nothing where they are already.
    pub fn with_cycles_held_out(&self) -> Option<Self> {
        let folds = self.folds.of_cycles(&self.records)?;
        let with = |data: &Self, again| Self {
            records: data.records.clone(),
            measured_nm: data.measured_nm.clone(),
            again,
            folds: folds.clone(),
            extent: data.extent.clone(),
            policy: data.policy.clone(),
            delivered: data.delivered,
        };
        let again = self.again.as_ref().map(|(smooth, again)| (smooth.clone(), Box::new(with(again, None))));
        Some(with(self, again))
    }

    /// The motions as the encoder would have read them once more, with what a joint like the model would have shown.
    pub fn again(&self) -> Option<&Self> {
        self.again.as_ref().map(|(_, again)| again.as_ref())
    }

    /// One simulation of the residual that the encoder alone causes at the rows, on a joint exactly like `model`, N m.
    pub fn encoder_nm(&self, model: &Model) -> Vec<f64> {
        let Some((smooth, again)) = &self.again else { return vec![0.0; self.measured_nm.len()] };
        let (true_nm, predicted_nm) = (smooth.predicted_by(model), again.records.predicted_by(model));
        true_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect()
    }

    /// The rows on which `model` can be scored: friction that jumps at a reversal is undetermined at rest, and around a rest before a turn.
    pub fn scored(&self, model: &Model) -> Vec<bool> {
        let jumps = model.combination == Combination::Sign || model.joint.backlash_m == 0.0;
        self.records.rows(|record, i| !(jumps && (record.rests[i] || record.before_turn[i])))
    }

    /// Measured less `predicted_nm`, N m.
    pub fn residual_nm(&self, predicted_nm: &[f64]) -> Vec<f64> {
        self.measured_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect()
    }
}

#[cfg(test)]
pub mod tests {
    use super::{DataSet, Policy};
    use crate::log::Campaign;
    use crate::model::Model;
    use std::path::Path;

    /// The bundled recording of a surgical tool with a model that lacks its transition.
    pub fn bundled() -> (DataSet, Model) {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/davinci_l4"));
        let campaign = Campaign::read(folder).unwrap();
        let model = Model::read(&folder.join("base_model.json")).unwrap();
        (DataSet::read(&campaign, &model, &Policy::default(), &|_| ()).unwrap(), model)
    }
}
