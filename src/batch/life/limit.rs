//! When a limit will be reached, with an interval, or why the history cannot say.
//!
//! The fitted line is continued at its slope of now. The interval holds every time at which the line, within its own 95 %
//! interval, may cross the limit (Fieller, J. R. Stat. Soc. B 16:175, 1954): (f(t) - L)^2 <= q^2 var f(t), a quadratic in t.

use super::regression::{Course, Fit, Part};

/// Fewest sessions from which a limit is foreseen.
const SESSIONS_MIN: usize = 6;

/// What a quantity is not to exceed.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The joint, or all.
    pub joint: Option<String>,
    /// The quantity: `friction_nm`, `backlash_m`, `change_over_m`, `rmse_nm` or a parameter's dotted name.
    pub what: String,
    /// The speed at which friction is meant, rad/s; the middle of the sweeps' where that is not told.
    pub speed_rad_s: Option<f64>,
    /// The limit.
    pub value: f64,
    /// Whether the magnitude is to stay below it, rather than above.
    pub is_upper: bool,
}

/// When a limit will be reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Forecast {
    /// It is.
    Reached,
    /// After so many days from the last session, with the ends of the 95 % interval.
    In {
        /// Most likely.
        days: f64,
        /// The earliest.
        low_days: f64,
        /// The latest.
        high_days: f64,
    },
    /// The history cannot say.
    Unknown(Refusal),
}

/// Why a history cannot say when a limit will be reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// There are so few sessions.
    Sessions(usize),
    /// No session identifies the quantity, or one alone.
    NotIdentified,
    /// Without dates there is no when.
    Undated,
    /// The drift is not significant.
    NoDrift,
    /// It drifts away from the limit.
    Away,
    /// Not before the day `low_days` after the last session; its latest end is beyond the history's own length.
    Beyond {
        /// The earliest, days from the last session.
        low_days: f64,
        /// The history's own length, days.
        history_days: f64,
    },
}

impl Refusal {
    /// In words.
    pub fn words(self) -> String {
        match self {
            Self::Sessions(n) => format!("{n} sessions are too few to foresee anything: record {SESSIONS_MIN}"),
            Self::NotIdentified => "no two sessions identify it".to_string(),
            Self::Undated => "not all sessions have a `date`".to_string(),
            Self::NoDrift => "no drift can be told from none".to_string(),
            Self::Away => "it drifts away from the limit".to_string(),
            Self::Beyond { low_days, history_days } => format!(
                "not within {low_days:.0} days; the latest day is farther ahead than the history of {history_days:.0} days reaches back"
            ),
        }
    }
}

/// When the magnitude of what `fit` holds of `course` will pass `limit`.
pub(super) fn ahead(course: &Course, fit: &Fit, limit: &Limit) -> Forecast {
    let last = course.len() - 1;
    let now = fit.factors(course, last);
    let (level, _) = fit.combined(&now);
    // Friction moving down is negative: its magnitude is limited.
    let target = limit.value * level.signum();
    if (level.abs() > limit.value) == limit.is_upper {
        return Forecast::Reached;
    }
    if course.len() < SESSIONS_MIN {
        return Forecast::Unknown(Refusal::Sessions(course.len()));
    }
    let drifts = |part: &Part| f64::from(matches!(part, Part::Drift { .. }));
    let ahead: Vec<f64> = std::iter::once(0.0).chain(fit.parts.iter().map(drifts)).collect();
    let (slope, slope_se) = fit.combined(&ahead);
    let q = fit.half_widths();
    if slope.abs() <= q * slope_se {
        return Forecast::Unknown(Refusal::NoDrift);
    }
    let days = (target - level) / slope;
    if days < 0.0 {
        return Forecast::Unknown(Refusal::Away);
    }
    // (level - L + slope t)^2 <= q^2 (v0 + 2 v01 t + v11 t^2), with v the covariance of level and slope.
    let (_, se) = fit.combined(&now);
    let (_, both) = fit.combined(&now.iter().zip(&ahead).map(|(a, b)| a + b).collect::<Vec<f64>>());
    let (v0, v11) = (se * se, slope_se * slope_se);
    let v01 = (both * both - v0 - v11) / 2.0;
    let (a, b, c) =
        (slope * slope - q * q * v11, (level - target) * slope - q * q * v01, (level - target).powi(2) - q * q * v0);
    let root = (b * b - a * c).max(0.0).sqrt();
    let (low_days, high_days) = (((-b - root) / a).max(0.0), (-b + root) / a);
    let history_days = course.days[last] - course.days[0];
    match high_days <= history_days {
        true => Forecast::In { days, low_days, high_days },
        false => Forecast::Unknown(Refusal::Beyond { low_days, history_days }),
    }
}
