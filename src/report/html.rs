//! `report.html`: one file, no link to anything outside.

use super::forms::{FormsTable, forms_of, note};
use super::identification::{overall_rmse_nm, parameter};
use super::number::{as_precise_as, count, percent, r_squared, significant, with_spread};
use super::page::Card;
use super::parameters::{Parameter, combination, friction, rests_on};
use super::plots::Figure;
use super::verdict::{Verdict, verdict};
use super::wording::{
    LEFT_OUT, LEFT_OUT_MEANING, Units, amplitude_spread, judged_on, moving, status_meaning, status_word,
};
use crate::identify::{CombinationFit, CurveKind, Identification, LegFit, Route};
use crate::model::{Direction, Status};
use askama::Template;

/// What the template shows; everything is text, and the template escapes all but the drawings.
#[derive(Template)]
#[template(path = "identification.html")]
struct Page<'a> {
    kicker: String,
    title: &'a str,
    subject: &'static str,
    short: String,
    steps: Vec<String>,
    warnings: &'a [String],
    cards: Vec<Card>,
    branches: Vec<ParameterRow>,
    others: Vec<ParameterRow>,
    rests_on: Option<String>,
    statuses: Vec<Chip>,
    forms: Vec<FormsTable>,
    free_forms: Vec<FreeFormRow>,
    curves: Vec<CurveRow>,
    reversals: String,
    figures: Vec<FigureView<'a>>,
    legs: Vec<[String; 9]>,
    units: Units,
    provenance: Vec<(&'static str, String)>,
}

/// A status as a small label.
struct Chip {
    class: &'static str,
    word: &'static str,
    meaning: &'static str,
}

/// One parameter, of both directions or of one curve.
struct ParameterRow {
    name: &'static str,
    meaning: &'static str,
    unit: &'static str,
    cells: Vec<Cell>,
}

struct Cell {
    value: String,
    interval: String,
    cv: String,
    chip: Chip,
}

struct FreeFormRow {
    name: &'static str,
    held_out: String,
    taken: bool,
}

struct CurveRow {
    name: &'static str,
    parameter: String,
    clearance: String,
    rmse: String,
    r_squared: String,
    note: &'static str,
}

struct FigureView<'a> {
    name: &'a str,
    title: &'a str,
    caption: &'a str,
    svg: &'a str,
}

/// The report of `found` with `figures` already drawn.
pub fn report<'a>(
    found: &'a Identification,
    campaign: &'a str,
    figures: &'a [(&Figure, String)],
) -> askama::Result<String> {
    let units = Units::of(found.model.joint.kind);
    let [up, down] = Direction::BOTH.map(|direction| friction(&found.model, direction));
    let Verdict { short, steps } = verdict(found);
    let view = |(figure, svg): &'a (&Figure, String)| FigureView {
        name: figure.name,
        title: figure.title,
        caption: figure.caption,
        svg,
    };
    Page {
        kicker: format!("tautline identify · campaign {campaign}"),
        title: &found.model.joint.name,
        subject: "identification",
        short: kept_together(&short.join(" ")),
        steps: steps.iter().map(|sentence| kept_together(sentence)).collect(),
        warnings: &found.warnings,
        cards: cards(found, &units),
        branches: up.iter().zip(&down).map(|(up, down)| parameter_row(up, Some(down))).collect(),
        others: combination(&found.model).iter().map(|row| parameter_row(row, None)).collect(),
        rests_on: rests_on(found, &units).map(|text| kept_together(&text)),
        statuses: Status::ALL.into_iter().map(status_chip).chain([left_out_chip()]).collect(),
        forms: forms(found, &units),
        free_forms: free_forms(found, &units),
        curves: found.combination.as_ref().map(|fit| curves(fit, &units)).unwrap_or_default(),
        reversals: found.combination.as_ref().map_or(String::new(), |fit| count(fit.windows)),
        figures: figures.iter().map(view).collect(),
        legs: found.legs.iter().map(leg_row).collect(),
        units,
        provenance: provenance(found, campaign),
    }
    .render()
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
        add("combination", format!("{}{own}", curve.kind.name()), note);
    }
    let note = "all trials, low-passed".to_string();
    add("RMSE", units.torque(overall_rmse_nm(found)), note);
    cards
}

fn parameter_row(first: &Parameter, other: Option<&Parameter>) -> ParameterRow {
    let cells = std::iter::once(first).chain(other).map(cell).collect();
    ParameterRow { name: first.name, meaning: first.meaning, unit: first.unit, cells }
}

fn cell(parameter: &Parameter) -> Cell {
    let shown = parameter.confidence.filter(|_| !parameter.left_out);
    let chip = match (parameter.left_out, &shown) {
        (true, _) => left_out_chip(),
        (false, Some(confidence)) => status_chip(confidence.status),
        (false, None) => Chip { class: "left-out", word: "as declared", meaning: "taken from the campaign" },
    };
    Cell {
        value: match shown {
            _ if parameter.left_out => "–".to_string(),
            Some(c) if c.status == Status::Pinned => as_precise_as(parameter.value, (c.high - c.low) / 2.0),
            _ => significant(parameter.value, 4),
        },
        interval: parameter.interval(),
        cv: shown.map_or(String::new(), |c| percent(c.cv)),
        chip,
    }
}

fn status_chip(status: Status) -> Chip {
    let class = match status {
        Status::Pinned => "pinned",
        Status::TradeOff => "trade-off",
        Status::Merged => "merged",
        Status::Flat => "flat",
        Status::AtBound => "at-bound",
    };
    Chip { class, word: status_word(status), meaning: status_meaning(status) }
}

fn left_out_chip() -> Chip {
    Chip { class: "left-out", word: LEFT_OUT, meaning: LEFT_OUT_MEANING }
}

fn forms(found: &Identification, units: &Units) -> Vec<FormsTable> {
    let Route::Sweeps(fits) = &found.route else { return Vec::new() };
    Direction::BOTH.into_iter().map(|direction| forms_of(fits.of(direction), units)).collect()
}

fn free_forms(found: &Identification, units: &Units) -> Vec<FreeFormRow> {
    let Route::Free(free) = &found.route else { return Vec::new() };
    let row = |(form, held_out_nm): &(crate::identify::free::FreeForm, f64)| FreeFormRow {
        name: form.name(free.is_loaded),
        held_out: units.torque(*held_out_nm),
        taken: *form == free.form,
    };
    free.forms.iter().map(row).collect()
}

fn curves(fit: &CombinationFit, units: &Units) -> Vec<CurveRow> {
    let row = |(at, curve): (usize, &crate::identify::CurveFit)| CurveRow {
        name: curve.kind.name(),
        parameter: parameter(&curve.curve).map_or(String::new(), |(name, x)| format!("{name} = {}", significant(x, 4))),
        clearance: match curve.kind {
            CurveKind::Sign => String::new(),
            _ => format!("{} mm", significant(1e3 * curve.backlash_m, 3)),
        },
        rmse: units.torque(curve.rmse_nm),
        r_squared: r_squared(curve.r_squared),
        note: note(at == fit.taken, at == fit.supported),
    };
    fit.curves.iter().enumerate().map(row).collect()
}

fn leg_row(leg: &LegFit) -> [String; 9] {
    [
        leg.file.clone(),
        leg.repeat.to_string(),
        leg.direction.name().to_string(),
        significant(leg.speed_rad_s, 3),
        count(leg.samples),
        with_spread(leg.a_nm, leg.a_se_nm),
        with_spread(leg.b_nm, leg.b_se_nm),
        r_squared(leg.r_squared),
        significant(1e3 * leg.rmse_nm, 3),
    ]
}

fn provenance(found: &Identification, campaign: &str) -> Vec<(&'static str, String)> {
    let joint = &found.model.joint;
    vec![
        ("tautline", env!("CARGO_PKG_VERSION").to_string()),
        ("campaign", campaign.to_string()),
        ("trials", count(found.trials)),
        ("rows", count(found.rows)),
        ("joint", format!("{} ({})", joint.name, joint.kind.name())),
        ("winch radius r1", format!("{} mm", significant(1e3 * joint.winch_radius_m, 4))),
        ("pulley radius r2", format!("{} mm", significant(1e3 * joint.pulley_radius_m, 4))),
        (
            "gravity torque",
            format!("{} {}", significant(found.model.dynamics.gravity_nm, 4), Units::of(joint.kind).torque),
        ),
    ]
}
