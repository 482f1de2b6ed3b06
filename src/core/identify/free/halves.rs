//! Free motion in two halves, each fitted and each judged by the other's fit.

use crate::identify::predicted::Prepared;
use crate::identify::strokes::{Part, Stroke};
use crate::model::{Both, Direction};
use crate::problem::{Problem, Result};
use std::path::Path;

/// All strokes, and the same shared out.
#[derive(Debug, Clone)]
pub struct Halves<'a> {
    /// All.
    pub all: Vec<Part<'a>>,
    /// The two halves.
    pub halves: [Vec<Part<'a>>; 2],
}

/// From this many trials on, whole trials are held out: a stroke shares with its neighbours what differs from trial to trial.
const TRIALS_MIN: usize = 4;

impl<'a> Halves<'a> {
    /// The strokes of `trials` shared out so that both halves move both ways: whole trials by their `folds` where there are
    /// enough of them, else stroke by stroke. `widest_rad` is the largest clearance whose K~ must be known.
    ///
    /// Errors: fewer than two usable strokes in a direction; `campaign` is the file named.
    pub fn new(
        trials: &'a [Prepared],
        folds: &[usize],
        widest_rad: f64,
        lowpass_hz: f64,
        campaign: &Path,
    ) -> Result<Self> {
        let all: Vec<Part> = trials.iter().map(|trial| Part::new(trial, widest_rad, lowpass_hz)).collect();
        for direction in Direction::BOTH {
            let mine = all.iter().flat_map(|part| &part.strokes).filter(|stroke| stroke.direction == direction);
            check(mine.count(), direction, campaign)?;
        }
        let moves_both_ways =
            |half: &Vec<Part>| Direction::BOTH.iter().all(|direction| half.iter().any(|part| part.moves(*direction)));
        let by_trial = by_trial(&all, folds);
        let whole = trials.len() >= TRIALS_MIN && by_trial.iter().all(moves_both_ways);
        let halves = if whole { by_trial } else { by_stroke(&all) };
        Ok(Self { all, halves })
    }
}

fn by_trial<'a>(all: &[Part<'a>], folds: &[usize]) -> [Vec<Part<'a>>; 2] {
    [0, 1].map(|half| all.iter().zip(folds).filter(|(_, fold)| **fold == half).map(|(part, _)| part.clone()).collect())
}

/// In the order a, b, b, a: the strokes of each direction in turn, so that the halves share whatever rises or falls along a
/// trial. Each trial begins with the other half than the one before: repeats then complete each other.
fn by_stroke<'a>(all: &[Part<'a>]) -> [Vec<Part<'a>>; 2] {
    let mut halves = [Vec::new(), Vec::new()];
    let mut begin = Both { up: 0, down: 1 };
    for part in all {
        let mut next = begin;
        let mut shares: [Vec<Stroke>; 2] = Default::default();
        for stroke in &part.strokes {
            let half = next.of_mut(stroke.direction);
            shares[*half].push(stroke.clone());
            *half = 1 - *half;
        }
        for direction in Direction::BOTH.into_iter().filter(|direction| part.moves(*direction)) {
            *begin.of_mut(direction) = 1 - *begin.of(direction);
        }
        for (half, strokes) in halves.iter_mut().zip(shares) {
            half.push(Part::of(part.trial, strokes));
        }
    }
    halves
}

fn check(usable: usize, direction: Direction, campaign: &Path) -> Result<()> {
    if usable >= 2 {
        return Ok(());
    }
    let count = ["no usable stroke moves", "one usable stroke moves"][usable];
    let what = format!("{count} {}: two are needed, one to fit and one to judge the fit", direction.name());
    let cure = "record motion that goes back and forth at least twice, within the sensor's range; nothing counts until the \
                joint has once gone through the clearance (backlash_m, at most half the longest stroke if estimated)";
    Problem::error(campaign, what, cure).alone()
}
