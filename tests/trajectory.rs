//! Trajectories: what they are sampled to, and their file.

use std::path::PathBuf;
use tautline::trajectory::{Path, Protocol, Segment, Trajectory, Wave};
use tempfile::TempDir;

const RATE_HZ: f64 = 200.0;

/// One segment of every kind, another joint moving along.
fn all_kinds() -> Trajectory {
    let sweep = |to_rad| Segment::Sweep { to_rad, speed_rad_s: 0.3, acceleration_rad_s2: 2.0 };
    let waves = [(0.1, 0.7, 0.0), (0.07, 1.9, 2.5)].map(|(amplitude_rad, frequency_hz, phase_rad)| Wave {
        amplitude_rad,
        frequency_hz,
        phase_rad,
    });
    let segments = vec![
        Segment::Rest { duration_s: 0.7 },
        sweep(1.3),
        Segment::Cosine { low_rad: 0.4, high_rad: 1.3, period_s: 3.21, periods: 2 },
        sweep(1.0 / 3.0),
        Segment::Multisine { duration_s: 9.0, fade_s: 1.5, waves: waves.to_vec() },
    ];
    let other = Path { start_rad: 0.0, segments: vec![sweep(-0.6), Segment::Rest { duration_s: 2.0 }] };
    Trajectory {
        name: "all_kinds".to_string(),
        protocol: Protocol::Free,
        repeats: Some(4),
        own: Path { start_rad: 0.2, segments },
        others: vec![other],
    }
}

fn written(text: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

#[test]
fn a_trajectory_reads_back_as_it_was_written() {
    let protocol = [
        Trajectory::sweep(0.02),
        Trajectory::cascade(),
        Trajectory::wide_cascade(),
        Trajectory::held(),
        Trajectory::touched(),
    ];
    for trajectory in protocol.into_iter().chain([all_kinds()]) {
        let (_folder, file) = written(&trajectory.to_toml());
        assert_eq!(Trajectory::read(&file).unwrap(), trajectory, "{}", trajectory.to_toml());
    }
}

#[test]
fn a_file_without_a_name_gives_its_own() {
    let toml = "format = \"trajectory/1\"\nstart_rad = 0\n[[segments]]\nkind = \"rest\"\nduration_s = 1\n";
    let (_folder, file) = written(toml);
    let read = Trajectory::read(&file).unwrap();
    assert_eq!((read.name.as_str(), read.repeats), ("mine", None));
    assert_eq!(read.positions_rad(10.0), vec![0.0; 10]);
}

#[test]
fn a_motion_is_smooth_and_as_long_as_it_says() {
    let trajectory = all_kinds();
    let positions = trajectory.positions_rad(RATE_HZ);
    assert_eq!(positions.len(), trajectory.samples(RATE_HZ));
    // The fastest wave: 0.07 rad at 1.9 Hz, with the slow one 1.3 rad/s; no step may be larger.
    let fastest = positions.windows(2).map(|pair| (pair[1] - pair[0]).abs() * RATE_HZ).fold(0.0, f64::max);
    assert!((0.5..1.4).contains(&fastest), "{fastest} rad/s");
    // No corner either: the ramps' 2 rad/s^2, the cosines' 1.7, the fastest wave's 10.
    let bend = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs() * RATE_HZ * RATE_HZ;
    let steepest = positions.windows(3).map(bend).fold(0.0, f64::max);
    assert!(steepest < 13.0, "{steepest} rad/s^2");
    let (low, high) = positions.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    assert!((high - 1.3).abs() < 1e-4 && low > 0.15, "{low} to {high}");
    assert!((positions[positions.len() - 1] - trajectory.own.end_rad()).abs() < 1e-4);
}

#[test]
fn a_trajectory_that_makes_no_sense_is_refused_with_its_row() {
    let toml = all_kinds().to_toml();
    for (from, to, expected) in [
        ("kind = \"rest\"", "kind = \"resst\"", "did you mean `rest`?"),
        ("duration_s = 0.7", "duration = 0.7", "duration_s"),
        ("speed_rad_s = 0.3", "speed_rad_s = -0.3", "above 0"),
        ("low_rad = 0.4", "low_rad = 1.4", "high_rad must be above low_rad"),
        ("high_rad = 1.3", "high_rad = 1.2", "the joint is at 1.3 there"),
        ("fade_s = 1.5", "fade_s = 5.0", "fade_s"),
        ("speed_rad_s = 0.3", "speed_rad_s = 0.00001", "36000 s at most"),
        ("name = \"all_kinds\"", "name = \"../up\"", "letters"),
        ("repeats = 4", "repeats = 0", "from 1 to 1000"),
        ("start_rad = 0.2", "start_deg = 0.2", "start_rad"),
        ("trajectory/1", "trajectory/2", "trajectory/1"),
        ("repeats = 4", "protocol = \"uniforn\"", "did you mean `uniform`?"),
    ] {
        assert!(toml.contains(from), "{from}");
        let (_folder, file) = written(&toml.replacen(from, to, 1));
        let errors = Trajectory::read(&file).unwrap_err().to_string();
        assert!(errors.contains(expected) && errors.contains("mine.toml, row"), "{from} -> {to}: {errors}");
    }
}

#[test]
fn a_uniform_motion_has_one_speed() {
    let with = |segments: &str| format!("format = \"trajectory/1\"\nprotocol = \"uniform\"\nstart_rad = 0\n{segments}");
    let sweep = |to: f64, speed: f64| format!("[[segments]]\nkind = \"sweep\"\nto_rad = {to}\nspeed_rad_s = {speed}\n");
    let read = |segments: &str| {
        let (_folder, file) = written(&with(segments));
        Trajectory::read(&file).map(|read| read.protocol).map_err(|problems| problems.to_string())
    };
    assert_eq!(read(&(sweep(1.0, 0.3) + &sweep(0.0, 0.3))), Ok(Protocol::Uniform { speed_rad_s: 0.3 }));
    assert!(read(&(sweep(1.0, 0.3) + &sweep(0.0, 0.4))).unwrap_err().contains("differ in speed"));
    assert!(read("[[segments]]\nkind = \"rest\"\nduration_s = 1\n").unwrap_err().contains("no segment is a sweep"));
}
