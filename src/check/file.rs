//! `baseline/1`: written so that a diff of two baselines reads well, a line for each trial and figure; and read.

use super::sketch::{SUMS, Sketch};
use super::{Baseline, Figure, Recipe, Snapshot, TrialMark};
use crate::document::{Document, Section};
use crate::identify::{CurveKind, Form, Settings, combination};
use crate::model::Model;
use crate::problem::Result;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;

const FORMAT: &str = "baseline/1";
const FORMS: [(&str, Form); 3] = [("two", Form::Two), ("one", Form::One), ("supported", Form::Supported)];

impl Baseline {
    /// The text of its file.
    pub fn to_json_text(&self) -> String {
        let Snapshot { settings, trials, choices, figures, .. } = &self.snapshot;
        let head = [
            ("format", json!(FORMAT)),
            ("tautline", json!(self.tautline)),
            ("campaign", json!(self.campaign)),
            ("recipe", recipe_json(&self.recipe)),
            ("settings", json!(settings)),
            ("choices", json!(choices)),
        ];
        let mut text = String::from("{\n");
        head.iter().for_each(|(key, value)| text += &format!("  \"{key}\": {value},\n"));
        text += &format!("  \"trials\": {},\n", lines(trials.iter().map(trial_json)));
        text += &format!("  \"figures\": {},\n", lines(figures.iter().map(figure_json)));
        text + &format!("  \"model\": {}\n}}\n", self.model.to_json())
    }

    /// Reads `file`.
    ///
    /// Errors: the file cannot be read or is no baseline; an unknown key, a missing or impossible value.
    pub fn read(file: &Path) -> Result<Self> {
        // Whatever the file is called, a baseline is JSON.
        let text = std::fs::read_to_string(file).or_else(|error| {
            let cure = "check the path, or store a baseline with --update";
            crate::problem::Problem::error(file, format!("cannot be read: {error}"), cure).alone()
        })?;
        Document::from_json(file, &text)?.read(Self::from_section)
    }

    fn from_section(root: &Section<'_>) -> Option<Self> {
        root.need("format").choice(&[(FORMAT, ())]);
        let (tautline, campaign) = (root.need("tautline").text(), root.need("campaign").text());
        let recipe = root.need("recipe").section(read_recipe);
        let (settings, choices) = (root.need("settings").section(texts), root.need("choices").section(texts));
        let trials = root.need("trials").sections(read_trial);
        let figures = root.need("figures").sections(read_figure);
        let model = root.need("model").section(Model::from_section);
        let snapshot = Snapshot {
            settings: settings?,
            trials: trials?,
            choices: choices?,
            figures: figures?,
            refused: BTreeMap::new(),
        };
        Some(Self { tautline: tautline?, campaign: campaign?, recipe: recipe?, model: model?, snapshot })
    }
}

fn lines(values: impl Iterator<Item = Value>) -> String {
    let lines: Vec<String> = values.map(|value| format!("    {value}")).collect();
    format!("[\n{}\n  ]", lines.join(",\n"))
}

fn recipe_json(recipe: &Recipe) -> Value {
    let Recipe::Identify(settings) = recipe else { return json!({ "identify": false }) };
    let form = FORMS.iter().find(|(_, form)| *form == settings.form).map(|(name, _)| name);
    json!({
        "identify": true,
        "form": form,
        "combination": settings.combination.wanted.map(CurveKind::name),
        "estimate_backlash": settings.combination.estimate_backlash,
        "refine": settings.refine,
    })
}

fn read_recipe(s: &Section<'_>) -> Option<Recipe> {
    let identify = s.need("identify").flag();
    let (form, estimate_backlash, refine) =
        (s.may("form").choice(&FORMS), s.may("estimate_backlash").flag(), s.may("refine").flag());
    let wanted = s.may("combination").choice(&CurveKind::ALL.map(|kind| (kind.name(), kind)));
    if !identify? {
        return Some(Recipe::Judge);
    }
    let combination = combination::Settings { wanted, estimate_backlash: estimate_backlash.unwrap_or_default() };
    Some(Recipe::Identify(Settings {
        form: form.unwrap_or_default(),
        combination,
        refine: refine.unwrap_or_default(),
        ..Settings::default()
    }))
}

fn texts(s: &Section<'_>) -> Option<BTreeMap<String, String>> {
    Some(s.keys().filter_map(|key| Some((key.to_string(), s.need(key).text()?))).collect())
}

fn trial_json(mark: &TrialMark) -> Value {
    let columns: Map<String, Value> =
        mark.columns.iter().map(|(name, sketch)| (name.clone(), sketch.to_text().into())).collect();
    json!({
        "file": mark.file,
        "declared": mark.declared,
        "rows": mark.rows,
        "duration_s": mark.duration_s,
        "digests": columns,
    })
}

fn read_trial(s: &Section<'_>) -> Option<TrialMark> {
    let (file, declared) = (s.need("file").text(), s.need("declared").text());
    let (rows, duration_s) = (s.need("rows").whole(0, i64::MAX), s.need("duration_s").not_negative());
    let columns = s.need("digests").section(|s| {
        let one = |name: &str| {
            let text = s.need(name).text()?;
            let sketch = Sketch::from_text(&text);
            if sketch.is_none() {
                s.reject(name, "is no digest", format!("expected {} numbers; store the baseline anew", SUMS + 1));
            }
            Some((name.to_string(), sketch?))
        };
        Some(s.keys().filter_map(one).collect())
    });
    let rows = usize::try_from(rows?).ok()?;
    Some(TrialMark { file: file?, declared: declared?, rows, duration_s: duration_s?, columns: columns? })
}

fn figure_json(figure: &Figure) -> Value {
    let mut value = json!({
        "name": figure.name,
        "unit": figure.unit,
        "value": figure.value,
        "rounding": figure.rounding,
        "tolerance": figure.tolerance,
        "error": figure.is_error,
    });
    if let Some(file) = &figure.file {
        value["file"] = json!(file);
    }
    value
}

fn read_figure(s: &Section<'_>) -> Option<Figure> {
    let (name, unit, file) = (s.need("name").text(), s.need("unit").text(), s.may("file").text());
    let value = s.may("value").number().unwrap_or(f64::NAN);
    let (rounding, tolerance) = (s.may("rounding").not_negative(), s.may("tolerance").not_negative());
    let (rounding, tolerance) = (rounding.unwrap_or(f64::INFINITY), tolerance.unwrap_or(f64::INFINITY));
    let is_error = s.need("error").flag();
    Some(Figure { name: name?, unit: unit?, file, value, rounding, tolerance, is_error: is_error? })
}

impl Sketch {
    /// Its numbers, with all digits that tell one from another.
    fn to_text(self) -> String {
        let numbers = std::iter::once(self.rms).chain(self.sums);
        numbers.map(|number| format!("{number:e}")).collect::<Vec<_>>().join(" ")
    }

    fn from_text(text: &str) -> Option<Self> {
        let numbers: Vec<f64> = text.split(' ').map(|number| number.parse().ok()).collect::<Option<_>>()?;
        let (rms, sums) = numbers.split_first()?;
        Some(Self { rms: *rms, sums: sums.try_into().ok()? })
    }
}
