//! A joint whose friction changes over in another way than along the curve of its model.

use crate::campaigns::truth;
use crate::next::diagnosed_with;
use tautline::trajectory::{Path, Protocol, Segment, Trajectory};

#[test]
fn a_change_over_of_another_shape_than_the_model_has_is_found() {
    let segments = [(16.0, 2), (7.0, 6), (4.0, 8)];
    let cosine = |(period_s, periods)| Segment::Cosine { low_rad: 0.2, high_rad: 1.1, period_s, periods };
    let swings = Trajectory {
        name: "swings".to_string(),
        protocol: Protocol::Free,
        repeats: Some(2),
        own: Path { start_rad: 0.2, segments: segments.map(cosine).to_vec() },
        others: Vec::new(),
    };
    // The model's own: 0.8 mm with p = 2.05. With that p no width rises so slowly at first.
    let late = "reversal_transition:backlash_m=0.006,p=0.4,n=2.5";
    let found = diagnosed_with((&truth(), &truth()), 0.01, &[late], swings, 7);
    let named: Vec<&str> = found.verdict.effects.iter().map(|cause| cause.name()).collect();
    assert_eq!(named, ["reversal_transition"], "{:?}", found.verdict.kind);
    let [width_m, ..] = found.after.effects[0].parameters[..] else { panic!("no shape") };
    assert!((width_m / 0.006 - 1.0).abs() < 0.1, "{width_m}");
}
