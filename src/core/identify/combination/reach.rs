//! How far after a reversal a curve is fitted.

use super::Settings;
use crate::identify::predicted::Prepared;
use crate::identify::windows::{Window, windows};
use crate::model::Model;
use crate::numerics::statistics::quantile;
use rayon::prelude::*;
use std::borrow::Borrow;

/// A window follows the motion after a reversal for this many clearances.
const REACH_BACKLASHES: f64 = 1.5;
/// A window follows it for at least this share of the median stroke, should the declared clearance be next to nothing.
const REACH_LEAST: f64 = 0.02;
/// When the clearance is estimated, up to this share of the median stroke.
const REACH_STROKE: f64 = 0.5;
/// The smallest clearance looked for, in deadbands of the encoder.
const MIN_DEADBANDS: f64 = 3.0;

/// How far after a reversal to look.
pub(super) struct Reach {
    /// The travel that a window follows, rad.
    reach_rad: f64,
    /// Where the clearance is looked for, if it is, rad.
    pub span_rad: Option<(f64, f64)>,
    /// The median stroke between reversals, rad.
    pub stroke_rad: f64,
}

impl Reach {
    /// As `settings` ask for.
    pub fn new<T: Borrow<Prepared>>(trials: &[T], model: &Model, settings: Settings) -> Self {
        let stroke_rad = median_stroke_rad(trials);
        let declared_rad = model.joint.backlash_rad();
        let reach_rad = if settings.estimate_backlash {
            (REACH_STROKE * stroke_rad).max(REACH_BACKLASHES * declared_rad)
        } else {
            (REACH_BACKLASHES * declared_rad).max(REACH_LEAST * stroke_rad).min(stroke_rad)
        };
        let deadband_rad = trials.iter().map(|t| t.borrow().series.deadband_rad).fold(0.0, f64::max);
        let smallest_rad = (MIN_DEADBANDS * deadband_rad).max(1e-3 * reach_rad);
        Self { reach_rad, span_rad: settings.estimate_backlash.then_some((smallest_rad, reach_rad)), stroke_rad }
    }

    /// With the clearance as the model has it.
    pub fn as_declared<T: Borrow<Prepared>>(trials: &[T], model: &Model) -> Self {
        let stroke_rad = median_stroke_rad(trials);
        let reach_rad = (REACH_BACKLASHES * model.joint.backlash_rad()).min(stroke_rad);
        Self { reach_rad, span_rad: None, stroke_rad }
    }

    /// The windows of all trials; `None` without any.
    pub fn windows<'a, T: Borrow<Prepared> + Sync>(
        &self,
        trials: &'a [T],
        model: &Model,
        lowpass_hz: f64,
    ) -> Option<Vec<Window<'a>>> {
        let of = |trial: &'a T| windows(trial.borrow(), model, self.reach_rad, lowpass_hz);
        let all: Vec<Window> = trials.par_iter().flat_map_iter(of).collect();
        (!all.is_empty()).then_some(all)
    }
}

fn median_stroke_rad<T: Borrow<Prepared>>(trials: &[T]) -> f64 {
    let mut strokes: Vec<f64> = trials.iter().flat_map(|trial| trial.borrow().strokes_rad()).copied().collect();
    quantile(&mut strokes, 0.5)
}
