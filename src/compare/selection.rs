//! Which causes explain what differs between two models: of one cause, of two and so on the set that explains most, with one more
//! while that explains more than chance would.

use super::cause::{Cause, CauseKind};
use super::observed::Observed;
use crate::model::Direction;
use crate::numerics::statistics::HALF_WIDTH;

/// A rival that explains all but this of chi squared cannot be told apart from the cause taken: the right one is farther behind once in
/// a hundred times.
const RIVAL: f64 = 6.63;
/// Most causes that are named: more would be a new joint.
const CAUSES: usize = 6;

impl Observed {
    /// The causes that explain more of chi squared than chance would, the clearest first.
    pub fn causes(&self) -> Vec<Cause> {
        let (mut taken, mut here) = (Vec::new(), self.chi_squared());
        for count in 1..=CAUSES {
            let Some((left, set)) = self.best(count).filter(|(left, _)| here - left > self.explains) else { break };
            (taken, here) = (set, left);
        }
        let taken = self.by_direction(taken);
        let Some((left, sizes, covariance)) = self.left(&taken) else { return Vec::new() };
        let cause = |at: usize| {
            let column = &self.columns[taken[at]];
            let (change, half) = (sizes[at], HALF_WIDTH * covariance[(at, at)].sqrt());
            Cause {
                kind: column.kind,
                direction: column.direction,
                change,
                low: change - half,
                high: change + half,
                measure: column.measure,
                rivals: self.rivals(&taken, at, left),
            }
        };
        let clearness = |at: &usize| sizes[*at].powi(2) / covariance[(*at, *at)];
        let mut places: Vec<usize> = (0..taken.len()).collect();
        places.sort_by(|a, b| clearness(b).total_cmp(&clearness(a)));
        places.into_iter().map(cause).collect()
    }

    fn of_kind(&self, kind: CauseKind) -> Vec<usize> {
        (0..self.columns.len()).filter(|i| self.columns[*i].kind == kind).collect()
    }

    /// The set of `count` columns that leaves least, and what that is. There are few columns: all sets are tried.
    fn best(&self, count: usize) -> Option<(f64, Vec<usize>)> {
        let longer = |set: &Vec<usize>| {
            let first = set.last().map_or(0, |last| last + 1);
            (first..self.columns.len()).map(|i| [&set[..], &[i]].concat()).collect::<Vec<_>>()
        };
        let sets = (0..count).fold(vec![Vec::new()], |sets: Vec<Vec<usize>>, _| sets.iter().flat_map(longer).collect());
        let tried = sets.into_iter().filter_map(|set| Some((self.left(&set)?.0, set)));
        tried.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// `taken`, where what moves both directions alike stands for two of one kind or the other way round: of a gain and both load
    /// coefficients, and of an offset and Coulomb friction in both directions, any two amount to the same. Load coefficients are named by
    /// direction, Coulomb friction too, unless it would rise in one direction and fall in the other.
    fn by_direction(&self, mut taken: Vec<usize>) -> Vec<usize> {
        for (alike, part) in [(CauseKind::Gain, CauseKind::LoadCoefficient), (CauseKind::Offset, CauseKind::Coulomb)] {
            let (wholes, parts) = (self.of_kind(alike), self.of_kind(part));
            let ([whole], [up, down]) = (&wholes[..], &parts[..]) else { continue };
            let (whole, up, down) = (*whole, *up, *down);
            let is_either = |i: &usize| [whole, up, down].contains(i);
            let rest: Vec<usize> = taken.iter().copied().filter(|i| !is_either(i)).collect();
            if rest.len() + 2 != taken.len() {
                continue;
            }
            let both = [&[up, down], &rest[..]].concat();
            let Some((_, sizes, _)) = self.left(&both) else { continue };
            // At the sensor, friction that rose in both directions moves them apart.
            let is_apart = sizes[0] * sizes[1] < 0.0;
            let larger = if sizes[0].abs() > sizes[1].abs() { up } else { down };
            taken = match part == CauseKind::Coulomb && !is_apart {
                true => [&[whole, larger], &rest[..]].concat(),
                false => both,
            };
        }
        taken
    }

    /// What would explain as well in place of the cause at `at`, the likeliest first.
    fn rivals(&self, taken: &[usize], at: usize, left: f64) -> Vec<(CauseKind, Option<Direction>)> {
        let what = |i: usize| (self.columns[i].kind, self.columns[i].direction);
        let instead = |i: usize| {
            let mut with = taken.to_vec();
            with[at] = i;
            Some((self.left(&with)?.0, what(i)))
        };
        let mut close: Vec<_> = (0..self.columns.len()).filter_map(instead).collect();
        close.retain(|(other, _)| other - left < RIVAL);
        close.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Between an offset and Coulomb friction in both directions `by_direction` has decided.
        let is_level = |kind| matches!(kind, CauseKind::Offset | CauseKind::Coulomb);
        let levels = taken.iter().filter(|i| is_level(self.columns[**i].kind)).count();
        let is_settled = |kind| is_level(kind) && is_level(self.columns[taken[at]].kind) && levels == 2;
        let mut rivals = Vec::new();
        for (_, rival) in close {
            let is_taken = taken.iter().any(|i| what(*i) == rival);
            if !is_taken && !rivals.contains(&rival) && !is_settled(rival.0) {
                rivals.push(rival);
            }
        }
        rivals
    }
}
