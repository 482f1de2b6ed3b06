//! Contacts: stretches in which the torque leaves all that depends on the recorded motion, and that are not there again when the
//! motion is.

use super::fit::{Bench, Ground};
use super::flexible::{self, Flexible};
use super::record::Record;
use crate::model::Combination;
use crate::numerics::statistics::{extent, quantile};
use std::ops::Range;

/// Rounds of fitting without what the last round found.
const ROUNDS: usize = 3;
/// A burst reaches so many times the usual level ...
const PEAK: f64 = 4.5;
/// (more in proportion to the root of the level over so many floors) ...
const MISFIT: f64 = 1.5;
/// ... and lasts as long as it stays above so many.
const EDGE: f64 = 1.8;
/// The level is taken over so many independent samples.
const WINDOW: f64 = 2.0;
/// Above this share of the rows bursts are no bursts.
const SHARE_MAX: f64 = 0.35;
/// A model that leaves less than this share of a burst's square foretells it.
const FORETOLD: f64 = 0.5;
/// What is there again at this share of its size, in one row of five in the same state elsewhere, is repeated.
const REPEATED: f64 = 0.4;
const OFTEN: f64 = 0.8;
/// Repeats of one motion show the same burst when its peak comes within this share of the range of positions.
const SAME_PLACE: f64 = 0.02;
/// The same state: position within this share of the range, ...
const NEAR: f64 = 0.05;
/// ... speed within this factor, or both slower than this share of the fastest; so many rows at least.
const FASTER: f64 = 1.6;
const SLOW: f64 = 0.02;
const ROWS_MIN: usize = 12;

/// Where a reversal was is not known better than to so many times the travel that counts as none.
const OPEN_STEPS: f64 = 3.0;
/// What swings so often, each time by this share of the largest area at least, rings.
const SWINGS: usize = 4;
const SWING_SHARE: f64 = 0.25;

/// One burst: rows of the series over all records.
#[derive(Debug, Clone, PartialEq)]
pub struct Burst {
    /// Its rows.
    pub rows: Range<usize>,
    /// The record that it is in.
    pub record: usize,
    /// Its largest excursion, N m.
    pub peak_nm: f64,
}

/// The bursts in `target_nm`, what `ground` leaves, and the flexible fit without them.
pub fn find(bench: &Bench<'_>, ground: &Ground, columns: &[Vec<f64>], target_nm: &[f64]) -> (Vec<Burst>, Flexible) {
    let mut used = bench.used.clone();
    let mut fitted = flexible::fit(bench, columns, target_nm, &used);
    let mut bursts = Vec::new();
    for _ in 0..ROUNDS {
        let found = stretches(bench, &fitted.residual_nm);
        let rows: usize = found.iter().map(|burst| burst.rows.len()).sum();
        if found == bursts || rows as f64 > SHARE_MAX * bench.rows() as f64 {
            break;
        }
        bursts = found;
        used.clone_from(&bench.used);
        bursts.iter().for_each(|burst| used[burst.rows.clone()].fill(false));
        fitted = flexible::fit(bench, columns, target_nm, &used);
    }
    let states = states(bench);
    let once = |burst: &Burst| {
        !is_repeated(bench, &states, &fitted.residual_nm, burst)
            && !recurs(bench, &states, &fitted.residual_nm, &bursts, burst)
            && !is_of_encoder(bench, ground, burst)
    };
    let bursts = bursts.iter().filter(|burst| once(burst)).cloned().collect();
    (bursts, fitted)
}

/// Whether most of the squares in `bursts` swing to and fro: what rings is no contact.
pub fn ring(bursts: &[Burst], residual_nm: &[f64]) -> bool {
    let square = |burst: &Burst| residual_nm[burst.rows.clone()].iter().map(|r| r * r).sum::<f64>();
    let (mut all, mut ringing) = (0.0, 0.0);
    for burst in bursts {
        all += square(burst);
        if swings(&residual_nm[burst.rows.clone()]) >= SWINGS {
            ringing += square(burst);
        }
    }
    2.0 * ringing > all
}

/// How many lobes of like size follow one another with signs that alternate.
fn swings(residual_nm: &[f64]) -> usize {
    let mut areas: Vec<f64> = Vec::new();
    for r in residual_nm {
        match areas.last_mut() {
            Some(area) if *area * r > 0.0 => *area += r,
            _ => areas.push(*r),
        }
    }
    let largest = areas.iter().fold(0.0, |most: f64, area| most.max(area.abs()));
    let large: Vec<f64> = areas.into_iter().filter(|area| area.abs() > SWING_SHARE * largest).collect();
    1 + large.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
}

/// The row of a burst's peak.
fn peak_row(residual_nm: &[f64], burst: &Burst) -> usize {
    burst
        .rows
        .clone()
        .max_by(|a, b| residual_nm[*a].abs().total_cmp(&residual_nm[*b].abs()))
        .unwrap_or(burst.rows.start)
}

/// Where the residual's level rises far above what is usual.
fn stretches(bench: &Bench<'_>, residual_nm: &[f64]) -> Vec<Burst> {
    let reach = ((WINDOW * bench.records.rows_per_independent / 2.0).round() as usize).max(1);
    let mut found = Vec::new();
    let levels: Vec<Vec<f64>> =
        bench.records.ranges.iter().map(|range| level(&residual_nm[range.clone()], reach)).collect();
    let mut all: Vec<f64> = levels.concat();
    let usual = (quantile(&mut all, 0.5)).max(bench.floor_nm);
    // Where the fit stays far above the floor, its own misfit has peaks too.
    let peak = PEAK * (usual / (MISFIT * bench.floor_nm).max(f64::MIN_POSITIVE)).max(1.0).sqrt();
    for (record, (range, level)) in bench.records.ranges.iter().zip(&levels).enumerate() {
        let mut at = 0;
        while at < level.len() {
            if level[at] <= EDGE * usual {
                at += 1;
                continue;
            }
            let end = level[at..].iter().position(|l| *l <= EDGE * usual).map_or(level.len(), |n| at + n);
            if level[at..end].iter().any(|l| *l > peak * usual) {
                let rows = range.start + at.saturating_sub(reach)..range.start + (end + reach).min(level.len());
                let peak_nm =
                    residual_nm[rows.clone()].iter().fold(0.0, |p: f64, r| if r.abs() > p.abs() { *r } else { p });
                found.push(Burst { rows, record, peak_nm });
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

/// Keeps the bursts that a model, fitted without them, leaves as they were: one that it foretells was no contact.
pub fn keep_unexplained(bench: &Bench<'_>, bursts: &mut Vec<Burst>, before_nm: &[f64], after_nm: &[f64]) {
    let square = |residual_nm: &[f64], burst: &Burst| {
        let excess = |r: &f64| r * r - bench.floor_nm * bench.floor_nm;
        residual_nm[burst.rows.clone()].iter().map(excess).sum::<f64>().max(0.0)
    };
    bursts.retain(|burst| square(after_nm, burst) > FORETOLD * square(before_nm, burst));
}

/// Position, velocity and travel since the last reversal at each row.
fn states(bench: &Bench<'_>) -> Vec<[f64; 3]> {
    let of = |record: &Record| {
        let travel = record.travel_rad();
        record.rows.iter().map(|i| [record.own[*i].position, record.own[*i].velocity, travel[*i]]).collect::<Vec<_>>()
    };
    bench.records.all.iter().flat_map(of).collect()
}

/// Whether the joint, when it is there again in the same motion, shows the like.
fn is_repeated(bench: &Bench<'_>, states: &[[f64; 3]], residual_nm: &[f64], burst: &Burst) -> bool {
    let range = bench.extent.position_rad.1 - bench.extent.position_rad.0;
    let [q, v, travel] = states[peak_row(residual_nm, burst)];
    let slow_rad_s = SLOW * bench.extent.speed_rad_s.1;
    let same = |i: &usize| {
        let [other_q, other_v, other_travel] = states[*i];
        let slow = v.abs() < slow_rad_s && other_v.abs() < slow_rad_s;
        let alike = slow || (v != 0.0 && (1.0 / FASTER..FASTER).contains(&(other_v / v)));
        let settled = other_travel > 0.2 * range && travel > 0.2 * range;
        (other_q - q).abs() < NEAR * range && alike && (settled || (other_travel - travel).abs() < NEAR * range)
    };
    let far = |i: &usize| *i + 10 < burst.rows.start || *i > burst.rows.end + 10;
    let mut others: Vec<f64> = (0..states.len()).filter(far).filter(same).map(|i| residual_nm[i].abs()).collect();
    others.len() >= ROWS_MIN && quantile(&mut others, OFTEN) > REPEATED * burst.peak_nm.abs()
}

/// Whether it is no more than what the encoder leaves open: just after a reversal friction passes within a travel of few steps.
fn is_of_encoder(bench: &Bench<'_>, ground: &Ground, burst: &Burst) -> bool {
    let backlash_rad = ground.model.backlash_m() / ground.model.joint.pulley_radius_m;
    let open_rad = OPEN_STEPS * bench.records.all[burst.record].deadband_rad;
    let (low_nm, high_nm) = extent(&ground.predicted_nm[burst.rows.clone()]);
    let passed = match ground.model.combination {
        // Where friction jumps, so does the prediction, at the sample at which the joint turns.
        Combination::Sign => 0.0,
        curve if backlash_rad > 0.0 => curve.share((open_rad / backlash_rad).min(1.0)),
        _ => 0.0,
    };
    burst.peak_nm.abs() <= passed * (high_nm - low_nm)
}

/// Whether most other repeats of the burst's trial have a burst of the same sign and the like size at the same place, in the
/// same direction.
fn recurs(bench: &Bench<'_>, states: &[[f64; 3]], residual_nm: &[f64], bursts: &[Burst], burst: &Burst) -> bool {
    let name = &bench.records.all[burst.record].repeats;
    let is_repeat = |record: &usize| *record != burst.record && bench.records.all[*record].repeats == *name;
    let repeats: Vec<usize> = (0..bench.records.all.len()).filter(is_repeat).collect();
    let range = bench.extent.position_rad.1 - bench.extent.position_rad.0;
    let [q, v, _] = states[peak_row(residual_nm, burst)];
    let like = |other: &&Burst| {
        let [other_q, other_v, _] = states[peak_row(residual_nm, other)];
        let same_place = (other_q - q).abs() < SAME_PLACE * range && other_v * v >= 0.0;
        same_place && (REPEATED..1.0 / REPEATED).contains(&(other.peak_nm / burst.peak_nm))
    };
    let has_like = |record: &&usize| bursts.iter().filter(|other| other.record == **record).any(|other| like(&other));
    name.is_some() && !repeats.is_empty() && 2 * repeats.iter().filter(has_like).count() >= repeats.len()
}

#[cfg(test)]
mod tests {
    use super::{Burst, ring};
    use std::f64::consts::PI;

    #[test]
    fn what_swings_to_and_fro_rings_and_a_push_does_not() {
        let series = |of: fn(f64) -> f64| (0..60).map(|i| of(f64::from(i) / 60.0)).collect::<Vec<f64>>();
        let bursts = [Burst { rows: 0..60, record: 0, peak_nm: 1.0 }];
        let rings = |of: fn(f64) -> f64| ring(&bursts, &series(of));
        assert!(rings(|t| (-t).exp() * (8.0 * PI * t).sin()));
        assert!(!rings(|t| (PI * t).sin()), "a push");
        assert!(!rings(|t| (2.0 * PI * t).sin()), "there and back");
        assert!(!rings(|t| (-4.0 * t).exp() + 0.02 * (40.0 * PI * t).sin()), "a blow in noise");
        assert!(!ring(&[], &[]));
    }
}
