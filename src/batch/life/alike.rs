//! The scatter between sessions, estimated from the other joints of a fleet.
//!
//! A short history hardly determines its own scatter, and a jump two sessions ago may then be chance. Joints of one fleet are mounted and
//! recorded alike, so the scatter of the same quantity, relative to its size, is assumed to be similar, as far as it is similar among the
//! other joints: excess variance of its logarithm between joints lowers the degrees of freedom that it counts for.

use super::Life;
use super::regression::Alike;
use crate::numerics::statistics::{mean, standard_deviation};
use std::collections::BTreeMap;

/// With fewer other joints no estimate is made.
const JOINTS_MIN: usize = 3;
/// Other joints count for at most this many degrees of freedom: a history of two years outweighs them.
const MOST: f64 = 20.0;

/// Of one joint and one kind of quantity.
struct Told {
    joint: usize,
    /// Variance between sessions over the square of the quantity's size.
    relative: f64,
    /// What the sessions claim, likewise.
    claimed: f64,
    freedom: f64,
}

/// The scatter of every kind of quantity, joint by joint.
pub(in crate::batch) struct Scatters(BTreeMap<String, Vec<Told>>);

/// Speeds and directions of one function, directions of one parameter, are of one kind.
fn kind(name: &str) -> String {
    let function = name.split(['(', ' ']).next().unwrap_or(name);
    function.rsplit('.').next().unwrap_or(function).to_string()
}

impl Scatters {
    /// Of the lives of all joints.
    pub fn new(joints: &[Vec<Life>]) -> Self {
        let mut all: BTreeMap<String, Vec<Told>> = BTreeMap::new();
        for (joint, lives) in joints.iter().enumerate() {
            let mut by_kind: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
            for (life, told) in lives.iter().filter_map(|life| Some((life, life.told_scatter()?))) {
                by_kind.entry(kind(&life.name)).or_default().push(told);
            }
            for (kind, of) in by_kind {
                let over = |place: usize| mean(&of.iter().map(|told| told[place]).collect::<Vec<f64>>());
                // Speeds and directions of one session scatter together: they count once.
                let told = Told { joint, relative: over(0), claimed: over(1), freedom: over(2) };
                all.entry(kind).or_default().push(told);
            }
        }
        Self(all)
    }

    /// What joints other than `joint` say of the scatter of its quantity `life`.
    pub fn of_others(&self, joint: usize, life: &Life) -> Option<Alike> {
        let others: Vec<&Told> = self.0.get(&kind(&life.name))?.iter().filter(|told| told.joint != joint).collect();
        if others.len() < JOINTS_MIN {
            return None;
        }
        let freedom: f64 = others.iter().map(|told| told.freedom).sum();
        let relative = others.iter().map(|told| told.freedom * told.relative).sum::<f64>() / freedom;
        // The logarithm of a variance with f degrees of freedom has a variance of 2 / f.
        let logs: Vec<f64> = others.iter().map(|told| (told.relative + told.claimed).ln()).collect();
        let by_chance = mean(&others.iter().map(|told| 2.0 / told.freedom).collect::<Vec<f64>>());
        let excess = (standard_deviation(&logs).powi(2) - by_chance).max(0.0);
        let alike = if excess > 0.0 { 2.0 / excess } else { f64::INFINITY };
        Some(Alike { variance: relative * life.typical().powi(2), freedom: freedom.min(alike).min(MOST) })
    }
}
