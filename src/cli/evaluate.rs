//! `tautline evaluate`.

use super::interrupt;
use super::judged::{Judged, campaign_name, model_name};
use super::outcome::{JUDGED_BAD, Talk, complain};
use super::progress;
use crate::evaluate::{self, Settings};
use crate::model::recorded_curves;
use crate::problem::{Problem, Result};
use crate::report::{evaluation, write_evaluation};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline evaluate data/elbow --model out/model.json -o judged
  tautline evaluate data/elbow --model out/model.json -o judged --sweeps --png
  tautline evaluate data/elbow --model out/model.json -o judged --fail-above 0.05 --quiet

Exit status: 0 judged, 1 the RMSE is above --fail-above, 2 bad input or usage.")]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// Folder to write: evaluation.json, report.html, plots/
    #[arg(short, long, default_value = "evaluated")]
    output: PathBuf,
    /// Judge the uniform sweeps too
    #[arg(long)]
    sweeps: bool,
    /// Exit with status 1 if the RMSE over all trials, low-passed, is above this, N m
    #[arg(long, value_name = "RMSE_NM", allow_negative_numbers = true)]
    fail_above: Option<f64>,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    if let Some(limit) = arguments.fail_above.filter(|limit| !limit.is_finite() || *limit < 0.0) {
        return Problem::error("command line", format!("--fail-above is {limit}"), "expected an RMSE in N m").alone();
    }
    let (campaign, model) = arguments.judged.read()?;
    let settings = Settings { sweeps: arguments.sweeps, recorded_curves: recorded_curves(&arguments.judged.model)? };
    let output = interrupt::output(&arguments.output, arguments.force, "evaluate")?;
    output.made_from("campaign file", &campaign.file);
    output.made_from("model file", &arguments.judged.model);
    let bar = progress::bar(talk, "judging", campaign.trials.len());
    let found = evaluate::run(&campaign, &model, &settings, &|| progress::step(&bar, "drawing"));
    bar.finish_and_clear();
    let found = found?;
    let (name, model_name) = (campaign_name(&campaign), model_name(&arguments.judged.model));
    write_evaluation(&found, &name, &model_name, &output, arguments.png)?;
    let rmse_nm = found.overall().all.rmse_nm;
    let failed = arguments.fail_above.is_some_and(|limit| rmse_nm > limit);
    let to_json = || {
        let mut json = evaluation::to_json(&found, &name, &model_name);
        if let Some(limit) = arguments.fail_above {
            (json["fail_above_nm"], json["failed"]) = (limit.into(), failed.into());
        }
        json
    };
    talk.finish(output, to_json, |out| evaluation::write_summary(out, &found, &name, &arguments.output))?;
    if let Some(limit) = arguments.fail_above.filter(|_| failed) {
        let what = format!("RMSE {rmse_nm:.4} N m is above --fail-above {limit}");
        complain(&Problem::error(&campaign.file, what, "").into());
    }
    Ok(if failed { ExitCode::from(JUDGED_BAD) } else { ExitCode::SUCCESS })
}
