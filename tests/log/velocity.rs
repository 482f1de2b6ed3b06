//! A recorded velocity is held against the position.

use super::{CAMPAIGN, folder, read_first};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::fmt::Write;

/// What reading a log of 20 s at 500 Hz gives: positions in deg by time, and velocities in what the log is said to hold.
fn problem(unit: &str, position: impl Fn(f64) -> f64, velocity: impl Fn(f64) -> f64) -> Option<String> {
    let column = format!("velocity = {{ name = \"vel\", unit = \"{unit}\" }}\n\n[[trials]]");
    let campaign = CAMPAIGN.replacen("\n[[trials]]", &column, 1);
    let campaign = campaign.replace("uniform", "free").replace("speed_rad_s = 0.5\n", "");
    let mut text = "t,pos,trq,vel\n".to_string();
    for row in 0..10_000 {
        let t = f64::from(row) * 2e-3;
        writeln!(text, "{t:.3},{:.4},{:.5},{:.5}", position(t), (7.0 * t).sin(), velocity(t)).expect("writes");
    }
    read_first(folder(&campaign, text).path()).err().map(|problems| problems.to_string())
}

fn position(t: f64) -> f64 {
    45.0 - 45.0 * (0.3 * t).cos()
}

fn velocity_deg_s(t: f64) -> f64 {
    13.5 * (0.3 * t).sin()
}

#[test]
fn a_good_velocity_passes_however_coarse_the_sensors() {
    let normal = Normal::new(0.0, 1.0).expect("a spread");
    let random = std::cell::RefCell::new(ChaCha8Rng::seed_from_u64(1));
    let noise = || normal.sample(&mut *random.borrow_mut());
    assert_eq!(problem("deg/s", position, velocity_deg_s), None);
    assert_eq!(problem("deg/s", |t| (position(t) * 4.0).round() / 4.0, |t| velocity_deg_s(t) + 3.0 * noise()), None);
    assert_eq!(problem("deg/s", |t| position(t) + 0.05 * noise(), |t| velocity_deg_s(t - 0.1)), None);
    assert_eq!(problem("rpm", position, |t| velocity_deg_s(t) / 6.0), None);
}

#[test]
fn a_joint_at_rest_tells_nothing() {
    let normal = Normal::new(0.0, 0.1).expect("a spread");
    let random = std::cell::RefCell::new(ChaCha8Rng::seed_from_u64(1));
    let noise = || normal.sample(&mut *random.borrow_mut());
    assert_eq!(problem("deg/s", |_| 30.0 + noise(), |_| noise()), None);
    // An encoder between two counts.
    assert_eq!(problem("deg/s", |_| if noise() > 0.25 { 30.01 } else { 30.0 }, |_| 0.0), None);
}

#[test]
fn a_wrong_velocity_is_told_with_its_slope_and_cure() {
    let delete = "delete columns.velocity";
    type Case<'a> = (&'a str, &'a dyn Fn(f64) -> f64, &'a [&'a str]);
    let cases: [Case<'_>; 5] = [
        ("rad/s", &velocity_deg_s, &["a.csv", "`vel`", "57.29", "to `deg/s`", delete]),
        ("deg/s", &|t| velocity_deg_s(t).to_radians(), &["0.017", "to `rad/s`", delete]),
        ("deg/s", &|t| -velocity_deg_s(t), &["-1.000 times", "turn its sign", delete]),
        ("deg/s", &|_| 0.0, &["is 0 times", delete]),
        ("deg/s", &|t| 1.4 * velocity_deg_s(t), &["1.400 times", delete]),
    ];
    for (unit, velocity, words) in cases {
        let found = problem(unit, position, velocity).expect("refused");
        for word in words {
            assert!(found.contains(word), "{word} not in {found}");
        }
    }
}
