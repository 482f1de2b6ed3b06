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

pub use mended::{stretches, without_missing_rows, without_repeated_rows};
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

/// Endings of text: tables, exports of TwinCAT's Scope, of LabVIEW and the like.
const TEXTS: [&str; 8] = ["csv", "txt", "tsv", "dat", "asc", "lvm", "prn", "log"];

fn ending(file: &Path) -> String {
    file.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Whether `file` is text, going by its ending.
pub fn is_text(file: &Path) -> bool {
    TEXTS.contains(&ending(file).as_str())
}

/// Whether `file` may be a log that is read here, going by its ending.
pub fn is_log(file: &Path) -> bool {
    is_text(file) || ["parquet", "mat", "mcap"].contains(&ending(file).as_str())
}

/// That `file` is of a format that is not read here, and how to make another of it.
pub fn unsupported(file: &Path) -> Problem {
    let cure = match ending(file).as_str() {
        "xlsx" | "xls" | "ods" => "save the sheet as CSV",
        "tdms" => {
            "export it as CSV; in Python: `nptdms.TdmsFile.read(file).as_dataframe().to_parquet(\"log.parquet\")`"
        }
        "bag" | "db3" => "convert it to MCAP: `rosbags-convert`, or `ros2 bag convert` with `storage_id: mcap`",
        "npy" | "npz" | "pkl" | "h5" | "hdf5" | "feather" | "json" => {
            "save its columns as CSV or Parquet, in Python with pandas' `to_parquet`"
        }
        _ => "it takes .csv, .txt, .tsv, .dat, .lvm, .parquet, .mat (MATLAB) and .mcap (ROS 2)",
    };
    Problem::error(file, "is of an unsupported log format", cure)
}

/// Whether `file` is a table that a campaign can hold as it is: Parquet, or CSV that is no export of TwinCAT's Scope.
pub fn is_table(file: &Path) -> bool {
    let begins = || -> std::io::Result<bool> {
        let mut begin = Vec::new();
        std::fs::File::open(file)?.take(4096).read_to_end(&mut begin)?;
        Ok(!scope::is_export(&begin))
    };
    ending(file) == "parquet" || is_text(file) && begins().unwrap_or(false)
}

/// The columns of `file`, or nothing where it is a table that a campaign can hold as it is (CSV or Parquet).
///
/// Errors: the file cannot be read, is of no kind known here, or is damaged.
pub fn read(file: &Path) -> Result<Option<Vec<Series>>> {
    let bytes = || {
        std::fs::read(file).or_else(|error| {
            Problem::error(file, format!("cannot be read: {error}"), "check the path and its permissions").alone()
        })
    };
    if is_table(file) {
        return Ok(None);
    }
    match ending(file).as_str() {
        "mat" => matlab::read(file, bytes()?).map(Some),
        "mcap" => joint_states::read(file, &bytes()?).map(Some),
        _ if is_text(file) => scope::read(file, &bytes()?).map(Some),
        _ => unsupported(file).alone(),
    }
}
