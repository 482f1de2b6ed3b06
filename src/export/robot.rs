//! The joint of a MuJoCo XML or of a URDF: all that such a joint can be is a constant friction, a viscous one, an added inertia
//! and (MuJoCo) a spring, the same in both directions and under any load.

use super::plain_name;
use crate::dynamics::{JointKind, Motion};
use crate::effects::{Added, Family, Sample, SimulatorJoint};
use crate::model::{Direction, Model, loss};
use crate::problem::{visible, visible_lines};
use std::f64::consts::FRAC_PI_2;

/// Speeds and positions at which the likeness is judged.
const SPEEDS: usize = 40;
const POSITIONS: usize = 10;

/// The simple joint that is most like a model's, in torques at the joint; for a prismatic one N, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeness {
    /// Constant friction, N m.
    pub friction_nm: f64,
    /// Viscous friction, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Inertia that the body's own does not hold, kg m^2.
    pub armature_kg_m2: f64,
    /// Of a spring, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Where the spring rests, rad.
    pub spring_rests_rad: f64,
    /// What the model's friction has beyond it at constant speed, root mean square, N m.
    pub left_nm: f64,
    /// What the model's friction is there, root mean square, N m.
    pub whole_nm: f64,
    /// What it cannot hold, a sentence each.
    pub lacks: Vec<String>,
}

/// Speed, direction and what the model's friction is there, N m at the joint.
struct Point {
    speed_rad_s: f64,
    sign: f64,
    friction_nm: f64,
}

impl Likeness {
    /// Of `model`, judged at constant speeds between the two `speeds_rad_s`, hanging to level under its own weight.
    pub fn of(model: &Model, speeds_rad_s: (f64, f64)) -> Self {
        let sum = |of: fn(SimulatorJoint) -> f64| model.effects.iter().filter_map(held).map(of).sum::<f64>();
        let (stiffness, preload) = (sum(|joint| joint.stiffness_nm_rad), sum(|joint| joint.preload_nm));
        let points = points(model, speeds_rad_s);
        let (friction_nm, damping_nm_s_rad) = line(&points);
        let rms = |of: &dyn Fn(&Point) -> f64| {
            (points.iter().map(|p| of(p).powi(2)).sum::<f64>() / points.len().max(1) as f64).sqrt()
        };
        let simple_nm = |p: &Point| p.sign * (friction_nm + damping_nm_s_rad * p.speed_rad_s);
        Self {
            friction_nm,
            damping_nm_s_rad,
            armature_kg_m2: sum(|joint| joint.inertia_kg_m2).max(0.0),
            stiffness_nm_rad: stiffness,
            spring_rests_rad: if stiffness == 0.0 { 0.0 } else { -preload / stiffness },
            left_nm: rms(&|p| p.friction_nm - simple_nm(p)),
            whole_nm: rms(&|p| p.friction_nm),
            lacks: lacks(model, &points),
        }
    }
}

/// What a simulator's joint holds of an effect.
fn held(added: &Added) -> Option<SimulatorJoint> {
    added.effect.in_simulator(&added.parameters)
}

/// The model's friction, its spring and inertia left out, over speeds, directions and positions.
fn points(model: &Model, (slow, fast): (f64, f64)) -> Vec<Point> {
    let mut model = model.clone();
    model.effects.retain(|e| held(e).is_none() && e.effect.about().family != Family::Outside);
    let turns = model.joint.kind == JointKind::Revolute;
    let reach = if turns { FRAC_PI_2 } else { 0.0 };
    let mut points = Vec::new();
    for at in 0..SPEEDS * POSITIONS {
        let (s, p) = ((at / POSITIONS) as f64 / (SPEEDS - 1) as f64, (at % POSITIONS) as f64 / (POSITIONS - 1) as f64);
        let (speed_rad_s, position) = (slow + s * (fast - slow), reach * p);
        let asked = model.asked_alone(Motion { position, ..Motion::default() }, 0.0);
        for direction in Direction::BOTH {
            let sign = direction.sign();
            let own = Motion { position, velocity: sign * speed_rad_s, acceleration: 0.0 };
            let sample = Sample { time_s: 0.0, elapsed_s: 0.0, own, others: &[] };
            let y_nm = model.driven_nm(&sample, asked, (sign + 1.0) / 2.0).torque_nm;
            let friction_nm = y_nm / model.joint.transmission() - asked.torque_nm;
            points.push(Point { speed_rad_s, sign, friction_nm });
        }
    }
    points
}

/// The constant and the slope nearest to all points, neither below zero.
fn line(points: &[Point]) -> (f64, f64) {
    let n = points.len().max(1) as f64;
    let mean = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (speed, resists) = (mean(&|p| p.speed_rad_s), mean(&|p| p.sign * p.friction_nm));
    let across = mean(&|p| (p.speed_rad_s - speed) * (p.sign * p.friction_nm - resists));
    let square = mean(&|p| (p.speed_rad_s - speed).powi(2));
    let slope = if square > 0.0 { (across / square).max(0.0) } else { 0.0 };
    match resists - slope * speed {
        constant if constant >= 0.0 => (constant, slope),
        _ => (0.0, (mean(&|p| p.sign * p.friction_nm * p.speed_rad_s) / mean(&|p| p.speed_rad_s.powi(2))).max(0.0)),
    }
}

fn lacks(model: &Model, points: &[Point]) -> Vec<String> {
    let unit = if model.joint.kind == JointKind::Revolute { "N m" } else { "N" };
    let mut lacks = Vec::new();
    let aside_nm = points.iter().map(|p| p.friction_nm).sum::<f64>() / points.len().max(1) as f64;
    lacks.push(format!(
        "friction that differs between moving up and down: on average {aside_nm:.3} {unit} at the joint to one side"
    ));
    let (up, down) = (&model.friction.up, &model.friction.down);
    if up.mu_c != 0.0 || down.mu_c != 0.0 {
        let share = |mu: f64| 100.0 * (1.0 / loss(mu) - 1.0);
        lacks.push(format!(
            "friction that grows with the load: {:.0} % of it moving up, {:.0} % moving down",
            share(up.mu_c),
            share(down.mu_c)
        ));
    }
    if [up.b_c, up.b_j, down.b_c, down.b_j].iter().any(|b| *b != 0.0) {
        lacks.push("friction that falls as the joint begins to move (Stribeck)".to_string());
    }
    if model.backlash_m() > 0.0 {
        lacks.push(format!(
            "the change of friction over {:.2} mm of cable after a reversal: here it jumps",
            1e3 * model.backlash_m()
        ));
    }
    for e in model.effects.iter().filter(|e| held(e).is_none()) {
        lacks.push(format!("{}: {}", e.id(), e.effect.about().means));
    }
    lacks
}

/// A MuJoCo XML to be included: a class for the joint, a motor for its winch.
pub fn mujoco_xml(model: &Model, like: &Likeness, source: &str) -> String {
    let name = plain_name(model);
    let spring = match like.stiffness_nm_rad {
        0.0 => String::new(),
        k => format!(" stiffness=\"{k:?}\" springref=\"{:?}\"", like.spring_rests_rad),
    };
    let gear = 1.0 / model.joint.transmission();
    format!(
        "<!--\n{}\n  Use it: include this file, give the joint class=\"{name}\" and its motor class=\"{name}\";\n  \
         the motor's control is then the torque at the winch. The spring's rest is in the unit of compiler angle: rad here.\n-->\n\
         <mujoco>\n  <default>\n    <default class=\"{name}\">\n      \
         <joint damping=\"{:?}\" frictionloss=\"{:?}\" armature=\"{:?}\"{spring}/>\n      \
         <motor gear=\"{gear:?}\"/>\n    </default>\n  </default>\n</mujoco>\n",
        remark(model, like, source, true),
        like.damping_nm_s_rad,
        like.friction_nm,
        like.armature_kg_m2,
    )
}

/// A URDF's `<dynamics>`, to be put into the joint.
pub fn urdf_xml(model: &Model, like: &Likeness, source: &str) -> String {
    let remark = remark(model, like, source, false);
    let (damping, friction) = (like.damping_nm_s_rad, like.friction_nm);
    format!("<!--\n{remark}\n-->\n<dynamics damping=\"{damping:?}\" friction=\"{friction:?}\"/>\n")
}

/// What the numbers are and what they are not.
fn remark(model: &Model, like: &Likeness, source: &str, has_springs: bool) -> String {
    let unit = if model.joint.kind == JointKind::Revolute { "N m" } else { "N" };
    let mut lines = vec![
        format!(
            "  {}, from {}: constant and viscous friction at the joint that come nearest to the model's.",
            visible(&model.joint.name),
            visible(source)
        ),
        format!(
            "  At constant speed they leave {:.3} of {:.3} {unit} (root mean square).",
            like.left_nm, like.whole_nm
        ),
        "  What this joint cannot hold:".to_string(),
    ];
    lines.extend(like.lacks.iter().map(|lack| format!("  - {lack}")));
    if !has_springs && like.stiffness_nm_rad != 0.0 {
        lines.push("  - a spring about the joint".to_string());
    }
    if !has_springs && like.armature_kg_m2 != 0.0 {
        lines.push(format!("  - {} kg m^2 of inertia beyond the link's: add it to the link", like.armature_kg_m2));
    }
    // Two dashes end a comment in XML.
    visible_lines(&lines.join("\n")).replace("--", "- -").replace("--", "- -")
}
