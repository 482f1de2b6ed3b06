//! `tautline init`.

mod files;
mod told;
mod write;

use super::outcome::Talk;
use crate::dynamics::JointKind;
use crate::init::{self, Answers, Draft, Known, Question, Source, Survey};
use crate::model::Drive;
use crate::problem::{Problem, Result};
use crate::units::Quantity;
use clap::ValueEnum;
use files::{Named, common_folder, is_in_place, is_perhaps_no_log, name_from, named};
use rayon::prelude::*;
use std::io::{BufRead, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use told::{tell, to_json};
use write::{write_beside, write_new};

/// The answer that leaves a question to the data.
const BY_DATA: &str = "data";

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
    /// What drives it [default: cable]
    #[arg(long, value_enum)]
    drive: Option<DriveChoice>,
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
    /// Which column holds what, where names do not tell: `position=column_2`; may be given several times
    #[arg(long, value_name = "QUANTITY=NAME", value_parser = column)]
    column: Vec<(String, String)>,
    /// Unit of the torque, where the header names none or the wrong one; or what a reading of 1 is, such as `0.0123 N m`
    #[arg(long, value_name = "UNIT", allow_hyphen_values = true)]
    torque_unit: Option<String>,
    /// Unit of the position, likewise; of an encoder with 4096 counts a turn `1/4096 turn`
    #[arg(long, value_name = "UNIT", allow_hyphen_values = true)]
    position_unit: Option<String>,
    /// Unit of the current, likewise
    #[arg(long, value_name = "UNIT", allow_hyphen_values = true)]
    current_unit: Option<String>,
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
    let Named { logs, others } = named(&arguments.files)?;
    let base = common_folder(&logs);
    let read = |file: &PathBuf| match init::read(file, &name_from(&base, file)) {
        // A folder may hold notes, licences and runs that were never recorded beside its logs.
        Err(_) if is_perhaps_no_log(file) && !arguments.files.contains(file) => Ok(None),
        read => read.map(Some),
    };
    let found = logs.par_iter().map(read).collect::<Result<Vec<Option<Source>>>>()?;
    let unread = logs.iter().zip(&found).filter(|(_, source)| source.is_none()).map(|(file, _)| file);
    let left_out: Vec<String> = unread.chain(&others).map(|file| name_from(&base, file)).collect();
    let sources: Vec<Source> = found.into_iter().flatten().collect();
    if sources.is_empty() {
        return Problem::error(&base, "holds no log", "name files with a column for each signal").alone();
    }
    let mut answers = answers(arguments)?;
    let mut survey = survey(arguments, &answers, sources, &left_out)?;
    answer_by_data(arguments, &survey, &mut answers)?;
    let mut draft = init::draft(&survey, &answers);
    if talk.shows_progress() && !arguments.no_questions && std::io::stdin().is_terminal() {
        (survey, draft) = ask(arguments, survey, answers, &left_out)?;
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

/// What `sources` hold, with what is answered so far.
fn survey(arguments: &Arguments, answers: &Answers, sources: Vec<Source>, left_out: &[String]) -> Result<Survey> {
    let kind = arguments.kind.map(|kind| match kind {
        KindChoice::Revolute => JointKind::Revolute,
        KindChoice::Prismatic => JointKind::Prismatic,
    });
    let (measures, rate_hz) = (answers.measures(), answers.number("files.rate_hz"));
    let columns = answers.columns.clone();
    if let Some((key, name)) = columns.iter().find(|(_, name)| !has_column(&sources, name)) {
        let held: Vec<&str> = sources[0].columns.iter().map(|series| series.name.as_str()).collect();
        let cure = format!("the files hold {}", crate::limits::listed(held.into_iter()));
        return Problem::error(&sources[0].path, format!("has no column `{name}` for the {key}"), cure).alone();
    }
    let known = Known { joint: arguments.joint.clone(), kind, columns, measures, rate_hz };
    let mut survey = init::survey(sources, &known)?;
    if !left_out.is_empty() {
        let names = crate::limits::listed(left_out.iter().map(String::as_str));
        survey.chosen.notes.push(format!("no logs, left out: {names}"));
    }
    Ok(survey)
}

/// `position=column_2` as a key under `[columns]` and a name.
fn column(text: &str) -> std::result::Result<(String, String), String> {
    let keys = || Quantity::ASKED.map(Quantity::name).join(", ");
    let found = text.split_once('=').filter(|(key, _)| Quantity::ASKED.iter().any(|asked| asked.name() == *key));
    found
        .map(|(key, name)| (key.to_string(), name.to_string()))
        .ok_or_else(|| format!("expected QUANTITY=NAME, QUANTITY one of {}", keys()))
}

fn has_column(sources: &[Source], name: &str) -> bool {
    sources[0].columns.iter().any(|series| series.name == name)
}

/// The answers that options give.
fn answers(arguments: &Arguments) -> Result<Answers> {
    let columns = arguments.column.iter().cloned().collect();
    let mut answers = Answers { name: arguments.name.clone(), drive: drive(arguments), columns, ..Answers::default() };
    let number = |value: Option<f64>| value.map(|value| value.to_string());
    let metres = |value: Option<f64>| number(value.map(|mm| mm * 1e-3));
    let given = |text: &Option<String>| text.clone().filter(|text| text != BY_DATA);
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
        ("signal.torque_sign", given(&arguments.torque_sign)),
        ("columns.position.offset", given(&arguments.zero)),
        ("files.rate_hz", number(arguments.rate_hz)),
        ("columns.torque", arguments.torque_unit.clone()),
        ("columns.position", arguments.position_unit.clone()),
        ("columns.current", arguments.current_unit.clone()),
        ("columns.current", arguments.current_unit.clone()),
        ("columns.time", arguments.time_unit.clone()),
    ] {
        if let Some(value) = value {
            answers.set(key, &value).or_else(|what| Problem::error(key, format!("is `{value}`"), what).alone())?;
        }
    }
    Ok(answers)
}

/// What drives the joint, as an option says it or needs it.
fn drive(arguments: &Arguments) -> Drive {
    match arguments.drive {
        Some(DriveChoice::Cable) => Drive::Cable,
        Some(DriveChoice::Gear) => Drive::Gear,
        Some(DriveChoice::Direct) => Drive::Direct,
        Some(DriveChoice::Screw) => Drive::Screw,
        None if arguments.gear_ratio.is_some() => Drive::Gear,
        None if arguments.lead_mm.is_some() => Drive::Screw,
        None => Drive::Cable,
    }
}

/// The answers that options leave to the data.
fn answer_by_data(arguments: &Arguments, survey: &Survey, answers: &mut Answers) -> Result<()> {
    let unit = survey.chosen.of(Quantity::Position).map_or(1.0, |choice| choice.measure.unit.factor());
    let sign = survey.hints.torque_sign;
    let zero = survey.hints.zero_rad.map(|zero_rad| zero_rad / unit);
    for (option, asked, key, found) in [
        ("--torque-sign", &arguments.torque_sign, "signal.torque_sign", sign),
        ("--zero", &arguments.zero, "columns.position.offset", zero),
    ] {
        if asked.as_deref() != Some(BY_DATA) {
            continue;
        }
        let Some(found) = found else {
            return Problem::error(option, "is `data`, and the data do not tell it", "give a number").alone();
        };
        answers.values.insert(key.to_string(), found.to_string());
    }
    Ok(())
}

/// Asks each question on the terminal; Enter takes what the data suggest, or leaves the question open. A unit or a rate changes
/// what is found, and with it what is asked next.
fn ask(arguments: &Arguments, survey: Survey, mut answers: Answers, left_out: &[String]) -> Result<(Survey, Draft)> {
    let mut survey = survey;
    let has_drive = arguments.drive.is_some() || answers.drive != Drive::Cable;
    if !has_drive {
        answers.drive = ask_drive();
    }
    let mut asked: Vec<String> = Vec::new();
    let mut draft = init::draft(&survey, &answers);
    while let Some(question) = draft.questions.iter().find(|question| !asked.contains(&question.key)).cloned() {
        let Question { key, asks, suggested } = question;
        let Some(text) = prompt(&format!("{key}: {asks}"), suggested.as_deref().unwrap_or("later")) else { break };
        let given = if text.is_empty() { suggested } else { Some(text) };
        if let Some((column, name)) =
            key.strip_prefix("columns.").zip(given.clone()).filter(|(_, name)| has_column(&survey.sources, name))
        {
            answers.columns.insert(column.to_string(), name);
            survey = self::survey(arguments, &answers, survey.sources, left_out)?;
            draft = init::draft(&survey, &answers);
            continue;
        }
        match given.map(|given| answers.set(&key, &given)) {
            Some(Err(what)) => {
                let _ = writeln!(anstream::stderr(), "{what}");
                continue;
            }
            Some(Ok(())) if key.starts_with("columns.") || key.starts_with("files.") => {
                survey = self::survey(arguments, &answers, survey.sources, left_out)?;
            }
            _ => {}
        }
        asked.push(key);
        draft = init::draft(&survey, &answers);
    }
    Ok((survey, draft))
}

/// Asks what drives the joint until the answer is one of these; without an answer it is a cable.
fn ask_drive() -> Drive {
    loop {
        match prompt("what drives the joint: cable, gear, direct or screw?", "cable").unwrap_or_default().as_str() {
            "" => return Drive::Cable,
            text => match Drive::ALL.into_iter().find(|drive| drive.name() == text) {
                Some(drive) => return drive,
                None => {
                    let _ = writeln!(anstream::stderr(), "expected cable, gear, direct or screw");
                }
            },
        }
    }
}

/// What is typed after a question; nothing at the end of the input.
fn prompt(question: &str, offer: &str) -> Option<String> {
    let mut out = anstream::stderr().lock();
    let _ = write!(out, "{question} [{offer}] ");
    let _ = out.flush();
    let mut line = String::new();
    let read = std::io::stdin().lock().read_line(&mut line).unwrap_or(0);
    (read > 0).then(|| line.trim().to_string())
}
