//! A URDF -> the bodies that matter for one of its joints.
//!
//! Only a joint's ancestors (their motion carries it) and descendants (they hang on it) matter; other branches of the tree
//! need neither inertia nor a recorded position. Transmissions, limits, damping and friction of the file are not read: friction
//! is what the model is for.

use super::JointKind;
use super::chain::{Body, Chain, Freedom};
use crate::document::{bytes, suggest};
use crate::limits::{URDF_BYTES, URDF_DEPTH, URDF_ELEMENTS};
use crate::problem::{Problem, Problems, Result};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use quick_xml::Reader;
use quick_xml::events::Event;
use std::path::Path;
use urdf_rs::{JointType, Link, Pose, Robot};

/// An axis shorter than this is no direction.
const AXIS_MIN: f64 = 1e-6;

impl Chain {
    /// Reads the bodies that matter for `joint` from the URDF in `file`.
    ///
    /// Errors: the file cannot be read; it has no such joint; a joint that matters is of a kind not known here (floating,
    /// planar); a link's inertia is not physical; the joints form no tree.
    pub fn read(file: &Path, joint: &str) -> Result<Self> {
        let text = String::from_utf8(bytes(file, URDF_BYTES)?).or_else(|_| {
            Problem::error(file, "holds bytes that are no UTF-8 text", "save the file as UTF-8").alone()
        })?;
        check_size(file, &text)?;
        let robot = urdf_rs::read_from_string(&text)
            .or_else(|error| Problem::error(file, format!("is no URDF: {error}"), "correct the file").alone())?;
        Tree { file, robot: &robot }.chain(joint)
    }
}

/// Errors: elements too many or too deep in each other for the parser, which recurses; a document type, whose entities could
/// expand without bound; broken syntax.
fn check_size(file: &Path, text: &str) -> Result<()> {
    let mut reader = Reader::from_str(text);
    let (mut depth, mut elements) = (0usize, 0usize);
    loop {
        let event = reader.read_event();
        let row = || {
            let before = text.as_bytes().iter().take(reader.buffer_position() as usize);
            1 + before.filter(|byte| **byte == b'\n').count() as u64
        };
        match event {
            Ok(Event::Eof) => return Ok(()),
            Ok(Event::Start(_)) => (depth, elements) = (depth + 1, elements + 1),
            Ok(Event::Empty(_)) => elements += 1,
            Ok(Event::End(_)) => depth = depth.saturating_sub(1),
            Ok(Event::DocType(_)) => {
                let cure = "delete the line: a URDF needs none";
                return Problem::error(file, "declares a document type", cure).at_row(row()).alone();
            }
            Ok(_) => {}
            Err(error) => {
                return Problem::error(file, format!("is no URDF: {error}"), "correct the file").at_row(row()).alone();
            }
        }
        if depth > URDF_DEPTH || elements > URDF_ELEMENTS {
            let (what, cure) = match depth > URDF_DEPTH {
                true => (format!("nests more than {URDF_DEPTH} elements"), "close each element"),
                false => (format!("has more than {URDF_ELEMENTS} elements"), "keep the links and joints of this robot"),
            };
            return Problem::error(file, what, cure).at_row(row()).alone();
        }
    }
}

struct Tree<'a> {
    file: &'a Path,
    robot: &'a Robot,
}

impl Tree<'_> {
    fn chain(&self, joint: &str) -> Result<Chain> {
        let joints = &self.robot.joints;
        let Some(named) = joints.iter().position(|j| j.name == joint) else {
            let movable = joints.iter().filter(|j| j.joint_type != JointType::Fixed).map(|j| j.name.as_str());
            let cure = suggest(joint, "its movable joints are", movable);
            return Problem::error(self.file, format!("has no joint `{joint}`"), cure).alone();
        };
        if joints[named].joint_type == JointType::Fixed {
            let what = format!("joint `{joint}` is fixed");
            return Problem::error(self.file, what, "name a joint that moves").alone();
        }
        let order = self.order(named)?;
        let mut problems = Vec::new();
        let mut bodies = Vec::with_capacity(order.len());
        for at in &order {
            let parent_link = &joints[*at].parent.link;
            let parent = order.iter().position(|other| joints[*other].child.link == *parent_link);
            match self.body(*at, parent) {
                Ok(body) => bodies.push(body),
                Err(Problems(found)) => problems.extend(found),
            }
        }
        let at = order.iter().position(|at| *at == named).unwrap_or(0);
        // What hangs on the joint stands behind it in the order.
        if problems.is_empty() && bodies[at..].iter().all(|body| body.mass_kg == 0.0) {
            let what = format!("nothing that hangs on joint `{joint}` has a mass");
            return Problem::error(self.file, what, "add <inertial> with mass, origin and inertia to its links")
                .alone();
        }
        Problems(problems).unless_errors(Chain::new(bodies, at))
    }

    /// The joints from the root to `named` and all below it, parents before children.
    fn order(&self, named: usize) -> Result<Vec<usize>> {
        let joints = &self.robot.joints;
        let mut order = vec![named];
        // Up to the root: each step finds the joint that carries the parent link.
        while let Some(carrier) = joints.iter().position(|j| j.child.link == joints[order[0]].parent.link) {
            if order.contains(&carrier) {
                return self.no_tree(&joints[carrier].name);
            }
            order.insert(0, carrier);
        }
        let mut next = order.len() - 1;
        while next < order.len() {
            let link = &joints[order[next]].child.link;
            for (at, below) in joints.iter().enumerate().filter(|(_, j)| j.parent.link == *link) {
                if order.contains(&at) {
                    return self.no_tree(&below.name);
                }
                order.push(at);
            }
            next += 1;
        }
        Ok(order)
    }

    fn no_tree<T>(&self, joint: &str) -> Result<T> {
        let what = format!("joint `{joint}` closes a loop");
        Problem::error(self.file, what, "give a chain or a tree, each link with one parent").alone()
    }

    fn body(&self, at: usize, parent: Option<usize>) -> Result<Body> {
        let joint = &self.robot.joints[at];
        let fault = |what: String, cure: &str| Problem::error(self.file, what, cure).in_column(&joint.name).alone();
        let freedom = match joint.joint_type {
            JointType::Fixed => Freedom::Fixed,
            JointType::Revolute | JointType::Continuous => Freedom::Moves(JointKind::Revolute),
            JointType::Prismatic => Freedom::Moves(JointKind::Prismatic),
            ref other => {
                return fault(
                    format!("is a {other:?} joint"),
                    "only revolute, continuous, prismatic and fixed are known",
                );
            }
        };
        let axis = Vector3::from(joint.axis.xyz.0);
        let axis = match Unit::try_new(axis, AXIS_MIN) {
            Some(axis) => axis,
            None if freedom == Freedom::Fixed => Vector3::x_axis(),
            None => return fault("its axis has no length".to_string(), "write a direction, as in xyz=\"0 1 0\""),
        };
        let Some(link) = self.robot.links.iter().find(|link| link.name == joint.child.link) else {
            return fault(format!("its child link `{}` is missing", joint.child.link), "add the link");
        };
        let (rotation, origin_m) = placed(&joint.origin);
        let (mass_kg, moment_kg_m, inertia_kg_m2) = self.inertia(link)?;
        Ok(Body {
            name: joint.name.clone(),
            parent,
            freedom,
            axis,
            rotation,
            origin_m,
            mass_kg,
            moment_kg_m,
            inertia_kg_m2,
        })
    }

    /// Mass, its first moment and its inertia about the origin of the link's frame.
    fn inertia(&self, link: &Link) -> Result<(f64, Vector3<f64>, Matrix3<f64>)> {
        let (rotation, centre_m) = placed(&link.inertial.origin);
        let i = &link.inertial.inertia;
        let own = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
        let inertia_kg_m2 = rotation.matrix() * own * rotation.matrix().transpose();
        let mass_kg = link.inertial.mass.value;
        let finite = mass_kg.is_finite() && centre_m.iter().chain(inertia_kg_m2.iter()).all(|x| x.is_finite());
        if !finite || mass_kg < 0.0 || inertia_kg_m2.symmetric_eigenvalues().min() < -1e-9 * inertia_kg_m2.norm() {
            let what = format!("mass {mass_kg} kg or inertia of link `{}` is not physical", link.name);
            let cure = "a mass is 0 or more, and no principal moment of inertia is negative";
            return Problem::error(self.file, what, cure).in_column(&link.name).alone();
        }
        // Parallel axes.
        let about_origin = Matrix3::from_diagonal_element(centre_m.norm_squared()) - centre_m * centre_m.transpose();
        Ok((mass_kg, mass_kg * centre_m, inertia_kg_m2 + mass_kg * about_origin))
    }
}

/// URDF's rpy turns about the fixed x, then y, then z axis.
fn placed(pose: &Pose) -> (Rotation3<f64>, Vector3<f64>) {
    let [roll, pitch, yaw] = pose.rpy.0;
    (Rotation3::from_euler_angles(roll, pitch, yaw), Vector3::from(pose.xyz.0))
}
