//! `model.json`: read and written.

use super::{
    Both, ChainName, Combination, Confidence, Direction, Drive, Friction, Functions, Joint, Model, Status, Term,
};
use crate::document::{Document, Section};
use crate::dynamics::{Dynamics, JointKind, Payload};
use crate::effects::{Added, LIBRARY, Parameter, Role};
use crate::problem::{Problem, Result};
use serde_json::{Map, Value, json};
use std::path::Path;

/// The format's name and version.
const FORMAT: &str = "model/1";

/// Keys that an identification adds for people to read; of them only the RMSE in `fit` and what failed in `checks` are read.
pub const EXTRA_KEYS: [&str; 9] =
    ["fit", "forms", "combinations", "refinement", "free_motion", "warnings", "provenance", "rests_on", "checks"];

impl Model {
    /// Reads a model; keys that an identification adds may be absent.
    ///
    /// Errors: the file, an unknown key or effect, a missing or impossible parameter.
    pub fn read(file: &Path) -> Result<Self> {
        if file.is_dir() {
            let cure = "name the model's file, or the folder that `identify` wrote";
            return Problem::error(file, "is a folder without a model.json", cure).alone();
        }
        Document::open(file)?.read(Self::from_section)
    }

    /// Reads a model from `text`, JSON that is called `file` in messages.
    ///
    /// Errors: as `read`.
    pub fn parse(file: &Path, text: &str) -> Result<Self> {
        Document::from_json(file, text)?.read(Self::from_section)
    }

    /// Reads a model that stands in a part of a larger file.
    pub fn from_section(root: &Section<'_>) -> Option<Self> {
        root.need("format").choice(&[(FORMAT, ())]);
        for key in EXTRA_KEYS {
            root.may(key);
        }
        let joint = root.need("joint").section(|s| Joint::read(s, Joint::read_kind(s)));
        let dynamics = root.need("dynamics").section(|s| {
            let gravity_nm = s.need("gravity_nm").number();
            let inertia_kg_m2 = s.need("inertia_kg_m2").not_negative();
            let (urdf, joint) = (s.may("urdf").text(), s.may("joint").text());
            let chain = urdf.zip(joint).map(|(urdf, joint)| ChainName { urdf, joint });
            let position_zero_rad = s.may("position_zero_rad").number().unwrap_or(0.0);
            let payload = s.may("payload").section(|s| read_payload(s, chain.is_some())).unwrap_or_default();
            let (gravity_nm, inertia_kg_m2) = (gravity_nm?, inertia_kg_m2?);
            Some((Dynamics { gravity_nm, inertia_kg_m2, position_zero_rad, payload }, chain))
        });
        let friction = root.need("friction").section(|s| {
            let up = s.need("up").section(|s| read_friction(s, Direction::Up));
            let down = s.need("down").section(|s| read_friction(s, Direction::Down));
            Some(Both { up: up?, down: down? })
        });
        let combination = root.need("combination").section(read_combination);
        let effects = root.may("effects").sections(read_effect).unwrap_or_default();
        let confidence = root.may("confidence").sections_by_name(|_, s| read_confidence(s)).unwrap_or_default();
        let functions = root.may("functions").section(Functions::read).unwrap_or_default();
        let own_rmse_nm = root.may("fit").section(|fit| {
            fit.with_more().may("whole").section(|whole| whole.with_more().may("rmse_nm").not_negative())
        });
        let checks = root.may("checks").sections(|check| {
            let check = check.with_more();
            let (name, passes) = (check.need("check").text(), check.need("passes").flag());
            Some((name?, passes?))
        });
        let failed = |(name, passes): (String, bool)| (!passes).then_some(name);
        let (dynamics, chain) = dynamics?;
        Some(Self {
            joint: joint?,
            dynamics,
            chain,
            friction: friction?,
            combination: combination?,
            effects,
            confidence,
            functions,
            own_rmse_nm,
            failed_checks: checks.unwrap_or_default().into_iter().filter_map(failed).collect(),
        })
    }

    /// The model as in `model.json`, without what an identification adds; numbers that are not finite become null.
    pub fn to_json(&self) -> Value {
        let branch = |f: &Friction| -> Value {
            Term::ALL.iter().map(|term| (term.name().to_string(), json!(f[*term]))).collect::<Map<_, _>>().into()
        };
        let mut combination = json!({ "kind": self.combination.name() });
        match self.combination {
            Combination::Arctan { k, p } => (combination["k"], combination["p"]) = (json!(k), json!(p)),
            Combination::Power { n } => combination["n"] = json!(n),
            Combination::Sign | Combination::Linear => {}
        }
        let mut joint = json!({
            "name": self.joint.name,
            "winch_radius_m": self.joint.winch_radius_m,
            "pulley_radius_m": self.joint.pulley_radius_m,
            "backlash_m": self.joint.backlash_m,
        });
        if self.joint.kind != JointKind::Revolute {
            joint["kind"] = json!(self.joint.kind.name());
        }
        if self.joint.drive != Drive::Cable {
            joint["drive"] = json!(self.joint.drive.name());
        }
        let mut dynamics = json!({
            "gravity_nm": self.dynamics.gravity_nm,
            "inertia_kg_m2": self.dynamics.inertia_kg_m2,
        });
        if self.dynamics.position_zero_rad != 0.0 {
            dynamics["position_zero_rad"] = json!(self.dynamics.position_zero_rad);
        }
        if !self.dynamics.payload.is_none() {
            let numbers = Payload::<f64>::NAMES.into_iter().zip(self.dynamics.payload.numbers());
            dynamics["payload"] =
                numbers.map(|(name, value)| (name.to_string(), json!(value))).collect::<Map<_, _>>().into();
        }
        if let Some(ChainName { urdf, joint }) = &self.chain {
            (dynamics["urdf"], dynamics["joint"]) = (json!(urdf), json!(joint));
        }
        let confidence: Map<String, Value> = self.confidence.iter().map(|(n, c)| (n.clone(), c.to_json())).collect();
        let mut all = json!({
            "format": FORMAT,
            "joint": joint,
            "dynamics": dynamics,
            "friction": { "up": branch(&self.friction.up), "down": branch(&self.friction.down) },
            "combination": combination,
            "effects": self.effects.iter().map(Added::to_json).collect::<Vec<Value>>(),
            "confidence": confidence,
        });
        if !self.functions.is_empty() {
            all["functions"] = self.functions.to_json();
        }
        all
    }
}

/// A curve that an identification fitted beside the one that its model took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedCurve {
    /// With its parameter.
    pub curve: Combination,
    /// The clearance fitted along with it, m.
    pub backlash_m: f64,
}

/// The curves with a parameter that the model's `file` lists under `combinations`; empty where none was fitted.
///
/// Errors: the file cannot be read, or an entry is no curve.
pub fn recorded_curves(file: &Path) -> Result<Vec<RecordedCurve>> {
    let document = Document::open(file)?;
    document.read(|root| {
        root.keys().for_each(|key| root.may(key).ignore());
        let one = |name: &str, s: &Section| {
            s.keys().for_each(|key| s.may(key).ignore());
            let (parameter, backlash_m) = (s.may("parameter").positive(), s.may("backlash_m").not_negative());
            let curve = match name {
                "arctan" => Combination::arctan(parameter?),
                "power" => Combination::Power { n: parameter? },
                _ => return None,
            };
            Some(RecordedCurve { curve, backlash_m: backlash_m? })
        };
        Some(root.may("combinations").sections_by_name(one).unwrap_or_default().into_values().collect())
    })
}

impl Added {
    /// The effect as in `model.json`.
    pub fn to_json(&self) -> Value {
        let parameters: Map<String, Value> = self.named().map(|(p, x)| (p.name.to_string(), json!(x))).collect();
        json!({ "id": self.id(), "parameters": parameters })
    }
}

impl Confidence {
    fn to_json(self) -> Value {
        json!({ "low": self.low, "high": self.high, "cv": self.cv, "status": self.status.name() })
    }
}

/// A branch; its rates must make the exponentials decay with speed in its own direction.
fn read_payload(s: &Section, has_chain: bool) -> Option<Payload> {
    let [mass_kg, x, y, z, inertia_kg_m2] = Payload::<f64>::NAMES.map(|name| s.need(name).number());
    if !has_chain {
        let cure =
            "delete it and give gravity_nm and inertia_kg_m2 with the payload on, or name the URDF and the joint in it";
        s.reject("mass_kg", "is a payload on a joint that moves alone", cure);
    }
    Some(Payload::of([mass_kg?, x?, y?, z?, inertia_kg_m2?]))
}

fn read_friction(s: &Section, direction: Direction) -> Option<Friction> {
    let values = Term::ALL.map(|term| (term, s.need(term.name()).number()));
    let mut friction = Friction::default();
    for (term, value) in values {
        if term == Term::Load && value.is_some_and(|mu| mu >= 1.0) {
            s.reject(term.name(), "leaves nothing of the tension", "a friction coefficient is below 1");
        } else if term.is_rate() && value.is_some_and(|rate| rate * direction.sign() < 0.0) {
            let sign = if direction == Direction::Up { "positive" } else { "negative" };
            s.reject(term.name(), "grows with speed", format!("on `{}` it is {sign}", direction.name()));
        }
    }
    for (term, value) in values {
        friction[term] = value?;
    }
    Some(friction)
}

fn read_combination(s: &Section) -> Option<Combination> {
    let kind = s.need("kind").choice(&["sign", "linear", "arctan", "power"].map(|name| (name, name)))?;
    match kind {
        "sign" => Some(Combination::Sign),
        "linear" => Some(Combination::Linear),
        "arctan" => {
            let (k, p) = (s.need("k").positive(), s.need("p").positive());
            Some(Combination::Arctan { k: k?, p: p? })
        }
        _ => Some(Combination::Power { n: s.need("n").positive()? }),
    }
}

/// One effect: its name, and a number for each of its parameters; a form or a shape that a file does not know is the default.
fn read_effect(s: &Section) -> Option<Added> {
    let effect = s.need("id").choice(&LIBRARY.map(|effect| (effect.about().id, effect)))?;
    let one = |s: &Section, parameter: &Parameter| {
        let value = match parameter.role {
            Role::Form | Role::Shape if parameter.default.is_some() => {
                s.may(parameter.name).number().or(parameter.default)
            }
            _ => s.need(parameter.name).number(),
        }?;
        if !parameter.allows(value) {
            let (low, high) = parameter.bounds;
            s.reject(parameter.name, format!("is {value}"), format!("expected {low} to {high}"));
        }
        Some(value)
    };
    let parameters = s.need("parameters").section(|s| {
        let values: Vec<Option<f64>> = effect.about().parameters.iter().map(|p| one(s, p)).collect();
        values.into_iter().collect::<Option<Vec<f64>>>()
    });
    Some(Added { effect, parameters: parameters? })
}

fn read_confidence(s: &Section) -> Option<Confidence> {
    let low = s.may("low").number().unwrap_or(f64::NEG_INFINITY);
    let high = s.may("high").number().unwrap_or(f64::INFINITY);
    let cv = s.may("cv").number().unwrap_or(f64::INFINITY);
    let status = s.need("status").choice(&Status::ALL.map(|status| (status.name(), status)))?;
    Some(Confidence { low, high, cv, status })
}
