//! Trials that hold the same recording: byte for byte, shifted or cut in time, or with other time stamps.
//!
//! The noise of a torque sensor is its signature: 16 readings in a row that fall and rise are not met twice. Every stretch of
//! 16 whose last two readings have a small hash, about 200 of a log, is hashed; these are its fingerprint (after Broder, On the
//! resemblance and containment of documents, 1997): of two logs that share a recording, the fingerprints share as large a part. What
//! has no noise, a simulation, has no fingerprint: equal motions then have equal torques, rightly.

use crate::log::Campaign;
use crate::problem::{Problem, Problems, Result};
use std::collections::{BTreeMap, HashMap};

/// Readings in a stretch.
const STRETCH: usize = 16;
/// A stretch counts where its readings change direction at least this many times; noise does at two of three samples.
const TURNS_MIN: usize = 6;
/// Hashes kept of a log, about.
const KEPT: usize = 200;
/// Fewer than this tell nothing.
const KEPT_MIN: usize = 12;
/// Logs of which this share of the smaller fingerprint is the same hold the same recording.
const SHARED: f64 = 0.3;

/// What tells one recording from another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fingerprint {
    /// Hash of each stretch kept, with that of its last two readings, in order, without repeats.
    hashes: Vec<(u64, u64)>,
    /// Stretches are kept whose last two readings hash below this.
    below: u64,
}

/// Any odd number with bits all over will do for mixing.
const MIX: u64 = 0x9E37_79B9_7F4A_7C15;

/// A hash of `reading` and of what was hashed `before`.
fn mixed(before: u64, reading: f64) -> u64 {
    // Both zeros are one reading.
    let bits = (reading + 0.0).to_bits();
    let hash = (before.rotate_left(23) ^ bits ^ (bits >> 29)).wrapping_mul(MIX);
    hash ^ (hash >> 31)
}

impl Fingerprint {
    /// Of the readings of a torque, as recorded.
    pub fn of(torque: &[f64]) -> Self {
        let below = (u64::MAX / torque.len().max(1) as u64).saturating_mul(KEPT as u64);
        let mut hashes = Vec::new();
        for stretch in torque.windows(STRETCH) {
            let ends = mixed(stretch[STRETCH - 2].to_bits(), stretch[STRETCH - 1]).wrapping_mul(MIX);
            if ends < below && turns(stretch) >= TURNS_MIN {
                hashes.push((stretch.iter().fold(0, |before, reading| mixed(before, *reading)), ends));
            }
        }
        hashes.sort_unstable();
        hashes.dedup();
        Self { hashes, below }
    }
}

/// How often `stretch` turns.
fn turns(stretch: &[f64]) -> usize {
    stretch.windows(3).filter(|three| (three[1] - three[0]) * (three[2] - three[1]) < 0.0).count()
}

/// The trials of `campaign` that hold the same recording as an earlier one of `prints`, and what is wrong with each: counted twice,
/// one recording makes every interval too narrow.
pub fn copies(campaign: &Campaign, prints: &[(usize, &Fingerprint)]) -> Vec<(usize, Problem)> {
    let of = |place: usize| &campaign.trials[prints[place].0].file;
    let told = |(place, original): (usize, Option<usize>)| {
        let what =
            format!("holds the same recording as `{}`, perhaps shifted or with other time stamps", of(original?));
        let cure = "delete the copies from campaign.toml: a repeat must be recorded anew";
        Some((prints[place].0, Problem::error(campaign.folder.join(of(place)), what, cure)))
    };
    let fingerprints: Vec<&Fingerprint> = prints.iter().map(|(_, print)| *print).collect();
    originals(&fingerprints).into_iter().enumerate().filter_map(told).collect()
}

/// Errors: two of the trials of `campaign` with these `prints` hold the same recording.
pub fn refuse_copies(campaign: &Campaign, prints: &[(usize, Fingerprint)]) -> Result<()> {
    let prints: Vec<(usize, &Fingerprint)> = prints.iter().map(|(trial, print)| (*trial, print)).collect();
    Problems(copies(campaign, &prints).into_iter().map(|(_, problem)| problem).collect()).unless_errors(())
}

/// Of each log of `fingerprints` that holds the same recording as an earlier one, that one's place.
pub(super) fn originals(fingerprints: &[&Fingerprint]) -> Vec<Option<usize>> {
    let mut first: HashMap<(u64, u64), usize> = HashMap::new();
    let mut found = Vec::with_capacity(fingerprints.len());
    for (place, print) in fingerprints.iter().enumerate() {
        let mut shared: BTreeMap<usize, usize> = BTreeMap::new();
        for hash in &print.hashes {
            let holder = *first.entry(*hash).or_insert(place);
            if holder != place {
                *shared.entry(holder).or_default() += 1;
            }
        }
        let most = shared.into_iter().max_by_key(|(_, count)| *count);
        found.push(most.filter(|(other, count)| is_same(fingerprints[*other], print, *count)).map(|(other, _)| other));
    }
    found
}

/// Whether `shared` hashes make two recordings one. Of logs of different lengths the longer one keeps a smaller share.
fn is_same(one: &Fingerprint, other: &Fingerprint, shared: usize) -> bool {
    let below = one.below.min(other.below);
    let kept = |print: &Fingerprint| print.hashes.iter().filter(|(_, ends)| *ends < below).count();
    let smaller = kept(one).min(kept(other));
    smaller >= KEPT_MIN && shared as f64 >= SHARED * smaller as f64
}
