//! Standard errors of a least squares fit whose errors hang together within clusters (a reversal, a stroke) but hardly between
//! them: the sandwich estimator. Samples of a filtered signal are no independent observations; whole clusters nearly are.

use nalgebra::{DMatrix, DVector};

/// Covariance of the parameters: bread (J'J)^-1, meat the scores J'e of each cluster, one column of `scores` each.
pub fn covariance(bread: &DMatrix<f64>, scores: &[DVector<f64>]) -> DMatrix<f64> {
    let (n, clusters) = (bread.nrows(), scores.len() as f64);
    let mut meat = DMatrix::zeros(n, n);
    for score in scores {
        meat += score * score.transpose();
    }
    let small_sample = clusters / freedom(scores.len(), n);
    bread * meat * bread * small_sample
}

/// Degrees of freedom that `clusters` leave to `parameters`, at least one.
pub fn freedom(clusters: usize, parameters: usize) -> f64 {
    (clusters as f64 - parameters as f64).max(1.0)
}
