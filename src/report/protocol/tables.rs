//! The tables of an identification: parameters with their status, the forms and curves that were compared, legs.

use super::kept_together;
use crate::identify::{CombinationFit, CurveKind, Identification, LegFit, Route};
use crate::model::{Direction, Status};
use crate::report::forms::{FormsTable, forms_of, note};
use crate::report::identification::parameter;
use crate::report::number::{as_precise_as, count, percent, r_squared, significant, with_spread};
use crate::report::page::{Block, Cell, Table, cells};
use crate::report::parameters::{Parameter, combination, friction, rests_on};
use crate::report::wording::{LEFT_OUT, LEFT_OUT_MEANING, Units, status_meaning, status_word};

/// Parameters by direction, those of the change-over, and what each status means.
pub(super) fn parameters(found: &Identification, units: &Units) -> Vec<Block> {
    let [up, down] = Direction::BOTH.map(|direction| friction(&found.model, direction));
    let named = |p: &Parameter| Cell {
        text: p.name.to_string(),
        meaning: p.meaning.to_string(),
        chip: "",
        link: String::new(),
    };
    let row = |parameters: &[&Parameter]| {
        let mut row = vec![named(parameters[0]), Cell::from(parameters[0].unit.to_string())];
        row.extend(parameters.iter().flat_map(|parameter| cells_of(parameter)));
        row
    };
    let table = |heads: &[&str], rows: Vec<Vec<Cell>>| Table {
        title: String::new(),
        intro: String::new(),
        heads: heads.iter().map(|head| (*head).to_string()).collect(),
        rows,
    };
    let both =
        ["friction", "unit", "▲ moving up", "95 % interval", "status", "▼ moving down", "95 % interval", "status"];
    let branches = table(&both, up.iter().zip(&down).map(|(up, down)| row(&[up, down])).collect());
    let others = combination(&found.model).iter().map(|one| row(&[one])).collect();
    let others = table(&["change-over", "unit", "value", "95 % interval", "status"], others);
    let statuses = Status::ALL.into_iter().map(status_chip).chain([left_out_chip()]);
    let mut blocks = vec![Block::Table(branches), Block::Table(others)];
    blocks.extend(rests_on(found, units).map(|text| Block::Text(kept_together(&format!("{text}.")))));
    blocks.push(Block::Terms(
        statuses.map(|chip| (Cell { meaning: String::new(), ..chip.clone() }, chip.meaning)).collect(),
    ));
    blocks
}

/// Value, interval and status.
fn cells_of(parameter: &Parameter) -> [Cell; 3] {
    let shown = parameter.confidence.filter(|_| !parameter.left_out);
    let mut chip = match (parameter.left_out, &shown) {
        (true, _) => left_out_chip(),
        (false, Some(confidence)) => status_chip(confidence.status),
        (false, None) => chip("left-out", "as declared", "taken from the campaign"),
    };
    if let Some(confidence) = shown {
        chip.meaning = format!("{}; coefficient of variation {}", chip.meaning, percent(confidence.cv));
    }
    let value = match shown {
        _ if parameter.left_out => "–".to_string(),
        Some(c) if c.status == Status::Pinned => as_precise_as(parameter.value, (c.high - c.low) / 2.0),
        _ => significant(parameter.value, 4),
    };
    [value.into(), parameter.interval().into(), chip]
}

fn chip(class: &'static str, text: &str, meaning: &str) -> Cell {
    Cell { text: text.to_string(), meaning: meaning.to_string(), chip: class, link: String::new() }
}

fn status_chip(status: Status) -> Cell {
    let class = match status {
        Status::Pinned => "pinned",
        Status::TradeOff => "trade-off",
        Status::Merged => "merged",
        Status::Flat => "flat",
        Status::AtBound => "at-bound",
    };
    chip(class, status_word(status), status_meaning(status))
}

fn left_out_chip() -> Cell {
    chip("left-out", LEFT_OUT, LEFT_OUT_MEANING)
}

/// How the form of the friction was chosen.
pub(super) fn form(found: &Identification, units: &Units) -> Vec<Block> {
    match &found.route {
        Route::Sweeps(fits) => {
            let intro = "B(v) is a constant and a straight line with no, one or two decaying exponentials. More of them always fit \
                         closer; Akaike's criterion (AICc, here relative to the best; lower is better), or with few points an F test, \
                         decides whether the data support them. The form that the model uses is also scored on the whole series, and no \
                         larger than the prediction supports.";
            let tables = Direction::BOTH.into_iter().flat_map(|direction| {
                let FormsTable { title, why, trades, rows } = forms_of(fits.of(direction), units);
                let rows = rows
                    .into_iter()
                    .map(|row| vec![row.name.to_string(), row.rmse, row.aicc, row.rates, row.note.to_string()]);
                let heads = ["form", "RMSE", "AICc", "rates (inverse speed)", "selected"];
                [Block::Table(Table::new(title, "", &heads, rows.collect())), Block::Text(why), Block::Text(trades)]
            });
            std::iter::once(Block::Text(intro.to_string())).chain(tables).collect()
        }
        Route::Free(free) => {
            let intro = "Without sweeps at constant speed, forms of growing size were fitted to whole series, each scored on held-out \
                         trials. The smallest form within one standard error of the best is selected.";
            let row = |(form, held_out_nm): &(crate::identify::free::FreeForm, f64)| {
                let selected = if *form == free.form { "selected" } else { "" };
                vec![form.name(free.is_loaded).to_string(), units.torque(*held_out_nm), selected.to_string()]
            };
            let rows = free.forms.iter().map(row).collect();
            vec![Block::Table(Table::new("", intro, &["form", "held-out RMSE", "selected"], rows))]
        }
    }
}

/// The curves of the combination side by side; nothing where none was fitted.
pub(super) fn curves(found: &Identification, units: &Units) -> Option<Block> {
    let fit: &CombinationFit = found.combination.as_ref()?;
    let held_out = if matches!(found.route, Route::Free(_)) { " and scored on held-out strokes" } else { "" };
    let row = |(at, curve): (usize, &crate::identify::CurveFit)| {
        let clearance = match curve.kind {
            CurveKind::Sign => String::new(),
            _ => format!("{} mm", significant(1e3 * curve.backlash_m, 3)),
        };
        vec![
            curve.kind.name().to_string(),
            parameter(&curve.curve).map_or(String::new(), |(name, x)| format!("{name} = {}", significant(x, 4))),
            clearance,
            units.torque(curve.rmse_nm),
            r_squared(curve.r_squared),
            note(at == fit.taken, at == fit.supported).to_string(),
        ]
    };
    let intro = format!("Four curves, fitted to {} reversals{held_out}.", count(fit.windows));
    let heads = ["curve", "parameter", "clearance", "RMSE", "R²", "selected"];
    Some(Block::Table(Table::new("", &intro, &heads, fit.curves.iter().enumerate().map(row).collect())))
}

/// A and B of every leg; nothing without legs.
pub(super) fn legs(found: &Identification, units: &Units) -> Vec<Block> {
    if found.legs.is_empty() {
        return Vec::new();
    }
    let heads = [
        "file".to_string(),
        "repeat".to_string(),
        "direction".to_string(),
        format!("speed ({})", units.speed),
        "samples".to_string(),
        format!("A ± SE ({})", units.torque),
        format!("B ± SE ({})", units.torque),
        "R²".to_string(),
        format!("RMSE ({})", units.milli_torque),
    ];
    let rows = found.legs.iter().map(|leg| cells(leg_row(leg).to_vec())).collect();
    let intro = "trials.csv holds every digit.".to_string();
    vec![Block::Table(Table { title: String::new(), intro, heads: heads.to_vec(), rows })]
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
