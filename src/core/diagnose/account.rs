//! The results of an explanation: gap, budget, places, candidates, contacts, series.

use super::answer::Kind;
use super::base::BaseModel;
use super::bootstrap::{Resamples, above};
use super::candidates::{Cause, FittedCause};
use super::contact_events::{self, ContactEvent};
use super::explain::Explanation;
use super::flexible::Flexible;
use super::floor::Floor;
use super::locate::{self, Place};
use super::mask::Mask;
use super::oscillation::Oscillation;
use super::parameters::{self, Fitted};
use super::record::Record;
use super::verdict::{Evidence, Verdict, signature};
use super::{Budget, Candidate, Contact, Gap, View};
use crate::effects::Region;
use std::ops::Range;

/// The explanation of a base model's residual, and the evidence for it.
pub struct Account<'a, 'd> {
    /// The model as delivered, over all rows that are scored.
    base: &'a BaseModel<'d>,
    explanation: &'a Explanation<'d>,
    /// What the verdict is drawn from.
    pub evidence: Evidence<'a>,
}

/// A set of rows.
#[derive(Clone, Copy, PartialEq)]
enum Rows {
    Unscored,
    /// Counted by the search.
    Counted,
    /// Set aside as contact, and left unexplained.
    Contact,
    /// Set aside, but predicted by the model that was fitted without them.
    Predicted,
}

impl<'a, 'd> Account<'a, 'd> {
    /// Of `explanation`, above `floor`.
    pub fn new(
        base: &'a BaseModel<'d>,
        explanation: &'a Explanation<'d>,
        resamples: &'a Resamples,
        floor: &Floor,
    ) -> Self {
        let evidence = evidence(&base.mask, explanation, resamples, floor);
        Self { base, explanation, evidence }
    }

    /// How large the gap is above `floor`; `flexible` is the fit of the ceiling.
    pub fn gap(&self, floor: Floor, flexible: &Flexible) -> Gap {
        let delivered = self.mean(&self.evidence.delivered);
        let least = flexible.held_out.min(self.mean(&self.evidence.last)).max(floor.upper_square());
        Gap {
            rmse_nm: delivered.sqrt(),
            explainable_nm: above(delivered, floor.rms_nm * floor.rms_nm),
            recoverable_nm: above(delivered, least),
            floor,
        }
    }

    /// What the mean square is made of.
    pub fn budget(&self) -> Budget {
        let (evidence, choice) = (&self.evidence, &self.explanation.choice);
        let (delivered, rest, last) =
            (self.mean(&evidence.delivered), self.mean(&evidence.rest), self.mean(&evidence.last));
        let floor = evidence.floor_square.min(delivered);
        let gain = |without: f64| (without - choice.last.score()).max(0.0);
        let mut weights: Vec<(Cause, f64)> =
            choice.found.iter().map(|found| (found.cause, gain(found.without))).collect();
        if evidence.contact {
            weights.push((Cause::CONTACT, (rest - self.mean(&choice.rest.held_out)).max(0.0)));
        }
        let explained = (rest - last).max(0.0).min(delivered - floor);
        let whole: f64 = weights.iter().map(|(_, w)| w).sum::<f64>().max(f64::MIN_POSITIVE);
        let causes: Vec<(Cause, f64)> = weights.into_iter().map(|(cause, w)| (cause, explained * w / whole)).collect();
        let named: f64 = causes.iter().map(|(_, share)| share).sum();
        let unexplained = (last - floor).clamp(0.0, (delivered - floor - named).max(0.0));
        Budget { floor, within_confidence: (delivered - floor - named - unexplained).max(0.0), causes, unexplained }
    }

    /// Where the gap lies; a cause that was found stands in its own region with what it explains.
    pub fn places(&self, verdict: &Verdict) -> Vec<Place> {
        let delivered_nm = self.base.data().residual_nm(&self.base.predicted_nm);
        let mut places = self.located(&delivered_nm);
        if !matches!(verdict.kind, Kind::None | Kind::Unknown) {
            let budget = self.budget();
            let causes: f64 = budget.causes.iter().map(|(_, share)| share).sum();
            let whole = causes + budget.unexplained + budget.within_confidence;
            let rmse_nm = self.mean(&self.evidence.delivered).sqrt();
            for (cause, share) in budget.causes {
                let found = self.explanation.choice.found.iter().find(|found| found.cause == cause);
                let region = signature(cause, found.map_or("", |found| found.how));
                locate::credit(&mut places, region, share / whole.max(f64::MIN_POSITIVE), (cause.name(), rmse_nm));
            }
        }
        places
    }

    /// Where what the causes leave lies.
    pub fn remainder(&self) -> Vec<Place> {
        self.located(&self.explanation.left_nm)
    }

    /// Where `residual_nm` lies, its oscillations first: the torque read holds them, too, so that they seem to go with the load.
    fn located(&self, residual_nm: &[f64]) -> Vec<Place> {
        let Explanation { events, oscillations, .. } = self.explanation;
        let mut places = locate::locate(self.base, residual_nm, events);
        let at_frequency = |oscillation: &Oscillation| Place {
            region: Region::Frequency,
            detail: format!("oscillation of {:.2} Hz", oscillation.frequency_hz),
            share_of_gap: oscillation.share,
            share_of_samples: 1.0,
            rmse_nm: locate::rms(residual_nm.iter().copied()),
        };
        let told = oscillations.iter().filter(|oscillation| oscillation.share >= locate::SHARE_MIN);
        places.splice(0..0, told.map(at_frequency));
        places
    }

    /// Every candidate, those taken first, then by score.
    pub fn candidates(&self) -> Vec<Candidate> {
        let choice = &self.explanation.choice;
        let mut all: Vec<Candidate> = Vec::new();
        for found in &choice.found {
            let taken = FittedCause { cause: found.cause, how: found.how, fit: choice.last.clone() };
            all.push(Candidate { trades_with: found.rivals.clone(), taken: true, ..self.candidate(&taken) });
        }
        // In the place of a named cause first: beside all of them anything does as well as they do.
        let in_place = choice.found.iter().flat_map(|found| &found.tried).map(|tried| (tried, false));
        let beside = choice.refused.iter().map(|tried| (tried, !choice.found.is_empty()));
        let mut others: Vec<(&FittedCause<'_>, bool)> = in_place.chain(beside).collect();
        others.sort_by(|(a, a_beside), (b, b_beside)| a_beside.cmp(b_beside).then(a.score().total_cmp(&b.score())));
        let mut known: Vec<Cause> = all.iter().map(|candidate| candidate.cause).collect();
        others.retain(|(tried, _)| {
            let is_new = !known.contains(&tried.cause);
            known.push(tried.cause);
            is_new
        });
        others.sort_by(|(a, _), (b, _)| a.score().total_cmp(&b.score()));
        all.extend(others.into_iter().map(|(tried, beside)| Candidate { beside, ..self.candidate(tried) }));
        all
    }

    fn candidate(&self, tried: &FittedCause<'_>) -> Candidate {
        let (evidence, last) = (&self.evidence, &self.explanation.choice.last);
        let set_aside = evidence.last.iter().zip(&last.held_out).map(|(all, held_out)| all - held_out);
        let left: Vec<f64> = tried.fit.held_out.iter().zip(set_aside).map(|(a, b)| a + b).collect();
        let parameters: Vec<Fitted> = parameters::of_cause(evidence.resamples, &tried.fit, (tried.cause, tried.how));
        Candidate {
            cause: tried.cause,
            how: tried.how,
            held_out_rmse_nm: self.mean(&left).sqrt(),
            shrink: evidence.shrink(&left, tried.fit.numbers()),
            parameters,
            trades_with: Vec::new(),
            taken: false,
            beside: false,
            settled: tried.fit.converged,
        }
    }

    /// Stretches of contact.
    pub fn contacts(&self) -> Vec<Contact> {
        let records = &self.base.data().records;
        let contact = |event: &ContactEvent| {
            let (record, range) = (&records.all[event.record], &records.ranges[event.record]);
            let time_s = |row: usize| record.time_s[record.rows[row - range.start]];
            let last = event.rows.end.max(event.rows.start + 1) - 1;
            Contact {
                file: record.file.clone(),
                from_s: time_s(event.rows.start),
                to_s: time_s(last),
                peak_nm: event.peak_nm,
            }
        };
        self.explanation.events.iter().map(contact).collect()
    }

    /// Every trial's series.
    pub fn views(&self) -> Vec<View> {
        let data = self.base.data();
        let view = |(record, range): (&Record, &Range<usize>)| {
            let at = |of: &dyn Fn(usize) -> f64| record.rows.iter().map(|i| of(*i)).collect::<Vec<f64>>();
            View {
                file: record.file.clone(),
                time_s: at(&|i| record.time_s[i]),
                position_rad: at(&|i| record.own[i].position),
                velocity_rad_s: at(&|i| record.own[i].velocity),
                measured_nm: data.measured_nm[range.clone()].to_vec(),
                before_nm: self.base.predicted_nm[range.clone()].to_vec(),
                after_nm: self.explanation.after_nm[range.clone()].to_vec(),
                judged: range.clone().map(|i| self.base.mask.counts(i)).collect(),
                clipped: record.rows.iter().map(|i| record.clipped[*i]).collect(),
            }
        };
        data.records.all.iter().zip(&data.records.ranges).map(view).collect()
    }

    /// Mean over all scored rows of what has `squares` in each unit.
    fn mean(&self, squares: &[f64]) -> f64 {
        squares.iter().sum::<f64>() / self.evidence.rows.iter().sum::<f64>().max(1.0)
    }
}

/// Squares left in each unit over all rows that `scored` counts, those set aside by the search put back.
fn evidence<'a>(
    scored: &Mask<'a>,
    explanation: &'a Explanation<'_>,
    resamples: &'a Resamples,
    floor: &Floor,
) -> Evidence<'a> {
    let (data, choice, left_nm) = (scored.data, &explanation.choice, &explanation.left_nm);
    let policy = &data.policy;
    let rows = rows(scored, explanation);
    let of_units = |set: &dyn Fn(Rows) -> bool, of: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let in_unit = |unit: &Range<usize>| unit.clone().filter(|i| set(rows[*i])).map(of).sum();
        data.folds.units.iter().map(in_unit).collect()
    };
    let delivered_nm = data.residual_nm(&choice.base.predicted_nm);
    let rest_nm = choice.base.residual_nm();
    let is_aside = |set: Rows| matches!(set, Rows::Contact | Rows::Predicted);
    let contact_nm2 = of_units(&|set| set == Rows::Contact, &|i| rest_nm[i] * rest_nm[i]);
    let contact_rows = of_units(&|set| set == Rows::Contact, &|_| 1.0);
    let all_rows = of_units(&|set| set != Rows::Unscored, &|_| 1.0);
    let floor_square = floor.rms_nm * floor.rms_nm;
    let whole = |of_units: &[f64]| of_units.iter().sum::<f64>();
    let excess = whole(&contact_nm2) - whole(&contact_rows) * floor_square;
    let noise_square = (floor_square - floor.encoder_nm.powi(2)).max(0.0);
    let (of_noise, of_encoder) = (policy.contact_floors.powi(2), policy.contact_encoder_share.powi(2));
    let hidden_square = of_noise * noise_square + of_encoder * floor.encoder_nm.powi(2);
    let is_large = excess > whole(&all_rows) * hidden_square;
    let contact = is_large && !contact_events::ring(policy, &explanation.events, left_nm);
    let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<f64>>();
    // What was set aside and is predicted nevertheless was held out in the strictest sense.
    let predicted = of_units(&|set| set == Rows::Predicted, &|i| left_nm[i] * left_nm[i]);
    let explained: Vec<f64> = contact_rows.iter().map(|n| n * floor_square).collect();
    let left_aside = add(&predicted, if contact { &explained } else { &contact_nm2 });
    Evidence {
        policy,
        rest: add(&choice.rest.held_out, &of_units(&is_aside, &|i| rest_nm[i] * rest_nm[i])),
        last: add(&choice.last.held_out, &left_aside),
        delivered: of_units(&|set| set != Rows::Unscored, &|i| delivered_nm[i] * delivered_nm[i]),
        rows: all_rows,
        contact,
        resamples,
        floor_square: floor.upper_square(),
        quick_square: floor.quick_upper_square(),
        found_again_nm: floor.found_again_nm,
        differing: floor.differing,
        oscillations: &explanation.oscillations,
        own_square: choice.base.model.own_rmse_nm.unwrap_or_default().powi(2),
        numbers: choice.last.numbers(),
    }
}

/// What became of each row.
fn rows(scored: &Mask<'_>, explanation: &Explanation<'_>) -> Vec<Rows> {
    let searched = &explanation.choice.last.mask;
    let of = |i: usize| match (scored.counts(i), searched.counts(i)) {
        (false, _) => Rows::Unscored,
        (true, true) => Rows::Counted,
        (true, false) => Rows::Predicted,
    };
    let mut rows: Vec<Rows> = (0..scored.data.measured_nm.len()).map(of).collect();
    for row in explanation.events.iter().flat_map(|event| event.rows.clone()) {
        if rows[row] == Rows::Predicted {
            rows[row] = Rows::Contact;
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::{Account, Rows, rows};
    use crate::diagnose::base::BaseModel;
    use crate::diagnose::bootstrap::Resamples;
    use crate::diagnose::contact_events::{self, ContactEvent};
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::explain::Explanation;
    use crate::diagnose::floor::{Floor, FloorSource};
    use crate::diagnose::mask::Mask;
    use crate::diagnose::perturbation::within_confidence;

    /// So high that no cause is searched for, N m.
    const FLOOR_NM: f64 = 1.0;

    #[test]
    fn every_row_that_is_counted_has_its_square() {
        let (data, model) = bundled();
        let base = BaseModel::new(&Mask::new(&data, data.scored(&model), FLOOR_NM), &model, within_confidence(&model));
        let rest_nm = base.residual_nm();
        let events =
            [500..900, 2000..2100].map(|rows| ContactEvent { rows, record: 0, peak_nm: 1.0, of_turn: false }).to_vec();
        let mask = base.mask.without(contact_events::rows(&events));
        // One of the two is predicted after all: it was set aside, and is no contact.
        let contact = events[..1].to_vec();
        let explanation = Explanation::of(&mask, &model, events, &rest_nm, &|_| ()).with_events(contact);
        let floor = Floor::of_noise(FLOOR_NM, FloorSource::Spectrum, 0.1);
        let resamples = Resamples::new(&data.folds, &floor);
        let account = Account::new(&base, &explanation, &resamples, &floor);
        let whole = |squares: &[f64]| squares.iter().sum::<f64>();
        let of = |set: Rows, nm: &[f64]| {
            let all = rows(&base.mask, &explanation);
            nm.iter().zip(all).filter(|(_, row)| *row == set).map(|(r, _)| r * r).sum::<f64>()
        };
        let (left_nm, rest_nm) = (&explanation.left_nm, explanation.choice.base.residual_nm());
        assert!(of(Rows::Predicted, left_nm) > 0.0 && of(Rows::Contact, left_nm) > 0.0);
        let counted = whole(&account.evidence.rows) as usize;
        assert_eq!(counted, base.mask.rows());
        let last = whole(&explanation.choice.last.held_out);
        let expected = last + of(Rows::Predicted, left_nm) + of(Rows::Contact, &rest_nm);
        assert!((whole(&account.evidence.last) / expected - 1.0).abs() < 1e-9);
    }
}
