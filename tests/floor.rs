//! The noise floor of a campaign without repeats.

use crate::campaigns::truth;
use crate::next::diagnosed_with;
use std::f64::consts::PI;
use tautline::diagnose::{FloorSource, Kind};
use tautline::trajectory::{Path, Protocol, Segment, Trajectory};

#[test]
fn reversals_in_every_stretch_are_no_noise() {
    let segments = vec![Segment::Cosine { low_rad: 0.2, high_rad: 0.9, period_s: 0.7, periods: 100 }];
    let quick = Trajectory {
        name: "quick".to_string(),
        protocol: Protocol::Free,
        repeats: Some(1),
        own: Path { start_rad: 0.2, segments },
        others: Vec::new(),
    };
    let mut worn = truth();
    worn.friction.up.d *= 1.5;
    worn.friction.down.d *= 1.5;
    let found = diagnosed_with((&worn, &truth()), 0.02, &[], quick, 1);
    // A zero-phase low-pass of 3 Hz, of order 4 each way, passes white noise within 0.898 times 3 Hz: the integral of
    // 1/(1 + x^8)^2. At 100 Hz noise reaches to 50.
    let floor_nm = 0.02 * (3.0 * 7.0 / 8.0 * (PI / 8.0) / (PI / 8.0).sin() / 50.0).sqrt();
    assert_eq!(found.gap.floor.source, FloorSource::Spectrum);
    let ratio = found.gap.floor.rms_nm / floor_nm;
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
    assert_ne!(found.verdict.kind, Kind::None);
}
