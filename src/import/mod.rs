//! Logs in formats that labs have -> columns of numbers by name.
//!
//! | file | format |
//! |---|---|
//! | `matlab` | MATLAB `.mat`: which version it is; v7.3 (HDF5) |
//! | `mat5` | MATLAB `.mat` of v5 to v7 |
//! | `joint_states` | ROS 2 recordings in MCAP: `sensor_msgs/msg/JointState` |
//! | `scope` | TwinCAT Scope's text export |
//! | `mended` | rows that repeat the one before dropped, trials parted at gaps |
//! | `picked` | of the columns, those that a campaign names |

mod joint_states;
mod mat5;
mod matlab;
mod mended;
mod picked;
mod scope;

pub use mended::{stretches, without_repeated_rows};
pub use picked::{Picked, picked};

use crate::problem::{Problem, Result};
use std::io::Read;
use std::path::Path;

/// One column as the file has it, in the file's own unit; what is missing is NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// How the file calls it.
    pub name: String,
    /// Its readings.
    pub values: Vec<f64>,
    /// Columns of one clock are as long as each other, and have the same number here.
    pub clock: usize,
    /// Where the first reading stands, for messages: its line in a text, its number (1) in a recording or an array.
    pub first_row: u64,
}

/// Whether `file` is a table that a campaign can hold as it is: Parquet, or CSV that is no export of TwinCAT's Scope.
pub fn is_table(file: &Path) -> bool {
    let begins = || -> std::io::Result<bool> {
        let mut begin = Vec::new();
        std::fs::File::open(file)?.take(4096).read_to_end(&mut begin)?;
        Ok(!scope::is_export(&begin))
    };
    match file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
        "parquet" => true,
        "csv" | "txt" | "tsv" | "dat" | "asc" => begins().unwrap_or(false),
        _ => false,
    }
}

/// The columns of `file`, or nothing where it is a table that a campaign can hold as it is (CSV or Parquet).
///
/// Errors: the file cannot be read, is of no kind known here, or is damaged.
pub fn read(file: &Path) -> Result<Option<Vec<Series>>> {
    let extension = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let bytes = || {
        std::fs::read(file).or_else(|error| {
            Problem::error(file, format!("cannot be read: {error}"), "check the path and its permissions").alone()
        })
    };
    if is_table(file) {
        return Ok(None);
    }
    match extension.as_str() {
        "mat" => matlab::read(file, bytes()?).map(Some),
        "mcap" => joint_states::read(file, &bytes()?).map(Some),
        "csv" | "txt" | "tsv" | "dat" | "asc" => scope::read(file, &bytes()?).map(Some),
        _ => {
            let cure = "it takes .mat (MATLAB), .mcap (ROS 2), .csv and .txt (TwinCAT Scope), .csv and .parquet";
            Problem::error(file, "is of an unsupported log format", cure).alone()
        }
    }
}
