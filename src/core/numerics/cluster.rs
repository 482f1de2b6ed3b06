//! Standard errors of a least squares fit whose errors hang together within clusters (a reversal, a stroke) but hardly between
//! them: the sandwich estimator. Samples of a filtered signal are no independent observations; whole clusters nearly are.

use nalgebra::{DMatrix, DVector};

/// Fewer clusters than these tell nothing of the errors: their scores, which sum to nearly zero at the optimum, then say
/// more of the fit than of the noise.
const FEWEST: usize = 5;

/// Covariance of the parameters: bread (J'J)^-1, meat the scores J'e of each cluster, one column of `scores` each; infinite
/// where the clusters leave no `freedom`.
pub fn covariance(bread: &DMatrix<f64>, scores: &[DVector<f64>]) -> DMatrix<f64> {
    let (n, clusters) = (bread.nrows(), scores.len() as f64);
    let freedom = freedom(scores.len(), n);
    if freedom == 0.0 {
        return DMatrix::from_element(n, n, f64::INFINITY);
    }
    let mut meat = DMatrix::zeros(n, n);
    for score in scores {
        meat += score * score.transpose();
    }
    bread * meat * bread * (clusters / freedom)
}

/// Degrees of freedom that `clusters` leave to `parameters`; zero with too few clusters to tell anything of the errors.
pub fn freedom(clusters: usize, parameters: usize) -> f64 {
    if clusters < FEWEST { 0.0 } else { clusters.saturating_sub(parameters) as f64 }
}
