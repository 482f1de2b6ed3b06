//! What `tautline simulate` takes, and the plan that it amounts to.

use super::super::arm::ArmArguments;
use super::super::judged::model_file;
use super::motor::Motor;
use crate::log::Signal;
use crate::problem::{Problem, Problems, Result};
use crate::simulate::{Plan, Sensors};
use crate::trajectory::{Trajectory, read_all};
use clap::ValueEnum;
use std::path::PathBuf;

/// The most of any kind of trial: more would be a slip of the finger.
const MANY: i64 = 1000;
/// The most joints recorded beside the model's: as many as `joint_coupling` can name.
const OTHERS: i64 = 64;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline simulate --model data/elbow/truth/model.json -o simulated
  tautline simulate --model out/model.json -o small --rate-hz 100 --format parquet --seed 3
  tautline simulate --model out/model.json -o gap --effect sensor_bias:bias_nm=0.05
  tautline simulate --model out/model.json -o wide --trajectory wide.toml --repeats 5
  tautline simulate --model out/model.json -o closed --closed-loop --torque-limit-nm 1.5
  tautline simulate --model out/model.json -o arm --urdf arm.urdf --joint elbow --multi-joint 3")]
pub struct Arguments {
    /// The model: a model.json, or the folder that holds it
    #[arg(long, value_parser = model_file())]
    pub model: PathBuf,
    /// Folder to write: campaign.toml and one log per trial
    #[arg(short, long)]
    pub output: PathBuf,
    /// An effect that the joint or its sensors have beyond the model, as ID:NAME=VALUE,NAME=VALUE; any number of them.
    /// `tautline effects` lists all
    #[arg(long, value_name = "EFFECT", allow_hyphen_values = true)]
    pub effect: Vec<String>,
    /// A file with another motion (`trajectory/1`), or a folder of such files as `excite` writes, in place of the protocol's; any
    /// number of them
    #[arg(long, value_name = "FILE")]
    trajectory: Vec<PathBuf>,
    /// Number of sweep speeds; 0 for a prismatic joint [default: 20; 0 with --trajectory]
    #[arg(long)]
    speeds: Option<usize>,
    /// Slowest sweep, rad/s
    #[arg(long, default_value_t = 0.02)]
    slowest_rad_s: f64,
    /// Fastest sweep, rad/s
    #[arg(long, default_value_t = 0.4)]
    fastest_rad_s: f64,
    /// Sweeps at each speed, trials of each trajectory [default: 3, or what the trajectory says]
    #[arg(long, value_parser = clap::value_parser!(u32).range(..=MANY))]
    repeats: Option<u32>,
    /// Trials of the cosine cascade (265.6 s each) [default: 3; 0 with --trajectory]
    #[arg(long, value_parser = clap::value_parser!(u32).range(..=MANY))]
    cosines: Option<u32>,
    /// Times that a person touches the joint, at rest and in motion (92 s and 80 s), beside a load cell that tells the torque at the winch
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=MANY))]
    interactions: u32,
    #[command(flatten)]
    pub of_arm: ArmArguments,
    /// Trials of the cosine cascade with the arm's first other joint moving
    #[arg(long, default_value_t = 0, requires = "urdf", value_parser = clap::value_parser!(u32).range(..=MANY))]
    pub multi_joint: u32,
    /// Joints that are recorded beside this one and move along in cosines and trajectories
    #[arg(long, default_value_t = 0, conflicts_with = "urdf", value_parser = clap::value_parser!(u32).range(..=OTHERS))]
    other_joints: u32,
    /// How far the joint strays from its trajectory, rad (root mean square); different in each trial
    #[arg(long, default_value_t = 0.0, conflicts_with = "closed_loop")]
    tracking_error_rad: f64,
    #[command(flatten)]
    pub motor: Motor,
    /// Sample rate, Hz
    #[arg(long, default_value_t = 1000.0)]
    rate_hz: f64,
    /// Standard deviation of the torque sensor's noise, N m
    #[arg(long, default_value_t = 0.02)]
    noise_nm: f64,
    /// Encoder counts per revolution; 0 for an exact position
    #[arg(long, default_value_t = 524_288.0)]
    encoder_counts: f64,
    /// Sign of the recorded torque: y = sign * recorded
    #[arg(long, default_value_t = -1, allow_negative_numbers = true, value_parser = clap::value_parser!(i8).range(-1..=1))]
    torque_sign: i8,
    /// Low-pass that the campaign declares, Hz
    #[arg(long, default_value_t = 5.0)]
    lowpass_hz: f64,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Format of the logs
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Replace an existing output folder
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    Csv,
    Parquet,
}

impl Arguments {
    /// Errors: every number that makes no sense.
    pub fn plan(&self) -> Result<Plan> {
        let mut problems: Vec<Problem> = self.senseless().collect();
        let trajectories = self.trajectories().unwrap_or_else(|Problems(found)| {
            problems.extend(found);
            Vec::new()
        });
        Problems(problems).unless_errors(self.as_plan(trajectories))
    }

    /// Every number that makes no sense.
    fn senseless(&self) -> impl Iterator<Item = Problem> {
        let (slowest, fastest, rate_hz, lowpass_hz) =
            (self.slowest_rad_s, self.fastest_rad_s, self.rate_hz, self.lowpass_hz);
        let speeds = self.speeds() as f64;
        let not_negative = |x: f64| x.is_finite() && x >= 0.0;
        [
            ("slowest-rad-s", slowest, slowest >= 0.001, "0.001 or more (that sweep takes an hour)"),
            ("fastest-rad-s", fastest, (slowest..=20.0).contains(&fastest), "from the slowest speed to 20"),
            ("speeds", speeds, speeds <= MANY as f64, "1000 at most"),
            ("rate-hz", rate_hz, rate_hz > 0.0 && rate_hz <= 1e5, "a rate above 0, at most 100000"),
            ("noise-nm", self.noise_nm, not_negative(self.noise_nm), "0 or more"),
            ("encoder-counts", self.encoder_counts, not_negative(self.encoder_counts), "0 or more"),
            ("tracking-error-rad", self.tracking_error_rad, (0.0..=1.0).contains(&self.tracking_error_rad), "0 to 1"),
            ("lowpass-hz", lowpass_hz, lowpass_hz > 0.0 && lowpass_hz < rate_hz / 2.0, "above 0, below half the rate"),
            ("torque-sign", f64::from(self.torque_sign), self.torque_sign != 0, "1 or -1"),
        ]
        .into_iter()
        .filter(|(_, _, makes_sense, _)| !makes_sense)
        .map(|(name, value, _, expected)| {
            Problem::error("command line", format!("--{name} is {value}"), format!("expected {expected}"))
        })
    }

    /// The files with other motions.
    fn trajectories(&self) -> Result<Vec<Trajectory>> {
        let read = read_all(&self.trajectory)?;
        Ok(read.into_iter().map(|read| Trajectory { repeats: self.repeats.or(read.repeats), ..read }).collect())
    }

    fn speeds(&self) -> usize {
        self.speeds.unwrap_or(if self.trajectory.is_empty() { 20 } else { 0 })
    }

    fn as_plan(&self, trajectories: Vec<Trajectory>) -> Plan {
        Plan {
            speeds: self.speeds(),
            slowest_rad_s: self.slowest_rad_s,
            fastest_rad_s: self.fastest_rad_s,
            repeats: self.repeats.unwrap_or(3),
            cosines: self.cosines.unwrap_or(if trajectories.is_empty() { 3 } else { 0 }),
            interactions: self.interactions,
            trajectories,
            arm: None,
            other_joints: self.other_joints as usize,
            tracking_error_rad: self.tracking_error_rad,
            controller: None,
            position_alone: self.motor.position_alone,
            rate_hz: self.rate_hz,
            sensors: Sensors { torque_noise_nm: self.noise_nm, encoder_counts: self.encoder_counts },
            seed: self.seed,
            signal: Signal { torque_sign: f64::from(self.torque_sign), lowpass_hz: self.lowpass_hz, lowpass_order: 4 },
            parquet: self.format == Format::Parquet,
        }
    }
}
