//! Where the gap between model and recordings lies, which unmodelled effect causes it, and how far it shrinks once that is added.
//!
//! The floor first; then what does not repeat (contacts) is set aside; then every candidate is fitted along with the base inside
//! its confidence and judged on units that its fit never saw; then the verdict.

mod bursts;
mod candidates;
mod choose;
mod extent;
mod fit;
mod flexible;
mod floor;
mod gram;
mod interval;
mod locate;
mod motion;
mod moves;
mod next;
mod pairs;
mod parameters;
mod parts;
mod record;
mod ripple;
mod verdict;
mod weigh;

pub use candidates::Cause;
pub use floor::{Floor, FloorSource};
pub use interval::Shrink;
pub use locate::Place;
pub use motion::{Follows, MotionGap, MotionPlace, MotionTrial, beside};
pub use next::{BlindSpot, NextExperiment};
pub use parameters::Fitted;
pub use verdict::{Kind, Verdict, signature};

use crate::evaluate::fitted;
use crate::log::Campaign;
use crate::model::Model;
use crate::problem::Result;
use bursts::Burst;
use candidates::{Tried, score};
use choose::{Choice, choose};
use fit::{Bench, Ground};
use interval::{Draws, above};
use parts::Parts;
use record::Records;
use verdict::Evidence;

/// Bursts whose RMS over all rows is above this share of the floor are told as a cause.
const CONTACT_FLOORS: f64 = 0.5;

/// All that is found.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The model as delivered.
    pub before: Model,
    /// The model with the causes added, and its base where the fit left it within its confidence.
    pub after: Model,
    /// How large the gap is.
    pub gap: Gap,
    /// What the gap is made of.
    pub budget: Budget,
    /// Where it lies, most first.
    pub places: Vec<Place>,
    /// Every candidate, best first.
    pub candidates: Vec<Candidate>,
    /// The answer.
    pub verdict: Verdict,
    /// Stretches of contact.
    pub contacts: Vec<Contact>,
    /// Every trial, thinned.
    pub views: Vec<View>,
    /// What was held out in turn: "trials" or "motion cycles".
    pub held_out: &'static str,
    /// What separates the recordings in motion from a simulator's log of the same commands, where there is one.
    pub motion: Option<MotionGap>,
    /// What to distrust.
    pub warnings: Vec<String>,
    /// What to record next, if that would say more.
    pub next: Option<NextExperiment>,
    /// What the recordings cannot show at all.
    pub blind_spots: Vec<BlindSpot>,
}

/// The gap over all samples that are judged, low-passed, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// RMSE of the model as delivered.
    pub rmse_nm: f64,
    /// What no model could explain.
    pub floor: Floor,
    /// sqrt(rmse^2 - floor^2).
    pub explainable_nm: f64,
    /// What a flexible fit recovers on held-out units: the ceiling for any named cause.
    pub recoverable_nm: f64,
}

/// What the mean square of the residual is made of, (N m)^2; the parts add up to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The floor.
    pub floor: f64,
    /// What moving the base within its confidence explains.
    pub within_confidence: f64,
    /// What each cause explains.
    pub causes: Vec<(Cause, f64)>,
    /// What is left.
    pub unexplained: f64,
}

/// A cause that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    /// RMSE on held-out units with it (and the other causes found) added, N m.
    pub held_out_rmse_nm: f64,
    /// How far the gap shrinks.
    pub shrink: Shrink,
    /// What was fitted.
    pub parameters: Vec<Fitted>,
    /// Causes that do as well.
    pub trades_with: Vec<Cause>,
    /// Whether the verdict rests on it.
    pub taken: bool,
    /// Whether the fit settled; if not, a longer search might do better.
    pub settled: bool,
}

/// A stretch of contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The trial's log.
    pub file: String,
    /// From, s since the trial began.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
    /// Its largest torque, N m.
    pub peak_nm: f64,
}

/// One trial, thinned to a few rows per period of the low-pass.
#[derive(Debug, Clone)]
pub struct View {
    /// Its log.
    pub file: String,
    /// Since it began, s.
    pub time_s: Vec<f64>,
    /// rad.
    pub position_rad: Vec<f64>,
    /// rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// y, low-passed, N m.
    pub measured_nm: Vec<f64>,
    /// Predicted by the model as delivered, N m.
    pub before_nm: Vec<f64>,
    /// Predicted with the causes added, N m.
    pub after_nm: Vec<f64>,
    /// Whether the row is judged.
    pub judged: Vec<bool>,
    /// Whether the sensor clips there or beside it.
    pub clipped: Vec<bool>,
}

/// Looks for what separates `model` from the recordings of `campaign`; `progress` hears of each trial read and each round of
/// trying.
///
/// Errors: the model is of another joint; all that is wrong with any trial; nothing can be judged.
pub fn run(campaign: &Campaign, model: &Model, progress: &(dyn Fn() + Sync)) -> Result<Diagnosis> {
    let (model, mut warnings) = fitted(campaign, model)?;
    let records = Records::read(campaign, &model, progress)?;
    warnings.extend(records.all.iter().flat_map(|record| record.warnings.iter().cloned()));
    let parts = Parts::new(&records);
    let chatters = model.combination == crate::model::Combination::Sign;
    let judged = records.rows(|record, i| !(chatters && record.rests[i]));
    let mut bench = Bench {
        records: &records,
        measured_nm: records.measured_nm(),
        parts: &parts,
        extent: extent::of(&records, &model),
        unit_rows: parts.rows(&judged),
        used: judged.clone(),
        floor_nm: 0.0,
    };
    let ground = bench.ground(&model, moves::within_confidence(&model));
    let delivered_nm = bench.residual_nm(&ground.predicted_nm);
    bench.floor_nm = floor::floor(&records, &bench.rest_residual_nm(&ground)).rms_nm;
    let rest_nm = bench.rest_residual_nm(&ground);
    let lines = [false, true].map(|by_direction| ripple::starts(&bench, &ground, &rest_nm, by_direction));
    let columns = flexible::columns(&bench, &ground, &lines.concat());
    let (mut bursts, flexible) = bursts::find(&bench, &ground, &columns, &rest_nm);
    progress();
    let (choice, after, after_nm) = told_apart(&mut bench, &mut bursts, &judged, &model, &ground, &rest_nm, progress);
    let left_nm = bench.residual_nm(&after_nm);
    let unforeseen_square = flexible::fit(&bench, &columns, &left_nm, &bench.used).held_out;
    let left_square = choice.last.held_out.iter().sum::<f64>() / bench.rows().max(1) as f64;
    let floor = floor::settled(&records, &left_nm, unforeseen_square.min(left_square));
    let draws = Draws::new(&parts, &floor);
    let scene = Scene {
        bench: &bench,
        choice: &choice,
        ground: &ground,
        delivered_nm: &delivered_nm,
        left_nm: &left_nm,
        judged: &judged,
        bursts: &bursts,
    };
    let evidence = scene.evidence(&draws, &floor);
    let verdict = verdict::verdict(&bench, &choice, &evidence);
    let situation = next::Situation {
        bench: &bench,
        campaign,
        ground: &ground,
        found: &choice.found,
        verdict: &verdict,
        floor_nm: floor.rms_nm,
    };
    let (next, blind_spots) = situation.propose();
    let delivered = mean(&evidence.delivered, &evidence.rows);
    let floor_square = floor.upper_square();
    let gap = Gap {
        rmse_nm: delivered.sqrt(),
        floor,
        explainable_nm: above(delivered, floor.rms_nm * floor.rms_nm),
        recoverable_nm: above(delivered, flexible.held_out.min(mean(&evidence.last, &evidence.rows)).max(floor_square)),
    };
    Ok(Diagnosis {
        budget: scene.budget(&evidence),
        places: scene.places(&evidence, &verdict),
        candidates: scene.candidates(&evidence),
        contacts: scene.contacts(),
        views: scene.views(&after_nm),
        before: model.clone(),
        after: if verdict.kind == Kind::None { model } else { after },
        gap,
        verdict,
        held_out: parts.held_out,
        motion: None,
        warnings,
        next,
        blind_spots,
    })
}

/// Rows that are judged, but for those in a burst.
fn aside(judged: &[bool], bursts: &[Burst]) -> Vec<bool> {
    let mut used = judged.to_vec();
    bursts.iter().for_each(|burst| used[burst.rows.clone()].fill(false));
    used
}

/// The causes found with what is contact set aside, the model that they make, and what it predicts, N m; of `bursts` those stay that
/// no model foretells.
fn told_apart(
    bench: &mut Bench<'_>,
    bursts: &mut Vec<Burst>,
    judged: &[bool],
    model: &Model,
    ground: &Ground,
    rest_nm: &[f64],
    progress: &(dyn Fn() + Sync),
) -> (Choice, Model, Vec<f64>) {
    let mut is_second = false;
    loop {
        let found = without(bench, bursts, judged, model, ground, progress);
        let suspected = bursts.len();
        let left_nm = bench.residual_nm(&found.2);
        bursts::keep_unexplained(bench, bursts, rest_nm, &left_nm);
        if bursts.len() == suspected && !is_second && !bursts.is_empty() && found.0.found.is_empty() {
            // With all that is striking set aside nothing was left to find: perhaps it was no contact at all.
            let whole = without(bench, &[], judged, model, ground, progress);
            bursts::keep_unexplained(bench, bursts, rest_nm, &bench.residual_nm(&whole.2));
            if 2 * bursts.len() <= suspected {
                bursts.clear();
                return whole;
            }
            bench.count(aside(judged, bursts));
            return found;
        } else if bursts.len() == suspected || is_second {
            return found;
        }
        is_second = true;
    }
}

/// The causes found with `bursts` set aside, the model that they make, and what it predicts, N m.
fn without(
    bench: &mut Bench<'_>,
    bursts: &[Burst],
    judged: &[bool],
    model: &Model,
    ground: &Ground,
    progress: &(dyn Fn() + Sync),
) -> (Choice, Model, Vec<f64>) {
    bench.count(aside(judged, bursts));
    let choice = choose(bench, model, progress);
    let after = parameters::settled(&choice, ground);
    let records = bench.records;
    let after_nm = records.predicted_nm(&after, &records.passages(&after), &records.branches(&after));
    (choice, after, after_nm)
}

fn mean(squares: &[f64], rows: &[f64]) -> f64 {
    squares.iter().sum::<f64>() / rows.iter().sum::<f64>().max(1.0)
}

/// What the parts of a diagnosis are told from.
struct Scene<'s> {
    bench: &'s Bench<'s>,
    choice: &'s Choice,
    ground: &'s Ground,
    delivered_nm: &'s [f64],
    left_nm: &'s [f64],
    judged: &'s [bool],
    bursts: &'s [Burst],
}

impl Scene<'_> {
    /// Squares left in each unit, bursts put back.
    fn evidence<'e>(&self, draws: &'e Draws, floor: &Floor) -> Evidence<'e> {
        let floor_nm = floor.rms_nm;
        let of_units = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            self.bench.parts.units.iter().map(|unit| unit.clone().map(of).sum()).collect()
        };
        let counts = |i: usize| if self.judged[i] { 1.0 } else { 0.0 };
        let in_burst = |i: usize| if self.judged[i] && !self.bench.used[i] { 1.0 } else { 0.0 };
        let rows = of_units(&counts);
        let delivered = of_units(&|i| counts(i) * self.delivered_nm[i] * self.delivered_nm[i]);
        let rest_nm = self.bench.rest_residual_nm(self.ground);
        let of_bursts = of_units(&|i| in_burst(i) * rest_nm[i] * rest_nm[i]);
        let burst_rows = of_units(&in_burst);
        let whole = |squares: &[f64]| squares.iter().sum::<f64>();
        let excess = whole(&of_bursts) - whole(&burst_rows) * floor_nm * floor_nm;
        let much = excess > whole(&rows) * (CONTACT_FLOORS * floor_nm).powi(2);
        let contact = much && !bursts::ring(self.bursts, self.left_nm);
        let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<f64>>();
        let explained: Vec<f64> = burst_rows.iter().map(|n| n * floor_nm * floor_nm).collect();
        Evidence {
            rest: add(&self.choice.rest.held_out, &of_bursts),
            last: add(&self.choice.last.held_out, if contact { &explained } else { &of_bursts }),
            rows,
            delivered,
            contact,
            draws,
            floor_square: floor.upper_square(),
            quick_square: floor.quick_upper_square(),
            numbers: self.bench.numbers(&self.choice.last),
        }
    }

    fn budget(&self, evidence: &Evidence<'_>) -> Budget {
        let of = |squares: &[f64]| mean(squares, &evidence.rows);
        let (delivered, rest, last) = (of(&evidence.delivered), of(&evidence.rest), of(&evidence.last));
        let floor = evidence.floor_square.min(delivered);
        let mut weights: Vec<(Cause, f64)> = self
            .choice
            .found
            .iter()
            .map(|found| (found.cause, (found.without - score(self.bench, &self.choice.last)).max(0.0)))
            .collect();
        if evidence.contact {
            let masked = of(&self.choice.rest.held_out);
            weights.push((Cause::Effect("contact"), (rest - masked).max(0.0)));
        }
        let explained = (rest - last).max(0.0).min(delivered - floor);
        let whole: f64 = weights.iter().map(|(_, w)| w).sum::<f64>().max(f64::MIN_POSITIVE);
        let causes: Vec<(Cause, f64)> = weights.into_iter().map(|(cause, w)| (cause, explained * w / whole)).collect();
        let named: f64 = causes.iter().map(|(_, share)| share).sum();
        let unexplained = (last - floor).clamp(0.0, (delivered - floor - named).max(0.0));
        Budget { floor, within_confidence: (delivered - floor - named - unexplained).max(0.0), causes, unexplained }
    }

    /// Where the gap lies; a cause that was found stands in its own region with what it explains.
    fn places(&self, evidence: &Evidence<'_>, verdict: &Verdict) -> Vec<Place> {
        let mut places = locate::locate(self.bench, self.ground, self.delivered_nm, self.bursts);
        if !matches!(verdict.kind, Kind::None | Kind::Unknown) {
            let budget = self.budget(evidence);
            let whole: f64 = budget.causes.iter().map(|(_, share)| share).sum::<f64>()
                + budget.unexplained
                + budget.within_confidence;
            for (cause, share) in budget.causes {
                let how = self.choice.found.iter().find(|found| found.cause == cause).map_or("", |found| found.how);
                locate::credit(&mut places, signature(cause, how), share / whole.max(f64::MIN_POSITIVE), cause.name());
            }
        }
        places
    }

    fn candidates(&self, evidence: &Evidence<'_>) -> Vec<Candidate> {
        let mut all: Vec<Candidate> = Vec::new();
        let last = &self.choice.last;
        for found in &self.choice.found {
            let taken = Tried { cause: found.cause, how: found.how, fit: last.clone() };
            all.push(self.candidate(
                evidence,
                &taken,
                found.rivals.clone(),
                true,
                parameters::of_cause(self.bench, evidence.draws, last, (found.cause, found.how)),
            ));
        }
        let tried = self.choice.found.iter().flat_map(|found| &found.tried).chain(&self.choice.refused);
        let mut others: Vec<&Tried> = tried.collect();
        others.sort_by(|a, b| a.score(self.bench).total_cmp(&b.score(self.bench)));
        for tried in others {
            if all.iter().all(|known| known.cause != tried.cause) {
                let named = (tried.cause, tried.how);
                let parameters = parameters::of_cause(self.bench, evidence.draws, &tried.fit, named);
                all.push(self.candidate(evidence, tried, Vec::new(), false, parameters));
            }
        }
        all
    }

    fn candidate(
        &self,
        evidence: &Evidence<'_>,
        tried: &Tried,
        trades_with: Vec<Cause>,
        taken: bool,
        parameters: Vec<Fitted>,
    ) -> Candidate {
        let bursts = evidence.last.iter().zip(&self.choice.last.held_out).map(|(all, held_out)| all - held_out);
        let left: Vec<f64> = tried.fit.held_out.iter().zip(bursts).map(|(held_out, burst)| held_out + burst).collect();
        Candidate {
            cause: tried.cause,
            how: tried.how,
            held_out_rmse_nm: mean(&left, &evidence.rows).sqrt(),
            shrink: evidence.shrink(&left, self.bench.numbers(&tried.fit)),
            parameters,
            trades_with,
            taken,
            settled: tried.fit.converged,
        }
    }

    fn contacts(&self) -> Vec<Contact> {
        let contact = |burst: &Burst| {
            let (record, range) = (&self.bench.records.all[burst.record], &self.bench.records.ranges[burst.record]);
            let time_s = |row: usize| record.time_s[record.rows[row - range.start]];
            let last = burst.rows.end.max(burst.rows.start + 1) - 1;
            Contact {
                file: record.file.clone(),
                from_s: time_s(burst.rows.start),
                to_s: time_s(last),
                peak_nm: burst.peak_nm,
            }
        };
        self.bursts.iter().map(contact).collect()
    }

    fn views(&self, after_nm: &[f64]) -> Vec<View> {
        let view = |(record, range): (&record::Record, &std::ops::Range<usize>)| {
            let at = |of: &dyn Fn(usize) -> f64| record.rows.iter().map(|i| of(*i)).collect::<Vec<f64>>();
            View {
                file: record.file.clone(),
                time_s: at(&|i| record.time_s[i]),
                position_rad: at(&|i| record.own[i].position),
                velocity_rad_s: at(&|i| record.own[i].velocity),
                measured_nm: self.bench.measured_nm[range.clone()].to_vec(),
                before_nm: self.ground.predicted_nm[range.clone()].to_vec(),
                after_nm: after_nm[range.clone()].to_vec(),
                judged: self.judged[range.clone()].to_vec(),
                clipped: record.rows.iter().map(|i| record.clipped[*i]).collect(),
            }
        };
        self.bench.records.all.iter().zip(&self.bench.records.ranges).map(view).collect()
    }
}
