//! Samples of a stream of CSV, one at a time: a log that is still being recorded.

use super::campaign::Campaign;
use super::columns::Wanted;
use super::controller::{Controller, Damped};
use super::csv_file::{name, no_number, number, ragged};
use super::readings::{Faults, check_width, locate};
use super::source::{self, Source};
use super::stamp;
use super::{POSITION, TIME, TORQUE};
use crate::numerics::causal::Lag;
use crate::problem::{Problem, Problems, Result};
use crate::units::Quantity;
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::io::Read;
use std::path::Path;

/// What messages call the stream.
const STREAM: &str = "standard input";

/// One sample, in SI; for a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// Position, rad.
    pub position_rad: f64,
    /// y: the recorded torque times `torque_sign`, N m.
    pub torque_nm: f64,
    /// Measured load at the joint, N m; 0 where none is recorded.
    pub load_nm: f64,
    /// Positions of coupled joints, in the order of their columns, rad or m.
    pub others: Vec<f64>,
}

/// Reads samples from a stream in the columns and units of a campaign.
pub struct Samples<R> {
    reader: Reader<Source<R>>,
    record: ByteRecord,
    wanted: Vec<Wanted>,
    places: Vec<usize>,
    fields: usize,
    decimal: u8,
    torque_sign: f64,
    transmission: f64,
    last: Option<Last>,
    /// The velocity as a controller has it.
    filter: Lag,
}

/// What the sample before was.
#[derive(Clone, Copy)]
struct Last {
    time_s: f64,
    position_rad: f64,
    command_rad: f64,
}

impl<R: Read> Samples<R> {
    /// Reads the header. Errors: it is missing, or lacks a column.
    pub fn new(campaign: &Campaign, stream: R) -> Result<Self> {
        let file = Path::new(STREAM);
        // What a stream's first rows look like is known too late: it is as the campaign says, or plain.
        let (delimiter, decimal) = (campaign.files.delimiter.unwrap_or(b','), campaign.files.decimal.unwrap_or(b'.'));
        let mut builder = ReaderBuilder::new();
        let builder = builder.has_headers(false).flexible(true).delimiter(delimiter);
        let mut reader = builder.from_reader(Source::new(stream));
        let mut record = ByteRecord::new();
        if !next(&mut reader, &mut record)? {
            return Problem::error(file, "is empty", "begin with a header of the columns' names").alone();
        }
        check_width(file, record.len())?;
        let names: Vec<String> = record.iter().map(name).collect();
        let needed =
            [Quantity::Time, Quantity::Position, Quantity::Torque, Quantity::LoadTorque, Quantity::OtherPosition];
        let wanted: Vec<Wanted> =
            campaign.columns.wanted().into_iter().filter(|want| needed.contains(&want.quantity)).collect();
        let mut faults = Faults::of(file);
        let places: Option<Vec<usize>> = locate(&names, &wanted, &mut faults).into_iter().collect();
        let places = places.ok_or_else(|| Problems(faults.into_problems()))?;
        let (fields, torque_sign, transmission) =
            (names.len(), campaign.signal.torque_sign, campaign.joint.transmission());
        let (last, filter) = (None, Lag::new(0.0));
        Ok(Self { reader, record, wanted, places, fields, decimal, torque_sign, transmission, last, filter })
    }

    fn sample(&mut self) -> Result<Sample> {
        let (file, row) = (Path::new(STREAM), self.record.position().map(csv::Position::line));
        if self.record.len() != self.fields {
            return ragged(file, &self.record, self.fields).at_row(row).alone();
        }
        let mut sample = Sample::default();
        for (at, (place, want)) in self.places.iter().zip(&self.wanted).enumerate() {
            let field = &self.record[*place];
            let number = number(field, self.decimal).or_else(|| stamp::reading(field, want));
            let Some(value) = number.map(|number| want.to_si(number)) else {
                return no_number(file, field, want).at_row(row).alone();
            };
            match at {
                TIME => sample.time_s = value,
                POSITION => sample.position_rad = value,
                TORQUE => sample.torque_nm = self.torque_sign * value,
                _ if want.quantity == Quantity::LoadTorque => sample.load_nm = value,
                _ => sample.others.push(value),
            }
        }
        if let Some(last) = self.last.filter(|last| sample.time_s <= last.time_s) {
            let what = format!("time goes from {} s to {} s", last.time_s, sample.time_s);
            let time = &self.wanted[TIME].column.name;
            return Problem::error(file, what, "send samples in the order of their time")
                .at_row(row)
                .in_column(time)
                .alone();
        }
        let command_rad = self.torque_sign * sample.torque_nm;
        if let Some(controller) = self.wanted[TORQUE].controller().copied() {
            sample.torque_nm = self.driven_nm(&controller, &sample, command_rad);
        }
        self.last = Some(Last { time_s: sample.time_s, position_rad: sample.position_rad, command_rad });
        Ok(sample)
    }

    /// y from `controller` and `command_rad`; velocities are backward differences.
    fn driven_nm(&mut self, controller: &Controller, sample: &Sample, command_rad: f64) -> f64 {
        let position_rad = sample.position_rad;
        let damped_rad_s = self.last.map_or(0.0, |last| {
            let of_command = if controller.damped == Damped::Error { command_rad - last.command_rad } else { 0.0 };
            let passed_s = sample.time_s - last.time_s;
            self.filter = self.filter.lasting(controller.speed_filter_s / passed_s);
            self.filter.step((position_rad - last.position_rad - of_command) / passed_s)
        });
        controller.torque_nm(self.transmission, command_rad - position_rad, damped_rad_s)
    }
}

impl<R: Read> Iterator for Samples<R> {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
        match next(&mut self.reader, &mut self.record) {
            Ok(true) => Some(self.sample()),
            Ok(false) => None,
            Err(problems) => Some(Err(problems)),
        }
    }
}

fn next<R: Read>(reader: &mut Reader<Source<R>>, record: &mut ByteRecord) -> Result<bool> {
    // Where the last record began, and one for itself.
    let row = record.position().map_or(1, |last| last.line() + 1);
    let is_there = reader.read_byte_record(record);
    reader.get_ref().row_ends();
    is_there.or_else(|error| source::problem(Path::new(STREAM), &error, row).alone())
}
