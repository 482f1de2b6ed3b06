//! From an interval to a verdict: pinned, trade-off, flat, at bound.

use crate::model::{Confidence, Status, scale_of_arctan};

/// A parameter is pinned when its standard error is at most this share of it.
pub const PINNED_CV: f64 = 0.10;
/// A parameter whose standard error exceeds this share of it even with all others known is flat.
pub const FLAT_CV: f64 = 0.5;

/// Takes the word `pinned` from parameters whose model does not describe the data: an interval knows only noise.
pub fn demote<'a>(known: impl Iterator<Item = &'a mut Confidence>) {
    for confidence in known.filter(|c| c.status == Status::Pinned) {
        confidence.status = Status::TradeOff;
    }
}

/// What is known of a parameter by two forms of the same law, neither of which the data rule out: both intervals.
pub fn spanning(taken: Confidence, other: Confidence) -> Confidence {
    let (low, high) = (taken.low.min(other.low), taken.high.max(other.high));
    let wider = (high - low) / (taken.high - taken.low);
    let cv = if wider.is_nan() { f64::INFINITY } else { taken.cv * wider };
    let is_lost = taken.status == Status::Pinned && cv > PINNED_CV;
    Confidence { low, high, cv, status: if is_lost { Status::TradeOff } else { taken.status } }
}

/// `confidence` of a parameter that stands for several of a larger form; one that the data do not show stays `flat`.
pub fn merged(confidence: Confidence) -> Confidence {
    let status = if confidence.status == Status::Flat { Status::Flat } else { Status::Merged };
    Confidence { status, ..confidence }
}

/// What is known of k, given what is known of p: k = 1 / atan(2 p).
pub fn of_k(of_p: Confidence) -> Confidence {
    let k = |p: f64| scale_of_arctan(p.max(0.0));
    Confidence { low: k(of_p.high), high: k(of_p.low), ..of_p }
}

/// The confidence of `value` within `ends` (in any order), `beside` added in quadrature on both sides.
///
/// `half_widths` is what the half width would be in standard errors if the size of the errors were known: where few data had
/// to tell it, the wider interval then counts against the parameter. `alone` is the coefficient of variation were all else known.
pub fn interval(value: f64, ends: [f64; 2], beside: f64, half_widths: f64, alone: f64, at_bound: bool) -> Confidence {
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    // Of a form that was not taken the best fit may lie beyond what is possible.
    let middle = value.clamp(low, high);
    let (low, high) = (middle - (middle - low).hypot(beside), middle + (high - middle).hypot(beside));
    let cv = (high - low) / 2.0 / half_widths / value.abs();
    let cv = if cv.is_nan() { f64::INFINITY } else { cv };
    let status = if at_bound {
        Status::AtBound
    } else if cv <= PINNED_CV {
        Status::Pinned
    } else if alone <= FLAT_CV {
        Status::TradeOff
    } else {
        Status::Flat
    };
    Confidence { low, high, cv, status }
}
