//! What `diagnose` writes: JSON, the summary on the terminal, the page.
//!
//! | file | what it makes |
//! |---|---|
//! | `json` | `diagnosis.json` |
//! | `words`, `evidence`, `next` | the verdict, its evidence, what to do next, in sentences |
//! | `names`, `parameters` | what causes, regions and fitted numbers are called |
//! | `motion` | the gap in motion, in each of these |
//! | `experiment` | the next experiment: its file, its words |
//! | `terminal` | the summary |
//! | `page`, `tables` | the page |

mod evidence;
mod experiment;
mod json;
pub mod motion;
pub mod names;
mod next;
mod page;
mod parameters;
mod tables;
mod terminal;
pub mod words;

pub use experiment::{next_toml, sentences};
pub use json::to_json;
pub use parameters::unit_of;
pub use terminal::write_summary;

use super::json_text;
use super::output::Output;
use crate::diagnose::Diagnosis;
use crate::problem::Result;

/// Writes the diagnosis of `campaign` with `model`: `diagnosis.json`, `model.json`, `plots/` and `report.html`; `png` asks for
/// pictures beside the drawings.
///
/// Errors: a file that cannot be written.
pub fn write_diagnosis(found: &Diagnosis, campaign: &str, model: &str, output: &Output, png: bool) -> Result<()> {
    output.write("diagnosis.json", json_text(&to_json(found, campaign, model)))?;
    output.write("model.json", json_text(&found.after.to_json()))?;
    experiment::next_toml(found).map_or(Ok(()), |text| output.write(experiment::FILE, text))?;
    page::page(found, campaign, model).write(output, png)
}
