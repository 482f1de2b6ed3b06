//! `tautline simulate`.

mod arguments;
mod checks;
mod motor;

pub use arguments::Arguments;

use super::interrupt;
use super::outcome::Talk;
use super::progress;
use crate::effects::Added;
use crate::model::Model;
use crate::problem::{Problem, Problems, Result};
use crate::report::json_text;
use crate::simulate::{Controller, Plan, SimulatedArm};
use checks::{check_others, check_sweeps, check_trials};
use rayon::prelude::*;
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

/// The name of the URDF in the campaign.
const URDF: &str = "arm.urdf";

impl Arguments {
    /// Errors: every effect that cannot be had so.
    fn effects(&self) -> Result<Vec<Added>> {
        let (mut effects, mut problems) = (Vec::new(), Vec::new());
        for text in &self.effect {
            match Added::parse(text) {
                Ok(effect) => effects.push(effect),
                Err(Problems(found)) => problems.extend(found),
            }
        }
        Problems(problems).unless_errors(effects)
    }

    /// Errors: no such joint, one of another kind, or one that moves alone.
    fn arm(&self, model: &Model) -> Result<Option<SimulatedArm>> {
        let Some(chain) = self.of_arm.chain(model, &self.model)? else { return Ok(None) };
        if self.multi_joint > 0 && chain.others().next().is_none() {
            let what = format!("--multi-joint is {}, and the joint moves alone", self.multi_joint);
            return Problem::error("command line", what, "leave it out").alone();
        }
        Ok(Some(SimulatedArm { urdf: URDF.to_string(), chain, multi_joint: self.multi_joint }))
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let known = Model::read(&arguments.model)?;
    let mut model = known.clone();
    model.effects.extend(arguments.effects()?);
    let arm = arguments.arm(&model)?;
    let chain = arm.as_ref().map(|arm| &arm.chain);
    let wanted = arguments.motor.wanted()?;
    let controller = wanted.map(|wanted| Controller::new(wanted, &model, &known, chain)).transpose()?;
    let plan = Plan { arm, controller, ..arguments.plan()? };
    check_sweeps(&plan, &model.joint)?;
    let trials = plan.trials(model.joint.kind);
    check_trials(&trials, model.joint.kind)?;
    check_others(&plan, &model)?;
    let output = interrupt::output(&arguments.output, arguments.force, "simulate")?;
    let bar = progress::bar(talk, "simulating", trials.len());
    trials.par_iter().try_for_each(|trial| {
        output.write(&trial.entry.file, &plan.log_bytes(&model, trial)?)?;
        bar.inc(1);
        Ok::<(), Problems>(())
    })?;
    bar.finish_and_clear();
    if let Some(urdf) = &arguments.of_arm.urdf {
        let text = std::fs::read(urdf).or_else(|e| Problem::error(urdf, format!("cannot be read: {e}"), "").alone())?;
        output.copy(URDF, &text)?;
    }
    output.write("campaign.toml", plan.campaign(&model, &arguments.output, &trials).to_toml().as_bytes())?;
    let mark = json!({
        "tautline": env!("CARGO_PKG_VERSION"),
        "seed": plan.seed,
        "model": model.to_json(),
        "controller": plan.controller.as_ref().map(Controller::to_json),
    });
    output.write("simulated.json", json_text(&mark))?;
    let (folder, name, count) = (arguments.output.display(), &model.joint.name, trials.len());
    talk.finish(
        output,
        || json!({ "campaign": arguments.output, "trials": count, "seed": plan.seed }),
        |out| writeln!(out, "{folder}: {count} trials of {name}, seed {}", plan.seed),
    )?;
    Ok(ExitCode::SUCCESS)
}
