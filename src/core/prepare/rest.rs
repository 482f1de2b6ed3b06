//! Where a joint rests: dry friction holds it there under any torque up to its own, so that no model knows which.

/// A joint that stays within this travel for [`REST_S`] to either side rests, rad: far below any sweep, above an encoder's noise.
pub const REST_RAD: f64 = 2e-4;
/// See [`REST_RAD`], s.
pub const REST_S: f64 = 0.1;

/// Where the joint rests: it stays within [`REST_RAD`], or the encoder's noise, for [`REST_S`] before and after.
pub fn rests(positions_rad: &[f64], rate_hz: f64, deadband_rad: f64) -> Vec<bool> {
    let reach = ((REST_S * rate_hz) as usize).max(1);
    let limit_rad = REST_RAD.max(2.0 * deadband_rad);
    let last = positions_rad.len().saturating_sub(1);
    let travel = |i: usize| {
        let (before, after) = (positions_rad[i.saturating_sub(reach)], positions_rad[(i + reach).min(last)]);
        (before - positions_rad[i]).abs().max((after - positions_rad[i]).abs())
    };
    (0..positions_rad.len()).map(|i| travel(i) < limit_rad).collect()
}
