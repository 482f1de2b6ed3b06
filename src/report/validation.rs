//! What `validate` understood of a campaign: on the terminal, as JSON, as a page with a figure for each trial.

use super::number::{counted, significant};
use super::output::Output;
use super::page::{Block, Card, Page, Section, Table, Warning};
use super::plots;
use super::wording::Units;
use crate::dynamics::JointKind;
use crate::identify::{Understood, UnderstoodTrial};
use crate::log::TorqueFrom;
use crate::problem::{Problem, Result, Severity};
use serde_json::{Value, json};
use std::io::{self, Write};

/// Places of the series of a trial.
pub const POSITION: usize = 1;
/// Speed.
pub const SPEED: usize = 2;
/// Torque.
pub const TORQUE: usize = 3;
/// Speeds named on the terminal.
const SPEEDS: usize = 6;

/// Units and factor of positions and speeds as a reader sees them: deg and deg/s, or mm and mm/s.
pub fn plain(understood: &Understood) -> (&'static str, &'static str, f64) {
    match understood.joint.kind {
        JointKind::Revolute => ("deg", "deg/s", 1f64.to_degrees()),
        JointKind::Prismatic => ("mm", "mm/s", 1e3),
    }
}

fn scaled(pair: (f64, f64), factor: f64) -> (f64, f64) {
    (factor * pair.0, factor * pair.1)
}

fn rates_hz(understood: &Understood) -> (f64, f64) {
    let rates = || understood.trials.iter().map(|trial| trial.rate_hz);
    (rates().fold(f64::INFINITY, f64::min), rates().fold(0.0, f64::max))
}

fn most(understood: &Understood, of: impl Fn(&UnderstoodTrial) -> f64) -> f64 {
    understood.trials.iter().map(of).fold(0.0, f64::max)
}

/// What the torque is.
fn torque_name(understood: &Understood) -> String {
    let name = match understood.torque_from {
        None => "torque",
        Some(TorqueFrom::Current(_)) => "torque from current",
        Some(TorqueFrom::Controller(_)) => "torque from command and position",
    };
    let is_scaled = understood.torque_from.is_none_or(|from| from.is_scaled());
    if is_scaled { name.to_string() } else { format!("{name} (up to one factor)") }
}

/// Each speed that sweeps declare, with the least and the most that was found, rad/s.
fn speeds(understood: &Understood) -> Vec<(f64, f64, f64)> {
    let mut all: Vec<(f64, f64)> = understood.sweeps().collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let of = |group: &[(f64, f64)]| {
        let found = || group.iter().map(|pair| pair.1);
        (group[0].0, found().fold(f64::INFINITY, f64::min), found().fold(0.0, f64::max))
    };
    all.chunk_by(|a, b| a.0 == b.0).map(of).collect()
}

/// As `--json` holds it.
pub fn to_json(understood: &Understood) -> Value {
    let (angle, speed) = match understood.joint.kind {
        JointKind::Revolute => ("position_deg", "speed_deg_s"),
        JointKind::Prismatic => ("position_mm", "speed_mm_s"),
    };
    let factor = plain(understood).2;
    let pair = |at: usize, factor: f64| {
        let (low, high) = scaled(understood.extent(at), factor);
        json!([low, high])
    };
    let (slowest_hz, fastest_hz) = rates_hz(understood);
    let speeds: Vec<Value> = speeds(understood)
        .into_iter()
        .map(|(declared, low, high)| json!({ "declared_rad_s": declared, "found_rad_s": [low, high] }))
        .collect();
    let mut told = json!({
        "trials": understood.trials.len(),
        "rows": understood.trials.iter().map(|trial| trial.rows).sum::<usize>(),
        "duration_s": understood.trials.iter().map(UnderstoodTrial::duration_s).sum::<f64>(),
        "rate_hz": [slowest_hz, fastest_hz], "torque_nm": pair(TORQUE, 1.0), "r1_over_r2": understood.ratio,
        "noise_nm": most(understood, |trial| trial.noise_nm), "speeds": speeds,
    });
    (told[angle], told[speed]) = (pair(POSITION, factor), pair(SPEED, factor));
    if let Some(of) = &understood.evidence {
        told["friction_nm"] = json!(of.friction_nm);
        told["gravity_gain"] = if of.has_load { json!(of.gain) } else { Value::Null };
    }
    told
}

/// On the terminal.
pub fn write_summary(out: &mut impl Write, understood: &Understood) -> io::Result<()> {
    let (angle, speed, factor) = plain(understood);
    let torque = Units::of(&understood.joint).torque;
    let seconds: f64 = understood.trials.iter().map(UnderstoodTrial::duration_s).sum();
    let rows: usize = understood.trials.iter().map(|trial| trial.rows).sum();
    let (slowest_hz, fastest_hz) = rates_hz(understood);
    let trials = understood.trials.len();
    writeln!(
        out,
        "understood: {trials} trials, {rows} rows, {:.1} min at {slowest_hz:.4} to {fastest_hz:.4} Hz",
        seconds / 60.0
    )?;
    let (low, high) = scaled(understood.extent(POSITION), factor);
    let (slow, fast) = scaled(understood.extent(SPEED), factor);
    let step = most(understood, |trial| trial.step_rad) * factor;
    let steps = if step > 0.0 { format!(", encoder steps of {} {angle}", significant(step, 2)) } else { String::new() };
    writeln!(out, "  position {low:.2} to {high:.2} {angle}, speed {slow:.2} to {fast:.2} {speed}{steps}")?;
    let (low, high) = understood.extent(TORQUE);
    let noise = significant(most(understood, |trial| trial.noise_nm), 2);
    writeln!(
        out,
        "  {} {low:.4} to {high:.4} {torque}, with torque_sign applied and low-passed (which takes {noise} {torque} RMS); r1/r2 = {:.4}",
        torque_name(understood),
        understood.ratio
    )?;
    let speeds = speeds(understood);
    if !speeds.is_empty() {
        let off =
            |(declared, low, high): &(f64, f64, f64)| (low / declared - 1.0).abs().max((high / declared - 1.0).abs());
        let worst = speeds.iter().map(off).fold(0.0, f64::max);
        let listed: Vec<String> = speeds.iter().take(SPEEDS).map(|speed| significant(speed.0, 3)).collect();
        let more = if speeds.len() > SPEEDS { ", ..." } else { "" };
        writeln!(
            out,
            "  sweeps at {} ({}{more} rad/s), found within {:.1} % of what is declared",
            counted(speeds.len(), "speed", "speeds"),
            listed.join(", "),
            100.0 * worst
        )?;
    }
    let Some(of) = &understood.evidence else { return Ok(()) };
    write!(out, "  friction takes about {:.4} {torque}", of.friction_nm)?;
    match of.has_load {
        true => writeln!(out, "; the torque follows {:.3} times the declared load (1 to 2 are usual)", of.gain),
        false => writeln!(out),
    }
}

/// Writes `validation.json` (`found`), `plots/` and `report.html` to `output`; `png` asks for pictures too.
pub fn write(understood: &Understood, found: &Value, problems: &[Problem], output: &Output, png: bool) -> Result<()> {
    output.write("validation.json", super::json_text(found))?;
    page(understood, problems).write(output, png)
}

fn page(understood: &Understood, problems: &[Problem]) -> Page {
    let (angle, speed, factor) = plain(understood);
    let units = Units::of(&understood.joint);
    let range = |at: usize, factor: f64| {
        let (low, high) = scaled(understood.extent(at), factor);
        format!("{} to {}", significant(low, 3), significant(high, 3))
    };
    let card = |name: &str, value: String, note: String| Card { name: name.into(), value, note };
    let errors = problems.iter().filter(|problem| problem.severity == Severity::Error).count();
    let short = match (errors, problems.len()) {
        (0, 0) => "Usable; no problem found.".to_string(),
        (0, n) => format!("Usable; {}.", counted(n, "warning", "warnings")),
        (e, _) => format!("Not usable: {}.", counted(e, "error", "errors")),
    };
    let choices = understood.trials.iter().enumerate();
    let choices =
        choices.map(|(at, trial)| (trial.file.clone(), vec![plots::validation::trial(understood, at, trial)]));
    Page {
        kicker: "tautline validate".to_string(),
        title: understood.joint.name.clone(),
        subject: "validation".to_string(),
        short,
        lead: plots::validation::speeds(understood).into_iter().collect(),
        next: vec![
            match errors {
                0 => "Identify the joint: tautline identify CAMPAIGN -o FOLDER.",
                _ => "Correct the errors below, each of which names its cure, and validate again.",
            }
            .to_string(),
        ],
        cards: vec![
            card(
                "position",
                format!("{} {angle}", range(POSITION, factor)),
                "the whole range of all trials".to_string(),
            ),
            card("speed", format!("{} {speed}", range(SPEED, factor)), String::new()),
            card(
                "torque",
                format!("{} {}", range(TORQUE, 1.0), units.torque),
                format!("{}, with torque_sign applied, low-passed", torque_name(understood)),
            ),
            card("noise", units.torque(most(understood, |trial| trial.noise_nm)), "RMS removed by the low-pass".into()),
        ],
        warnings: problems.iter().map(|problem| Warning { text: problem.to_string(), figure: None }).collect(),
        sections: vec![
            Section::open("Each trial", vec![Block::Choice("trial", choices.collect())]),
            Section::folded("Table of the trials", vec![Block::Table(table(understood))]),
        ],
        ..Page::default()
    }
}

fn table(understood: &Understood) -> Table {
    let (_, speed, factor) = plain(understood);
    let row = |trial: &UnderstoodTrial| {
        let declared = trial.protocol.speed_rad_s().map_or(String::new(), |speed| significant(factor * speed, 3));
        vec![
            trial.file.clone(),
            trial.protocol.name().to_string(),
            declared,
            significant(factor * trial.speed_rad_s, 3),
            significant(trial.duration_s(), 4),
            significant(trial.rate_hz, 4),
        ]
    };
    let heads =
        ["", "protocol", &format!("declared ({speed})"), &format!("found ({speed})"), "duration (s)", "rate (Hz)"];
    Table::new(
        "",
        "Found is the median speed where the joint moves.",
        &heads,
        understood.trials.iter().map(row).collect(),
    )
}
