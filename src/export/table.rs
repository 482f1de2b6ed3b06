//! A model's parameters with their confidence as tables: CSV for programs, LaTeX and Markdown for papers and notes.

use crate::dynamics::Payload;
use crate::model::{Confidence, Model, Status};
use crate::problem::visible;
use crate::report::diagnosis::unit_of;
use crate::report::number::{interval, significant};
use crate::report::parameters::parameters;
use crate::report::wording::{Units, status_word};

/// Significant digits of a value without an interval.
const DIGITS: usize = 5;

/// One row.
struct Row {
    /// Dotted name as in model.json.
    name: String,
    meaning: String,
    unit: String,
    value: f64,
    confidence: Option<Confidence>,
    /// Its interval in words.
    interval: String,
    /// Whether the data set the interval's lower and upper end, rather than the limit of the search.
    told: [bool; 2],
}

fn rows(model: &Model) -> Vec<Row> {
    let of = |name: &str, meaning: &str, unit: &str, value: f64| {
        let confidence = model.confidence.get(name).copied();
        Row {
            name: name.to_string(),
            meaning: meaning.to_string(),
            unit: unit.to_string(),
            value,
            confidence,
            interval: confidence.map_or_else(String::new, |c| interval(value, c.low, c.high)),
            told: [true; 2],
        }
    };
    let units = Units::of(&model.joint);
    let joint = &model.joint;
    let mut rows = vec![
        of("joint.winch_radius_m", "radius of the winch, r1", "m", joint.winch_radius_m),
        of("joint.pulley_radius_m", "radius of the pulley, r2", "m", joint.pulley_radius_m),
    ];
    if model.chain.is_none() {
        let inertia_unit = if units.load == "N" { "kg" } else { "kg m^2" };
        rows.push(of("dynamics.gravity_nm", "gravity torque at 90 deg", units.load, model.dynamics.gravity_nm));
        rows.push(of("dynamics.inertia_kg_m2", "inertia", inertia_unit, model.dynamics.inertia_kg_m2));
    }
    if !model.dynamics.payload.is_none() {
        let numbers = Payload::<f64>::NAMES.into_iter().zip(model.dynamics.payload.numbers());
        rows.extend(numbers.map(|(name, value)| {
            of(&format!("dynamics.payload.{name}"), "what the last link carries", unit_of(name), value)
        }));
    }
    rows.extend(parameters(model).into_iter().filter(|p| !p.left_out).map(|p| Row {
        name: match p.direction {
            Some(direction) => format!("friction.{}.{}", direction.name(), p.name),
            None if p.name == "backlash" => "joint.backlash_mm".to_string(),
            None => format!("combination.{}", p.name),
        },
        meaning: p.meaning.to_string(),
        unit: p.unit.to_string(),
        value: p.value,
        confidence: p.confidence,
        interval: p.interval(),
        told: p.searched.map(|searched| !searched && !p.is_open),
    }));
    for effect in &model.effects {
        rows.extend(effect.named().map(|(parameter, value)| {
            let name = format!("effects.{}.{}", effect.id(), parameter.name);
            of(&name, effect.effect.about().means, unit_of(parameter.name), value)
        }));
    }
    rows
}

/// Commas, a header, full precision; what is not known is empty.
pub fn csv(model: &Model) -> String {
    let mut text = "name,unit,value,low,high,cv,status,meaning\n".to_string();
    for row in rows(model) {
        let known = |of: fn(&Confidence) -> f64, is_told: bool| {
            let value = row.confidence.as_ref().map(of).filter(|x| is_told && x.is_finite());
            value.map_or_else(String::new, |x| format!("{x:?}"))
        };
        let status = row.confidence.map_or("", |c| c.status.name());
        let [low, high] = [known(|c| c.low, row.told[0]), known(|c| c.high, row.told[1])];
        let cv = known(|c| c.cv, true);
        let meaning = row.meaning.replace('"', "\"\"");
        text += &format!("{},{},{:?},{low},{high},{cv},{status},\"{meaning}\"\n", row.name, row.unit, row.value);
    }
    text
}

fn told(row: &Row) -> [String; 3] {
    let status = row.confidence.map_or_else(String::new, |c| status_word(c.status).to_string());
    [significant(row.value, DIGITS), row.interval.clone(), status]
}

/// What Markdown takes for more than text: links, HTML, emphasis, code, cells, addresses.
const MARKDOWN: &str = "\\`*_[]<>()!|#~&:@";

/// A table for notes.
pub fn markdown(model: &Model) -> String {
    let mut text = format!("Parameters of {}\n\n", escaped(&visible(&model.joint.name), MARKDOWN));
    text += "| parameter | unit | value | 95 % interval | known |\n|---|---|---:|---|---|\n";
    for row in rows(model) {
        let [value, interval, status] = told(&row);
        text += &format!("| `{}` | {} | {value} | {interval} | {status} |\n", row.name, row.unit);
    }
    text + &footnote(model)
}

/// A table for a paper: `booktabs` draws its rules.
pub fn latex(model: &Model) -> String {
    let mut text = "% Needs \\usepackage{booktabs}\n\\begin{tabular}{llrll}\n\\toprule\n".to_string();
    text += "parameter & unit & value & 95\\,\\% interval & known \\\\\n\\midrule\n";
    for row in rows(model) {
        let [value, interval, status] = told(&row);
        let unit = row.unit.replace("^2", "$^2$").replace('²', "$^2$").replace(' ', "\\,");
        let name = escaped(&row.name, "_");
        text += &format!("\\texttt{{{name}}} & {unit} & ${value}$ & {interval} & {status} \\\\\n");
    }
    text += "\\bottomrule\n\\end{tabular}\n";
    text + &footnote(model)
        .lines()
        .filter(|line| !line.is_empty())
        .map(|line| format!("% {line}\n"))
        .collect::<String>()
}

fn escaped(text: &str, signs: &str) -> String {
    text.chars().flat_map(|c| signs.contains(c).then_some('\\').into_iter().chain([c])).collect()
}

/// What the words of the last column say, where there are any.
fn footnote(model: &Model) -> String {
    let has = |status: Status| model.confidence.values().any(|c| c.status == status);
    let means = |status: Status| format!("{}: {}", status_word(status), crate::report::wording::status_meaning(status));
    let said: Vec<String> = Status::ALL.into_iter().filter(|s| has(*s)).map(means).collect();
    if said.is_empty() { String::new() } else { format!("\n{}\n", said.join("\n\n")) }
}
