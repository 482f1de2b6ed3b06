//! A campaign thinned to the bandwidth of its low-pass, and any model's prediction of it: the form in which hundreds of models are compared
//! with the same recordings.

use super::encoder;
use super::progress::{Listener, Progress};
use super::record::Record;
use crate::dynamics::Both;
use crate::effects::Added;
use crate::log::{Campaign, Fingerprint, clock_s, is_one_recording, read_trial, refuse_copies, span_s};
use crate::model::Model;
use crate::numerics::dual::{Dual, VARIABLES};
use crate::prepare::prepare;
use crate::problem::{Problem, Problems, Result};
use rayon::prelude::*;
use std::ops::Range;

/// Where friction stands at each thinned sample of each record.
pub type Passages = Vec<Vec<f64>>;

/// The unloaded friction of both branches at each thinned sample of each record, N m.
pub type Branches = Vec<Vec<Both<f64>>>;

/// All records, and how their rows lie one after the other.
#[derive(Debug)]
pub struct Records {
    /// The trials, in the campaign's order.
    pub all: Vec<Record>,
    /// The rows of each record in the series over all.
    pub ranges: Vec<Range<usize>>,
    /// Compared samples per independent one: a low-pass at f leaves 2 f a second.
    pub rows_per_independent: f64,
    /// Cut-off of the low-pass, Hz.
    pub lowpass_hz: f64,
    /// Whether the trials are pieces of one recording, cut.
    pub one_recording: bool,
}

/// A trial without its encoder, and as the encoder would have read it once more.
type Beside = (Record, Record);

/// A trial as it was read, when it began and ended (s), its place in the list and its content.
type Read = (Record, Option<Beside>, (f64, f64), (usize, Fingerprint));

impl Records {
    /// Reads and thins the trials of `campaign` that a model without a person can be judged on; `listener` hears of each. Beside them the
    /// same trials without their encoder, and as it would have read them once more; nothing where one of those cannot be prepared.
    ///
    /// Errors: all that is wrong with any trial; no sample is left to judge.
    pub fn read(campaign: &Campaign, model: &Model, listener: Listener<'_>) -> Result<(Self, Option<(Self, Self)>)> {
        listener(Progress::Ahead(campaign.trials.len()));
        let one = |index: usize| {
            let mut trial = read_trial(campaign, index).and_then(|log| prepare(campaign, index, log))?;
            let span = span_s(&trial.log);
            listener(Progress::Done(&campaign.trials[index].file));
            let print = std::mem::take(&mut trial.log.fingerprint);
            let record = Record::new(campaign, model, &trial)?;
            let moved = |position_rad| record.moved(campaign, model, &trial, position_rad);
            let [smooth_rad, again_rad] = encoder::motions_rad(campaign, &trial);
            let beside = moved(smooth_rad).zip(moved(again_rad));
            Ok((record, beside, span, (index, print)))
        };
        let (mut all, mut beside, mut problems) = (Vec::new(), Vec::new(), Vec::new());
        let (mut spans, mut prints) = (Vec::new(), Vec::new());
        let found: Vec<Result<Read>> = (0..campaign.trials.len()).into_par_iter().with_max_len(1).map(one).collect();
        for result in found {
            match result {
                Ok((record, read_beside, span, print)) => {
                    all.push(record);
                    beside.push(read_beside);
                    spans.push(span);
                    prints.push(print);
                }
                Err(Problems(found)) => problems.extend(found),
            }
        }
        if !problems.is_empty() {
            return Err(Problems(problems));
        }
        refuse_copies(campaign, &prints)?;
        let beside: Option<Vec<Beside>> = beside.into_iter().collect();
        let (mut smooth, mut again): (Vec<Record>, Vec<Record>) = beside.unwrap_or_default().into_iter().unzip();
        for records in [&mut all, &mut smooth, &mut again] {
            records.iter_mut().zip(clock_s(&spans)).for_each(|(record, began_s)| record.began_s = began_s);
        }
        let mut at = 0;
        let mut range = |record: &Record| {
            let range = at..at + record.rows.len();
            at = range.end;
            range
        };
        let ranges: Vec<Range<usize>> = all.iter().map(&mut range).collect();
        if at == 0 {
            let what = "no sample can be judged: the joint never moves through its clearance";
            return Problem::error(&campaign.file, what, "record motion in both directions").alone();
        }
        let lowpass_hz = campaign.signal.lowpass_hz;
        let row_s = |r: &Record| r.rows.get(1).map_or(0.0, |next| (next - r.rows[0]) as f64 / r.rate_hz);
        let rows_per_independent = (1.0 / (2.0 * lowpass_hz * row_s(&all[0]).max(1e-9))).max(1.0);
        let one_recording = is_one_recording(&spans);
        let of =
            |all: Vec<Record>| Self { all, ranges: ranges.clone(), rows_per_independent, lowpass_hz, one_recording };
        let beside = (!again.is_empty()).then(|| (of(smooth), of(again)));
        Ok((Self { all, ranges, rows_per_independent, lowpass_hz, one_recording }, beside))
    }

    /// What `of` says of each row: of the record and the thinned sample.
    pub fn rows<T: Send>(&self, of: impl Fn(&Record, usize) -> T + Sync) -> Vec<T> {
        self.all.iter().flat_map(|record| record.rows.iter().map(|i| of(record, *i)).collect::<Vec<T>>()).collect()
    }

    /// The speed at the rows, rad/s.
    pub fn speeds_rad_s(&self) -> Vec<f64> {
        self.rows(|record, i| record.own[i].velocity.abs())
    }

    /// Measured y at the rows, low-passed, N m.
    pub fn measured_nm(&self) -> Vec<f64> {
        self.rows(|record, i| record.torque_nm[i])
    }

    /// Where friction stands along every record under `model`.
    pub fn passages(&self, model: &Model) -> Passages {
        self.all.par_iter().with_max_len(1).map(|record| record.passage(model)).collect()
    }

    /// The unloaded friction of both branches along every record.
    pub fn branches(&self, model: &Model) -> Branches {
        self.all.par_iter().with_max_len(1).map(|record| record.branches(model)).collect()
    }

    /// Predicted y at the rows, low-passed, N m.
    pub fn predicted_nm(&self, model: &Model, passages: &Passages, branches: &Branches) -> Vec<f64> {
        let one = |((record, k_tilde), branches): ((&Record, &Vec<f64>), &Vec<Both<f64>>)| {
            record.predicted_nm(model, k_tilde, branches)
        };
        let all = self.all.par_iter().zip(passages).zip(branches).with_max_len(1);
        all.map(one).collect::<Vec<Vec<f64>>>().concat()
    }

    /// What `model` predicts at the rows, N m.
    pub fn predicted_by(&self, model: &Model) -> Vec<f64> {
        self.predicted_nm(model, &self.passages(model), &self.branches(model))
    }

    /// How y at the rows, low-passed, changes with each variable of `varied`, N m per unit. Where none of them has a part in K~ or in the
    /// branches, those are given.
    pub fn slopes_nm(
        &self,
        varied: &Model<Dual>,
        passages: Option<&Passages>,
        branches: Option<&Branches>,
    ) -> [Vec<f64>; VARIABLES] {
        self.side_by_side(|at, record| {
            let k_tilde = passages.map(|passages| &passages[at][..]);
            record.slopes_nm(varied, k_tilde, branches.map(|branches| &branches[at][..]))
        })
    }

    /// What each of some strengths of an effect that only adds torque adds to y per unit at the rows, low-passed, N m: the
    /// slopes of `added`.
    pub fn added_nm(
        &self,
        model: &Model,
        added: &Added<Dual>,
        passages: &Passages,
        branches: &Branches,
    ) -> [Vec<f64>; VARIABLES] {
        self.side_by_side(|at, record| record.added_nm(model, added, &passages[at], &branches[at]))
    }

    /// The columns that `of` makes of each record, one record after the other.
    fn side_by_side(&self, of: impl Fn(usize, &Record) -> [Vec<f64>; VARIABLES] + Sync) -> [Vec<f64>; VARIABLES] {
        let all = self.all.par_iter().enumerate().with_max_len(1);
        let all: Vec<[Vec<f64>; VARIABLES]> = all.map(|(at, record)| of(at, record)).collect();
        std::array::from_fn(|at| all.iter().flat_map(|columns| columns[at].iter().copied()).collect())
    }

    /// A signal given at every thinned sample, low-passed like the torque, at the rows. `of` receives the record's place in the list, the
    /// record, and the sample.
    pub fn low_passed(&self, of: impl Fn(usize, &Record, usize) -> f64 + Sync) -> Vec<f64> {
        let one = |(at, record): (usize, &Record)| {
            let signal: Vec<f64> = (0..record.own.len()).map(|i| of(at, record, i)).collect();
            record.at_rows(&record.lowpass.zero_phase(&signal))
        };
        self.all.par_iter().enumerate().with_max_len(1).map(one).collect::<Vec<Vec<f64>>>().concat()
    }

    /// How many other joints are recorded.
    pub fn others(&self) -> usize {
        self.all.iter().map(|record| record.joints).max().unwrap_or(0)
    }
}
