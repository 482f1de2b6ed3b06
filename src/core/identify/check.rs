//! What the trials of a campaign contradict or lack together, told before anything is fitted.

use super::drift::{Drift, LegTime};
use super::legs::{LegFit, amplitude, consistent, load_of_a_nm, no_leg};
use super::reading::Reading;
use crate::log::{Campaign, Protocol};
use crate::model::Direction;
use crate::problem::Problem;
use std::path::Path;

/// Speeds that B(v) needs, in each direction.
const SPEEDS_MIN: usize = 2;

/// Why the joint of `campaign` cannot be identified from `readings`, or what to know of them together. Of trials that could not be read, whose readings are
/// missing, the best is assumed.
pub fn check(campaign: &Campaign, readings: &[Reading]) -> Vec<Problem> {
    let is_unread = |file: &str| readings.iter().all(|reading| reading.entry.file != file);
    let unread: Vec<Protocol> =
        campaign.trials.iter().filter(|entry| is_unread(&entry.file)).map(|entry| entry.protocol).collect();
    if campaign.trials.iter().all(|entry| entry.protocol == Protocol::Interaction) {
        let what = "every trial is an `interaction`: what its person does cannot be told from the joint's friction";
        let cure = "add trials in which nobody touches the joint: `uniform` sweeps, or `cosine` or `free` motion";
        return vec![Problem::error(&campaign.file, what, cure).in_column("protocol")];
    }
    if campaign.trials.iter().all(|entry| entry.protocol.speed_rad_s().is_none()) {
        return if unread.is_empty() { no_turn(readings, &campaign.file).into_iter().collect() } else { Vec::new() };
    }
    let legs: Vec<LegFit> = readings.iter().flat_map(|reading| &reading.legs).map(|leg| leg.fit(0.0)).collect();
    let legs: Vec<&LegFit> = legs.iter().collect();
    let unread: Vec<f64> = unread.iter().filter_map(|protocol| protocol.speed_rad_s()).collect();
    let load_nm = load_of_a_nm(campaign);
    let in_direction = |direction| of_direction(direction, &legs, &unread, load_nm, &campaign.file);
    let times: Vec<LegTime> = readings.iter().flat_map(|reading| reading.times.iter().copied()).collect();
    let drift = Drift::of(&legs, &times).map(|drift| drift.problem(&campaign.file));
    Direction::BOTH.into_iter().flat_map(in_direction).chain(drift).collect()
}

fn of_direction(
    direction: Direction,
    legs: &[&LegFit],
    unread_rad_s: &[f64],
    load_nm: f64,
    campaign: &Path,
) -> Vec<Problem> {
    let Some(a) = amplitude(legs.iter().copied(), direction) else {
        let missing = unread_rad_s.is_empty().then(|| no_leg(direction, campaign));
        return missing.into_iter().collect();
    };
    let read = legs.iter().filter(|leg| leg.direction == direction).map(|leg| leg.speed_rad_s);
    let few = few_speeds(direction, read.chain(unread_rad_s.iter().copied()), campaign);
    consistent(a, legs.iter().copied(), direction, load_nm, campaign).err().into_iter().chain(few).collect()
}

/// What is wrong where the legs of `direction` have these `speeds`, rad/s.
pub fn few_speeds(direction: Direction, speeds: impl Iterator<Item = f64>, campaign: &Path) -> Option<Problem> {
    let mut speeds: Vec<f64> = speeds.collect();
    let legs = speeds.len();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    (speeds.len() < SPEEDS_MIN).then(|| {
        let what = format!("{legs} of the legs move {}, all at one speed: too few for B(v)", direction.name());
        Problem::error(campaign, what, "record sweeps at six speeds or more, at least two")
    })
}

fn no_turn(readings: &[Reading], campaign: &Path) -> Option<Problem> {
    let alone = readings.iter().filter(|reading| reading.entry.protocol != Protocol::Interaction);
    let mut prepared = alone.map(|reading| &reading.prepared);
    let turns = prepared.any(|p| p.series.velocity_rad_s.iter().any(|v| *v > 0.0) && !p.reversals().is_empty());
    (!turns).then(|| {
        let what = "no sweep, and no trial in which the joint turns: friction cannot be told from the load";
        Problem::error(campaign, what, "record motion in both directions")
    })
}
