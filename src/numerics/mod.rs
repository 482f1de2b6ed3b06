//! Mathematics that knows no joint: each file one tool.

/// Linear least squares with covariance.
pub mod linear;

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
