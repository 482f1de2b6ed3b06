//! `tautline rig check`: everything but torque.

use crate::capture::operator::Agrees;
use crate::capture::plan::Plan;
use crate::capture::session::{Live, Outcome, Task, Torque, capture};
use crate::cli::interrupt;
use crate::cli::live::View;
use crate::cli::outcome::{JUDGED_BAD, TORQUE_ON, Talk};
use crate::cli::wire::{self, Described};
use crate::problem::{Problem, Result};
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The rig: a rig.toml, or `demo`
    #[arg(long)]
    pub rig: PathBuf,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let outcome = look(arguments, &Described::read(&arguments.rig)?, talk)?;
    let wrong = outcome.doubt.as_ref().map(ToString::to_string);
    let (late, missed) = (outcome.counts.late, outcome.counts.missed);
    let (position_rad, torque_nm) =
        outcome.now.as_ref().map_or((f64::NAN, None), |now| (now.position_rad, now.sensor.torque_nm));
    talk.result(
        || {
            json!({
                "report": outcome.report, "cycles": outcome.cycles, "late_cycles": late, "missed_cycles": missed,
                "position_rad": position_rad, "torque_nm": torque_nm, "sensor_sd_counts": outcome.looked.sd_counts,
                "wrong": wrong, "torque_off": outcome.torque == Torque::Off,
            })
        },
        |out| {
            outcome.report.iter().try_for_each(|line| writeln!(out, "{line}"))?;
            writeln!(out, "{} cycles: {late} late, {missed} missed", outcome.cycles)?;
            let torque = torque_nm.map_or("of no use".to_string(), |torque| format!("{torque:+.4} N m"));
            let noise = outcome.looked.sd_counts;
            writeln!(out, "joint at {position_rad:+.4} rad, torque {torque}, its noise {noise:.1} counts")?;
            match &wrong {
                Some(wrong) => writeln!(out, "wrong: {wrong}"),
                None => writeln!(out, "all as the rig says; nothing was enabled"),
            }
        },
    )?;
    if let Some(warning) = outcome.torque.warning() {
        let _ = writeln!(anstream::stderr(), "{warning}");
        return Ok(ExitCode::from(TORQUE_ON));
    }
    Ok(if wrong.is_some() { ExitCode::from(JUDGED_BAD) } else { ExitCode::SUCCESS })
}

/// Brings the bus to OP and looks at it for a while, without torque.
///
/// Errors: it does not start.
pub fn look(arguments: &Arguments, described: &Described, talk: &Talk) -> Result<Outcome> {
    let rig = &described.rig;
    let wire = wire::open(&rig.bus.interface, false, 1)?;
    let plan = Plan { trials: Vec::new(), rest_s: 0.0 };
    let task = Task { rig, plan: &plan, armed: false, interrupted: interrupt::noted(), operator: &Agrees };
    let live = Arc::new(Mutex::new(Live::default()));
    let _view = View::new(talk, &live);
    capture(wire, &task, None, &live)
        .or_else(|why| Problem::error(&arguments.rig, why.0, "nothing was enabled").alone())
}
