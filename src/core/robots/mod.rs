//! A robot's description -> the model of one of its joints: what a URDF or a MuJoCo XML says of friction, gravity and inertia.
//!
//! The joint is driven directly: r1 = r2 = 1 m, torques are the joint's. Friction is the simulator's: a constant and a viscous term
//! alike in both directions. Gravity and inertia are those of all bodies that the joint carries, the other joints at 0.
//!
//! | file | what it reads |
//! |---|---|
//! | `urdf` | URDF: `<dynamics friction damping>`, the chain |
//! | `mjcf` | MuJoCo XML: frictionloss, damping, armature, stiffness, the bodies |
//! | `xml` | a tree of elements, bounded |

mod mjcf;
mod urdf;
mod xml;

use crate::dynamics::JointKind;
use crate::effects::linear_spring;
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::path::Path;

/// What a description says of one joint; for a slide N and m.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Constant friction, N m.
    pub friction_nm: f64,
    /// Viscous friction, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Inertia about the joint, N m s^2/rad.
    pub inertia_kg_m2: f64,
    /// Torque that holds the joint at 0 and at a quarter turn, N m; of a slide at 0 twice.
    pub gravity_nm: (f64, f64),
    /// Stiffness of a spring, N m/rad, and where it rests, rad.
    pub spring: Option<(f64, f64)>,
    /// What the description does not say.
    pub unknown: Vec<String>,
}

/// Reads joint `joint` of `file`: a URDF or a MuJoCo XML, as its outermost element says.
///
/// Errors: it cannot be read, is neither, or has no such joint.
pub fn read(file: &Path, joint: &str) -> Result<Described> {
    let root = xml::read(file)?;
    match root.name.as_str() {
        "robot" => urdf::described(file, &root, joint),
        "mujoco" => mjcf::described(file, &xml::with_included(root, file)?, joint),
        other => {
            let what = format!("begins with <{}>", crate::limits::shown(other));
            Problem::error(file, what, "expected a URDF (<robot>) or a MuJoCo XML (<mujoco>)").alone()
        }
    }
}

impl Described {
    /// As `model.json`, with what is unknown listed under `provenance`.
    pub fn to_json(&self) -> Value {
        let (at_0, at_90) = self.gravity_nm;
        let is_angle = self.kind == JointKind::Revolute;
        // G(q) = a sin(q) + b cos(q) = M sin(q + z).
        let (gravity_nm, zero_rad) = if is_angle { (at_0.hypot(at_90), at_0.atan2(at_90)) } else { (at_0, 0.0) };
        let branch = |sense: f64| {
            json!({
                "mu_c": 0.0, "a_j": sense * self.friction_nm, "b_c": 0.0, "c_c": sense * 100.0, "b_j": 0.0, "c_j": sense * 10.0,
                "d": self.damping_nm_s_rad,
            })
        };
        let mut joint = json!({
            "name": self.name, "drive": "direct", "winch_radius_m": 1.0, "pulley_radius_m": 1.0, "backlash_m": 0.0,
        });
        if !is_angle {
            joint["kind"] = json!(self.kind.name());
        }
        let mut dynamics = json!({ "gravity_nm": gravity_nm, "inertia_kg_m2": self.inertia_kg_m2 });
        if zero_rad != 0.0 {
            dynamics["position_zero_rad"] = json!(zero_rad);
        }
        let spring = self.spring.map(|(stiffness, rest)| linear_spring(stiffness, rest).to_json());
        json!({
            "format": "model/1",
            "joint": joint,
            "dynamics": dynamics,
            "friction": { "up": branch(1.0), "down": branch(-1.0) },
            "combination": { "kind": "sign" },
            "effects": spring.into_iter().collect::<Vec<Value>>(),
            "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "unknown": self.unknown },
        })
    }
}
