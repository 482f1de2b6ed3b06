//! What is known before causes are sought: the base model, the noise floor, what was contact, and what any function of the motion could explain.

use super::base::BaseModel;
use super::bootstrap::above;
use super::contact_events::{self, ContactEvent};
use super::criteria::Decision;
use super::data::DataSet;
use super::flexible::{self, Flexible};
use super::floor;
use super::mask::Mask;
use super::perturbation::within_confidence;
use super::progress::{Listener, Phase, Progress};
use super::ripple;
use crate::model::Model;

/// Where the search for causes begins.
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
        let mut base = base.above(floor::of_noise(&mask, &base_nm, f64::INFINITY).rms_nm);
        begins(Phase::ContactEvents);
        let rest_nm = base.residual_nm();
        let lines = [false, true].map(|by_direction| ripple::starts(&base, &rest_nm, by_direction));
        let columns = flexible::columns(&base, &lines.concat());
        let (mut events, mut flexible) = contact_events::find(&base, &columns, &rest_nm);
        let floor_nm = floor::of_noise(&mask, &base_nm, flexible.held_out).rms_nm.min(flexible.held_out.sqrt());
        if floor_nm < base.mask.floor_nm {
            base = base.above(floor_nm);
            (events, flexible) = contact_events::find(&base, &columns, &rest_nm);
        }
        Self { base, columns, rest_nm, events, flexible }
    }

    /// What of it is kept to compare other held-out units by.
    pub fn ceiling(&self) -> Ceiling {
        let Flexible { held_out, of, .. } = self.flexible;
        let floor_square = self.base.mask.floor_square();
        Ceiling { held_out, of, floor_square, unnamed_share: self.base.data().policy.unnamed_share }
    }
}

/// The rule of which units are held out.
pub const HELD_OUT: &str = "held out";

/// How much even the flexible fit leaves on held-out trials: no cause does well where it does not, however plain the law is on what was fitted.
pub struct Ceiling {
    /// Mean square that it leaves, and that there was, (N m)^2.
    held_out: f64,
    of: f64,
    /// The floor's square, (N m)^2.
    floor_square: f64,
    unnamed_share: f64,
}

impl Ceiling {
    /// What it leaves, against what causes may leave that name the gap, N m.
    pub fn on_trials(&self) -> Decision {
        let [value, limit] =
            [above(self.held_out, self.floor_square), self.unnamed_share * above(self.of, self.floor_square)];
        let outcome = if value > limit { "not foreseen" } else { "foreseen" };
        Decision { rule: HELD_OUT, subject: "trials", value, limit, outcome }
    }

    /// What the flexible fit of `opening` leaves on cycles, against half the mean square that it leaves on trials, N m.
    pub fn on_cycles(&self, opening: &Opening<'_>) -> Decision {
        let left = |held_out: f64| above(held_out, self.floor_square);
        let [value, limit] = [left(opening.flexible.held_out), left(self.held_out) / std::f64::consts::SQRT_2];
        let outcome = if value > limit { "not foreseen" } else { "foreseen" };
        Decision { rule: HELD_OUT, subject: "motion cycles", value, limit, outcome }
    }
}

#[cfg(test)]
mod tests {
    use super::Opening;
    use crate::diagnose::data::tests::bundled;

    #[test]
    fn cycles_foresee_an_offset_of_each_trial_that_trials_do_not() {
        let (mut data, model) = bundled();
        let offsets_nm = [0.05, -0.08, 0.11, -0.03, -0.1, 0.07, 0.02];
        for (range, offset_nm) in data.records.ranges.iter().zip(offsets_nm.iter().cycle()) {
            data.measured_nm[range.clone()].iter_mut().for_each(|y| *y += offset_nm);
        }
        let ceiling = Opening::of(&data, &model, &|_| ()).ceiling();
        assert_eq!(ceiling.on_trials().outcome, "not foreseen");
        let by_cycles = data.with_cycles_held_out().unwrap();
        let on_cycles = ceiling.on_cycles(&Opening::of(&by_cycles, &model, &|_| ()));
        assert!(on_cycles.value < 0.6 * on_cycles.limit, "{on_cycles:?}");
        assert!(by_cycles.with_cycles_held_out().is_none());
    }
}
