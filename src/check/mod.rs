//! A campaign against a stored baseline: whether code or data changed what comes out, and whether that matters.
//!
//! A baseline holds a `Snapshot` of a campaign: what is declared, a digest of every log, what the identification found, and
//! how well the model that it found predicts every trial. Checking takes the same snapshot again, judging the model that the
//! *baseline* holds, and holds one against the other:
//!
//! - On the same data, bit for bit, a figure may move by another machine's arithmetic alone, for better or worse: whatever
//!   else moves it is a change of code.
//! - Where data differ, be it by rounding alone (`sketch` tells), a figure may move within its confidence, that of a difference
//!   between two recordings, and errors may shrink. New data alone are no regression, but told. Rounding needs as much: a
//!   sample that passes a threshold by it is one more or less in a leg, and moves its figures by a thousandth.
//! - Regressed in any case: a setting or a trial's declaration that differs, a trial lost or added, one that holds another's
//!   data, another curve or form, and an identification that refuses what it could use.

mod figures;
mod file;
mod finding;
mod judge;
mod marks;
pub mod sketch;

pub use figures::Figure;
pub use finding::{Finding, Held, Outcome, Part};
pub use judge::{Checked, judge};
pub use marks::TrialMark;

use crate::evaluate;
use crate::identify;
use crate::log::Campaign;
use crate::model::Model;
use crate::problem::{Problem, Problems, Result};
use std::collections::BTreeMap;

/// How a baseline's figures come about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recipe {
    /// The campaign is identified, and its model judged.
    Identify(identify::Settings),
    /// A model that was given is judged.
    Judge,
}

/// What a baseline holds.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// Version of the program that stored it.
    pub tautline: String,
    /// What the campaign was called.
    pub campaign: String,
    /// How its figures come about.
    pub recipe: Recipe,
    /// The model that is judged.
    pub model: Model,
    /// Everything that is compared.
    pub snapshot: Snapshot,
}

/// A campaign and what comes of it.
#[derive(Debug, Clone, Default)]
pub struct Snapshot {
    /// What `campaign.toml` declares beyond its trials, by dotted name.
    pub settings: BTreeMap<String, String>,
    /// The trials.
    pub trials: Vec<TrialMark>,
    /// What was chosen: the curve, the forms.
    pub choices: BTreeMap<String, String>,
    /// The figures.
    pub figures: Vec<Figure>,
    /// Why a stage refused to work on logs that can be read, by the stage's name.
    pub refused: BTreeMap<String, String>,
}

impl Baseline {
    /// Of `campaign`, called `name`; judges `model`, or the one that is identified.
    ///
    /// Errors: whatever keeps the campaign from being read, identified or judged.
    pub fn record(campaign: &Campaign, name: &str, recipe: Recipe, model: Option<&Model>) -> Result<Self> {
        let mut snapshot =
            Snapshot { settings: settings(campaign), trials: marks::read(campaign)?, ..Snapshot::default() };
        let identified = match recipe {
            Recipe::Identify(settings) => Some(snapshot.identify(campaign, settings)?),
            Recipe::Judge => None,
        };
        let Some(model) = model.cloned().or(identified) else {
            return Problem::error("command line", "there is no model to judge", "name one with --model").alone();
        };
        snapshot.evaluate(campaign, &model)?;
        let tautline = env!("CARGO_PKG_VERSION").to_string();
        Ok(Self { tautline, campaign: name.to_string(), recipe, model, snapshot })
    }

    /// Holds `campaign` against the baseline.
    ///
    /// Errors: its logs cannot be read; none of them is the baseline's, neither by name nor by what it holds. What only the stages
    /// after reading refuse is a finding: the baseline's they could use.
    pub fn check(&self, campaign: &Campaign) -> Result<Checked> {
        let mut now = Snapshot { settings: settings(campaign), trials: marks::read(campaign)?, ..Snapshot::default() };
        let is_known =
            |new: &TrialMark| self.snapshot.trials.iter().any(|old| old.file == new.file || old.holds_same(new));
        if !now.trials.iter().any(is_known) {
            let what = format!("the baseline is of another campaign, {}: they share no trial", self.campaign);
            let cure = "name this campaign's own baseline; --update stores one to a file that is not there yet";
            return Problem::error(&campaign.file, what, cure).alone();
        }
        if let Recipe::Identify(settings) = self.recipe
            && let Err(problems) = now.identify(campaign, settings)
        {
            now.refuse("identification", &problems);
        }
        if let Err(problems) = now.evaluate(campaign, &self.model) {
            now.refuse("evaluation", &problems);
        }
        Ok(judge(&self.snapshot, &now))
    }
}

impl Snapshot {
    fn identify(&mut self, campaign: &Campaign, settings: identify::Settings) -> Result<Model> {
        let found = identify::run(campaign, settings, &|| ())?;
        self.choices.extend(figures::choices(&found));
        self.figures.extend(figures::of_identification(&found, &self.trials, campaign.signal.lowpass_hz));
        Ok(found.model)
    }

    fn evaluate(&mut self, campaign: &Campaign, model: &Model) -> Result<()> {
        let settings = evaluate::Settings { sweeps: true, recorded_curves: Vec::new() };
        let found = evaluate::run(campaign, model, &settings, &|| ())?;
        self.figures.extend(figures::of_evaluation(&found, &self.trials));
        Ok(())
    }

    fn refuse(&mut self, stage: &str, Problems(problems): &Problems) {
        let why: Vec<String> = problems.iter().map(Problem::to_string).collect();
        self.refused.insert(stage.to_string(), why.join("\n"));
    }
}

/// What `campaign` declares of the joint and its signals. Names and units of columns are not among it: what they make of the
/// logs is in the digests; so is `torque_sign`.
fn settings(campaign: &Campaign) -> BTreeMap<String, String> {
    let (joint, signal) = (&campaign.joint, &campaign.signal);
    let mut all = vec![
        ("joint.name", joint.name.clone()),
        ("joint.kind", joint.kind.name().to_string()),
        ("joint.winch_radius_m", joint.winch_radius_m.to_string()),
        ("joint.pulley_radius_m", joint.pulley_radius_m.to_string()),
        ("joint.backlash_m", joint.backlash_m.to_string()),
        ("signal.lowpass_hz", signal.lowpass_hz.to_string()),
        ("signal.lowpass_order", signal.lowpass_order.to_string()),
    ];
    match &campaign.arm {
        Some(arm) => {
            let held: Vec<String> = arm.held_rad.iter().map(|(name, at)| format!("{name} = {at}")).collect();
            all.push(("dynamics.urdf", arm.urdf.clone()));
            all.push(("dynamics.joint", arm.name().joint));
            all.push(("dynamics.held_rad", held.join(", ")));
        }
        None => {
            all.push(("dynamics.gravity_nm", campaign.dynamics.gravity_nm.to_string()));
            all.push(("dynamics.inertia_kg_m2", campaign.dynamics.inertia_kg_m2.to_string()));
        }
    }
    all.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
}
