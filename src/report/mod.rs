//! Results for readers: terminal, JSON, tables, figures, one HTML file.
//!
//! What comes in is a finished `Identification`; what goes out is text and pictures. Nothing here fits anything: the only
//! arithmetic is binning and formatting.
//!
//! | file | what it makes |
//! |---|---|
//! | `output` | a folder that appears whole or not at all, with the list of its files |
//! | `gate` | what is not a number ends as an error, at every output |
//! | `tables` | `trials.csv`, written and read |
//! | `identification` | the JSON of `model.json` and `--json` |
//! | `evaluation` | an evaluation as JSON, on the terminal, as a page |
//! | `effects` | the effect library as JSON, on the terminal |
//! | `excitation` | motions held against limits, as JSON, on the terminal |
//! | `checked` | a campaign held against its baseline, on the terminal, as JSON, JUnit, GitHub annotations |
//! | `fleet` | many campaigns: by joint, over time, as JSON, on the terminal, as a page |
//! | `comparison` | two models compared as JSON, on the terminal, as a page |
//! | `diagnosis` | a diagnosis as JSON, on the terminal, as a page |
//! | `interaction` | an interaction as JSON, tables, on the terminal, as a page |
//! | `predicted` | a trial's prediction, sample by sample |
//! | `verdict` | the result in plain words |
//! | `validation` | what `validate` understood, on the terminal, as JSON, as a page |
//! | `terminal` | the summary on the terminal |
//! | `chart` | figures as data: panels, series, axes; drawn as SVG, or sent to the page's script |
//! | `plots` | results as figures, one file each |
//! | `png` | a figure as a picture, with the bundled font |
//! | `forms` | the forms of B(v) side by side, for the page |
//! | `page` | `report.html`: a list of sections in one file, with its script and style |
//! | `protocol` | the page of an identification |
//! | `parameters`, `number`, `wording` | what all of these share: rows, digits, units and words |

pub mod chart;
pub mod checked;
pub mod comparison;
pub mod diagnosis;
pub mod effects;
pub mod evaluation;
pub mod excitation;
pub mod fleet;
mod forms;
pub mod gate;
pub mod identification;
pub mod interaction;
mod life;
pub mod number;
pub mod output;
pub mod page;
pub mod parameters;
pub mod plots;
pub mod png;
pub mod predicted;
mod protocol;
pub mod repeatability;
pub mod tables;
pub mod terminal;
pub mod validation;
pub mod verdict;
pub mod wording;

pub use output::Output;
pub use tables::{read_trials_csv, trials_csv};

use crate::batch::{self, Fleet, Repeatability};
use crate::compare::Comparison;
use crate::evaluate::Evaluation;
use crate::excite::{Asked, Limits};
use crate::identify::{Identification, LegFit};
use crate::interaction::Interaction;
use crate::log::mixed;
use crate::problem::{Problem, Result, acts};

/// Writes `model.json`, `trials.csv` (its header alone without sweeps), `plots/` and `report.html` of `found` to `output`.
///
/// `campaign` is the name that the report calls the campaign by; `png` asks for pictures beside the drawings.
pub fn write_identification(found: &Identification, campaign: &str, output: &Output, png: bool) -> Result<()> {
    output.write("model.json", json_text(&identification::to_json(found, campaign)))?;
    write_trials(&found.legs, &found.model.joint.name, output)?;
    protocol::page(found, campaign).write(output, png)
}

/// Writes `evaluation.json`, `plots/` and `report.html` of `found` to `output`.
pub fn write_evaluation(found: &Evaluation, campaign: &str, model: &str, output: &Output, png: bool) -> Result<()> {
    output.write("evaluation.json", json_text(&evaluation::to_json(found, campaign, model)))?;
    evaluation::page(found, campaign, model).write(output, png)
}

/// Writes `interaction.json`, a table per trial called as `names` says, `plots/` and `report.html` of `found` to `output`.
pub fn write_interaction(
    found: &Interaction,
    names: &[String],
    campaign: &str,
    model: &str,
    output: &Output,
    png: bool,
) -> Result<()> {
    output.write("interaction.json", json_text(&interaction::to_json(found, campaign, model)))?;
    for (trial, name) in found.trials.iter().zip(names) {
        output.write(name, interaction::trial_csv(trial, &found.quiet))?;
    }
    interaction::page(found, campaign, model).write(output, png)
}

/// Writes `table.csv`, `table.parquet`, `fleet.json`, `plots/` and `report.html` of `fleet`, called `name`, to `output`.
pub fn write_fleet(fleet: &Fleet, name: &str, output: &Output, png: bool) -> Result<()> {
    let columns = batch::columns(&fleet.rows);
    let shown = |name: &str| output.path().join(name);
    output.write("table.csv", mixed::csv_bytes(&shown("table.csv"), &columns)?)?;
    output.write("table.parquet", mixed::parquet_bytes(&shown("table.parquet"), &columns)?)?;
    output.write("fleet.json", json_text(&fleet::to_json(fleet)))?;
    fleet::page(fleet, name).write(output, png)
}

/// Writes `comparison.json`, `plots/` and `report.html` of `found` between the models called `names` to `output`.
pub fn write_comparison(found: &Comparison, names: &[String; 2], output: &Output, png: bool) -> Result<()> {
    output.write("comparison.json", json_text(&comparison::to_json(found, names)))?;
    comparison::page(found, names).write(output, png)
}

/// Writes `repeatability.json`, the page and the plots to `output`.
pub fn write_repeatability(found: &[Repeatability], output: &Output, png: bool) -> Result<()> {
    output.write("repeatability.json", json_text(&repeatability::to_json(found)))?;
    repeatability::page(found).write(output, png)
}

/// Writes a file for each motion of `asked`, `excitation.json` and `plan.svg` to `output`; `png` asks for a picture too.
pub fn write_excitation(asked: &[Asked], limits: &Limits, output: &Output, picture: bool) -> Result<()> {
    output.write("excitation.json", json_text(&excitation::to_json(asked, limits)))?;
    for one in asked {
        output.write(&excitation::file_of(one), one.trajectory.to_toml())?;
    }
    page::write_figure(&plots::excitation::figure(asked, limits), "", output, picture)
}

/// Writes `legs` of the joint called `joint` to `trials.csv`.
pub fn write_trials(legs: &[LegFit], joint: &str, output: &Output) -> Result<()> {
    let table = trials_csv(legs, joint).or_else(|error| unmade(output, "trials.csv", error))?;
    output.write("trials.csv", table)
}

/// `value` as a file holds it: what acts on a terminal (`problem::acts`) stands as its code, as JSON writes it.
pub fn json_text(value: &serde_json::Value) -> String {
    let text = format!("{value:#}\n");
    if !text.contains(|c| acts(c) && c != '\n') {
        return text;
    }
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        match acts(c) && c != '\n' {
            true => c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| plain += &format!("\\u{unit:04x}")),
            false => plain.push(c),
        }
    }
    plain
}

/// An output that could not be made: a fault of this program, not of its input.
fn unmade<T>(output: &Output, name: &str, error: impl std::fmt::Display) -> Result<T> {
    let what = format!("could not be made: {error}");
    Problem::error(output.path().join(name), what, "report this with the campaign").alone()
}
