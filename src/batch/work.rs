//! One campaign: identify, evaluate, diagnose. Whatever is wrong with it is its result.

use super::manifest::Entry;
use super::record::{Diagnosed, FORMAT, Record};
use crate::identify::{self, FrictionFit, Identification};
use crate::log::{Campaign, Protocol};
use crate::model::{Model, Term};
use crate::numerics::dual::Dual;
use crate::numerics::statistics::HALF_WIDTH;
use crate::prepare::read_campaign;
use crate::problem::{Problem, Problems, Result};
use crate::{diagnose, evaluate};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// What a campaign is diagnosed against that is its joint's reference itself.
const ITSELF: &str = "itself";

/// What is done with each campaign.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// How it is identified.
    pub identify: identify::Settings,
    /// Whether it is diagnosed too.
    pub diagnose: bool,
}

/// The result of `entry`, which depends on `inputs`.
pub fn record(entry: &Entry, settings: &Settings, inputs: String) -> Record {
    let begun = Instant::now();
    let blank = Record {
        format: FORMAT.to_string(),
        name: entry.name.clone(),
        inputs,
        tautline: env!("CARGO_PKG_VERSION").to_string(),
        ..Record::default()
    };
    // A fault of this program must not take the other campaigns along.
    let found = catch_unwind(AssertUnwindSafe(|| work(entry, settings, blank.clone()))).unwrap_or_else(|_| {
        Problem::error(&entry.path, "a fault of tautline's own ended its work", "report it with the campaign").alone()
    });
    let record = found.unwrap_or_else(|problems| Record { failure: Some(reason(&problems)), ..blank });
    Record { duration_s: begun.elapsed().as_secs_f64(), ..record }
}

/// The first problem, and how many more there are.
fn reason(Problems(problems): &Problems) -> String {
    let first = problems.first().map(Problem::to_string).unwrap_or_default();
    match problems.len() {
        0 | 1 => first,
        n => format!("{first} (and {} more: `tautline validate` lists them)", n - 1),
    }
}

fn work(entry: &Entry, settings: &Settings, mut record: Record) -> Result<Record> {
    let campaign = read_campaign(&entry.path)?;
    let given = entry.model.as_deref().map(Model::read).transpose()?;
    let found = identify::run(&campaign, settings.identify, &|| ())?;
    record.route = if found.route.sweeps().is_some() { "sweeps" } else { "free" }.to_string();
    (record.trials, record.rows) = (found.trials, found.rows);
    identified(&found, &mut record.figures);
    record.warnings.extend(found.warnings.iter().cloned());
    record.model = Some(found.model.to_json());
    let model = given.unwrap_or(found.model);
    judged(&timed(&campaign, &model)?, &model, &mut record)?;
    if settings.diagnose {
        // A fault of another campaign, or a model that does not suit this one, takes nothing from what was identified.
        let not_diagnosed = match reference(entry, &model, settings) {
            Err(problems) => Some(format!("its reference: {}", reason(&problems))),
            Ok((model, against)) => {
                let of = format!("against {against}");
                let done = timed(&campaign, &model).and_then(|timed| diagnosed(&timed, &model, against, &mut record));
                done.err().map(|problems| format!("{of}: {}", reason(&problems)))
            }
        };
        record.warnings.extend(not_diagnosed.map(|why| format!("not diagnosed: {why}")));
    }
    if let Some((name, _)) = record.figures.iter().find(|(name, figure)| figure.is_infinite() && !may_be_open(name)) {
        let what = format!("`{name}` is not a number, because of a numerical overflow");
        return Problem::error(&entry.path, what, "`tautline validate` checks the data").alone();
    }
    // What is not known, and intervals without an end.
    record.figures.retain(|_, figure| figure.is_finite());
    Ok(record)
}

/// `campaign` with the clock that effects of `model` may need.
fn timed(campaign: &Campaign, model: &Model) -> Result<Campaign> {
    if model.needs_clock() { campaign.clone().with_clock() } else { Ok(campaign.clone()) }
}

/// The model that `entry` is diagnosed against, and whose it is; `own` is the one that it is judged by.
fn reference(entry: &Entry, own: &Model, settings: &Settings) -> Result<(Model, String)> {
    match (&entry.model, &entry.against) {
        (None, Some(reference)) => {
            let campaign = read_campaign(&reference.path)?;
            Ok((identify::run(&campaign, settings.identify, &|| ())?.model, reference.name.clone()))
        }
        (Some(file), _) => Ok((own.clone(), file.display().to_string())),
        (None, None) => Ok((own.clone(), ITSELF.to_string())),
    }
}

/// Whether the figure called `name` is a width or an end that the data may leave open.
fn may_be_open(name: &str) -> bool {
    ["half_width", "low", "high", "interval"].iter().any(|part| name.contains(part))
}

fn put<const N: usize>(figures: &mut BTreeMap<String, f64>, pairs: [(&str, f64); N]) {
    figures.extend(pairs.map(|(name, figure)| (name.to_string(), figure)));
}

/// A and, at one speed, B(v), each with the half width of its 95 % interval.
fn identified(found: &Identification, figures: &mut BTreeMap<String, f64>) {
    let Some(fits) = found.route.sweeps() else { return };
    let (slowest, fastest) = fits.up.points.speed_range_rad_s();
    let speed_rad_s = (slowest * fastest).sqrt();
    put(figures, [("level_speed_rad_s", speed_rad_s)]);
    for fit in [&fits.up, &fits.down] {
        let direction = fit.direction.name();
        put(
            figures,
            [
                (&format!("a_{direction}_nm"), fit.a.a_nm),
                (&format!("a_{direction}_half_width_nm"), fit.a.half_width_nm),
                (&format!("level_{direction}_nm"), found.model.b_nm(fit.direction, speed_rad_s)),
                (&format!("level_{direction}_half_width_nm"), half_width_nm(&found.model, fit, speed_rad_s)),
            ],
        );
    }
}

/// Of B(v) at `speed_rad_s`, N m, to first order: the variance g' C g with g the slopes of B by the parameters and C their
/// covariance. Parameters known only together still give a B(v) that is known well. NaN without a covariance.
fn half_width_nm(model: &Model, fit: &FrictionFit, speed_rad_s: f64) -> f64 {
    let Ok(covariance) = &fit.covariance else { return f64::NAN };
    let slope = |term: &Term| {
        let mut moving = model.over::<Dual>();
        moving.friction.of_mut(fit.direction)[*term] = Dual::variable(fit.friction[*term], 0);
        moving.b_nm(fit.direction, speed_rad_s).slopes[0]
    };
    let slopes: Vec<f64> = covariance.parameters.iter().map(slope).collect();
    let n = slopes.len();
    let variance: f64 = (0..n * n).map(|k| slopes[k / n] * covariance.matrix[(k / n, k % n)] * slopes[k % n]).sum();
    HALF_WIDTH * variance.max(0.0).sqrt()
}

/// How well `model` predicts the cosine and free trials, if there are any.
fn judged(campaign: &Campaign, model: &Model, record: &mut Record) -> Result<()> {
    if !campaign.trials.iter().any(|trial| matches!(trial.protocol, Protocol::Cosine | Protocol::Free)) {
        record.warnings.push("not evaluated: there is no cosine or free trial".to_string());
        return Ok(());
    }
    let found = evaluate::run(campaign, model, &evaluate::Settings::default(), &|| ())?;
    let (low_passed, raw) = (found.overall(), found.together(|trial| &trial.raw));
    put(
        &mut record.figures,
        [
            ("rmse_nm", low_passed.all.rmse_nm),
            ("mae_nm", low_passed.all.mae_nm),
            ("peak_nm", low_passed.all.peak_nm),
            ("rmse_percent", low_passed.all.rmse_percent),
            ("stable_rmse_nm", low_passed.stable.rmse_nm),
            ("transition_rmse_nm", low_passed.transition.rmse_nm),
            ("raw_rmse_nm", raw.all.rmse_nm),
        ],
    );
    record.warnings.extend(found.warnings);
    Ok(())
}

fn diagnosed(campaign: &Campaign, model: &Model, against: String, record: &mut Record) -> Result<()> {
    let found = diagnose::run(campaign, model, &|_| ())?;
    let verdict = &found.verdict;
    put(
        &mut record.figures,
        [
            ("gap_nm", found.gap.explainable_nm),
            ("noise_floor_nm", found.gap.floor.rms_nm),
            ("gap_after_nm", verdict.gap_after_nm),
            ("shrink", verdict.shrink.value),
            ("verdict_confidence", verdict.confidence),
        ],
    );
    let is_its_own = against == ITSELF;
    let effects = verdict.effects.iter().map(|cause| cause.name().to_string()).collect();
    record.diagnosis = Some(Diagnosed { verdict: verdict.kind.name().to_string(), effects, against });
    if is_its_own {
        record.warnings.push(
            "diagnosed against the model identified from the same recordings: what that model has absorbed does not show"
                .to_string(),
        );
    }
    record.warnings.extend(found.warnings.iter().cloned());
    Ok(())
}
