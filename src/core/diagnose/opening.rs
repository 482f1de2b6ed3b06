//! What is known before causes are sought: the base model, the noise floor, what was contact, and what any function of the motion could explain.

use super::base::BaseModel;
use super::contact_events::{self, ContactEvent};
use super::data::DataSet;
use super::flexible::{self, Flexible};
use super::floor;
use super::mask::Mask;
use super::perturbation::within_confidence;
use super::progress::{Listener, Phase, Progress};
use super::ripple;
use crate::model::Model;

/// Where the search for causes begins.
#[derive(Clone)]
pub struct Opening<'d> {
    /// The model as delivered, above the noise floor.
    pub base: BaseModel<'d>,
    /// The columns of flexible fits.
    pub columns: Vec<Vec<f64>>,
    /// What the base leaves at every row, N m.
    pub rest_nm: Vec<f64>,
    /// Contact events.
    pub events: Vec<ContactEvent>,
    /// What any function of the recorded quantities explains without them: the ceiling for causes.
    pub flexible: Flexible,
}

impl<'d> Opening<'d> {
    /// Of `model` on `data`; `listener` hears what it is at.
    pub fn of(data: &'d DataSet, model: &Model, listener: Listener<'_>) -> Self {
        let begins = |phase| listener(Progress::Begins(phase));
        let mask = Mask::new(data, data.scored(model), 0.0);
        begins(Phase::NoiseFloor);
        let base = BaseModel::new(&mask, model, within_confidence(model));
        let base_nm = base.residual_nm();
        let base = base.above(floor::of_noise(&mask, &base_nm, f64::INFINITY).rms_nm);
        begins(Phase::ContactEvents);
        let rest_nm = base.residual_nm();
        let lines = [false, true].map(|by_direction| ripple::lines(&base, &rest_nm, by_direction));
        let columns = flexible::columns(&base, &lines.concat());
        let (events, flexible) = contact_events::find(&base, &columns, &rest_nm);
        let floor_nm = floor::of_noise(&mask, &base_nm, flexible.held_out).rms_nm.min(flexible.held_out.sqrt());
        let opening = Self { base, columns, rest_nm, events, flexible };
        if floor_nm < opening.base.mask.floor_nm { opening.above(floor_nm) } else { opening }
    }

    /// The same above another floor.
    pub fn above(self, floor_nm: f64) -> Self {
        let base = self.base.above(floor_nm);
        let (events, flexible) = contact_events::find(&base, &self.columns, &self.rest_nm);
        Self { base, events, flexible, ..self }
    }
}
