//! The causes that explain the recordings, separated from contact.
//!
//! A contact event that the model with its causes predicts was no contact: the search is then repeated with its samples back in.

use super::base::BaseModel;
use super::bootstrap::above;
use super::choose::{self, Choice, choose};
use super::contact_events::{self, ContactEvent};
use super::flexible;
use super::floor::{self, Floor};
use super::mask::Mask;
use super::oscillation::{Oscillation, without_oscillations};
use super::parameters;
use super::progress::Listener;
use crate::model::Model;
use std::sync::Arc;

/// Causes found, with what was set aside while they were sought.
#[derive(Debug)]
pub struct Explanation<'d> {
    /// The causes, over the rows that its mask counts.
    pub choice: Choice<'d>,
    /// The model that they make.
    pub after: Model,
    /// What it predicts, N m.
    pub after_nm: Vec<f64>,
    /// Its residual, N m.
    pub left_nm: Vec<f64>,
    /// The contact events: of those set aside, the ones that no model predicts.
    pub events: Vec<ContactEvent>,
    /// Where nothing is named: the oscillations of the residual.
    pub oscillations: Vec<Oscillation>,
    /// The residual without them, N m: they are no noise, though they do not repeat with the motion.
    quiet_nm: Vec<f64>,
}

/// The causes of the residual of `base` (`rest_nm` at every row), with `suspected` contact events set aside.
pub fn explain<'d>(
    base: &BaseModel<'d>,
    suspected: Vec<ContactEvent>,
    rest_nm: &[f64],
    listener: Listener<'_>,
) -> Explanation<'d> {
    let count = suspected.len();
    let of = |events: Vec<ContactEvent>| {
        Explanation::of(&base.mask.without(contact_events::rows(&events)), &base.model, events, rest_nm, listener)
    };
    let mut first = of(suspected);
    if first.events.len() < count {
        first = of(first.events);
    }
    if first.events.is_empty() {
        return first;
    }
    // Perhaps it was no contact at all, but a cause where it is strongest, hidden by what was set aside.
    let whole = Explanation::of(&base.mask, &base.model, first.events.clone(), rest_nm, listener);
    let most = base.data().policy.contact_needless_factor.powi(2);
    let is_cause = match first.choice.found.is_empty() {
        true => 2 * whole.events.len() <= first.events.len(),
        false => whole.choice.last.held_out_square() <= most * first.choice.last.held_out_square(),
    };
    if is_cause { whole.with_events(Vec::new()) } else { first }
}

impl<'d> Explanation<'d> {
    /// By a search over the rows of `mask`; of `events` those stay that it leaves unexplained.
    pub(super) fn of(
        mask: &Arc<Mask<'d>>,
        model: &Model,
        mut events: Vec<ContactEvent>,
        rest_nm: &[f64],
        listener: Listener<'_>,
    ) -> Self {
        let found = Self::of_choice(choose(mask, model, listener));
        contact_events::keep_unexplained(mask, &mut events, rest_nm, &found.left_nm);
        found.with_events(events)
    }

    /// By `choice`, without contact events.
    fn of_choice(choice: Choice<'d>) -> Self {
        let (after, data) = (parameters::settled(&choice), choice.last.mask.data);
        let after_nm = data.records.predicted_by(&after);
        let left_nm = data.residual_nm(&after_nm);
        let (quiet_nm, events, oscillations) = (left_nm.clone(), Vec::new(), Vec::new());
        Self { choice, after, after_nm, left_nm, events, oscillations, quiet_nm }
    }

    /// The same with `events`. Beside causes an oscillation may be misfit of their formulas.
    pub(super) fn with_events(mut self, events: Vec<ContactEvent>) -> Self {
        self.events = events;
        (self.oscillations, self.quiet_nm) = match self.is_bare() {
            true => without_oscillations(self.choice.last.mask.data, &self.left_nm),
            false => (Vec::new(), self.left_nm.clone()),
        };
        self
    }

    /// Whether nothing is named.
    fn is_bare(&self) -> bool {
        self.choice.found.is_empty() && self.events.is_empty()
    }

    /// The same without its causes, on which the share `agreement` of the resamples agreed.
    pub fn given_up(self, agreement: f64) -> Self {
        Self::of_choice(self.choice.given_up(agreement)).with_events(self.events)
    }

    /// Whether the search ended because nothing remained above its own floor, though above `floor` a further cause could stand.
    pub fn ended_early(&self, floor: &Floor) -> bool {
        let (choice, policy) = (&self.choice, &self.choice.last.mask.data.policy);
        let ended_at_floor = choice.refused.is_empty() && (1..choose::CAUSES_MAX).contains(&choice.found.len());
        let left_nm = above(choice.last.held_out_square(), floor.upper_square());
        ended_at_floor && floor.rms_nm < choice.last.mask.floor_nm && left_nm > policy.further_floors * floor.rms_nm
    }

    /// Whether it leaves less than `other` on the rows that each counts.
    pub fn leaves_less(&self, other: &Self) -> bool {
        self.choice.last.held_out_square() < other.choice.last.held_out_square()
    }

    /// The floor now that the causes are known; `columns` are those of the flexible fit.
    pub fn floor(&self, columns: &[Vec<f64>]) -> Floor {
        let mask = &self.choice.last.mask;
        let oscillating: f64 = self.oscillations.iter().map(|oscillation| oscillation.share).sum();
        let left_square = (1.0 - oscillating) * self.choice.last.held_out_square();
        let unpredicted_square = flexible::fit(mask, columns, &self.quiet_nm).held_out.min(left_square);
        floor::settled((mask, &self.after), &self.quiet_nm, (unpredicted_square, left_square), self.is_bare())
    }
}

#[cfg(test)]
mod tests {
    use super::Explanation;
    use crate::diagnose::base::BaseModel;
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::floor::{Floor, FloorSource};
    use crate::diagnose::mask::Mask;
    use crate::diagnose::perturbation::within_confidence;

    /// Above what the first cause leaves, below what the base does, N m.
    const HIGH_NM: f64 = 0.015;

    #[test]
    fn a_search_that_ended_at_its_floor_goes_on_only_above_a_lower_one() {
        let (data, model) = bundled();
        let mask = Mask::new(&data, data.scored(&model), HIGH_NM);
        let rest_nm = BaseModel::new(&mask, &model, within_confidence(&model)).residual_nm();
        let explanation = Explanation::of(&mask, &model, Vec::new(), &rest_nm, &|_| ());
        assert_eq!(explanation.choice.found.len(), 1);
        let goes_on = |floor_nm: f64| explanation.ended_early(&Floor::of_noise(floor_nm, FloorSource::Spectrum, 0.1));
        let left_nm = explanation.choice.last.held_out_square().sqrt();
        assert!(goes_on(0.001) && !goes_on(0.9 * left_nm) && !goes_on(HIGH_NM));
    }
}
