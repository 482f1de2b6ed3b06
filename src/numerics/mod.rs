//! Mathematics that knows no joint: each file one tool.

/// Linear least squares with covariance.
pub mod linear;

/// Levenberg-Marquardt within bounds, with covariance.
pub mod marquardt;

/// Least cost and crossings along one line.
pub mod line;

/// Standard errors from clusters of samples.
pub mod causal;
pub mod cluster;

/// Zero-phase Butterworth low-pass.
pub mod filter;

/// Velocity and acceleration from samples of a position.
pub mod difference;

/// Means, spreads, quantiles.
pub mod statistics;
