//! The cost along one rate while the other is held.

use super::{Points, RATIO_MIN};
use crate::numerics::line::{crossing, lowest};

/// Places looked at along each rate.
const GRID: usize = 32;
/// Golden sections between two of those places: 14 resolve 0.1 % of their distance.
const SECTIONS: usize = 14;
/// Points looked at across the region that one line search found.
const ACROSS: usize = 7;

/// One rate held, the other free between `from` and `to` (logarithms), with its lowest place and the cost there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    place: usize,
    held: f64,
    from: f64,
    to: f64,
    pub lowest: f64,
    pub cost: f64,
}

impl Line {
    /// Both rates, slow first, where the free one's logarithm is `log`.
    pub fn rates(&self, log: f64) -> Vec<f64> {
        if self.place == 0 { vec![self.held, log.exp()] } else { vec![log.exp(), self.held] }
    }
}

impl Points {
    /// The cost along one rate with the other, at `place`, `held`; `None` where the limits leave no room.
    pub(super) fn line(&self, place: usize, held: f64) -> Option<Line> {
        let (low, high) = self.rate_limits();
        let (low, high) = if place == 0 { (held * RATIO_MIN, high) } else { (low, held / RATIO_MIN) };
        if low >= high {
            return None;
        }
        let mut line = Line { place, held, from: low.ln(), to: high.ln(), lowest: 0.0, cost: f64::INFINITY };
        let cost = |log: f64| self.cost(&line.rates(log)).unwrap_or(f64::INFINITY);
        let step = (line.to - line.from) / (GRID - 1) as f64;
        let at = |i: usize| line.from + step * i as f64;
        let costs: Vec<f64> = (0..GRID).map(|i| cost(at(i))).collect();
        let best = (0..GRID).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        let (lowest, _) = lowest(at(best.saturating_sub(1)), at((best + 1).min(GRID - 1)), SECTIONS, cost);
        // An end of the line may lie lower than all within.
        let lowest = [lowest, at(best)].into_iter().min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(lowest);
        (line.lowest, line.cost) = (lowest, cost(lowest));
        Some(line)
    }

    /// Rates inside the region whose `place` is `held`: across the interval of the other rate where the cost stays below
    /// `threshold`. With one rate, that rate itself.
    pub(super) fn region_along(&self, best: &[f64], place: usize, held: f64, threshold: f64) -> Vec<Vec<f64>> {
        if best.len() == 1 {
            return vec![vec![held]];
        }
        let Some(line) = self.line(place, held).filter(|line| line.cost <= threshold) else { return Vec::new() };
        let below = |log: f64| self.cost(&line.rates(log)).is_some_and(|cost| cost <= threshold);
        let end = |outside: f64| crossing(line.lowest, outside, SECTIONS, below);
        let (first, last) = (end(line.from), end(line.to));
        (0..ACROSS).map(|i| line.rates(first + (last - first) * i as f64 / (ACROSS - 1) as f64)).collect()
    }
}

/// `GRID` rates, evenly spaced in their logarithm.
pub(super) fn spaced((low, high): (f64, f64)) -> Vec<f64> {
    (0..GRID).map(|i| low * (high / low).powf(i as f64 / (GRID - 1) as f64)).collect()
}
