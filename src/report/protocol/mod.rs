//! The page of an identification: the verdict, B(v), what to do next; below, the steps of the protocol.

mod tables;

use super::chart::Figure;
use super::identification::parameter;
use super::number::{as_precise_as, count, significant};
use super::page::{Block, Card, Page, Section, Warning};
use super::plots::FIGURES;
use super::verdict::{Verdict, verdict};
use super::wording::{Units, amplitude_spread, judged_on, moving};
use crate::identify::{Identification, Route};
use crate::model::{Direction, Drive, Joint, Status};
use crate::numerics::statistics::extent;
use rayon::prelude::*;
use tables::{curves, form, legs, parameters};

/// Words of a warning, and the figure that shows what it is about; the first that fits counts.
const SHOWN_BY: [(&str, &str); 9] = [
    ("sweeps reach", "residual_speed"),
    ("reversal", "transition"),
    ("clearance", "transition"),
    ("combination", "transition"),
    ("B(v)", "friction"),
    ("exponential", "friction"),
    ("A(v)", "amplitude"),
    ("sweep", "sweep"),
    ("residual", "residual_time"),
];

/// The formulas of the model and what their symbols mean, as the guide's page has them.
fn formulas() -> Vec<String> {
    let (_, rest) = include_str!("../../guide/model.md").split_once("```text\n").unwrap_or_default();
    let (formulas, rest) = rest.split_once("\n```\n\n").unwrap_or_default();
    let (symbols, _) = rest.split_once("\n\n").unwrap_or_default();
    formulas.lines().map(str::to_string).chain([symbols.replace('\n', " ").replace('`', "")]).collect()
}

/// The page of `found`.
pub fn page(found: &Identification, campaign: &str) -> Page {
    let units = Units::of(&found.model.joint);
    let Verdict { short, steps } = verdict(found);
    let mut figures: Vec<Figure> = FIGURES.par_iter().filter_map(|make| make(found)).collect();
    let names: Vec<String> = figures.iter().map(|figure| figure.name.clone()).collect();
    let mut take = |name: &str| {
        let at = figures.iter().position(|figure| figure.name == name)?;
        Some(figures.remove(at))
    };
    // Without sweeps there is no B(v): the residual over position shows most.
    let lead = take("friction").or_else(|| take("residual_position"));
    let (transition, confidence) = (take("transition"), take("confidence"));
    let (sweep, amplitude) = (take("sweep"), take("amplitude"));
    let rest = figures.into_iter().map(Block::Figure).collect();
    let only = |figure: Option<Figure>| figure.into_iter().map(Block::Figure);
    let sections = [
        Section::open("Change of friction after a reversal", only(transition).chain(curves(found, &units)).collect()),
        Section::open("The model", vec![Block::List(formulas())]),
        Section::open("Parameters", parameters(found, &units).into_iter().chain(only(confidence)).collect()),
        Section::open("Residuals", rest),
        Section::folded("Load and sweeps", only(amplitude).chain(only(sweep)).collect()),
        Section::folded(
            "Results by step",
            vec![Block::List(steps.iter().map(|sentence| kept_together(sentence)).collect())],
        ),
        Section::folded("How the form was chosen", form(found, &units)),
        Section::folded("Legs", legs(found, &units)),
    ];
    Page {
        kicker: format!("tautline identify · campaign {campaign}"),
        title: found.model.joint.name.clone(),
        subject: "identification".to_string(),
        short: kept_together(&short.join(" ")),
        lead: lead.into_iter().collect(),
        next: next(found),
        cards: cards(found, &units),
        warnings: found.warnings.iter().map(|text| warning(text, &names)).collect(),
        sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect(),
        provenance: provenance(found, campaign),
    }
}

/// `text` with the figure that shows why, if it is among `figures`.
fn warning(text: &str, figures: &[String]) -> Warning {
    let shown = SHOWN_BY.iter().find(|(word, figure)| text.contains(word) && figures.iter().any(|name| name == figure));
    Warning { text: text.to_string(), figure: shown.map(|(_, figure)| (*figure).to_string()) }
}

/// What to do next, a sentence each.
fn next(found: &Identification) -> Vec<String> {
    let of = |status: Status| {
        let all = super::parameters::parameters(&found.model);
        let mine = all.iter().filter(|p| !p.left_out && p.confidence.is_some_and(|known| known.status == status));
        mine.map(|p| p.direction.map_or(p.name.to_string(), |d| format!("{} {}", p.name, d.name()))).collect::<Vec<_>>()
    };
    let mut steps = vec![
        "Evaluate the model on motions that it was not identified from: tautline evaluate CAMPAIGN --model THIS_FOLDER -o FOLDER."
            .to_string(),
    ];
    let unseen = [of(Status::Flat), of(Status::AtBound)].concat();
    if !unseen.is_empty() {
        steps.push(format!("These data do not determine {}; sweeps {}would.", unseen.join(", "), beyond(found)));
    }
    if !found.warnings.is_empty() {
        steps.insert(0, "Read the warnings below: where one names a cure, record or correct that first.".to_string());
    }
    steps
}

/// Speeds that the sweeps lack.
fn beyond(found: &Identification) -> String {
    let units = Units::of(&found.model.joint);
    match extent(&found.legs.iter().map(|leg| leg.speed_rad_s).collect::<Vec<f64>>()) {
        (low, high) if low.is_finite() && high.is_finite() => {
            format!(
                "slower than {} {unit} and faster than {} {unit} ",
                significant(low, 2),
                significant(high, 2),
                unit = units.speed
            )
        }
        _ => "at constant speeds, slow and fast, ".to_string(),
    }
}

/// `text` with spaces that do not break between a number and its unit.
fn kept_together(text: &str) -> String {
    const FIXED: [(&str, &str); 5] =
        [("N m", "N\u{a0}m"), (" N", "\u{a0}N"), (" mN", "\u{a0}mN"), (" mm", "\u{a0}mm"), (" ± ", "\u{a0}±\u{a0}")];
    FIXED.iter().fold(text.to_string(), |text, (from, to)| text.replace(from, to))
}

fn cards(found: &Identification, units: &Units) -> Vec<Card> {
    let mut cards = Vec::new();
    let mut add = |name: &str, value: String, note: String| cards.push(Card { name: name.to_string(), value, note });
    match &found.route {
        Route::Sweeps(fits) => {
            for direction in Direction::BOTH {
                let a = fits.of(direction).a;
                let value = format!("{} {}", as_precise_as(a.a_nm, a.half_width_nm), units.torque);
                add(&format!("A {}", moving(direction)), value, amplitude_spread(&a));
            }
        }
        Route::Free(free) => {
            add("held-out RMSE", units.torque(free.held_out_nm), free.form.name(free.is_loaded).to_string())
        }
    }
    if let Some(fit) = &found.combination {
        let curve = fit.curve();
        let own =
            parameter(&curve.curve).map_or(String::new(), |(name, x)| format!(", {name} = {}", significant(x, 3)));
        let note = format!("RMSE {} {}", units.torque(curve.rmse_nm), judged_on(fit.judged_on));
        add("change-over curve", format!("{}{own}", curve.kind.name()), note);
    }
    let note = "all trials, low-passed".to_string();
    add("RMSE", units.torque(found.rmse_nm()), note);
    cards
}

fn provenance(found: &Identification, campaign: &str) -> Vec<(&'static str, String)> {
    let joint = &found.model.joint;
    vec![
        ("campaign", campaign.to_string()),
        ("trials", count(found.trials)),
        ("rows", count(found.rows)),
        ("joint", format!("{} ({})", joint.name, joint.kind.name())),
        ("driven by", driven_by(joint)),
        ("gravity torque", format!("{} {}", significant(found.model.dynamics.gravity_nm, 4), Units::of(joint).load)),
    ]
}

/// What drives `joint`, with its ratio.
fn driven_by(joint: &Joint) -> String {
    let millimetres = |radius_m: f64| significant(1e3 * radius_m, 4);
    match joint.drive {
        Drive::Cable => {
            let (r1, r2) = (millimetres(joint.winch_radius_m), millimetres(joint.pulley_radius_m));
            format!("cable, winch radius r1 {r1} mm, pulley radius r2 {r2} mm")
        }
        Drive::Gear => format!("gear or belt, ratio {}", significant(1.0 / joint.transmission(), 4)),
        Drive::Direct => "the motor itself".to_string(),
        Drive::Screw => format!("screw, {} mm a turn", millimetres(std::f64::consts::TAU * joint.transmission())),
    }
}
