//! A joint of a URDF: `<dynamics>` for its friction, the chain for gravity and inertia.

use super::Described;
use super::xml::Node;
use crate::dynamics::{Chain, JointKind, Motion};
use crate::problem::Result;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

pub(super) fn described(file: &Path, root: &Node, joint: &str) -> Result<Described> {
    // The chain reports a joint that does not exist.
    let chain = Chain::read(file, joint)?;
    let kind = chain.kind();
    let others = vec![Motion::default(); chain.others().count()];
    let gravity = |position| chain.torque(Motion { position, ..Motion::default() }, &others).gravity_nm;
    let moved = chain.torque(Motion { acceleration: 1.0, ..Motion::default() }, &others);
    let at_90 = if kind == JointKind::Revolute { gravity(FRAC_PI_2) } else { gravity(0.0) };
    let found = root.all("joint").find(|node| node.text("name") == Some(joint));
    let dynamics = found.and_then(|node| node.all("dynamics").next());
    let number = |key: &str| dynamics?.numbers(key)?.first().copied();
    let (friction, damping) = (number("friction"), number("damping"));
    let mut unknown = vec!["joint.backlash_m: a URDF knows no clearance".to_string()];
    if friction.is_none() {
        unknown.push("friction.*.a_j: no <dynamics friction>".to_string());
    }
    if damping.is_none() {
        unknown.push("friction.*.d: no <dynamics damping>".to_string());
    }
    unknown.push("dynamics.inertia_kg_m2: a rotor's inertia is not in a URDF".to_string());
    Ok(Described {
        name: joint.to_string(),
        kind,
        friction_nm: friction.unwrap_or(0.0),
        damping_nm_s_rad: damping.unwrap_or(0.0),
        inertia_kg_m2: moved.inertia_nm,
        gravity_nm: (gravity(0.0), at_90),
        spring: None,
        unknown,
    })
}
