//! A campaign held against its baseline: on the terminal, as JSON, as JUnit XML, as annotations of a GitHub workflow.

mod json;
mod machines;
mod terminal;

pub use json::to_json;
pub use machines::{to_github, to_junit};
pub use terminal::write_summary;

use super::number::significant;
use crate::check::{Finding, Held, Outcome};

/// What a report says of itself.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a> {
    /// The campaign.
    pub campaign: &'a str,
    /// The file of the campaign, which annotations point to.
    pub campaign_file: &'a str,
    /// The baseline's file.
    pub baseline: &'a str,
    /// The version that stored it.
    pub stored_by: &'a str,
}

/// A finding in a line, after its name; empty where nothing is to be said.
pub fn told(finding: &Finding) -> String {
    if finding.outcome == Outcome::Same {
        return String::new();
    }
    let unit = if finding.unit.is_empty() { String::new() } else { format!(" {}", finding.unit) };
    let held = |held: &Held| match held {
        Held::Nothing => "nothing".to_string(),
        Held::Text(text) => text.clone(),
        Held::Number(number) if number.is_nan() => "no number".to_string(),
        Held::Number(number) => format!("{}{unit}", digits(*number, finding)),
    };
    let mut words = match (&finding.before, &finding.now) {
        (Held::Text(a), Held::Text(b)) if a == b => String::new(),
        (before, now) => format!("{} -> {}", held(before), held(now)),
    };
    if finding.moved().is_finite() {
        let by = format!("{:+.1e}{unit}", finding.moved());
        words += &match finding.outcome {
            Outcome::Untold => format!(", moved {by}: too loosely known to tell"),
            _ => format!(", moved {by}, {} of the {:.1e}{unit} allowed", times(finding.tolerances()), finding.allowed),
        };
    }
    let note = finding.note.replace('\n', " | ");
    match (words.is_empty(), note.is_empty()) {
        (false, false) => format!("{words}; {note}"),
        _ => words + &note,
    }
}

/// As many digits as the move takes to be seen.
fn digits(number: f64, finding: &Finding) -> String {
    let share = (number / finding.moved()).abs();
    let digits = if share.is_finite() && share > 1.0 { share.log10().ceil() as usize + 2 } else { 4 };
    significant(number, digits.clamp(4, 12))
}

/// "3.1 times", or a share where it is below 1.
fn times(tolerances: f64) -> String {
    match tolerances {
        few if few < 1.0 => format!("{:.0} %", 100.0 * few),
        some if some < 1e5 => format!("{} times", significant(some, 3)),
        _ => "far beyond".to_string(),
    }
}
