//! Means, spreads, quantiles.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Two-sided level of every interval that is printed.
pub const CONFIDENCE: f64 = 0.95;

/// Half width of a two-sided `CONFIDENCE` interval in standard errors, the errors' size known.
pub const HALF_WIDTH: f64 = 1.959_963_984_540_054;

/// Arithmetic mean; NaN of nothing.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sample standard deviation (n - 1); NaN of fewer than two.
pub fn standard_deviation(values: &[f64]) -> f64 {
    let m = mean(values);
    (values.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / (values.len() as f64 - 1.0)).sqrt()
}

/// Root of the mean square; NaN of nothing.
pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// The lowest and the highest of `values`; an empty range, (inf, -inf), of nothing.
pub fn extent(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

/// The value that `share` (0 to 1) of `values` do not exceed; NaN of nothing. Reorders `values`.
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let at = ((values.len() - 1) as f64 * share.clamp(0.0, 1.0)).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Standard deviation of normal noise of which these are the `sizes`, from their median: a few that are far off do not matter; NaN of
/// nothing. Reorders `sizes`.
pub fn deviation_by_median(sizes: &mut [f64]) -> f64 {
    /// Standard deviation of the normal distribution over the median of its size.
    const OVER_MEDIAN: f64 = 1.4826;
    OVER_MEDIAN * quantile(sizes, 0.5)
}

/// Half width of a two-sided `CONFIDENCE` interval in standard errors, by Student's t with `freedom` degrees; infinite
/// without any.
pub fn student_t(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + CONFIDENCE / 2.0))
}

/// Half width of the 95 % interval of a sum of independent errors, each with its variance and the degrees of freedom that this was
/// estimated with (Satterthwaite, Biometrics Bulletin 2:110, 1946).
pub fn half_width_of_sum(parts: &[(f64, f64)]) -> f64 {
    let variance: f64 = parts.iter().map(|part| part.0).sum();
    if variance == 0.0 || !variance.is_finite() {
        return variance;
    }
    let freedom = variance.powi(2) / parts.iter().map(|(variance, freedom)| variance.powi(2) / freedom).sum::<f64>();
    student_t(freedom) * variance.sqrt()
}

/// Distance from the mean, in standard deviations, beyond which the share `outside` of a normal distribution lies, on both sides.
pub fn normal(outside: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::INFINITY, |normal| -normal.inverse_cdf(outside / 2.0))
}

/// What widens a 95 % interval so that of `count` such intervals together all hold in 95 % of cases (Bonferroni).
pub fn together(count: usize) -> f64 {
    normal((1.0 - CONFIDENCE) / count.max(1) as f64) / HALF_WIDTH
}

/// Quantile of Fisher's F at `CONFIDENCE`, with `over` and `under` degrees of freedom; infinite without any.
pub fn fisher_f(over: f64, under: f64) -> f64 {
    FisherSnedecor::new(over, under).map_or(f64::INFINITY, |f| f.inverse_cdf(CONFIDENCE))
}

/// The mean of a Poisson count that `count` or fewer still come of with a chance of 5 %: half the 95 % quantile of chi-square
/// with 2 (count + 1) degrees (Garwood, Biometrika 28:437, 1936); infinite where that has no value.
pub fn poisson_bound(count: f64) -> f64 {
    ChiSquared::new(2.0 * (count + 1.0)).map_or(f64::INFINITY, |chi| chi.inverse_cdf(CONFIDENCE) / 2.0)
}

/// The median of a mean of `freedom` squares of normal deviates, as a share of what it is the mean of (Wilson and Hilferty 1931).
pub fn median_of_squares(freedom: f64) -> f64 {
    (1.0 - 2.0 / (9.0 * freedom)).powi(3)
}

/// Chance that chi squared with `freedom` degrees exceeds `value`; NaN without any.
pub fn chi_squared_tail(value: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::NAN, |chi| chi.sf(value.max(0.0)))
}

/// Chance that Fisher's F with `over` and `under` degrees of freedom exceeds `value`; 1 without any.
pub fn fisher_tail(value: f64, over: f64, under: f64) -> f64 {
    FisherSnedecor::new(over, under).map_or(1.0, |f| f.sf(value.max(0.0)))
}
/// Root mean square error of evenly sampled `readings` of something smooth, as second differences show it: where errors are
/// independent of each other, the square of a second difference is six times theirs.
pub fn reading_noise(readings: &[f64]) -> f64 {
    let bends: Vec<f64> = readings.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]).collect();
    root_mean_square(&bends) / 6f64.sqrt()
}
