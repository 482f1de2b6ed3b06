//! `tautline rig jog`: the joint moved from the keyboard, slowly and only while a key is held.

use super::propose::{self, Proposed, propose};
use crate::capture::operator::{Agrees, Operator};
use crate::capture::plan::Plan;
use crate::capture::run::jog::{Jog, Jogger};
use crate::capture::session::{Live, Outcome, Task, Torque, jog};
use crate::cli::interrupt;
use crate::cli::keyboard::Keyboard;
use crate::cli::live::View;
use crate::cli::outcome::{JUDGED_BAD, TORQUE_ON, Talk};
use crate::cli::wire::{self, Described};
use crate::problem::{Problem, Result};
use console::{Key, Term};
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Keys: arrow up or u moves up, arrow down or d moves down, for as long as the key is held; any other key
stops, q ends. Everything that `tautline capture --arm` shows and asks comes first.

Examples:
  tautline rig jog --rig rig.toml
  tautline rig jog --rig demo --script 'up 1, rest 0.5, down 1'    without a keyboard, on the software joint
  tautline rig jog --rig rig.toml --at-rad 0 --write               the zero from where it ends, without asking

Nothing is recorded. Go two degrees up and two down, or farther: at the end you are asked how far it went, and where it is. From that
follow sign and scale of the drive, the joint's zero, and by the torque of both ways the sensor's sign (with a known load its scale).
They are shown, and written to the rig's file if you agree; its comments stay."
)]
pub struct Arguments {
    /// The rig: a rig.toml, or `demo`
    #[arg(long)]
    rig: PathBuf,
    /// What is asked for, in place of keys: up, down or rest, each with its seconds (software joint only)
    #[arg(long)]
    script: Option<String>,
    #[command(flatten)]
    told: propose::Arguments,
}

/// How long a key press counts: a held key repeats faster than that, except for the delay before the first repeat.
const HELD: Duration = Duration::from_millis(250);
/// The longest of a script, s.
const LONGEST_S: f64 = 600.0;

/// What the keyboard asks for. Keys are read from when torque has come: before, the operator is asked for a word.
#[derive(Debug, Default)]
struct Keys {
    last: Arc<Mutex<Option<(Jog, Instant)>>>,
    begun: OnceLock<()>,
}

impl Keys {
    /// Reads keys in a thread of its own, until the one that ends it.
    fn begin(&self) {
        let last = Arc::clone(&self.last);
        std::thread::spawn(move || {
            let term = Term::stderr();
            loop {
                let wanted = match term.read_key() {
                    Ok(Key::ArrowUp | Key::Char('u')) => Jog::Up,
                    Ok(Key::ArrowDown | Key::Char('d')) => Jog::Down,
                    Ok(Key::Char('q') | Key::Escape) | Err(_) => Jog::End,
                    Ok(_) => Jog::Rest,
                };
                *last.lock().unwrap_or_else(PoisonError::into_inner) = Some((wanted, Instant::now()));
                if wanted == Jog::End {
                    break;
                }
            }
        });
    }
}

impl Jogger for Keys {
    fn wanted(&self, _: f64) -> Jog {
        self.begun.get_or_init(|| self.begin());
        // Whoever holds it does so for no longer than an assignment takes; then nothing is asked for.
        match self.last.try_lock().ok().and_then(|last| *last) {
            Some((Jog::End, _)) => Jog::End,
            Some((wanted, at)) if at.elapsed() < HELD => wanted,
            _ => Jog::Rest,
        }
    }
}

/// What a script asks for, each until its time, s.
#[derive(Debug)]
struct Script(Vec<(Jog, f64)>);

impl Script {
    /// Reads `up 1, rest 0.5, down 1`.
    ///
    /// Errors: what is none of that.
    fn parse(text: &str) -> Result<Self> {
        let refuse = |what: String| {
            Problem::error("--script", what, "write such as 'up 1, rest 0.5, down 1': what, and how many seconds")
                .alone()
        };
        let (mut steps, mut until_s) = (Vec::new(), 0.0);
        for step in text.split(',').map(str::trim) {
            let (word, time) = step.split_once(' ').unwrap_or((step, ""));
            let wanted = match word {
                "up" => Jog::Up,
                "down" => Jog::Down,
                "rest" => Jog::Rest,
                _ => return refuse(format!("`{step}` asks for neither up, down nor rest")),
            };
            match time.trim().parse::<f64>() {
                Ok(time_s) if time_s > 0.0 && time_s + until_s <= LONGEST_S => until_s += time_s,
                _ => return refuse(format!("`{step}` names no time of up to {LONGEST_S} s in all")),
            }
            steps.push((wanted, until_s));
        }
        Ok(Self(steps))
    }
}

impl Jogger for Script {
    fn wanted(&self, time_s: f64) -> Jog {
        self.0.iter().find(|(_, until_s)| time_s < *until_s).map_or(Jog::End, |(wanted, _)| *wanted)
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let described = Described::read(&arguments.rig)?;
    let rig = &described.rig;
    let script = arguments.script.as_deref().map(Script::parse).transpose()?;
    if script.is_some() && !described.is_demo {
        let cure = "leave --script out, and hold a key: nothing moves a real joint by itself here";
        return Problem::error("--script", "is for the software joint", cure).alone();
    }
    if script.is_none() && !Term::stderr().is_term() {
        return Problem::error("rig jog", "has no keyboard", "run it in a terminal").alone();
    }
    let wire = wire::open(&rig.bus.interface, script.is_none(), 1)?;
    let plan = Plan { trials: Vec::new(), rest_s: 0.0 };
    let (keyboard, keys) = (Keyboard::default(), Keys::default());
    let operator: &dyn Operator = if described.is_demo { &Agrees } else { &keyboard };
    let jogger: &dyn Jogger = script.as_ref().map_or(&keys, |script| script);
    let task = Task { rig, plan: &plan, armed: true, interrupted: interrupt::noted(), operator };
    let live = Arc::new(Mutex::new(Live::default()));
    let view = View::new(talk, &live);
    let outcome = jog(wire, &task, jogger, &live);
    drop(view);
    match outcome {
        Ok(outcome) if outcome.declined => {
            Problem::error("operator", "did not type the word that was asked for", "nothing was enabled").alone()
        }
        Ok(outcome) => {
            let is_over = outcome.cause.is_none() && outcome.torque == Torque::Off;
            let jogged = outcome.jogged.as_ref().filter(|_| is_over);
            let propose = |jogged| propose(&arguments.told, &arguments.rig, &described, jogged, script.is_none());
            // Whatever comes of it, the last words on the torque stand.
            let proposed = jogged.map(propose).transpose();
            let (proposed, refused) = proposed.map_or_else(|why| (None, Some(why)), |proposed| (proposed, None));
            let status = tell(&outcome, &proposed.unwrap_or_default(), talk)?;
            refused.map_or(Ok(status), Err)
        }
        Err(why) => Problem::error(&arguments.rig, why.0, "nothing was enabled").alone(),
    }
}

fn tell(outcome: &Outcome, proposed: &Proposed, talk: &Talk) -> Result<ExitCode> {
    let position_rad = outcome.now.as_ref().map_or(f64::NAN, |now| now.position_rad);
    let stopped = outcome.cause.as_ref().map(ToString::to_string);
    talk.result(
        || {
            json!({
                "report": outcome.report, "cycles": outcome.cycles, "late_cycles": outcome.counts.late,
                "missed_cycles": outcome.counts.missed, "position_rad": position_rad, "stopped_by": stopped,
                "torque_off": outcome.torque == Torque::Off, "proposed": proposed.to_json(),
            })
        },
        |out| {
            outcome.report.iter().try_for_each(|line| writeln!(out, "{line}"))?;
            proposed.lines().try_for_each(|line| writeln!(out, "{line}"))?;
            writeln!(out, "joint at {position_rad:+.4} rad")
        },
    )?;
    if let Some(stopped) = &stopped {
        let _ = writeln!(anstream::stderr(), "stopped: {stopped}");
    }
    if let Some(warning) = outcome.torque.warning() {
        let _ = writeln!(anstream::stderr(), "{warning}");
        return Ok(ExitCode::from(TORQUE_ON));
    }
    Ok(if stopped.is_some() { ExitCode::from(JUDGED_BAD) } else { ExitCode::SUCCESS })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_is_read_and_ends() {
        let script = Script::parse("up 1, rest 0.5, down 2").unwrap();
        let at = |time_s| script.wanted(time_s);
        assert_eq!([at(0.5), at(1.2), at(3.0), at(3.6)], [Jog::Up, Jog::Rest, Jog::Down, Jog::End]);
        for wrong in ["", "up", "sideways 1", "up -1", "up nan", "up 1e9"] {
            assert!(Script::parse(wrong).is_err(), "{wrong}");
        }
    }
}
