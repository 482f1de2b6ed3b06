//! Contacts: stretches in which the torque departs from everything that depends on the recorded motion, and that do not repeat with the
//! motion.

use super::base::BaseModel;
use super::data::DataSet;
use super::flexible::{self, Flexible};
use super::mask::Mask;
use super::policy::Policy;
use super::turns;
use crate::dynamics::Motion;
use crate::numerics::statistics::{mean, quantile, standard_deviation};
use std::ops::Range;

/// Rounds of fitting without what the last round found.
const ROUNDS: usize = 3;
/// The level is averaged over this many independent samples.
const WINDOW: f64 = 2.0;
/// Fewer rows in the same state elsewhere do not show whether a residual repeats.
const ROWS_MIN: usize = 12;
/// Rows farther apart than this belong to different visits of a state.
const APART: usize = 10;

/// One event: rows of the series over all records.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEvent {
    /// Its rows.
    pub rows: Range<usize>,
    /// The record that it is in.
    pub record: usize,
    /// Its largest excursion, N m.
    pub peak_nm: f64,
    /// Whether friction that turns earlier or later than the encoder tells would explain it.
    pub of_turn: bool,
}

/// The rows of `events`.
pub fn rows(events: &[ContactEvent]) -> impl Iterator<Item = Range<usize>> {
    events.iter().map(|event| event.rows.clone())
}

/// The events in `target_nm`, the residual of `base`, and the flexible fit without them.
pub fn find(base: &BaseModel<'_>, columns: &[Vec<f64>], target_nm: &[f64]) -> (Vec<ContactEvent>, Flexible) {
    let mask = &base.mask;
    let mut fitted = flexible::fit(mask, columns, target_nm);
    let mut events = Vec::new();
    for _ in 0..ROUNDS {
        let found = stretches(mask, &fitted.residual_nm);
        if found == events {
            break;
        }
        events = found;
        fitted = flexible::fit(&mask.without(rows(&events)), columns, target_nm);
    }
    if events.is_empty() {
        return (events, fitted);
    }
    let data = base.data();
    let (states, encoder_nm, undecided_nm) = (states(data), data.encoder_nm(&base.model), turns::undecided_nm(base));
    let once = |event: &ContactEvent| {
        !is_repeated(data, &states, &fitted.residual_nm, event)
            && !recurs(data, &states, &fitted.residual_nm, &events, event)
            && !is_of_encoder(&data.policy, &encoder_nm, event)
    };
    let of_turn = |event: &ContactEvent| {
        let residual_nm = &fitted.residual_nm;
        !is_left(mask, event, |row| residual_nm[row], |row| turns::left_nm(&undecided_nm, residual_nm, row))
    };
    let events = events.iter().filter(|event| once(event));
    let events = events.map(|event| ContactEvent { of_turn: of_turn(event), ..event.clone() }).collect();
    (events, fitted)
}

/// Whether most of the squares in `events` oscillate: an oscillating residual is not a contact event.
pub fn ring(policy: &Policy, events: &[ContactEvent], residual_nm: &[f64]) -> bool {
    let square = |event: &ContactEvent| residual_nm[event.rows.clone()].iter().map(|r| r * r).sum::<f64>();
    let (mut all, mut ringing) = (0.0, 0.0);
    for event in events {
        all += square(event);
        if swings(policy, &residual_nm[event.rows.clone()]) as f64 >= policy.contact_swings {
            ringing += square(event);
        }
    }
    2.0 * ringing > all
}

/// How many lobes of like size follow one another with signs that alternate.
fn swings(policy: &Policy, residual_nm: &[f64]) -> usize {
    let mut areas: Vec<f64> = Vec::new();
    for r in residual_nm {
        match areas.last_mut() {
            Some(area) if *area * r > 0.0 => *area += r,
            _ => areas.push(*r),
        }
    }
    let largest = areas.iter().fold(0.0, |most: f64, area| most.max(area.abs()));
    let least = policy.contact_swing_share * largest;
    let large: Vec<f64> = areas.into_iter().filter(|area| area.abs() > least).collect();
    1 + large.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
}

/// The row of an event's peak.
fn peak_row(residual_nm: &[f64], event: &ContactEvent) -> usize {
    event
        .rows
        .clone()
        .max_by(|a, b| residual_nm[*a].abs().total_cmp(&residual_nm[*b].abs()))
        .unwrap_or(event.rows.start)
}

/// The row in the middle of an event's squares. Whoever touches a joint that moves does so at any time; the peak of a push that lasts is where
/// friction or gravity happens to help it.
fn centre_row(residual_nm: &[f64], event: &ContactEvent) -> usize {
    let squares = || event.rows.clone().map(|row| residual_nm[row].powi(2));
    let half = squares().sum::<f64>() / 2.0;
    let mut before = 0.0;
    let is_before = |square: &f64| {
        before += square;
        before < half
    };
    event.rows.start + squares().take_while(is_before).count()
}

/// Where the residual's level rises far above what is usual.
fn stretches(mask: &Mask<'_>, residual_nm: &[f64]) -> Vec<ContactEvent> {
    let reach = ((WINDOW * mask.data.records.rows_per_independent / 2.0).round() as usize).max(1);
    let (policy, mut found) = (&mask.data.policy, Vec::new());
    let levels: Vec<Vec<f64>> =
        mask.data.records.ranges.iter().map(|range| level(&residual_nm[range.clone()], reach)).collect();
    let mut all: Vec<f64> = levels.concat();
    let usual = (quantile(&mut all, 0.5)).max(mask.floor_nm);
    // Where the fit stays far above the floor, its own misfit has peaks too.
    let misfit = usual / (policy.contact_misfit_floors * mask.floor_nm).max(f64::MIN_POSITIVE);
    let peak = policy.contact_peak * misfit.max(1.0).sqrt();
    let edge_nm = policy.contact_edge * usual;
    for (record, (range, level)) in mask.data.records.ranges.iter().zip(&levels).enumerate() {
        let mut at = 0;
        while at < level.len() {
            if level[at] <= edge_nm {
                at += 1;
                continue;
            }
            let end = level[at..].iter().position(|l| *l <= edge_nm).map_or(level.len(), |n| at + n);
            if level[at..end].iter().any(|l| *l > peak * usual) {
                let rows = range.start + at.saturating_sub(reach)..range.start + (end + reach).min(level.len());
                let peak_nm =
                    residual_nm[rows.clone()].iter().fold(0.0, |p: f64, r| if r.abs() > p.abs() { *r } else { p });
                found.push(ContactEvent { rows, record, peak_nm, of_turn: false });
            }
            at = end;
        }
    }
    found
}

/// Root mean square over `reach` rows to either side.
fn level(values: &[f64], reach: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    values.iter().for_each(|v| sums.push(sums[sums.len() - 1] + v * v));
    (0..values.len())
        .map(|i| {
            let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(values.len()));
            ((sums[to] - sums[from]) / (to - from) as f64).max(0.0).sqrt()
        })
        .collect()
}

/// Keeps the events that a model, fitted without them, leaves as they were: one that it predicts was not contact; and of those that gather where
/// the joint is slow the ones that are not there. None is kept if they still gather at one speed or acceleration, or if friction that turns at another
/// time would explain each of them.
pub fn keep_unexplained(mask: &Mask<'_>, events: &mut Vec<ContactEvent>, before_nm: &[f64], after_nm: &[f64]) {
    let policy = &mask.data.policy;
    events.retain(|event| is_left(mask, event, |row| before_nm[row], |row| after_nm[row]));
    if events.is_empty() {
        return;
    }
    let (states, slow_rad_s) = (states(mask.data), policy.same_place_share * mask.data.extent.speed_rad_s.1);
    let by_speed = ranks(states.iter().map(|state| state.velocity.abs().max(slow_rad_s)));
    drop_slow(policy, &by_speed, events);
    let by_acceleration = ranks(states.iter().map(|state| state.acceleration.abs()));
    let centres: Vec<usize> = events.iter().map(|event| centre_row(after_nm, event)).collect();
    let is_of_turns = events.iter().all(|event| event.of_turn);
    if is_of_turns || gather(policy, &by_speed, &centres) || gather(policy, &by_acceleration, &centres) {
        events.clear();
    }
}

/// The rank of each of `values` as a share of their number: the share below it, and half of those that equal it.
fn ranks(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let of = |value: &f64| {
        let [below, to] = [sorted.partition_point(|s| s < value), sorted.partition_point(|s| s <= value)];
        (below + to) as f64 / (2 * sorted.len()) as f64
    };
    values.iter().map(of).collect()
}

/// Leaves out the slower half, if `events` gather where the joint is slow: what friction, play and the encoder do at rest and at reversals no model
/// predicts to the end. Of rows picked by chance the mean rank `by_speed` is 1/2, its variance at most 1/12.
fn drop_slow(policy: &Policy, by_speed: &[f64], events: &mut Vec<ContactEvent>) {
    let rank = |event: &ContactEvent| mean(&by_speed[event.rows.clone()]);
    let count = events.len() as f64;
    let below: f64 = events.iter().map(|event| 0.5 - rank(event)).sum();
    if below > policy.contact_slow_errors * (count / 12.0).sqrt() {
        events.retain(|event| rank(event) > 0.5);
    }
}

/// Whether the rows `at` lie together among all rows with these `ranks`, by their mean or their scatter: whoever touches the joint does so in any
/// state. Where all are of the faster half, which is what [`drop_slow`] leaves, they are held against that half.
fn gather(policy: &Policy, ranks: &[f64], at: &[usize]) -> bool {
    if at.len() < 2 {
        return false;
    }
    let picked: Vec<f64> = at.iter().map(|row| ranks[*row]).collect();
    let n = picked.len() as f64;
    let least = if picked.iter().all(|rank| *rank > 0.5) { 0.5 } else { 0.0 };
    let all: Vec<f64> = ranks.iter().copied().filter(|rank| *rank > least).collect();
    let [usual, found] = [&all, &picked].map(|ranks| standard_deviation(ranks).powi(2));
    // The variance of n evenly spread values has a standard error of sqrt(0.8 / n) of itself.
    let (off, together) =
        ((mean(&picked) - mean(&all)).abs() / (usual / n).sqrt(), (1.0 - found / usual) / (0.8 / n).sqrt());
    off.max(together) > policy.contact_gather_errors
}

/// The motion at each row.
fn states(data: &DataSet) -> Vec<Motion> {
    data.records.all.iter().flat_map(|record| record.rows.iter().map(|i| record.own[*i])).collect()
}

/// Whether the joint, when it is there again in the same motion, shows the like.
fn is_repeated(data: &DataSet, states: &[Motion], residual_nm: &[f64], event: &ContactEvent) -> bool {
    let range = data.extent.position_rad.1 - data.extent.position_rad.0;
    let Motion { position, velocity, .. } = states[peak_row(residual_nm, event)];
    let policy = &data.policy;
    let (near, slow_rad_s) = (policy.same_place_share * range, policy.same_place_share * data.extent.speed_rad_s.1);
    let speeds = 1.0 / policy.contact_speed_factor..policy.contact_speed_factor;
    let same = |i: &usize| {
        let other = states[*i];
        let both_slow = velocity.abs() < slow_rad_s && other.velocity.abs() < slow_rad_s;
        let alike = both_slow || (velocity != 0.0 && speeds.contains(&(other.velocity / velocity)));
        (other.position - position).abs() < near && alike
    };
    let far = |i: &usize| *i + APART < event.rows.start || *i > event.rows.end + APART;
    let there: Vec<usize> = (0..states.len()).filter(far).filter(same).collect();
    let mut others = without_largest_visit(&there, residual_nm);
    let least_nm = policy.contact_repeated_share * event.peak_nm.abs();
    there.len() >= ROWS_MIN && quantile(&mut others, policy.contact_repeated_quantile) > least_nm
}

/// The residual's magnitude at the rows `there`, without the visit (rows that follow one another) that shows most of it where there are several:
/// one may be another contact.
fn without_largest_visit(there: &[usize], residual_nm: &[f64]) -> Vec<f64> {
    let visits = there.chunk_by(|row, next| *next <= row + APART);
    let mut visits: Vec<Vec<f64>> =
        visits.map(|rows| rows.iter().map(|row| residual_nm[*row].abs()).collect()).collect();
    visits.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
    if visits.len() > 1 {
        visits.pop();
    }
    visits.concat()
}

/// Whether it is no more than what the encoder alone may leave there.
fn is_of_encoder(policy: &Policy, encoder_nm: &[f64], event: &ContactEvent) -> bool {
    let most_nm = encoder_nm[event.rows.clone()].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    event.peak_nm.abs() <= policy.contact_over_encoder * most_nm
}

/// Whether so much of `event` is left by what leaves `after_nm` at each row, of `before_nm`, that it was not predicted.
fn is_left(
    mask: &Mask<'_>,
    event: &ContactEvent,
    before_nm: impl Fn(usize) -> f64,
    after_nm: impl Fn(usize) -> f64,
) -> bool {
    let excess = |r: f64| r * r - mask.floor_square();
    let [before, after]: [f64; 2] =
        [event.rows.clone().map(|i| excess(before_nm(i))).sum(), event.rows.clone().map(|i| excess(after_nm(i))).sum()];
    after.max(0.0) > mask.data.policy.contact_left_share * before.max(0.0)
}

/// Whether most other repeats of the event's trial have an event of the same sign and the like size at the same place, in the
/// same direction.
fn recurs(
    data: &DataSet,
    states: &[Motion],
    residual_nm: &[f64],
    events: &[ContactEvent],
    event: &ContactEvent,
) -> bool {
    let name = &data.records.all[event.record].repeats;
    let is_repeat = |record: &usize| *record != event.record && data.records.all[*record].repeats == *name;
    let repeats: Vec<usize> = (0..data.records.all.len()).filter(is_repeat).collect();
    let range = data.extent.position_rad.1 - data.extent.position_rad.0;
    let (repeated, same_place) = (data.policy.contact_repeated_share, data.policy.same_place_share * range);
    let Motion { position, velocity, .. } = states[peak_row(residual_nm, event)];
    let like = |other: &&ContactEvent| {
        let there = states[peak_row(residual_nm, other)];
        let is_there = (there.position - position).abs() < same_place && there.velocity * velocity >= 0.0;
        is_there && (repeated..1.0 / repeated).contains(&(other.peak_nm / event.peak_nm))
    };
    let has_like = |record: &&usize| events.iter().filter(|other| other.record == **record).any(|other| like(&other));
    name.is_some() && 2 * repeats.iter().filter(has_like).count() > repeats.len()
}

#[cfg(test)]
mod tests {
    use super::{
        ContactEvent, Mask, Policy, centre_row, drop_slow, gather, keep_unexplained, ranks, ring, without_largest_visit,
    };
    use crate::diagnose::data::tests::bundled;
    use std::f64::consts::PI;

    #[test]
    fn events_at_turns_are_contacts_only_beside_another() {
        let (data, _) = bundled();
        let rows = data.measured_nm.len();
        let mask = Mask::new(&data, vec![true; rows], 0.01);
        let residual_nm = vec![1.0; rows];
        let kept = |of_turn: [bool; 2]| {
            let event =
                |(at, of_turn): (usize, bool)| ContactEvent { rows: at..at + 20, record: 0, peak_nm: 1.0, of_turn };
            let mut events = [rows / 5, rows / 2].into_iter().zip(of_turn).map(event).collect();
            keep_unexplained(&mask, &mut events, &residual_nm, &residual_nm);
            events.len()
        };
        assert_eq!([kept([true, true]), kept([true, false]), kept([false, false])], [0, 2, 2]);
    }

    #[test]
    fn what_swings_to_and_fro_rings_and_a_push_does_not() {
        let series = |of: fn(f64) -> f64| (0..60).map(|i| of(f64::from(i) / 60.0)).collect::<Vec<f64>>();
        let events = [ContactEvent { rows: 0..60, record: 0, peak_nm: 1.0, of_turn: false }];
        let rings = |of: fn(f64) -> f64| ring(&Policy::default(), &events, &series(of));
        assert!(rings(|t| (-t).exp() * (8.0 * PI * t).sin()));
        assert!(!rings(|t| (PI * t).sin()), "a push");
        assert!(!rings(|t| (2.0 * PI * t).sin()), "there and back");
        assert!(!rings(|t| (-4.0 * t).exp() + 0.02 * (40.0 * PI * t).sin()), "a blow in noise");
        assert!(!ring(&Policy::default(), &[], &[]));
    }

    #[test]
    fn events_that_gather_where_the_joint_is_slow_are_no_contacts() {
        let by_speed: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        let left = |rows: &[usize]| {
            let mut events: Vec<ContactEvent> = rows
                .iter()
                .map(|at| ContactEvent { rows: *at..at + 10, record: 0, peak_nm: 1.0, of_turn: false })
                .collect();
            drop_slow(&Policy::default(), &by_speed, &mut events);
            events.iter().map(|event| event.rows.start).collect::<Vec<usize>>()
        };
        assert_eq!(left(&[10, 20, 30, 600]), [600]);
        assert_eq!(left(&[10, 700]), [10, 700], "two can be there by chance");
        assert_eq!(left(&[900, 910, 920, 930]), [900, 910, 920, 930], "fast ones are not of this kind");
        assert!(left(&[]).is_empty());
    }

    #[test]
    fn of_several_visits_the_one_that_may_be_another_contact_does_not_count() {
        let residual_nm: Vec<f64> = (0..300)
            .map(|i| if [100..120, 160..180].iter().any(|rows| rows.contains(&i)) { -2.0 } else { 0.1 })
            .collect();
        let rows = |starts: &[usize]| starts.iter().flat_map(|start| *start..start + 15).collect::<Vec<usize>>();
        let largest =
            |starts: &[usize]| without_largest_visit(&rows(starts), &residual_nm).into_iter().fold(0.0, f64::max);
        assert_eq!(largest(&[10, 102, 200]), 0.1);
        assert_eq!(largest(&[102]), 2.0, "all that there is");
        assert_eq!(largest(&[10, 102, 162, 200]), 2.0, "it shows twice");
        assert!(without_largest_visit(&[], &residual_nm).is_empty());
    }

    #[test]
    fn the_middle_of_an_event_is_that_of_its_squares() {
        let residual_nm: Vec<f64> = (0..100).map(|i| if i < 90 { 1.0 } else { 1.2 }).collect();
        let centre = |rows: std::ops::Range<usize>| {
            centre_row(&residual_nm, &ContactEvent { rows, record: 0, peak_nm: 1.2, of_turn: false })
        };
        assert_eq!((centre(10..50), centre(60..61)), (29, 60));
        assert!((80..85).contains(&centre(70..95)), "not its peak");
    }

    #[test]
    fn events_that_gather_in_a_state_of_motion_are_no_contacts() {
        let all: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        let gathers = |at: &[usize]| gather(&Policy::default(), &all, at);
        let spread = |from: usize, step: usize| (0..20).map(|i| from + i * step).collect::<Vec<usize>>();
        assert!(!gathers(&spread(25, 50)));
        assert!(gathers(&spread(450, 5)), "at one speed");
        assert!(gathers(&spread(0, 25)), "where it is slow");
        assert!(!gathers(&spread(510, 25)), "spread over the faster half");
        // Few can be together by chance.
        assert!(!gathers(&[900, 910]) && !gathers(&[500]) && !gathers(&[]));
        assert_eq!(ranks([3.0, 1.0, 1.0, 2.0].into_iter()), [0.875, 0.25, 0.25, 0.625]);
    }
}
