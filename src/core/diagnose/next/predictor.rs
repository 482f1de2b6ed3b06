//! How differently two refitted rivals predict a motion that nobody has recorded yet.
//!
//! Rival a is taken for the truth along the motion and b is fitted to what it predicts: b's own numbers free, the base within
//! its confidence. What b cannot follow, root mean square, and the same with the two exchanged: the smaller counts (the
//! T-optimal design of Atkinson & Fedorov, Biometrika 62:57, 1975, after Hunter & Reiner, Technometrics 7:307, 1965). An exact
//! tie then shows as next to nothing along every motion.

use super::super::base::BaseModel;
use super::super::candidates::FittedCause;
use super::super::folds::Folds;
use super::super::gram::{Gram, Prior, RIDGE};
use super::super::perturbation::Perturbation;
use crate::dynamics::Chain;
use crate::effects::constant_load;
use crate::model::{Model, settle};
use crate::numerics::dual::VARIABLES;
use crate::numerics::filter::LowPass;
use crate::simulate::{Course, readings_along};
use crate::trajectory::Trajectory;

/// Rows compared per independent sample: twice what the low-pass lets through.
const OVERSAMPLING: f64 = 2.0;

/// A rival at its best on the recordings, base and all.
pub struct Rival {
    pub name: &'static str,
    model: Model,
    /// What of it moves: the base's numbers, within their deviations, then the cause's own.
    moves: Vec<(Perturbation, f64)>,
}

impl Rival {
    pub fn new(tried: &FittedCause<'_>, base: &BaseModel<'_>) -> Self {
        let mut model = tried.fit.model.clone();
        base.moves.iter().zip(&tried.fit.base_x).for_each(|(way, x)| way.apply(&mut model, *x));
        let base = base.moves.iter().map(|way| (way.clone(), way.prior));
        let own = tried.fit.moves.iter().map(|way| (way.clone(), way.stride));
        Self { name: tried.cause.name(), model, moves: base.chain(own).collect() }
    }
}

/// What a motion is predicted with.
pub struct Predictor<'c> {
    pub chain: Option<&'c Chain>,
    pub rate_hz: f64,
    pub lowpass: LowPass,
    pub lowpass_hz: f64,
    pub floor_nm: f64,
    /// The measured load, as it was on average, N m at the joint.
    pub load_nm: f64,
}

/// A rival along one motion: what it predicts, and how that changes with each of its numbers.
pub struct Predicted {
    reading_nm: Vec<f64>,
    columns: Vec<Vec<f64>>,
    deviations: Vec<f64>,
}

impl Predictor<'_> {
    /// Seconds between rows that are compared.
    fn thinned(&self) -> usize {
        ((self.rate_hz / (2.0 * OVERSAMPLING * self.lowpass_hz)) as usize).max(1)
    }

    /// `rival` along `trajectory`.
    pub fn predicted(&self, rival: &Rival, trajectory: &Trajectory) -> Predicted {
        let position_rad = trajectory.positions_rad(self.rate_hz);
        let samples = position_rad.len();
        let other = |path: &crate::trajectory::Path| {
            let mut positions_rad = path.positions_rad(self.rate_hz);
            positions_rad.resize(samples, path.end_rad());
            positions_rad
        };
        let others_rad = trajectory.others.iter().map(other).collect();
        let course = Course { position_rad, others_rad, ..Course::default() };
        let joint = &rival.model.joint;
        let (_, known_from) = settle(&course.position_rad, rival.model.backlash_m() / joint.pulley_radius_m, 0.0);
        let loaded = self.loaded(&rival.model);
        let reading_nm = readings_along(&loaded, self.chain, &course, self.rate_hz);
        let ways: Vec<Perturbation> = rival.moves.iter().map(|(way, _)| way.clone()).collect();
        let of_group = |group: &[Perturbation]| {
            let readings_nm = readings_along(&Perturbation::varied(&loaded, group), self.chain, &course, self.rate_hz);
            let mut slopes_nm: Vec<[f64; VARIABLES]> = readings_nm.into_iter().map(|y| y.slopes).collect();
            self.lowpass.zero_phase_together(&mut slopes_nm);
            let column = |at: usize| self.compared(slopes_nm.iter().map(|slopes| slopes[at]), known_from);
            (0..group.len()).map(column).collect::<Vec<Vec<f64>>>()
        };
        Predicted {
            columns: ways.chunks(VARIABLES).flat_map(of_group).collect(),
            deviations: rival.moves.iter().map(|(_, deviation)| *deviation).collect(),
            reading_nm: self.compared(self.lowpass.zero_phase(&reading_nm).into_iter(), known_from),
        }
    }

    /// The samples of `series` that are compared, from `from` on.
    fn compared(&self, series: impl Iterator<Item = f64>, from: usize) -> Vec<f64> {
        series.skip(from).step_by(self.thinned()).collect()
    }

    /// `model` under the measured load.
    fn loaded(&self, model: &Model) -> Model {
        let mut loaded = model.clone();
        loaded.effects.extend((self.load_nm != 0.0).then(|| constant_load(self.load_nm)));
        loaded
    }

    /// What two rivals cannot make up for between them, root mean square, N m.
    pub fn apart_nm(&self, a: &Predicted, b: &Predicted) -> f64 {
        self.left_nm(a, b).min(self.left_nm(b, a))
    }

    /// What `b`, its numbers free, leaves of `a`.
    fn left_nm(&self, a: &Predicted, b: &Predicted) -> f64 {
        // The two may know friction's state from different samples on; their ends are the same.
        let rows = a.reading_nm.len().min(b.reading_nm.len());
        if rows == 0 {
            return 0.0;
        }
        let end = |series: &'_ [f64]| -> Vec<f64> { series[series.len() - rows..].to_vec() };
        let target: Vec<f64> = end(&a.reading_nm).iter().zip(end(&b.reading_nm)).map(|(x, y)| x - y).collect();
        let columns: Vec<Vec<f64>> = b.columns.iter().map(|column| end(column)).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let gram = Gram::new(&Folds::whole(rows), &columns, &target);
        let prior = Prior {
            rows: &[rows],
            deviations: &b.deviations,
            floor_square: self.floor_nm * self.floor_nm,
            rows_per_independent: self.rows_per_independent(),
            ridge: RIDGE,
        };
        (gram.solve(prior).square / rows as f64).max(0.0).sqrt()
    }

    fn rows_per_independent(&self) -> f64 {
        (self.rate_hz / self.thinned() as f64 / (2.0 * self.lowpass_hz)).max(1.0)
    }
}
