//! Agreement with other programs, through values that committed scripts wrote.

use serde_json::Value;
use std::path::Path;
use tautline::dynamics::{Chain, Motion};
use tautline::numerics::filter::LowPass;

/// Largest difference relative to the signal's size: what two libraries' rounding leaves is 3e-13 at 170 samples per period of the cut-off,
/// 1e-10 at 4000.
const FILTER_AGREEMENT: f64 = 1e-9;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// `scripts/reference/filter.py`: SciPy's `butter` and `sosfiltfilt`, edges included.
#[test]
fn low_pass_agrees_with_scipy() {
    let reference: Value =
        serde_json::from_str(&std::fs::read_to_string("tests/reference/filter.json").unwrap()).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert!(cases.len() > 30);
    for case in cases {
        let order = case["order"].as_u64().unwrap() as usize;
        let (cutoff_hz, rate_hz) = (case["cutoff_hz"].as_f64().unwrap(), case["rate_hz"].as_f64().unwrap());
        let filter = LowPass::new(order, cutoff_hz, rate_hz).unwrap();
        let expected = numbers(&case["filtered"]);
        let filtered = filter.zero_phase(&numbers(&case["signal"]));
        assert_eq!(filtered.len(), expected.len());
        let size = expected.iter().fold(0f64, |m, x| m.max(x.abs()));
        for (i, (ours, theirs)) in filtered.iter().zip(&expected).enumerate() {
            let off = (ours - theirs).abs() / size;
            assert!(off < FILTER_AGREEMENT, "order {order}, {cutoff_hz} of {rate_hz} Hz, sample {i}: off by {off:e}");
        }
    }
}

#[test]
fn signals_side_by_side_are_filtered_as_each_alone() {
    for order in [1, 2, 4, 5] {
        let filter = LowPass::new(order, 5.0, 100.0).unwrap();
        let mut together: Vec<[f64; 3]> =
            (0..300).map(|i| [0.0, 1.3, 2.6].map(|phase| (0.17 * f64::from(i) + phase).sin() + phase)).collect();
        let alone = [0, 1, 2].map(|k| filter.zero_phase(&together.iter().map(|x| x[k]).collect::<Vec<f64>>()));
        filter.zero_phase_together(&mut together);
        for (i, x) in together.iter().enumerate() {
            assert_eq!(*x, [alone[0][i], alone[1][i], alone[2][i]], "order {order}, sample {i}");
        }
    }
}

#[test]
fn a_filter_that_cannot_be_is_refused() {
    assert!(LowPass::new(0, 5.0, 100.0).is_none());
    assert!(LowPass::new(4, 50.0, 100.0).is_none());
    assert!(LowPass::new(4, f64::NAN, 100.0).is_none());
    assert!(LowPass::new(4, -1.0, 100.0).is_none());
}

#[test]
fn a_signal_shorter_than_the_padding_passes_unchanged() {
    let filter = LowPass::new(4, 5.0, 100.0).unwrap();
    let signal: Vec<f64> = (0..LowPass::padding(4)).map(|i| i as f64).collect::<Vec<f64>>();
    assert_eq!(filter.zero_phase(&signal), signal);
}

/// Largest difference of a joint torque, N m: two programs' rounding leaves 1e-13.
const TORQUE_AGREEMENT_NM: f64 = 1e-9;

/// `scripts/reference/chain.py`: Pinocchio's inverse dynamics at random states of three URDFs, joint by joint.
#[test]
fn chain_dynamics_agree_with_pinocchio() {
    let reference: Value =
        serde_json::from_str(&std::fs::read_to_string("tests/reference/chain.json").unwrap()).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert!(cases.len() > 30);
    for case in cases {
        let names: Vec<&str> = case["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
        let [positions, velocities, accelerations] =
            ["positions", "velocities", "accelerations"].map(|key| numbers(&case[key]));
        let motion =
            |at: usize| Motion { position: positions[at], velocity: velocities[at], acceleration: accelerations[at] };
        for (at, name) in names.iter().enumerate() {
            let chain = Chain::read(Path::new(case["urdf"].as_str().unwrap()), name).unwrap();
            let others: Vec<Motion> = chain
                .others()
                .map(|(other, _)| motion(names.iter().position(|known| *known == other).unwrap()))
                .collect();
            let ours = chain.torque(motion(at), &others);
            for (part, ours) in
                [("gravity_nm", ours.gravity_nm), ("inertia_nm", ours.inertia_nm), ("coriolis_nm", ours.coriolis_nm)]
            {
                let theirs = numbers(&case[part])[at];
                assert!((ours - theirs).abs() < TORQUE_AGREEMENT_NM, "{name}, {part}: {ours} against {theirs}");
            }
        }
    }
}
