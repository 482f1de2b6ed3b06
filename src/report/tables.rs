//! `trials.csv`: one row per leg, written for people and programs, read back by `fit friction`.

use crate::document::{nearest, suggest};
use crate::identify::{LegFit, LegZero};
use crate::log::mixed::{cell_text, text_cell};
use crate::log::{Campaign, TrialEntry};
use crate::model::Direction;
use crate::problem::{Problem, Problems, Result};
use csv::StringRecord;
use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

/// The columns that every such table has, in their order.
pub const REQUIRED: [&str; 9] =
    ["file", "repeat", "direction", "speed_rad_s", "samples", "a_nm", "b_nm", "r_squared", "rmse_nm"];

/// The columns that this program adds.
pub const EXTRA: [&str; 5] = ["a_se_nm", "b_se_nm", "raw_rmse_nm", "mean_sine", "mean_torque_nm"];

/// And of these the position's zero, all 0 where it is taken as declared.
pub const ZERO: [&str; 5] =
    ["position_zero_rad", "position_zero_half_width_rad", "a_by_zero_nm_rad", "mean_slope", "a_position_se_nm"];

/// And the last, the joint's name.
const JOINT: &str = "joint";

/// Faults told of one table: more of them would say the same again.
const FAULTS_TOLD: usize = 20;

/// `legs` of the joint called `joint` as a table; numbers in the shortest form that reads back to the same bits.
pub fn trials_csv(legs: &[LegFit], joint: &str) -> std::result::Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(REQUIRED.iter().chain(&EXTRA).chain(&ZERO).chain(&[JOINT]))?;
    for leg in legs {
        // What is not known is empty.
        let number = |x: f64| if x.is_nan() { String::new() } else { format!("{x:?}") };
        writer.write_record([
            text_cell(&leg.file).into_owned(),
            leg.repeat.to_string(),
            leg.direction.name().to_string(),
            number(leg.speed_rad_s),
            leg.samples.to_string(),
            number(leg.a_nm),
            number(leg.b_nm),
            number(leg.r_squared),
            number(leg.rmse_nm),
            number(leg.a_se_nm),
            number(leg.b_se_nm),
            number(leg.raw_rmse_nm),
            number(leg.mean_sine),
            number(leg.mean_torque_nm),
            number(leg.zero.zero_rad),
            number(leg.zero.half_width_rad),
            number(leg.zero.a_by_zero_nm_rad),
            number(leg.zero.mean_slope),
            number(leg.zero.a_position_se_nm),
            text_cell(joint).into_owned(),
        ])?;
    }
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The legs of `campaign` in the table at `path`. The columns of `EXTRA` may be absent and are then NaN, those of `ZERO` and are then 0, so may the joint's
/// name; others are not looked at.
///
/// Errors: the file cannot be read, lacks a column, holds no row, a field is no number, or a row is of another joint or
/// campaign; all rows are looked at.
pub fn read_trials_csv(path: &Path, campaign: &Campaign) -> Result<Vec<LegFit>> {
    let unreadable = |error: csv::Error| unreadable(path, &error);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(unreadable)?;
    let headers = reader.headers().map_err(unreadable)?.clone();
    check_headers(path, &headers)?;
    let mut legs = Vec::new();
    let mut faults = Vec::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                faults.push(unreadable(error));
                break;
            }
        };
        let mut row = Row { path, headers: &headers, record: &record, faults: &mut faults };
        row.check_joint(&campaign.joint.name);
        let leg = row.leg();
        legs.extend(leg.inspect(|leg| row.check_trial(leg, &campaign.trials)));
        if faults.len() >= FAULTS_TOLD {
            break;
        }
    }
    if faults.is_empty() && legs.is_empty() {
        faults.push(Problem::error(
            path,
            "holds no leg",
            "run `tautline fit trials` on a campaign with uniform sweeps",
        ));
    }
    Problems(faults).unless_errors(legs)
}

fn unreadable(path: &Path, error: &csv::Error) -> Problem {
    let row = error.position().map(|at| at.line());
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("has {len} fields, the header {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "is no UTF-8 text".to_string(),
        csv::ErrorKind::Io(error) => format!("cannot be read: {error}"),
        _ => format!("cannot be read: {error}"),
    };
    Problem::error(path, what, "name a trials.csv written by tautline").at_row(row)
}

/// Errors: a column that seems misspelt, by its likely name; all others that are missing, together.
fn check_headers(path: &Path, headers: &StringRecord) -> Result<()> {
    let missing: Vec<&str> = REQUIRED.into_iter().filter(|name| !headers.iter().any(|h| h == *name)).collect();
    let strange: Vec<&str> = headers
        .iter()
        .filter(|h| !REQUIRED.contains(h) && !EXTRA.contains(h) && !ZERO.contains(h) && *h != JOINT)
        .collect();
    let mut faults = Vec::new();
    let mut absent = Vec::new();
    for name in missing {
        match nearest(name, strange.iter().copied()) {
            Some(near) => {
                let cure = format!("rename `{near}` to `{name}`");
                faults.push(Problem::error(path, "the column is missing", cure).at_row(1).in_column(name));
            }
            None => absent.push(name),
        }
    }
    if !absent.is_empty() {
        let what = format!("lacks {}", absent.join(", "));
        faults.push(Problem::error(path, what, "name a trials.csv written by tautline").at_row(1));
    }
    Problems(faults).unless_errors(())
}

/// One row being read.
struct Row<'a> {
    path: &'a Path,
    headers: &'a StringRecord,
    record: &'a StringRecord,
    faults: &'a mut Vec<Problem>,
}

impl Row<'_> {
    /// The leg in this row; every field is read before the row is rejected, so that all faults are reported at once.
    fn leg(&mut self) -> Option<LegFit> {
        let file = self.field("file").map(|cell| cell_text(cell).to_string());
        let repeat = self.number("repeat", "a whole number", |_: &u32| true);
        let direction = self.direction();
        let speed_rad_s = self.number("speed_rad_s", "a positive number", |x: &f64| x.is_finite() && *x > 0.0);
        let samples = self.number("samples", "a whole number", |_: &usize| true);
        let a_nm = self.number("a_nm", "a finite number", |x: &f64| x.is_finite());
        let b_nm = self.number("b_nm", "a finite number", |x: &f64| x.is_finite());
        let mut known_or_nan = |name: &str| match self.field(name) {
            None | Some("") => Some(f64::NAN),
            Some(_) => self.number(name, "a number, or empty", |_: &f64| true),
        };
        let [r_squared, rmse_nm] = ["r_squared", "rmse_nm"].map(&mut known_or_nan);
        let [a_se_nm, b_se_nm, raw_rmse_nm, mean_sine, mean_torque_nm] = EXTRA.map(&mut known_or_nan);
        let [zero_rad, half_width_rad, a_by_zero_nm_rad, mean_slope, a_position_se_nm] =
            ZERO.map(|name| match self.field(name) {
                None | Some("") => Some(0.0),
                Some(_) => self.number(name, "a finite number", |x: &f64| x.is_finite()),
            });
        Some(LegFit {
            file: file?,
            repeat: repeat?,
            direction: direction?,
            speed_rad_s: speed_rad_s?,
            samples: samples?,
            a_nm: a_nm?,
            a_se_nm: a_se_nm?,
            b_nm: b_nm?,
            b_se_nm: b_se_nm?,
            r_squared: r_squared?,
            rmse_nm: rmse_nm?,
            raw_rmse_nm: raw_rmse_nm?,
            mean_sine: mean_sine?,
            mean_torque_nm: mean_torque_nm?,
            zero: LegZero {
                zero_rad: zero_rad?,
                half_width_rad: half_width_rad?,
                a_by_zero_nm_rad: a_by_zero_nm_rad?,
                mean_slope: mean_slope?,
                a_position_se_nm: a_position_se_nm?,
            },
        })
    }

    fn check_joint(&mut self, ours: &str) {
        let theirs = self.field(JOINT).map_or(ours, cell_text).to_string();
        if theirs != ours {
            let what = format!("is of the joint `{theirs}`, the campaign's is `{ours}`");
            self.fault(JOINT, what, "name the table that `fit trials` made of this campaign".to_string());
        }
    }

    fn check_trial(&mut self, leg: &LegFit, trials: &[TrialEntry]) {
        if trials.iter().all(|trial| trial.file != leg.file) {
            let cure = "name the table that `fit trials` made of this campaign".to_string();
            self.fault("file", "names no trial of the campaign".to_string(), cure);
        }
    }

    fn field(&self, name: &str) -> Option<&str> {
        self.headers.iter().position(|h| h == name).and_then(|at| self.record.get(at))
    }

    fn direction(&mut self) -> Option<Direction> {
        let text = self.field("direction").unwrap_or_default().to_string();
        let found = Direction::BOTH.into_iter().find(|direction| direction.name() == text);
        if found.is_none() {
            let names = Direction::BOTH.map(Direction::name);
            self.fault("direction", format!("`{text}` is no direction"), suggest(&text, "the directions are", names));
        }
        found
    }

    fn number<T: FromStr>(&mut self, name: &str, wanted: impl Display, accept: impl Fn(&T) -> bool) -> Option<T> {
        let text = self.field(name).unwrap_or_default().to_string();
        let found = text.parse().ok().filter(accept);
        if found.is_none() {
            self.fault(name, format!("`{text}` is not what belongs here"), format!("write {wanted}"));
        }
        found
    }

    fn fault(&mut self, column: &str, what: String, cure: String) {
        let row = self.record.position().map(|at| at.line());
        self.faults.push(Problem::error(self.path, what, cure).at_row(row).in_column(column));
    }
}
