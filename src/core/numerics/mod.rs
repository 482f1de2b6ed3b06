//! Mathematics that knows no joint: each file one tool.

/// Linear least squares with covariance.
pub mod linear;

/// Which combinations of its parameters a design shows.
pub mod rank;

/// Levenberg-Marquardt within bounds, with covariance.
pub mod marquardt;

/// Least cost and crossings along one line.
pub mod line;

/// Filters that run one sample at a time.
pub mod causal;

/// Standard errors from clusters of samples.
pub mod cluster;

/// Zero-phase Butterworth low-pass.
pub mod filter;

/// Velocity and acceleration from samples of a position.
pub mod difference;

/// Where a falling function crosses zero.
pub mod root;

/// A series read between its samples.
pub mod resample;

/// Means, spreads, quantiles.
pub mod statistics;

/// Numbers that a formula can be written over.
pub mod scalar;

/// Second-order sections of filters.
mod section;

/// Numbers that carry their derivatives.
pub mod dual;

/// Numbers that remember how they came about, to be printed as code.
pub mod expression;

/// Arrays filled in place.
pub mod fill;
