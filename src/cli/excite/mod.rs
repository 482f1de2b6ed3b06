//! `tautline excite`.

mod motions;

use super::arm::ArmArguments;
use super::interrupt;
use super::judged::model_file;
use super::outcome::Talk;
use crate::excite::{Asked, Known, Limits, check};
use crate::model::Model;
use crate::problem::{Problem, Problems, Result};
use crate::report::excitation::{to_json, write_summary};
use crate::report::write_excitation;
use crate::trajectory::Trajectory;
use clap::Subcommand;
use motions::{Cosine, MultiJoint, Next, Uniform};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline excite uniform -o sweeps                        the paper's sweeps, 20 speeds, 3 repeats
  tautline excite cosine -o cosines --limits rig.toml      the paper's cascade, held against the joint's limits
  tautline excite multi-joint -o moving --other-high-rad 0.5
  tautline excite next diagnosed -o next --model model.json --limit-torque-nm 1.5
                                                           what `diagnose` proposes, and the torque it takes
  tautline simulate --model model.json -o rehearsal --trajectory sweeps --trajectory cosines

Each writes a file per motion (trajectory/1), excitation.json and plan.svg. A motion that breaks a limit is refused, and
nothing is written. For a prismatic joint _rad is m and _nm is N.")]
pub struct Arguments {
    #[command(subcommand)]
    motion: Motion,
}

#[derive(Debug, Subcommand)]
enum Motion {
    /// Sweeps at constant speed, from end to end and back, a file for each speed
    Uniform {
        #[command(flatten)]
        motion: Uniform,
        #[command(flatten)]
        common: Common,
    },
    /// A cascade of cosines, one whole period of each length after the other
    Cosine {
        #[command(flatten)]
        motion: Cosine,
        #[command(flatten)]
        common: Common,
    },
    /// A cascade of cosines while other joints swing along
    MultiJoint {
        #[command(flatten)]
        motion: MultiJoint,
        #[command(flatten)]
        common: Common,
    },
    /// What `diagnose` proposes to record next, or any motions of your own
    Next {
        #[command(flatten)]
        motion: Next,
        #[command(flatten)]
        common: Common,
    },
}

#[derive(Debug, clap::Args)]
struct Common {
    /// Folder to write: a file per motion, excitation.json, plan.svg
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
    /// Write the figure as PNG too
    #[arg(long)]
    png: bool,
    /// How many times each motion is to be recorded [default: 3, or what the motion says]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: Option<u32>,
    /// A model of the joint, which tells the torque: a model.json, or the folder that holds it
    #[arg(long, value_parser = model_file())]
    model: Option<PathBuf>,
    #[command(flatten)]
    of_arm: ArmArguments,
    #[command(flatten)]
    limits: LimitArguments,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits of the joint")]
struct LimitArguments {
    /// A TOML file with [limits] (low_rad, high_rad, speed_rad_s, acceleration_rad_s2, torque_nm), such as a rig's
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Lowest position, rad
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    limit_low_rad: Option<f64>,
    /// Highest position, rad
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    limit_high_rad: Option<f64>,
    /// Highest speed, rad/s
    #[arg(long, value_name = "RAD_S")]
    limit_speed_rad_s: Option<f64>,
    /// Highest acceleration, rad/s^2
    #[arg(long, value_name = "RAD_S2")]
    limit_acceleration_rad_s2: Option<f64>,
    /// Largest torque at the winch, N m; takes --model
    #[arg(long, value_name = "NM")]
    limit_torque_nm: Option<f64>,
}

impl LimitArguments {
    /// Those of the command line, then those of the file.
    ///
    /// Errors: a file that makes no sense, a number that is none.
    fn limits(&self) -> Result<Limits> {
        let given = Limits {
            low_rad: self.limit_low_rad,
            high_rad: self.limit_high_rad,
            speed_rad_s: self.limit_speed_rad_s,
            acceleration_rad_s2: self.limit_acceleration_rad_s2,
            torque_nm: self.limit_torque_nm,
        };
        let problem = |what: String, cure: &str| Problem::error("command line", what, cure);
        let numbers = [
            ("speed-rad-s", given.speed_rad_s),
            ("acceleration-rad-s2", given.acceleration_rad_s2),
            ("torque-nm", given.torque_nm),
        ];
        let senseless = |(name, value): (&str, Option<f64>)| {
            let value = value.filter(|x| x.is_nan() || *x <= 0.0)?;
            Some(problem(format!("--limit-{name} is {value}"), "expected a number above 0"))
        };
        let mut problems: Vec<Problem> = numbers.into_iter().filter_map(senseless).collect();
        let of_file = self.limits.as_deref().map(Limits::read).transpose()?;
        let limits = given.or(of_file.unwrap_or_default());
        if let Some((low, high)) = limits.empty_range() {
            problems.push(problem(format!("the lowest position is {low} rad, the highest {high}"), "mend the limits"));
        }
        Problems(problems).unless_errors(limits)
    }
}

impl Common {
    fn known(&self) -> Result<Option<Known>> {
        let Some(file) = &self.model else {
            return match &self.of_arm.urdf {
                Some(urdf) => Problem::error(urdf, "serves a model, and there is none", "add --model").alone(),
                None => Ok(None),
            };
        };
        let model = Model::read(file)?;
        let chain = self.of_arm.chain(&model, file)?;
        Ok(Some(Known { model, chain }))
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (made, common) = match &arguments.motion {
        Motion::Uniform { motion, common } => (motion.trajectories()?, common),
        Motion::Cosine { motion, common } => (motion.trajectories()?, common),
        Motion::MultiJoint { motion, common } => (motion.trajectories()?, common),
        Motion::Next { motion, common } => (motion.trajectories()?, common),
    };
    check_names(&made)?;
    let limits = common.limits.limits()?;
    let known = common.known()?;
    let moved = made.iter().map(|trajectory| trajectory.others.len()).max().unwrap_or(0);
    if let Some(chain) = known.as_ref().and_then(|known| known.chain.as_ref()).filter(|c| c.others().count() < moved) {
        let what = format!("the motion moves {moved} other joints, the arm has {}", chain.others().count());
        return Problem::error("command line", what, "move fewer, or leave out --urdf").alone();
    }
    let repeats = |of: &Trajectory| Some(common.repeats.or(of.repeats).unwrap_or(3));
    let made: Vec<Trajectory> = made.into_iter().map(|of| Trajectory { repeats: repeats(&of), ..of }).collect();
    let asked: Vec<Asked> = made.into_par_iter().map(|trajectory| Asked::of(trajectory, known.as_ref())).collect();
    check(&asked, &limits)?;
    let output = interrupt::output(&common.output, common.force, "excite")?;
    write_excitation(&asked, &limits, &output, common.png)?;
    talk.finish(output, || to_json(&asked, &limits), |out| write_summary(out, &asked, &limits, &common.output))?;
    Ok(ExitCode::SUCCESS)
}

/// Errors: two motions that would be one file.
fn check_names(made: &[Trajectory]) -> Result<()> {
    let mut names = BTreeSet::new();
    match made.iter().find(|trajectory| !names.insert(&trajectory.name)) {
        Some(twice) => {
            let what = format!("two motions are called `{}`", twice.name);
            Problem::error("command line", what, "give each a `name` of its own; speeds must differ by 0.0001 rad/s")
                .alone()
        }
        None => Ok(()),
    }
}
