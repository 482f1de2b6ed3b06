//! The life of a joint: what happened to each of its parameters and functions over sessions, and when a limit will be reached.
//!
//! | file | what it does |
//! |---|---|
//! | `regression` | a level, what happened to it, and a scatter from session to session |
//! | `search` | which jumps, episodes and drifts there are, by one criterion |
//! | `alike` | what other joints say of that scatter |
//! | `limit` | when a limit will be reached, or why that cannot be said |

mod alike;
mod limit;
mod regression;
mod search;

pub(super) use alike::Scatters;
pub use limit::{Forecast, Limit, Refusal};
pub(super) use regression::Alike;
pub use regression::Part;

use super::quantities::Quantity;
use crate::numerics::statistics::quantile;
use limit::ahead;
use regression::{Course, Fit, SCATTER_KNOWN_FROM};
use search::Search;

/// Differences below this share of a value count as zero, however narrow the intervals of the sessions are.
const IMMATERIAL: f64 = 1e-3;
/// Fewest sessions with a temperature that can show what follows it.
const TEMPERATURES_MIN: usize = 6;
/// Temperatures that differ by less than this show nothing, K.
const STEADY_K: f64 = 1.0;

/// The sessions of one joint, in time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sessions {
    /// When each was, days since 1970; their numbers where dates are not known.
    pub days: Vec<f64>,
    /// Whether `days` are days.
    pub dated: bool,
    /// The temperature of each, degC, where it was recorded.
    pub temperatures_degc: Vec<Option<f64>>,
    /// First sessions after retensionings.
    pub retensioned: Vec<usize>,
}

/// What happened to one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Life {
    /// Its name, as `batch` names quantities.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Which of the joint's sessions show it.
    pub sessions: Vec<usize>,
    /// What happened, in time.
    pub parts: Vec<Happened>,
    /// Scatter between sessions beyond what they claim, a standard deviation; NaN with too few sessions to say.
    pub scatter: f64,
    /// What would have been found without the recorded temperature, where that differs.
    pub without_temperature: Option<Vec<Happened>>,
    course: Course,
    fit: Fit,
}

/// One thing that happened to a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Happened {
    /// What and when, in numbers of the joint's sessions.
    pub part: Part,
    /// Its size: in the quantity's unit, of a drift per day, of temperature per K.
    pub size: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
}

/// The fitted change of a quantity from one session to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// At the first.
    pub before: f64,
    /// At the other.
    pub after: f64,
    /// Half width of the change's 95 % interval.
    pub half_width: f64,
}

impl Life {
    /// Of `quantity` over `sessions`, one of `compared` of the fleet; `None` where too few sessions show it.
    pub(super) fn new(quantity: &Quantity, sessions: &Sessions, compared: usize) -> Option<Self> {
        let shown: Vec<usize> = (0..quantity.values.len()).filter(|i| quantity.values[*i].is_some()).collect();
        let known = || quantity.values.iter().flatten();
        // A quantity without intervals needs a known scatter.
        let is_claimed = known().all(|value| value.1 > 0.0);
        if shown.len() < if is_claimed { 2 } else { SCATTER_KNOWN_FROM } {
            return None;
        }
        let values: Vec<f64> = known().map(|value| value.0).collect();
        let immaterial = IMMATERIAL * typical(&values);
        let course = Course {
            days: shown.iter().map(|i| sessions.days[*i]).collect(),
            variances: known().map(|value| value.1.powi(2) + immaterial.powi(2)).collect(),
            temperatures: sessions.temperatures(&shown),
            alike: None,
            values,
        };
        Self::found(quantity.name.clone(), quantity.unit, shown, course, sessions, compared)
    }

    /// The same where other joints say `alike` of its scatter.
    pub(super) fn informed(self, alike: Option<Alike>, sessions: &Sessions, compared: usize) -> Self {
        if alike.is_none() {
            return self;
        }
        let (shown, course) = (self.sessions.clone(), Course { alike, ..self.course.clone() });
        Self::found(self.name.clone(), self.unit, shown, course, sessions, compared).unwrap_or(self)
    }

    /// What happened along `course`, of the sessions `shown`; `None` where they cannot tell.
    fn found(
        name: String,
        unit: &'static str,
        shown: Vec<usize>,
        course: Course,
        sessions: &Sessions,
        compared: usize,
    ) -> Option<Self> {
        // Before the first session that shows it nothing changed.
        let mut retensioned: Vec<usize> = sessions.retensioned.iter().map(|at| after(&shown, *at)).collect();
        retensioned.retain(|at| (1..shown.len()).contains(at));
        retensioned.dedup();
        let search = Search { course: &course, retensioned: &retensioned, compared };
        let plain = search.run(&[])?;
        let warm = course.temperatures.as_ref().and_then(|_| search.run(&[Part::Temperature]));
        // Temperature is taken where it leaves less to explain, or explains much itself.
        let is_better = |warm: &Fit| {
            let [with, without] =
                [warm, &plain].map(|fit| fit.parts.iter().filter(|p| **p != Part::Temperature).count());
            let explains = || warm.chance_of(&course, Part::Temperature) * (compared as f64) < search::OUTSIDE;
            with < without || with == without && explains()
        };
        let warm = warm.filter(is_better);
        let happened = |fit: &Fit| happened(fit, &shown);
        let others = |parts: &[Happened]| {
            let all = parts.iter().map(|of| of.part).filter(|part| *part != Part::Temperature);
            all.collect::<Vec<Part>>()
        };
        let without = warm.as_ref().map(|warm| (happened(warm), happened(&plain)));
        let without_temperature = without.filter(|(a, b)| others(a) != others(b)).map(|(_, plain)| plain);
        let fit = warm.unwrap_or(plain);
        Some(Self {
            name,
            unit,
            parts: happened(&fit),
            scatter: fit.scatter,
            without_temperature,
            sessions: shown,
            course,
            fit,
        })
    }

    /// From the joint's session `from` to `to`, both of which show it; `None` where nothing happened between them.
    pub fn between(&self, from: usize, to: usize) -> Option<Change> {
        let place = |session: usize| self.sessions.iter().position(|i| *i == session);
        let [a, b] = [place(from)?, place(to)?].map(|i| self.fit.factors(&self.course, i));
        let difference: Vec<f64> = b.iter().zip(&a).map(|(b, a)| b - a).collect();
        let (_, se) = self.fit.combined(&difference);
        let (before, after) = (self.fit.combined(&a).0, self.fit.combined(&b).0);
        (difference.iter().any(|x| *x != 0.0)).then_some(Change {
            before,
            after,
            half_width: self.fit.half_widths() * se,
        })
    }

    /// What was fitted in each of `sessions`, the temperature's part left out.
    pub fn fitted(&self) -> Vec<f64> {
        let fitted = |i| self.fit.combined(&self.fit.factors(&self.course, i)).0;
        (0..self.course.len()).map(fitted).collect()
    }

    /// Value and half width of the 95 % interval as each of `sessions` claims them.
    pub fn claimed(&self) -> impl Iterator<Item = (f64, f64)> {
        let half = |variance: &f64| crate::numerics::statistics::HALF_WIDTH * variance.sqrt();
        self.course.values.iter().copied().zip(self.course.variances.iter().map(half))
    }

    /// Its usual size.
    pub(super) fn typical(&self) -> f64 {
        typical(&self.course.values)
    }

    /// Its scatter between sessions as a variance over the square of its size, what the sessions claim, likewise, and the degrees of
    /// freedom; `None` where that is not known.
    pub(super) fn told_scatter(&self) -> Option<[f64; 3]> {
        let typical = self.typical();
        let claimed = self.course.variances.iter().sum::<f64>() / self.course.len() as f64;
        let known = self.scatter.is_finite() && typical > 0.0 && self.fit.freedom >= 1.0;
        known.then(|| [(self.scatter / typical).powi(2), claimed / typical.powi(2), self.fit.freedom])
    }

    /// When its magnitude will be beyond `limit`.
    pub(super) fn forecast(&self, limit: &Limit) -> Forecast {
        ahead(&self.course, &self.fit, limit)
    }
}

impl Sessions {
    /// The temperatures of `shown` less their mean, if they can show anything.
    fn temperatures(&self, shown: &[usize]) -> Option<Vec<f64>> {
        let known: Option<Vec<f64>> = shown.iter().map(|i| self.temperatures_degc[*i]).collect();
        let known = known.filter(|known| known.len() >= TEMPERATURES_MIN)?;
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let spread = known.iter().fold(0.0, |most: f64, t| most.max((t - mean).abs()));
        (spread > STEADY_K / 2.0).then(|| known.iter().map(|t| t - mean).collect())
    }
}

/// The median size of `values`.
fn typical(values: &[f64]) -> f64 {
    quantile(&mut values.iter().map(|value| value.abs()).collect::<Vec<f64>>(), 0.5)
}

/// The place in `shown` of the first session from `session` on.
fn after(shown: &[usize], session: usize) -> usize {
    shown.iter().position(|i| *i >= session).unwrap_or(shown.len())
}

/// The parts of `fit` in numbers of the joint's sessions, in time.
fn happened(fit: &Fit, shown: &[usize]) -> Vec<Happened> {
    let part = |part: Part| match part {
        Part::Jump { at, until, retensioned } => {
            Part::Jump { at: shown[at], until: until.map(|until| shown[until]), retensioned }
        }
        Part::Drift { from } => Part::Drift { from: shown[from] },
        Part::Temperature => Part::Temperature,
    };
    let one = |(at, of): (usize, &Part)| Happened {
        part: part(*of),
        size: fit.sizes[at + 1],
        half_width: fit.half_widths() * fit.covariance[(at + 1, at + 1)].sqrt(),
    };
    let mut all: Vec<Happened> = fit.parts.iter().enumerate().map(one).collect();
    let place = |of: &Happened| match of.part {
        Part::Temperature => 0,
        Part::Drift { from } => from + 1,
        Part::Jump { at, .. } => at + 1,
    };
    all.sort_by_key(place);
    all
}
