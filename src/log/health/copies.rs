//! Trials that hold the same recording: byte for byte, shifted or cut in time, or with other time stamps.
//!
//! The noise of a torque sensor is its signature: 16 readings in a row that fall and rise are not met twice. Every stretch of
//! 16 is hashed, and the stretches with the smallest hashes, about 200 of a log, are its fingerprint (Broder, On the
//! resemblance and containment of documents, 1997): of two logs that share a recording, the fingerprints share as large a part. What
//! has no noise, a simulation, has no fingerprint: equal motions then have equal torques, rightly.

use crate::log::Campaign;
use crate::problem::{Problem, Problems, Result};
use std::collections::BTreeMap;

/// Readings in a stretch.
const STRETCH: usize = 16;
/// A stretch counts where its readings turn at least so many times; noise turns at two of three.
const TURNS_MIN: u32 = 6;
/// Hashes kept of a log, about.
const KEPT: usize = 200;
/// Fewer than this tell nothing.
const KEPT_MIN: usize = 12;
/// Logs of which this share of the smaller fingerprint is the same hold the same recording.
const SHARED: f64 = 0.3;

/// What tells one recording from another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fingerprint {
    /// The smallest hashes, in order, without repeats.
    hashes: Vec<u64>,
    /// Hashes below this one are kept.
    below: u64,
}

impl Fingerprint {
    /// Of the readings of a torque, as recorded.
    pub fn of(torque: &[f64]) -> Self {
        /// Any odd number with bits all over will do for a rolling hash, and for mixing it.
        const BASE: u64 = 0x9E37_79B9_7F4A_7C15;
        let out_of_reach = (0..STRETCH).fold(1u64, |power, _| power.wrapping_mul(BASE));
        let below = (u64::MAX / torque.len().max(1) as u64).saturating_mul(KEPT as u64);
        let (mut hashes, mut rolling, mut turns) = (Vec::new(), 0u64, 0u64);
        for (i, reading) in torque.iter().enumerate() {
            let bits = |reading: f64| (reading + 0.0).to_bits() ^ (reading.to_bits() >> 29);
            rolling = rolling.wrapping_mul(BASE).wrapping_add(bits(*reading));
            if i >= STRETCH {
                rolling = rolling.wrapping_sub(out_of_reach.wrapping_mul(bits(torque[i - STRETCH])));
            }
            if i >= 2 {
                let turn = (reading - torque[i - 1]) * (torque[i - 1] - torque[i - 2]) < 0.0;
                turns = turns << 1 | u64::from(turn);
            }
            let mixed = (rolling ^ (rolling >> 31)).wrapping_mul(BASE);
            let mixed = mixed ^ (mixed >> 29);
            if i + 1 >= STRETCH && mixed < below && (turns & 0x3FFF).count_ones() >= TURNS_MIN {
                hashes.push(mixed);
            }
        }
        hashes.sort_unstable();
        hashes.dedup();
        Self { hashes, below }
    }
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
    let mut first: BTreeMap<u64, usize> = BTreeMap::new();
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
    let kept = |print: &Fingerprint| print.hashes.iter().filter(|hash| **hash < below).count();
    let smaller = kept(one).min(kept(other));
    smaller >= KEPT_MIN && shared as f64 >= SHARED * smaller as f64
}
