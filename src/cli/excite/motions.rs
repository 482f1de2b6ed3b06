//! The motions that `tautline excite` makes, as they are asked for.

use crate::problem::{Problem, Problems, Result};
use crate::trajectory::{self, ACCELERATION_RAD_S2, CASCADE_S, Trajectory, read_all};
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

/// The longest motion, s: what a trajectory's file may hold.
const LONGEST_S: f64 = 36_000.0;

/// `excite uniform`.
#[derive(Debug, clap::Args)]
pub struct Uniform {
    /// Number of speeds, spaced evenly in their logarithm
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=1000))]
    speeds: u16,
    /// Slowest sweep, rad/s
    #[arg(long, default_value_t = 0.02)]
    slowest_rad_s: f64,
    /// Fastest sweep, rad/s
    #[arg(long, default_value_t = 0.4)]
    fastest_rad_s: f64,
    /// Where sweeps begin and end, rad
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    low_rad: f64,
    /// Where they turn back, rad
    #[arg(long, default_value_t = FRAC_PI_2, allow_negative_numbers = true)]
    high_rad: f64,
    /// Acceleration of the ramps, rad/s^2
    #[arg(long, default_value_t = ACCELERATION_RAD_S2)]
    acceleration_rad_s2: f64,
    /// Rest at both ends, s
    #[arg(long, default_value_t = 0.5)]
    rest_s: f64,
}

impl Uniform {
    /// Errors: every number that makes no sense; a sweep without a plateau.
    pub fn trajectories(&self) -> Result<Vec<Trajectory>> {
        let (slowest, fastest, ramps) = (self.slowest_rad_s, self.fastest_rad_s, self.acceleration_rad_s2);
        let reach_rad = self.high_rad - self.low_rad;
        let problems = senseless([
            ("slowest-rad-s", slowest, slowest >= 1e-4, "0.0001 or more"),
            ("fastest-rad-s", fastest, fastest.is_finite() && fastest >= slowest, "the slowest speed or more"),
            ("low-rad", self.low_rad, self.low_rad.is_finite(), "a number"),
            ("high-rad", self.high_rad, reach_rad.is_finite() && reach_rad > 0.0, "above --low-rad"),
            ("acceleration-rad-s2", ramps, ramps.is_finite() && ramps > 0.0, "a number above 0"),
            ("rest-s", self.rest_s, (0.0..=LONGEST_S).contains(&self.rest_s), "0 or more"),
        ]);
        Problems(problems).unless_errors(())?;
        if fastest * fastest / ramps > reach_rad / 2.0 {
            let what = format!("--fastest-rad-s is {fastest}: its ramps take more than half of the way");
            return Problem::error("command line", what, "lower it, or raise --acceleration-rad-s2").alone();
        }
        let sweeps = trajectory::Uniform {
            speeds: self.speeds.into(),
            slowest_rad_s: slowest,
            fastest_rad_s: fastest,
            low_rad: self.low_rad,
            high_rad: self.high_rad,
            acceleration_rad_s2: ramps,
            rest_s: self.rest_s,
        };
        not_too_long(sweeps.trajectories())
    }
}

/// `excite cosine`.
#[derive(Debug, clap::Args)]
pub struct Cosine {
    /// Lower end, rad [default: 20 deg]
    #[arg(long, allow_negative_numbers = true)]
    low_rad: Option<f64>,
    /// Upper end, rad [default: 60 deg]
    #[arg(long, allow_negative_numbers = true)]
    high_rad: Option<f64>,
    #[command(flatten)]
    periods: Periods,
}

#[derive(Debug, clap::Args)]
struct Periods {
    /// Lengths of the periods, s, each once, in this order
    #[arg(long, value_delimiter = ',', default_values_t = CASCADE_S)]
    periods_s: Vec<f64>,
}

impl Cosine {
    /// Errors: every number that makes no sense.
    pub fn trajectories(&self) -> Result<Vec<Trajectory>> {
        let ends = (self.low_rad.unwrap_or(20f64.to_radians()), self.high_rad.unwrap_or(60f64.to_radians()));
        Ok(vec![cascade("cosine", &self.periods, ends)?])
    }
}

/// `excite multi-joint`.
#[derive(Debug, clap::Args)]
pub struct MultiJoint {
    /// Lower end, rad [default: 40 deg]
    #[arg(long, allow_negative_numbers = true)]
    low_rad: Option<f64>,
    /// Upper end, rad [default: 90 deg]
    #[arg(long, allow_negative_numbers = true)]
    high_rad: Option<f64>,
    #[command(flatten)]
    periods: Periods,
    /// How many other joints swing along, each a little slower than the one before
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=64))]
    others: u8,
    /// Where other joints begin, rad
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    other_low_rad: f64,
    /// How far they go, rad [default: 40 deg]
    #[arg(long, allow_negative_numbers = true)]
    other_high_rad: Option<f64>,
    /// Period of the first of them, s; shortened so that it ends with the motion
    #[arg(long, default_value_t = 33.2)]
    other_period_s: f64,
}

/// So many times the period of the joint before is a joint's own: never in step.
const SLOWER: f64 = 1.3;

impl MultiJoint {
    /// Errors: every number that makes no sense.
    pub fn trajectories(&self) -> Result<Vec<Trajectory>> {
        let (low, high) = (self.other_low_rad, self.other_high_rad.unwrap_or(40f64.to_radians()));
        let is_period = self.other_period_s >= 0.1 && self.other_period_s <= LONGEST_S;
        let problems = senseless([
            ("other-low-rad", low, low.is_finite(), "a number"),
            ("other-high-rad", high, high.is_finite() && high > low, "above --other-low-rad"),
            ("other-period-s", self.other_period_s, is_period, "0.1 or more"),
        ]);
        Problems(problems).unless_errors(())?;
        let ends = (self.low_rad.unwrap_or(40f64.to_radians()), self.high_rad.unwrap_or(90f64.to_radians()));
        let own = cascade("multi_joint", &self.periods, ends)?;
        let period_s = |at: i32| self.other_period_s * SLOWER.powi(at);
        Ok(vec![(0..i32::from(self.others)).fold(own, |all, at| all.beside_a_swing(low, high, period_s(at)))])
    }
}

/// `excite next`.
#[derive(Debug, clap::Args)]
pub struct Next {
    /// The folder that `diagnose` wrote, with its next_experiment.toml; or files of motions (`trajectory/1`)
    #[arg(required = true)]
    motions: Vec<PathBuf>,
}

impl Next {
    /// Errors: everything that is wrong with the files; a diagnosis that proposes nothing.
    pub fn trajectories(&self) -> Result<Vec<Trajectory>> {
        let is_diagnosis = |path: &&PathBuf| path.join("diagnosis.json").is_file();
        let proposes = |path: &PathBuf| path.join("next_experiment.toml").is_file();
        match self.motions.iter().filter(is_diagnosis).find(|path| !proposes(path)) {
            Some(silent) => {
                let cure = "its report.html says what to do next; `excite` makes other motions too";
                Problem::error(silent, "this diagnosis proposes no motion", cure).alone()
            }
            None => read_all(&self.motions),
        }
    }
}

fn cascade(name: &str, periods: &Periods, (low_rad, high_rad): (f64, f64)) -> Result<Trajectory> {
    let is_period = |period: &f64| *period >= 0.1 && *period <= LONGEST_S;
    let wrong = periods.periods_s.iter().copied().find(|period| !is_period(period));
    let problems = senseless([
        ("low-rad", low_rad, low_rad.is_finite(), "a number"),
        ("high-rad", high_rad, high_rad.is_finite() && high_rad > low_rad, "above the lower end"),
        ("periods-s", wrong.unwrap_or(1.0), wrong.is_none(), "0.1 or more"),
    ]);
    Problems(problems).unless_errors(())?;
    Ok(not_too_long(vec![Trajectory::cosines(name, &periods.periods_s, low_rad, high_rad)])?.remove(0))
}

/// Name, value, whether it makes sense, and what would.
fn senseless<const N: usize>(numbers: [(&str, f64, bool, &str); N]) -> Vec<Problem> {
    let wrong = numbers.into_iter().filter(|(_, _, makes_sense, _)| !makes_sense);
    wrong
        .map(|(name, value, _, expected)| {
            Problem::error("command line", format!("--{name} is {value}"), format!("expected {expected}"))
        })
        .collect()
}

fn not_too_long(trajectories: Vec<Trajectory>) -> Result<Vec<Trajectory>> {
    match trajectories.iter().find(|of| of.own.duration_s() > LONGEST_S) {
        Some(long) => {
            let what = format!("`{}` would take {:.0} s", long.name, long.own.duration_s());
            Problem::error("command line", what, format!("expected {LONGEST_S} s at most: move faster")).alone()
        }
        None => Ok(trajectories),
    }
}
