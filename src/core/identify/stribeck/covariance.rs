//! What the points know of a fit's coefficients and rates together, to first order.

use super::{ExponentialFit, Points, row};
use crate::model::decayed;
use crate::numerics::linear::solve;
use nalgebra::{DMatrix, DVector};

impl Points {
    /// s^2 (J' W J)^-1 at `fit`: the covariance of its coefficients, then of its rates, each in its own unit, J being the
    /// derivatives of (19). A rate that ended at its limit is held: its row and column are zero.
    ///
    /// Errors, in words: no more points than parameters, or a Jacobian whose columns depend on each other.
    pub fn covariance(&self, fit: &ExponentialFit) -> Result<DMatrix<f64>, &'static str> {
        let freedom = fit.freedom();
        if freedom < 1.0 {
            return Err("exactly determined: as many parameters as points");
        }
        let coefficients = fit.coefficients.len();
        let rates = (0..fit.rates.len()).filter(|i| !fit.at_bound[*i]).map(|i| coefficients + i);
        let free: Vec<usize> = (0..coefficients).chain(rates).collect();
        let slopes: Vec<Vec<f64>> = self.speeds.iter().map(|s| slopes(fit, s.speed_rad_s)).collect();
        let jacobian =
            DMatrix::from_fn(self.speeds.len(), free.len(), |i, j| self.speeds[i].weight.sqrt() * slopes[i][free[j]]);
        let solved = solve(jacobian, DVector::zeros(self.speeds.len()));
        let unscaled = solved.ok_or("singular: the points do not tell the parameters apart")?.unscaled_covariance();
        let mut all = DMatrix::zeros(fit.parameters(), fit.parameters());
        for (i, a) in free.iter().enumerate() {
            for (j, b) in free.iter().enumerate() {
                all[(*a, *b)] = unscaled[(i, j)] * fit.residual_sum / freedom;
            }
        }
        Ok(all)
    }
}

/// Derivatives of B at `speed_rad_s` by the coefficients, then by the rates.
fn slopes(fit: &ExponentialFit, speed_rad_s: f64) -> Vec<f64> {
    let by_rate = |(rate, b): (&f64, &f64)| -b * speed_rad_s * decayed(*rate, speed_rad_s);
    let by_rates = fit.rates.iter().zip(fit.coefficients.iter().skip(2)).map(by_rate);
    row(speed_rad_s, &fit.rates).chain(by_rates).collect()
}
