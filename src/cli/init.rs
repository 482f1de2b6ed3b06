//! `tautline init`.

use super::interrupt;
use super::outcome::Talk;
use crate::dynamics::JointKind;
use crate::import::Series;
use crate::init::{self, Answers, Draft, DraftTrial, Known, Question, Source, Survey};
use crate::log::table::{Numbers, parquet_bytes};
use crate::model::Drive;
use crate::problem::{Problem, Result};
use crate::trajectory::Protocol;
use clap::ValueEnum;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Digits kept after the point in logs that are written anew: float64 has 15 to 17 significant ones.
const DECIMALS: usize = 15;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline init logs/*.csv -o my-campaign
  tautline init logs -o logs                the draft goes beside the logs, which stay as they are
  tautline init run.mcap -o c --joint elbow --winch-radius-mm 12 --pulley-radius-mm 40 --gravity-nm 0.69 --torque-sign data --zero data

Questions that no data answer are asked on a terminal; without one they stand in campaign.toml as lines with `# ?`, and
`tautline validate` names those that are left.")]
pub struct Arguments {
    /// Logs: files, folders, patterns such as 'logs/*.csv'
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Folder of the campaign; the folder of the logs itself, or a new one into which they are copied
    #[arg(short, long)]
    output: PathBuf,
    /// The joint, where files hold several
    #[arg(long)]
    joint: Option<String>,
    /// The joint's name
    #[arg(long)]
    name: Option<String>,
    /// How the joint moves [default: as the position's unit says]
    #[arg(long, value_enum)]
    kind: Option<KindChoice>,
    /// What drives it
    #[arg(long, value_enum, default_value_t = DriveChoice::Cable)]
    drive: DriveChoice,
    /// Radius of the winch, mm
    #[arg(long, value_name = "MM")]
    winch_radius_mm: Option<f64>,
    /// Radius of the pulley at the joint, mm
    #[arg(long, value_name = "MM")]
    pulley_radius_mm: Option<f64>,
    /// Turns of the motor for one of the joint (drive gear)
    #[arg(long, value_name = "RATIO")]
    gear_ratio: Option<f64>,
    /// Travel of the slide for a turn of the screw, mm (drive screw)
    #[arg(long, value_name = "MM")]
    lead_mm: Option<f64>,
    /// Clearance of the cable, mm
    #[arg(long, value_name = "MM")]
    backlash_mm: Option<f64>,
    /// Gravity's torque about the joint at 90 deg, N m
    #[arg(long, value_name = "NM", allow_negative_numbers = true)]
    gravity_nm: Option<f64>,
    /// Inertia about the joint, kg m^2
    #[arg(long, value_name = "KG_M2")]
    inertia_kg_m2: Option<f64>,
    /// Sign of the torque: 1, -1, or `data`: the one with which friction opposes motion
    #[arg(long, value_name = "SIGN", allow_hyphen_values = true)]
    torque_sign: Option<String>,
    /// What is to be added to the position, in its unit, so that gravity's torque is 0 at 0: a number, or `data`
    #[arg(long, value_name = "OFFSET", allow_hyphen_values = true)]
    zero: Option<String>,
    /// Torque of the motor per ampere, where current was recorded
    #[arg(long, value_name = "NM_A")]
    torque_constant_nm_a: Option<f64>,
    /// Stiffness of the position controller at the joint, where neither torque nor current was recorded
    #[arg(long, value_name = "NM_RAD")]
    stiffness_nm_rad: Option<f64>,
    /// Its damping of the velocity
    #[arg(long, value_name = "NM_S_RAD", requires = "stiffness_nm_rad")]
    damping_nm_s_rad: Option<f64>,
    /// The most torque that it gives
    #[arg(long, value_name = "NM", requires = "stiffness_nm_rad")]
    torque_limit_nm: Option<f64>,
    /// Sample rate, where no column holds time
    #[arg(long, value_name = "HZ")]
    rate_hz: Option<f64>,
    /// Unit of the torque, where the header names none
    #[arg(long, value_name = "UNIT")]
    torque_unit: Option<String>,
    /// Unit of the position, where the header names none
    #[arg(long, value_name = "UNIT")]
    position_unit: Option<String>,
    /// Unit of time, where the header names none
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,
    /// Ask nothing, even on a terminal
    #[arg(long)]
    no_questions: bool,
    /// Replace an existing campaign.toml, or a folder that `init` wrote
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum KindChoice {
    Revolute,
    Prismatic,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum DriveChoice {
    Cable,
    Gear,
    Direct,
    Screw,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let files = files(&arguments.files)?;
    let base = common_folder(&files);
    let read = |file: &PathBuf| match init::read(file, &name_from(&base, file)) {
        // A folder may hold notes and licences beside its logs.
        Err(_) if is_perhaps_text(file) && !arguments.files.contains(file) => Ok(None),
        read => read.map(Some),
    };
    let sources = files.par_iter().map(read).collect::<Result<Vec<Option<Source>>>>()?;
    let sources: Vec<Source> = sources.into_iter().flatten().collect();
    if sources.is_empty() {
        return Problem::error(&base, "holds no log", "name files with a column for each signal").alone();
    }
    let kind = arguments.kind.map(|kind| match kind {
        KindChoice::Revolute => JointKind::Revolute,
        KindChoice::Prismatic => JointKind::Prismatic,
    });
    let known = Known { joint: arguments.joint.clone(), kind };
    let survey = init::survey(sources, &known, arguments.rate_hz)?;
    let mut answers = answers(arguments, &survey)?;
    let mut draft = init::draft(&survey, &answers);
    if talk.shows_progress() && !arguments.no_questions && std::io::stdin().is_terminal() {
        draft = ask(&survey, draft, &mut answers);
    }
    let is_in_place = is_in_place(&arguments.output, &base, &survey.sources);
    if is_in_place {
        write_beside(&arguments.output, &draft.text, arguments.force)?;
    } else {
        write_new(arguments, &survey, &draft)?;
    }
    talk.result(|| to_json(arguments, &survey, &draft), |out| tell(out, arguments, &survey, &draft))?;
    Ok(ExitCode::SUCCESS)
}

/// Every log that the arguments name: files, those in folders, those that patterns match; sorted, each once.
fn files(named: &[PathBuf]) -> Result<Vec<PathBuf>> {
    const ENDINGS: [&str; 8] = ["csv", "parquet", "mat", "mcap", "txt", "tsv", "dat", "asc"];
    let is_log = |file: &Path| {
        let ending = file.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        file.is_file() && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
    };
    let mut found = Vec::new();
    for path in named {
        if path.is_dir() {
            let entries = std::fs::read_dir(path).or_else(|error| {
                Problem::error(path, format!("cannot be read: {error}"), "check the path and its permissions").alone()
            })?;
            found.extend(entries.flatten().map(|entry| entry.path()).filter(|file| is_log(file)));
        } else if path.exists() {
            found.push(path.clone());
        } else {
            let matched: Vec<PathBuf> = glob::glob(&path.to_string_lossy()).into_iter().flatten().flatten().collect();
            if matched.is_empty() {
                return Problem::error(path, "there is no such file", "name logs, their folder or a pattern").alone();
            }
            found.extend(matched.into_iter().filter(|file| is_log(file)));
        }
    }
    found.sort();
    found.dedup();
    match found.is_empty() {
        true => Problem::error(&named[0], "holds no log", "logs end in .csv, .parquet, .mat, .mcap or .txt").alone(),
        false => Ok(found),
    }
}

/// Whether a file's name leaves open that it is no log.
fn is_perhaps_text(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ["txt", "dat", "asc"].iter().any(|text| ending.eq_ignore_ascii_case(text)))
}

/// The folder that all files lie in, at whatever depth.
fn common_folder(files: &[PathBuf]) -> PathBuf {
    let mut folder = files[0].parent().unwrap_or(Path::new("")).to_path_buf();
    while !files.iter().all(|file| file.starts_with(&folder)) && folder.pop() {}
    folder
}

/// What `file` is called relative to `base`.
fn name_from(base: &Path, file: &Path) -> String {
    file.strip_prefix(base).unwrap_or(file).to_string_lossy().into_owned()
}

/// Whether the campaign's folder is the logs' own, and the logs can stay as they are.
fn is_in_place(output: &Path, base: &Path, sources: &[Source]) -> bool {
    let base = if base.as_os_str().is_empty() { Path::new(".") } else { base };
    let is_same = matches!((output.canonicalize(), base.canonicalize()), (Ok(a), Ok(b)) if a == b);
    is_same && sources.iter().all(|source| source.is_table && source.repeated == 0)
}

/// Writes campaign.toml beside the logs.
fn write_beside(folder: &Path, text: &str, force: bool) -> Result<()> {
    let file = folder.join("campaign.toml");
    if file.exists() && !force {
        return Problem::error(&file, "exists", "name another folder, or replace it with --force").alone();
    }
    let written = tempfile::NamedTempFile::new_in(folder).and_then(|mut new| {
        new.write_all(text.as_bytes())?;
        new.persist(&file).map_err(|error| error.error)?;
        Ok(())
    });
    written.or_else(|error| Problem::unwritable(&file, "cannot be written", &error).alone())
}

/// Writes a new folder with campaign.toml and the logs: tables as they are, others as Parquet.
fn write_new(arguments: &Arguments, survey: &Survey, draft: &Draft) -> Result<()> {
    let output = interrupt::output(&arguments.output, arguments.force, "init")?;
    for source in &survey.sources {
        let name = source.log_name();
        if source.is_table && source.repeated == 0 {
            let bytes = std::fs::read(&source.path)
                .or_else(|error| Problem::error(&source.path, format!("cannot be read: {error}"), "").alone())?;
            output.copy(&name, &bytes)?;
            continue;
        }
        let named = |series: &&Series| survey.chosen.columns.iter().any(|choice| choice.name == series.name);
        let numbers: Vec<Numbers<'_>> = source
            .columns
            .iter()
            .filter(named)
            .map(|series| Numbers { name: &series.name, values: &series.values, decimals: DECIMALS })
            .collect();
        output.write(&name, parquet_bytes(Path::new(&name), &numbers)?)?;
    }
    output.write("campaign.toml", &draft.text)?;
    output.finish()
}

/// The answers that options give.
fn answers(arguments: &Arguments, survey: &Survey) -> Result<Answers> {
    let drive = match arguments.drive {
        DriveChoice::Cable => Drive::Cable,
        DriveChoice::Gear => Drive::Gear,
        DriveChoice::Direct => Drive::Direct,
        DriveChoice::Screw => Drive::Screw,
    };
    let mut answers = Answers { name: arguments.name.clone(), drive, ..Answers::default() };
    let data = |asked: &Option<String>, found: Option<String>, option: &str| match asked.as_deref() {
        Some("data") => found
            .map(Some)
            .ok_or_else(|| Problem::error(option, "is `data`, and the data do not tell it", "give a number")),
        other => Ok(other.map(str::to_string)),
    };
    let unit = survey.chosen.of(crate::units::Quantity::Position).map_or(1.0, |choice| choice.unit.factor());
    let sign = data(&arguments.torque_sign, survey.hints.torque_sign.map(|sign| sign.to_string()), "--torque-sign")?;
    let zero = data(&arguments.zero, survey.hints.zero_rad.map(|zero| (zero / unit).to_string()), "--zero")?;
    let number = |value: Option<f64>| value.map(|value| value.to_string());
    let metres = |value: Option<f64>| number(value.map(|mm| mm * 1e-3));
    for (key, value) in [
        ("joint.winch_radius_m", metres(arguments.winch_radius_mm)),
        ("joint.pulley_radius_m", metres(arguments.pulley_radius_mm)),
        ("joint.gear_ratio", number(arguments.gear_ratio)),
        ("joint.lead_m", metres(arguments.lead_mm)),
        ("joint.backlash_m", metres(arguments.backlash_mm)),
        ("joint.torque_constant_nm_a", number(arguments.torque_constant_nm_a)),
        ("controller.stiffness_nm_rad", number(arguments.stiffness_nm_rad)),
        ("controller.damping_nm_s_rad", number(arguments.damping_nm_s_rad)),
        ("controller.torque_limit_nm", number(arguments.torque_limit_nm)),
        ("dynamics.gravity_nm", number(arguments.gravity_nm)),
        ("dynamics.inertia_kg_m2", number(arguments.inertia_kg_m2)),
        ("signal.torque_sign", sign),
        ("columns.position.offset", zero),
        ("files.rate_hz", number(arguments.rate_hz)),
        ("columns.torque", arguments.torque_unit.clone()),
        ("columns.position", arguments.position_unit.clone()),
        ("columns.time", arguments.time_unit.clone()),
    ] {
        if let Some(value) = value {
            answers.set(key, &value).or_else(|what| Problem::error(key, format!("is `{value}`"), what).alone())?;
        }
    }
    Ok(answers)
}

/// Asks each question on the terminal; Enter takes what the data suggest, or leaves the question open.
fn ask(survey: &Survey, mut draft: Draft, answers: &mut Answers) -> Draft {
    let mut input = std::io::stdin().lock();
    for question in draft.questions.clone() {
        loop {
            let offer = question.suggested.as_ref().map_or("later".to_string(), Clone::clone);
            let mut out = anstream::stderr().lock();
            let _ = write!(out, "{}: {} [{offer}] ", question.key, question.asks);
            let _ = out.flush();
            let mut line = String::new();
            if input.read_line(&mut line).unwrap_or(0) == 0 {
                return init::draft(survey, answers);
            }
            let given = match (line.trim(), &question.suggested) {
                ("", None) => break,
                ("", Some(suggested)) => suggested.clone(),
                (text, _) => text.to_string(),
            };
            match answers.set(&question.key, &given) {
                Ok(()) => break,
                Err(what) => _ = writeln!(out, "{what}"),
            }
        }
    }
    draft = init::draft(survey, answers);
    draft
}

fn to_json(arguments: &Arguments, survey: &Survey, draft: &Draft) -> Value {
    let column = |choice: &init::Choice| json!({ "key": choice.key, "name": choice.name, "unit": choice.unit.name(), "why": choice.why });
    let trial = |trial: &DraftTrial| {
        let speed = match trial.protocol {
            Protocol::Uniform { speed_rad_s } => Some(speed_rad_s),
            _ => None,
        };
        json!({
            "file": survey.sources[trial.source].log_name(),
            "rows": trial.rows.as_ref().map(|rows| [rows.start, rows.end]),
            "protocol": trial.protocol.name(),
            "speed_rad_s": speed,
            "repeat": trial.repeat,
            "trajectory": trial.trajectory,
            "found": trial.found,
        })
    };
    let question =
        |question: &Question| json!({ "key": question.key, "asks": question.asks, "suggested": question.suggested });
    let source =
        |source: &Source| json!({ "file": source.path, "form": source.form, "repeated_rows": source.repeated });
    json!({
        "format": "init/1",
        "campaign": arguments.output,
        "kind": survey.chosen.kind.name(),
        "rate_hz": survey.rate_hz,
        "joints": survey.chosen.joints,
        "files": survey.sources.iter().map(source).collect::<Vec<_>>(),
        "columns": survey.chosen.columns.iter().map(column).collect::<Vec<_>>(),
        "trials": survey.trials.iter().map(trial).collect::<Vec<_>>(),
        "questions": draft.questions.iter().map(question).collect::<Vec<_>>(),
        "notes": survey.chosen.notes,
    })
}

fn tell(out: &mut Vec<u8>, arguments: &Arguments, survey: &Survey, draft: &Draft) -> std::io::Result<()> {
    let file = arguments.output.join("campaign.toml");
    writeln!(out, "{} files at {:.6} Hz, {} trials", survey.sources.len(), survey.rate_hz, survey.trials.len())?;
    for choice in &survey.chosen.columns {
        writeln!(out, "  {:<12} `{}`, {}", choice.key, choice.name, choice.unit.name())?;
    }
    for note in &survey.chosen.notes {
        writeln!(out, "  {note}")?;
    }
    if draft.questions.is_empty() {
        return writeln!(out, "{}: complete; `tautline validate` checks it", file.display());
    }
    writeln!(out, "{}: {} questions are open, marked `# ?`:", file.display(), draft.questions.len())?;
    for question in &draft.questions {
        writeln!(out, "  {}: {}", question.key, question.asks)?;
    }
    Ok(())
}
