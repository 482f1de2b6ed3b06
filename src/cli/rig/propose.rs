//! What a jog means for the numbers of a rig's file: asked for, told, and written with the operator's consent.

use super::rewrite::rewrite;
use crate::capture::commission::{Findings, Jogged, Told, findings};
use crate::cli::wire::Described;
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::io::{self, BufRead, Write};
use std::path::Path;

/// What the operator saw and knows of a jog.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// The way between the ends of the jog as you saw it, rad (m); negative where the joint went down while up was asked for
    #[arg(long, allow_negative_numbers = true, value_name = "RAD")]
    moved_rad: Option<f64>,
    /// How well you can read that, rad (m): half a degree by default
    #[arg(long, default_value_t = 0.009, value_name = "RAD")]
    read_to_rad: f64,
    /// Where the joint is at the end, rad (m): a pose that you know, for the zero
    #[arg(long, allow_negative_numbers = true, value_name = "RAD")]
    at_rad: Option<f64>,
    /// The torque at the winch that holds the joint there, N m (N): a known weight, for the sensor's scale
    #[arg(long, allow_negative_numbers = true, value_name = "NM")]
    load_nm: Option<f64>,
    /// Write what is proposed to the rig's file without asking
    #[arg(long)]
    write: bool,
}

/// What was proposed, and whether it stands in the file now.
#[derive(Debug, Default)]
pub struct Proposed {
    found: Findings,
    is_written: bool,
}

/// What follows from `jogged`; the operator is asked for what `arguments` do not say, where one is there (`asks`).
///
/// Errors: something told that cannot be so; the file cannot be written.
pub fn propose(
    arguments: &Arguments,
    file: &Path,
    described: &Described,
    jogged: &Jogged,
    asks: bool,
) -> Result<Proposed> {
    let asked = |told: Option<f64>, question: &str| match told {
        None if asks => number(question),
        told => Ok(told),
    };
    let told = Told {
        moved_rad: asked(
            arguments.moved_rad,
            "How far is it between the ends of the jog, rad (m), negative if the joint went down while up was asked for",
        )?,
        read_to_rad: arguments.read_to_rad,
        at_rad: asked(arguments.at_rad, "Where is the joint now, rad (m)")?,
        load_nm: asked(arguments.load_nm, "Which torque at the winch holds it there, N m (N), if you know it")?,
    };
    let found = findings(&described.rig, jogged, &told)
        .or_else(|what| Problem::error("rig jog", what, "nothing was written; jog again, or tell otherwise").alone())?;
    let numbers: Vec<_> = found.proposals.iter().map(|new| (new.section, new.key, new.after)).collect();
    if numbers.is_empty() || !described.has_file || !(arguments.write || asks && agrees(file, &found)) {
        return Ok(Proposed { found, is_written: false });
    }
    rewrite(file, &described.text, &numbers)?;
    Ok(Proposed { found, is_written: true })
}

impl Proposed {
    /// For programs.
    pub fn to_json(&self) -> Value {
        let numbers: Vec<Value> = self.found.proposals.iter().map(|new| {
            json!({ "section": new.section, "key": new.key, "before": new.before, "after": new.after, "why": new.why })
        }).collect();
        json!({ "numbers": numbers, "seen": self.found.lines, "written": self.is_written })
    }

    /// In lines.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        let last = match (self.found.proposals.is_empty(), self.is_written) {
            (true, _) => None,
            (false, true) => Some("written to the rig's file".to_string()),
            (false, false) => Some("nothing was written (--write does)".to_string()),
        };
        self.found.lines.iter().cloned().chain(proposals(&self.found)).chain(last)
    }
}

fn proposals(found: &Findings) -> impl Iterator<Item = String> {
    found
        .proposals
        .iter()
        .map(|new| format!("proposed: [{}] {} = {} (was {}): {}", new.section, new.key, new.after, new.before, new.why))
}

/// A number that is typed, or nothing where none is.
fn number(question: &str) -> Result<Option<f64>> {
    loop {
        let typed = typed(&format!("{question} (nothing: not known): "))?;
        match typed.as_str() {
            "" => return Ok(None),
            other => match other.parse::<f64>() {
                Ok(number) if number.is_finite() => return Ok(Some(number)),
                _ => continue,
            },
        }
    }
}

/// Whether the operator wants the file written.
fn agrees(file: &Path, found: &Findings) -> bool {
    let shown = proposals(found).collect::<Vec<_>>().join("\n");
    typed(&format!("{shown}\nType `write` to put that into {}: ", file.display())).is_ok_and(|typed| typed == "write")
}

fn typed(question: &str) -> Result<String> {
    let mut line = String::new();
    let mut out = anstream::stderr();
    let read =
        write!(out, "{question}").and_then(|()| out.flush()).and_then(|()| io::stdin().lock().read_line(&mut line));
    match read {
        Ok(_) => Ok(line.trim().to_string()),
        Err(error) => Problem::error("keyboard", format!("cannot be read: {error}"), "tell it by options").alone(),
    }
}
