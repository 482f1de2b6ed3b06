//! The page of an identification: the verdict, B(v), what to do next; below, the steps of the protocol.

use super::chart::Figure;
use super::forms::{FormsTable, forms_of, note};
use super::identification::{overall_rmse_nm, parameter};
use super::number::{as_precise_as, count, percent, r_squared, significant, with_spread};
use super::page::{Block, Card, Cell, Page, Section, Table, Warning, cells};
use super::parameters::{Parameter, combination, friction, rests_on};
use super::plots::FIGURES;
use super::verdict::{Verdict, verdict};
use super::wording::{
    LEFT_OUT, LEFT_OUT_MEANING, Units, amplitude_spread, judged_on, moving, status_meaning, status_word,
};
use crate::identify::{CombinationFit, CurveKind, Identification, LegFit, Route};
use crate::model::{Direction, Drive, Joint, Status};
use crate::numerics::statistics::extent;

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
    let (_, rest) = include_str!("../guide/model.md").split_once("```text\n").unwrap_or_default();
    let (formulas, rest) = rest.split_once("\n```\n\n").unwrap_or_default();
    let (symbols, _) = rest.split_once("\n\n").unwrap_or_default();
    formulas.lines().map(str::to_string).chain([symbols.replace('\n', " ").replace('`', "")]).collect()
}

/// The page of `found`.
pub fn page(found: &Identification, campaign: &str) -> Page {
    let units = Units::of(&found.model.joint);
    let Verdict { short, steps } = verdict(found);
    let mut figures: Vec<Figure> = FIGURES.iter().filter_map(|make| make(found)).collect();
    let names: Vec<String> = figures.iter().map(|figure| figure.name.clone()).collect();
    let mut take = |name: &str| {
        let at = figures.iter().position(|figure| figure.name == name)?;
        Some(figures.remove(at))
    };
    // Without sweeps there is no B(v): what the model leaves over position tells most.
    let lead = take("friction").or_else(|| take("residual_position"));
    let (transition, confidence) = (take("transition"), take("confidence"));
    let (sweep, amplitude) = (take("sweep"), take("amplitude"));
    let rest = figures.into_iter().map(Block::Figure).collect();
    let only = |figure: Option<Figure>| figure.into_iter().map(Block::Figure);
    let sections = [
        Section::open("Change of friction after a reversal", only(transition).chain(curves(found, &units)).collect()),
        Section::open("The model", vec![Block::List(formulas())]),
        Section::open("Parameters", parameters(found, &units).into_iter().chain(only(confidence)).collect()),
        Section::open("What the model leaves", rest),
        Section::folded("Load and sweeps", only(amplitude).chain(only(sweep)).collect()),
        Section::folded("Steps", vec![Block::List(steps.iter().map(|sentence| kept_together(sentence)).collect())]),
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
        steps.push(format!("These data do not determine {}: sweeps {}would.", unseen.join(", "), beyond(found)));
    }
    if !found.warnings.is_empty() {
        steps.insert(0, "Read the warnings: where one names a cure, record or correct that first.".to_string());
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
    add("RMSE", units.torque(overall_rmse_nm(found)), note);
    cards
}

fn parameters(found: &Identification, units: &Units) -> Vec<Block> {
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
fn form(found: &Identification, units: &Units) -> Vec<Block> {
    match &found.route {
        Route::Sweeps(fits) => {
            let intro = "B(v) is a constant and a straight line with no, one or two decaying exponentials. More of them always fit \
                         closer; Akaike's criterion (AICc, here above the best; lower is better), or with few points an F test, \
                         decides whether the data ask for them. What the model takes is scored on the whole series too, and no \
                         larger than the prediction bears.";
            let tables = Direction::BOTH.into_iter().flat_map(|direction| {
                let FormsTable { title, why, trades, rows } = forms_of(fits.of(direction), units);
                let rows = rows
                    .into_iter()
                    .map(|row| vec![row.name.to_string(), row.rmse, row.aicc, row.rates, row.note.to_string()]);
                let heads = ["form", "RMSE", "AICc", "rates (inverse speed)", "taken"];
                [Block::Table(Table::new(title, "", &heads, rows.collect())), Block::Text(why), Block::Text(trades)]
            });
            std::iter::once(Block::Text(intro.to_string())).chain(tables).collect()
        }
        Route::Free(free) => {
            let intro = "Without sweeps at constant speed, forms of growing size were fitted to whole series, each scored on held-out \
                         trials. The smallest that is no worse than the best by more than one standard error is taken.";
            let row = |(form, held_out_nm): &(crate::identify::free::FreeForm, f64)| {
                let taken = if *form == free.form { "taken" } else { "" };
                vec![form.name(free.is_loaded).to_string(), units.torque(*held_out_nm), taken.to_string()]
            };
            let rows = free.forms.iter().map(row).collect();
            vec![Block::Table(Table::new("", intro, &["form", "held-out RMSE", "taken"], rows))]
        }
    }
}

/// The curves of the combination side by side; nothing where none was fitted.
fn curves(found: &Identification, units: &Units) -> Option<Block> {
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
    let heads = ["curve", "parameter", "clearance", "RMSE", "R²", "taken"];
    Some(Block::Table(Table::new("", &intro, &heads, fit.curves.iter().enumerate().map(row).collect())))
}

/// A and B of every leg; nothing without legs.
fn legs(found: &Identification, units: &Units) -> Vec<Block> {
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
