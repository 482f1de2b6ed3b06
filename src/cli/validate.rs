//! `tautline validate`.

use super::outcome::{BAD_INPUT, Talk, complain};
use super::progress;
use crate::dynamics::JointKind;
use crate::identify::{self, Doubt, Reading, check, examine_trials, implausible};
use crate::log::{Campaign, FromCurrent, Survey};
use crate::numerics::statistics::extent;
use crate::prepare::left_out;
use crate::problem::{Problem, Problems, Result, Severity};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tautline validate my-campaign\n\nExit status: 0 usable (perhaps with warnings), 2 not."
)]
pub struct Arguments {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
    /// Make errors of doubts: declared scale, sign, zero, radii or gravity that the data contradict
    #[arg(long)]
    strict: bool,
}

/// What was found.
#[derive(Default)]
struct Found {
    problems: Vec<Problem>,
    doubts: Vec<Doubt>,
    understood: Option<Understood>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (found, trials) = match Survey::read(&arguments.campaign) {
        Ok(survey) => (examine(&survey, arguments.strict, talk), survey.readable.len()),
        Err(Problems(problems)) => (Found { problems, ..Found::default() }, 0),
    };
    let Found { problems, doubts, understood } = found;
    let errors = problems.iter().filter(|p| p.severity == Severity::Error).count();
    let text = match (errors, problems.len()) {
        (0, 0) => format!("{}: {trials} trials, no problem found\n", arguments.campaign.display()),
        (0, n) => format!("{}: {trials} trials, usable; warnings: {n}\n", arguments.campaign.display()),
        (e, n) => format!("{}: not usable; errors: {e}, warnings: {}\n", arguments.campaign.display(), n - e),
    };
    let rows: Vec<Value> = problems.iter().map(problem_json).collect();
    let doubts: Vec<Value> = doubts.iter().map(doubt_json).collect();
    let json = json!({
        "campaign": arguments.campaign, "trials": trials, "errors": errors, "problems": rows, "doubts": doubts,
        "understood": understood.as_ref().map(Understood::to_json),
    });
    complain(&Problems(problems));
    talk.result(
        || json,
        |out| {
            understood.iter().try_for_each(|understood| understood.write(out))?;
            out.write_all(text.as_bytes())
        },
    )?;
    Ok(if errors == 0 { ExitCode::SUCCESS } else { ExitCode::from(BAD_INPUT) })
}

/// Every problem of `campaign.toml`, then of every trial by itself, then of all trials together.
fn examine(survey: &Survey, strict: bool, talk: &Talk) -> Found {
    let bar = progress::bar(talk, "checking", survey.readable.len());
    let mut problems = survey.problems.clone();
    let (mut doubts, mut understood) = (Vec::new(), None);
    match &survey.campaign {
        Some(campaign) => {
            let readable = Campaign { trials: survey.readable.clone(), ..campaign.clone() };
            let (readings, found): (Vec<_>, Vec<_>) = examine_trials(&readable, &|| bar.inc(1)).into_iter().unzip();
            for (entry, found) in readable.trials.iter().zip(found) {
                let is_stump = entry.is_incomplete() && found.iter().any(|p| p.severity == Severity::Error);
                problems.extend(if is_stump { vec![left_out(&readable, entry, &found)] } else { found });
            }
            let readings: Vec<Reading> = readings.into_iter().flatten().collect();
            if survey.is_whole {
                doubts = implausible(campaign, &readings);
                problems.splice(0..0, doubts.iter().map(|doubt| told(doubt, campaign, strict)));
                problems.extend(check(campaign, &readings));
                understood = Understood::of(campaign, &readings);
            }
        }
        None => {
            let found: Vec<Vec<Problem>> = survey.readable.par_iter().map(|entry| survey.problems_of(entry)).collect();
            problems.extend(found.concat());
        }
    }
    bar.finish_and_clear();
    Found { problems, doubts, understood }
}

fn told(doubt: &Doubt, campaign: &Campaign, strict: bool) -> Problem {
    let severity = if strict { Severity::Error } else { Severity::Warning };
    Problem { severity, ..doubt.problem(campaign) }
}

fn doubt_json(doubt: &Doubt) -> Value {
    let causes: Vec<&str> = doubt.causes.iter().map(|cause| cause.name()).collect();
    json!({ "causes": causes, "what": doubt.what, "cure": doubt.cure })
}

/// What was understood of the recordings, in plain units.
struct Understood {
    trials: usize,
    rows: usize,
    duration_s: f64,
    rate_hz: (f64, f64),
    position: (f64, f64),
    torque_nm: (f64, f64),
    speed: (f64, f64),
    evidence: Option<identify::Evidence>,
    ratio: f64,
    is_angle: bool,
    from_current: Option<FromCurrent>,
}

impl Understood {
    fn of(campaign: &Campaign, readings: &[Reading]) -> Option<Self> {
        let each = |of: &dyn Fn(&Reading) -> (f64, f64)| {
            let all: Vec<(f64, f64)> = readings.iter().map(of).collect();
            let low = all.iter().map(|pair| pair.0).fold(f64::INFINITY, f64::min);
            (low, all.iter().map(|pair| pair.1).fold(f64::NEG_INFINITY, f64::max))
        };
        let span_s = |reading: &Reading| {
            let time = &reading.prepared.series.time_s;
            time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first)
        };
        let is_angle = campaign.joint.kind == JointKind::Revolute;
        let scale = if is_angle { 1f64.to_degrees() } else { 1e3 };
        let in_plain = |pair: (f64, f64)| (scale * pair.0, scale * pair.1);
        (!readings.is_empty()).then(|| Self {
            trials: readings.len(),
            rows: readings.iter().map(|reading| reading.rows).sum(),
            duration_s: readings.iter().map(span_s).sum(),
            rate_hz: each(&|reading| {
                let rate = (reading.rows as f64 - 1.0) / span_s(reading).max(f64::MIN_POSITIVE);
                (rate, rate)
            }),
            position: in_plain(each(&|reading| extent(&reading.prepared.series.position_rad))),
            torque_nm: each(&|reading| extent(&reading.prepared.series.torque_nm)),
            speed: in_plain(each(&|reading| extent(&reading.prepared.series.velocity_rad_s))),
            evidence: identify::evidence(campaign, readings),
            ratio: campaign.joint.transmission(),
            is_angle,
            from_current: campaign.columns.from_current,
        })
    }

    fn to_json(&self) -> Value {
        let (position, speed) =
            if self.is_angle { ("position_deg", "speed_deg_s") } else { ("position_mm", "speed_mm_s") };
        let mut told = json!({
            "trials": self.trials, "rows": self.rows, "duration_s": self.duration_s,
            "rate_hz": [self.rate_hz.0, self.rate_hz.1], "torque_nm": [self.torque_nm.0, self.torque_nm.1],
            "r1_over_r2": self.ratio,
        });
        (told[position], told[speed]) =
            (json!([self.position.0, self.position.1]), json!([self.speed.0, self.speed.1]));
        if let Some(of) = &self.evidence {
            told["friction_nm"] = json!(of.friction_nm);
            told["gravity_gain"] = if of.has_load { json!(of.gain) } else { Value::Null };
        }
        told
    }

    fn write(&self, out: &mut Vec<u8>) -> std::io::Result<()> {
        let (angle, speed) = if self.is_angle { ("deg", "deg/s") } else { ("mm", "mm/s") };
        let minutes = self.duration_s / 60.0;
        writeln!(
            out,
            "understood: {} trials, {} rows, {minutes:.1} min at {:.4} to {:.4} Hz",
            self.trials, self.rows, self.rate_hz.0, self.rate_hz.1
        )?;
        writeln!(
            out,
            "  position {:.2} to {:.2} {angle}, speed {:.2} to {:.2} {speed}",
            self.position.0, self.position.1, self.speed.0, self.speed.1
        )?;
        let torque = match self.from_current {
            Some(FromCurrent { torque_constant_nm_a: None, .. }) => "torque (in A: no torque constant)",
            Some(_) => "torque from current",
            None => "torque",
        };
        let unit = if self.is_angle { "N m" } else { "N" };
        writeln!(
            out,
            "  {torque} {:.4} to {:.4} {unit}, with torque_sign applied and low-passed; r1/r2 = {:.4}",
            self.torque_nm.0, self.torque_nm.1, self.ratio
        )?;
        let Some(of) = &self.evidence else { return Ok(()) };
        write!(out, "  friction takes about {:.4} {unit}", of.friction_nm)?;
        match of.has_load {
            true => writeln!(out, "; the torque follows {:.3} times the declared load (1 to 2 are usual)", of.gain),
            false => writeln!(out),
        }
    }
}

fn problem_json(problem: &Problem) -> Value {
    json!({
        "severity": match problem.severity { Severity::Error => "error", Severity::Warning => "warning" },
        "file": problem.file,
        "row": problem.row,
        "column": problem.column,
        "what": problem.what,
        "cure": problem.cure,
    })
}
