//! `tautline simulate`.

use super::interrupt;
use super::outcome::Talk;
use super::progress;
use crate::dynamics::{Chain, JointKind};
use crate::log::Signal;
use crate::model::{Joint, Model};
use crate::prepare::fastest_sweep_rad_s;
use crate::problem::{Problem, Problems, Result};
use crate::report::json_text;
use crate::simulate::{Plan, Sensors, SimulatedArm};
use clap::ValueEnum;
use rayon::prelude::*;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline simulate --model data/elbow/truth/model.json -o simulated
  tautline simulate --model out/model.json -o simulated --rate-hz 100 --format parquet --seed 3
  tautline simulate --model out/model.json -o arm --urdf data/arm/arm.urdf --joint elbow_flexion --multi-joint 3")]
pub struct Arguments {
    /// The model: a model.json
    #[arg(long)]
    model: PathBuf,
    /// Folder to write: campaign.toml and one log per trial
    #[arg(short, long)]
    output: PathBuf,
    /// Number of sweep speeds; 0 for a prismatic joint
    #[arg(long, default_value_t = 20)]
    speeds: usize,
    /// Slowest sweep, rad/s
    #[arg(long, default_value_t = 0.02)]
    slowest_rad_s: f64,
    /// Fastest sweep, rad/s
    #[arg(long, default_value_t = 0.4)]
    fastest_rad_s: f64,
    /// Sweeps at each speed
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(..=MANY))]
    repeats: u32,
    /// Trials of the cosine cascade (265.6 s each)
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(..=MANY))]
    cosines: u32,
    /// Times that a person touches the joint, at rest and in motion (92 s and 80 s), beside a load cell that tells the torque at the winch
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=MANY))]
    interactions: u32,
    /// URDF of the whole arm, in place of the model's gravity and inertia
    #[arg(long, requires = "joint")]
    urdf: Option<PathBuf>,
    /// The model's joint in the URDF
    #[arg(long, requires = "urdf")]
    joint: Option<String>,
    /// Trials of the cosine cascade with the arm's first other joint moving
    #[arg(long, default_value_t = 0, requires = "urdf", value_parser = clap::value_parser!(u32).range(..=MANY))]
    multi_joint: u32,
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
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    Csv,
    Parquet,
}

impl Arguments {
    /// Errors: every number that makes no sense.
    fn plan(&self) -> Result<Plan> {
        let mut problems = Vec::new();
        let mut need = |fine: bool, name: &str, value: f64, expected: &str| {
            if !fine {
                let what = format!("--{name} is {value}");
                problems.push(Problem::error("command line", what, format!("expected {expected}")));
            }
        };
        let positive = |x: f64| x.is_finite() && x > 0.0;
        need(
            self.slowest_rad_s >= 0.001,
            "slowest-rad-s",
            self.slowest_rad_s,
            "0.001 or more (that sweep takes an hour)",
        );
        need(
            self.fastest_rad_s >= self.slowest_rad_s && self.fastest_rad_s <= 20.0,
            "fastest-rad-s",
            self.fastest_rad_s,
            "from the slowest speed to 20",
        );
        need(self.speeds <= MANY as usize, "speeds", self.speeds as f64, "1000 at most");
        need(positive(self.rate_hz) && self.rate_hz <= 1e5, "rate-hz", self.rate_hz, "a rate above 0, at most 100000");
        need(self.noise_nm.is_finite() && self.noise_nm >= 0.0, "noise-nm", self.noise_nm, "0 or more");
        need(
            self.encoder_counts.is_finite() && self.encoder_counts >= 0.0,
            "encoder-counts",
            self.encoder_counts,
            "0 or more",
        );
        need(
            positive(self.lowpass_hz) && self.lowpass_hz < self.rate_hz / 2.0,
            "lowpass-hz",
            self.lowpass_hz,
            "above 0, below half the rate",
        );
        need(self.torque_sign != 0, "torque-sign", 0.0, "1 or -1");
        need(
            self.speeds as u64 * u64::from(self.repeats)
                + [self.cosines, self.interactions, self.multi_joint].map(u64::from).iter().sum::<u64>()
                > 0,
            "speeds",
            self.speeds as f64,
            "at least one trial",
        );
        Problems(problems).unless_errors(self.as_plan())
    }

    fn as_plan(&self) -> Plan {
        Plan {
            speeds: self.speeds,
            slowest_rad_s: self.slowest_rad_s,
            fastest_rad_s: self.fastest_rad_s,
            repeats: self.repeats,
            cosines: self.cosines,
            interactions: self.interactions,
            arm: None,
            rate_hz: self.rate_hz,
            sensors: Sensors { torque_noise_nm: self.noise_nm, encoder_counts: self.encoder_counts },
            seed: self.seed,
            signal: Signal { torque_sign: f64::from(self.torque_sign), lowpass_hz: self.lowpass_hz, lowpass_order: 4 },
            parquet: self.format == Format::Parquet,
        }
    }
}

/// The most of any kind of trial: more would be a slip of the finger.
const MANY: i64 = 1000;
/// The name of the URDF in the campaign.
const URDF: &str = "arm.urdf";

impl Arguments {
    /// Errors: no such joint, one of another kind, or one that moves alone.
    fn arm(&self, model: &Model) -> Result<Option<SimulatedArm>> {
        let (Some(urdf), Some(name)) = (&self.urdf, &self.joint) else {
            return match &model.chain {
                None => Ok(None),
                Some(of) => {
                    let what = format!("takes gravity and inertia from joint `{}` of {}", of.joint, of.urdf);
                    Problem::error(&self.model, what, "name the arm with --urdf and --joint").alone()
                }
            };
        };
        let joint = &model.joint;
        let chain = Chain::read(urdf, name)?;
        if chain.kind() != joint.kind {
            let what = format!("`{name}` is {}, the model's joint {}", chain.kind().name(), joint.kind.name());
            return Problem::error(urdf, what, "name the joint that the model is of").alone();
        }
        if self.multi_joint > 0 && chain.others().next().is_none() {
            let what = format!("--multi-joint is {}, and `{name}` moves alone", self.multi_joint);
            return Problem::error(urdf, what, "leave it out").alone();
        }
        Ok(Some(SimulatedArm { urdf: URDF.to_string(), chain, multi_joint: self.multi_joint }))
    }
}

/// Errors: sweeps that nothing could be identified from.
fn check_sweeps(plan: &Plan, joint: &Joint) -> Result<()> {
    if plan.speeds == 0 || plan.repeats == 0 {
        return Ok(());
    }
    let refuse = |what: String, cure: String| Problem::error("command line", what, cure).alone();
    if joint.kind == JointKind::Prismatic {
        let what = format!("--speeds is {}, and the joint is prismatic", plan.speeds);
        let cure = "add `--speeds 0`: sweeps serve y = A sin(theta) + B, and here is no angle; cosine trials remain";
        return refuse(what, cure.to_string());
    }
    let (slowest, fastest) = (plan.slowest_rad_s, plan.fastest_rad_s);
    if !plan.speeds_rad_s().is_sorted_by(|a, b| a < b) {
        let what = format!("--speeds is {} from {slowest} to {fastest} rad/s", plan.speeds);
        return refuse(what, "speeds must differ by 0.0001 rad/s: take fewer, or a wider range".to_string());
    }
    match fastest_sweep_rad_s(slowest, fastest, plan.rate_hz, joint, plan.signal.lowpass_hz) {
        Some(feasible) if feasible == fastest => Ok(()),
        Some(feasible) => {
            let what = format!("--fastest-rad-s is {fastest}: a sweep of 90 deg has no constant speed left");
            refuse(what, format!("at this rate, {:.2} is the fastest", (100.0 * feasible).floor() / 100.0))
        }
        None => {
            let what = format!("--slowest-rad-s is {slowest}: not even that sweep has a leg of constant speed");
            refuse(what, "raise --rate-hz, or correct backlash_m in the model".to_string())
        }
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let model = Model::read(&arguments.model)?;
    let plan = Plan { arm: arguments.arm(&model)?, ..arguments.plan()? };
    check_sweeps(&plan, &model.joint)?;
    let trials = plan.trials();
    let output = interrupt::output(
        &arguments.output,
        arguments.force,
        &["simulated.json", "campaign.toml", URDF, "*.csv", "*.parquet"],
    )?;
    let bar = progress::bar(talk, "simulating", trials.len());
    trials.par_iter().try_for_each(|trial| {
        output.write(&trial.entry.file, &plan.log_bytes(&model, trial)?)?;
        bar.inc(1);
        Ok::<(), Problems>(())
    })?;
    bar.finish_and_clear();
    if let Some(urdf) = &arguments.urdf {
        let text = std::fs::read(urdf).or_else(|e| Problem::error(urdf, format!("cannot be read: {e}"), "").alone())?;
        output.write(URDF, text)?;
    }
    output.write("campaign.toml", plan.campaign(&model, &arguments.output, &trials).to_toml().as_bytes())?;
    let mark = json!({ "tautline": env!("CARGO_PKG_VERSION"), "seed": plan.seed, "model": model.to_json() });
    output.write("simulated.json", json_text(&mark))?;
    output.finish()?;
    let (folder, name, count) = (arguments.output.display(), &model.joint.name, trials.len());
    talk.result(
        || json!({ "campaign": arguments.output, "trials": count, "seed": plan.seed }),
        |out| writeln!(out, "{folder}: {count} trials of {name}, seed {}", plan.seed),
    )?;
    Ok(ExitCode::SUCCESS)
}
