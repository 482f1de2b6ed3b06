//! A gap that no cause names on held-out trials, looked at again on held-out motion cycles: a zero that wanders is not foreseen on a whole trial.

use super::bootstrap::above;
use super::criteria::Decision;
use super::data::DataSet;
use super::flexible::Flexible;
use super::opening::Opening;
use super::progress::{Listener, Phase, Progress};
use super::{Diagnosis, Kind, explained};
use crate::log::Campaign;
use crate::model::Model;

/// Warning where a cause of time was found on motion cycles, nothing on trials.
const WANDERS: &str = "on held-out trials no cause names the gap, which changes from trial to trial; the verdict is on held-out motion cycles, \
                       with the rest of their trials fitted: it tells what happened in these trials, not what will happen in another";

/// The rule of which units are held out.
const HELD_OUT: &str = "held out";

/// Looks again with motion cycles held out in the place of trials, of which not even the `ceiling` foresees enough: `found`, an unknown gap, becomes
/// what is found so if that begins with a cause of time. A law of the motion would be foreseen on whole trials, too.
pub fn look_again(
    found: &mut Diagnosis,
    ceiling: &Ceiling,
    data: &DataSet,
    (campaign, model): (&Campaign, &Model),
    listener: Listener<'_>,
) {
    let on_trials = ceiling.on_trials();
    let is_foreseen = on_trials.value <= on_trials.limit;
    found.verdict.decisions.push(on_trials);
    let Some(data) = (!is_foreseen).then(|| data.with_cycles_held_out()).flatten() else { return };
    listener(Progress::Begins(Phase::MotionCycles));
    let opening = Opening::of(&data, model, listener);
    let on_cycles = ceiling.on_cycles(&opening);
    let is_foreseen = on_cycles.value <= on_cycles.limit;
    found.verdict.decisions.push(on_cycles);
    if !is_foreseen {
        return;
    }
    let mut again = explained(opening, (campaign, model), listener);
    if again.verdict.effects.first().is_some_and(|cause| cause.is_of_time()) && again.verdict.kind != Kind::Unknown {
        let held_out = found.verdict.decisions.drain(..).filter(|decision| decision.rule == HELD_OUT);
        again.verdict.decisions.extend(held_out);
        again.warnings.push(WANDERS.to_string());
        *found = again;
    }
}

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
    /// Of `opening`, with trials held out.
    pub fn of(opening: &Opening<'_>) -> Self {
        let Flexible { held_out, of, .. } = opening.flexible;
        let mask = &opening.base.mask;
        Self { held_out, of, floor_square: mask.floor_square(), unnamed_share: mask.data.policy.unnamed_share }
    }

    /// What it leaves, against what causes may leave that name the gap, N m.
    fn on_trials(&self) -> Decision {
        let [value, limit] =
            [above(self.held_out, self.floor_square), self.unnamed_share * above(self.of, self.floor_square)];
        let outcome = if value > limit { "not foreseen" } else { "foreseen" };
        Decision { rule: HELD_OUT, subject: "trials", value, limit, outcome }
    }

    /// What the flexible fit of `opening` leaves on cycles, against half the mean square that it leaves on trials, N m.
    fn on_cycles(&self, opening: &Opening<'_>) -> Decision {
        let left = |held_out: f64| above(held_out, self.floor_square);
        let [value, limit] = [left(opening.flexible.held_out), left(self.held_out) / std::f64::consts::SQRT_2];
        let outcome = if value > limit { "not foreseen" } else { "foreseen" };
        Decision { rule: HELD_OUT, subject: "motion cycles", value, limit, outcome }
    }
}

#[cfg(test)]
mod tests {
    use super::{Ceiling, Opening};
    use crate::diagnose::data::tests::bundled;

    #[test]
    fn cycles_foresee_an_offset_of_each_trial_that_trials_do_not() {
        let (mut data, model) = bundled();
        let offsets_nm = [0.05, -0.08, 0.11, -0.03, -0.1, 0.07, 0.02];
        for (range, offset_nm) in data.records.ranges.iter().zip(offsets_nm.iter().cycle()) {
            data.measured_nm[range.clone()].iter_mut().for_each(|y| *y += offset_nm);
        }
        let ceiling = Ceiling::of(&Opening::of(&data, &model, &|_| ()));
        assert_eq!(ceiling.on_trials().outcome, "not foreseen");
        let by_cycles = data.with_cycles_held_out().unwrap();
        let on_cycles = ceiling.on_cycles(&Opening::of(&by_cycles, &model, &|_| ()));
        assert!(on_cycles.value < 0.6 * on_cycles.limit, "{on_cycles:?}");
        assert!(by_cycles.with_cycles_held_out().is_none());
    }
}
