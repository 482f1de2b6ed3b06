//! `tautline export`.

use super::interrupt;
use super::judged::{model_file, model_name};
use super::outcome::Talk;
use crate::export::{Language, Likeness, Settings, controller, csv, latex, markdown, mujoco_xml, plain_name, urdf_xml};
use crate::model::Model;
use crate::problem::{Problem, Result};
use crate::report::json_text;
use clap::ValueEnum;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline export out/model.json -o exported
  tautline export out -o exported --only c,rust --rate-hz 2000
  tautline export out -o exported --only latex --force")]
pub struct Arguments {
    /// The model: a model.json, or the folder that holds it
    #[arg(value_parser = model_file())]
    model: PathBuf,
    /// Folder to write: NAME_model.h, NAME_model.rs, mujoco.xml, urdf_dynamics.xml, parameters.csv, .tex, .md
    #[arg(short, long)]
    output: PathBuf,
    /// What to write [default: all]
    #[arg(long, value_enum, value_delimiter = ',')]
    only: Vec<Kind>,
    /// Calls of the controller a second, Hz: only a model with a time_delay depends on it
    #[arg(long, default_value_t = 1000.0)]
    rate_hz: f64,
    /// Slowest speed at which MuJoCo's and URDF's friction should be like the model's, rad/s
    #[arg(long, default_value_t = 0.02)]
    slowest_rad_s: f64,
    /// Fastest such speed, rad/s
    #[arg(long, default_value_t = 0.4)]
    fastest_rad_s: f64,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Kind {
    /// A C99 header for a controller
    C,
    /// A Rust module for a controller, without the standard library
    Rust,
    /// A class of joints for MuJoCo
    Mujoco,
    /// A URDF's <dynamics>
    Urdf,
    /// Parameters with confidence, for programs
    Csv,
    /// The same for a paper
    Latex,
    /// The same for notes
    Markdown,
}

impl Arguments {
    fn check(&self) -> Result<()> {
        let refuse = |what: String, cure: &str| Problem::error("command line", what, cure).alone();
        if !(self.rate_hz > 0.0 && self.rate_hz <= 1e6) {
            return refuse(format!("--rate-hz is {}", self.rate_hz), "expected a rate above 0, at most 1000000");
        }
        let (slow, fast) = (self.slowest_rad_s, self.fastest_rad_s);
        if !(slow > 0.0 && fast > slow && fast.is_finite()) {
            return refuse(format!("speeds from {slow} to {fast} rad/s"), "expected a range above 0");
        }
        Ok(())
    }

    fn wants(&self, kind: Kind) -> bool {
        self.only.is_empty() || self.only.contains(&kind)
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    arguments.check()?;
    let model = Model::read(&arguments.model)?;
    let (name, source) = (plain_name(&model), model_name(&arguments.model));
    let settings = Settings { rate_hz: arguments.rate_hz, source: source.clone() };
    let like = Likeness::of(&model, (arguments.slowest_rad_s, arguments.fastest_rad_s));
    let code = |language: Language| controller(&model, language, &settings);
    let mut made: Vec<(String, String)> = Vec::new();
    for kind in Kind::value_variants().iter().filter(|kind| arguments.wants(**kind)) {
        made.push(match kind {
            Kind::C => (format!("{name}_model.h"), code(Language::C)?),
            Kind::Rust => (format!("{name}_model.rs"), code(Language::Rust)?),
            Kind::Mujoco => ("mujoco.xml".to_string(), mujoco_xml(&model, &like, &source)),
            Kind::Urdf => ("urdf_dynamics.xml".to_string(), urdf_xml(&model, &like, &source)),
            Kind::Csv => ("parameters.csv".to_string(), csv(&model)),
            Kind::Latex => ("parameters.tex".to_string(), latex(&model)),
            Kind::Markdown => ("parameters.md".to_string(), markdown(&model)),
        });
    }
    let output = interrupt::output(&arguments.output, arguments.force, "export")?;
    made.iter().try_for_each(|(name, text)| output.write(name, text))?;
    let told = json!({
        "format": "export/1", "joint": model.joint.name, "files": made.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "simple_joint": {
            "friction_nm": like.friction_nm, "damping_nm_s_rad": like.damping_nm_s_rad,
            "armature_kg_m2": like.armature_kg_m2, "stiffness_nm_rad": like.stiffness_nm_rad,
            "spring_rests_rad": like.spring_rests_rad, "left_nm": like.left_nm, "whole_nm": like.whole_nm,
            "lacks": like.lacks,
        },
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "model": source },
    });
    output.write("export.json", json_text(&told))?;
    let is_simple = [Kind::Mujoco, Kind::Urdf].iter().any(|kind| arguments.wants(*kind));
    talk.finish(
        output,
        || told,
        |out| {
            made.iter().try_for_each(|(name, _)| writeln!(out, "{}", arguments.output.join(name).display()))?;
            if is_simple {
                writeln!(out, "\nA joint of MuJoCo or of a URDF leaves {:.3} of {:.3} N m of friction at constant speed; it cannot hold", like.left_nm, like.whole_nm)?;
                like.lacks.iter().try_for_each(|lack| writeln!(out, "  {lack}"))?;
            }
            Ok(())
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
