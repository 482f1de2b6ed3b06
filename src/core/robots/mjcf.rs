//! A joint of a MuJoCo XML (MuJoCo documentation, XML reference): frictionloss, damping, armature, stiffness and springref of the joint,
//! defaults and classes applied; gravity and inertia of the bodies that it carries, all joints at 0.
//!
//! A body's mass is its `<inertial>`; without one that of its geoms as far as they name a `mass`, as points. Masses that MuJoCo would
//! compute from shapes and density, and frames, are not read, and told.

use super::Described;
use super::xml::Node;
use crate::document::suggest;
use crate::dynamics::{GRAVITY_M_S2, JointKind};
use crate::problem::{Problem, Result};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::path::Path;

/// A body that the joint carries.
struct Mass {
    kg: f64,
    /// Centre of mass in the world, m.
    centre_m: Vector3<f64>,
    /// About it, in the world's axes, kg m^2.
    inertia_kg_m2: Matrix3<f64>,
}

/// The joint where it was found.
struct Place<'n> {
    node: &'n Node,
    /// Names of the default classes that apply, the nearest first.
    class: Option<String>,
    /// Its anchor and axis in the world.
    anchor_m: Vector3<f64>,
    axis: Vector3<f64>,
    masses: Vec<Mass>,
}

struct Reader<'n> {
    root: &'n Node,
    joint: &'n str,
    /// Degrees, unless the compiler says radians.
    angle: f64,
    names: Vec<String>,
    unknown: Vec<String>,
}

pub(super) fn described(file: &Path, root: &Node, joint: &str) -> Result<Described> {
    let is_radian = root.all("compiler").any(|node| node.text("angle") == Some("radian"));
    let angle = if is_radian { 1.0 } else { 1f64.to_radians() };
    let mut reader = Reader { root, joint, angle, names: Vec::new(), unknown: Vec::new() };
    let world = root.all("worldbody").next();
    let found = world.and_then(|world| reader.body(world, Rotation3::identity(), Vector3::zeros(), None).1);
    let Some(place) = found else {
        let cure = suggest(joint, "it has", reader.names.iter().map(String::as_str));
        return Problem::error(file, format!("has no joint `{}`", crate::limits::shown(joint)), cure).alone();
    };
    let number = |key: &str| reader.number(&place, key);
    let kind = match reader.attribute(&place, "type").as_deref() {
        None | Some("hinge") => JointKind::Revolute,
        Some("slide") => JointKind::Prismatic,
        Some(other) => {
            let what = format!("joint `{joint}` is a {other} joint");
            return Problem::error(file, what, "name a hinge or a slide").alone();
        }
    };
    let gravity = root.all("option").find_map(|node| node.numbers("gravity"));
    let gravity = vector(gravity.as_deref()).unwrap_or(Vector3::new(0.0, 0.0, -GRAVITY_M_S2));
    let Carried { inertia_kg_m2, gravity_nm } = carried(&place, kind, gravity);
    let inertia_kg_m2 = inertia_kg_m2 + number("armature").unwrap_or(0.0);
    let stiffness = number("stiffness").filter(|stiffness| *stiffness > 0.0);
    let rest = number("springref").unwrap_or(0.0) * if kind == JointKind::Revolute { angle } else { 1.0 };
    let (friction, damping) = (number("frictionloss"), number("damping"));
    let mut unknown = std::mem::take(&mut reader.unknown);
    unknown.push("joint.backlash_m: a MuJoCo joint knows no clearance".to_string());
    for (value, words) in [(friction, "friction.*.a_j: no frictionloss"), (damping, "friction.*.d: no damping")] {
        if value.is_none() {
            unknown.push(words.to_string());
        }
    }
    Ok(Described {
        name: joint.to_string(),
        kind,
        friction_nm: friction.unwrap_or(0.0),
        damping_nm_s_rad: damping.unwrap_or(0.0),
        inertia_kg_m2,
        gravity_nm,
        spring: stiffness.map(|stiffness| (stiffness, rest)),
        unknown,
    })
}

/// What a joint carries.
struct Carried {
    inertia_kg_m2: f64,
    /// Torque of gravity at 0 and at 90 deg.
    gravity_nm: (f64, f64),
}

/// Inertia and gravity of the masses at `place` about or along its axis.
fn carried(place: &Place<'_>, kind: JointKind, gravity: Vector3<f64>) -> Carried {
    let axis = place.axis;
    let (mut inertia_kg_m2, mut at_0, mut at_90) = (0.0, 0.0, 0.0);
    for mass in &place.masses {
        let arm = mass.centre_m - place.anchor_m;
        // The torque of gravity is the negative of the torque that holds the joint at rest.
        match kind {
            JointKind::Revolute => {
                let across = arm - axis * axis.dot(&arm);
                inertia_kg_m2 += axis.dot(&(mass.inertia_kg_m2 * axis)) + mass.kg * across.norm_squared();
                at_0 -= mass.kg * axis.dot(&arm.cross(&gravity));
                at_90 -= mass.kg * axis.dot(&axis.cross(&arm).cross(&gravity));
            }
            JointKind::Prismatic => {
                inertia_kg_m2 += mass.kg;
                at_0 -= mass.kg * axis.dot(&gravity);
                at_90 = at_0;
            }
        }
    }
    Carried { inertia_kg_m2, gravity_nm: (at_0, at_90) }
}

impl<'n> Reader<'n> {
    /// The masses of `node` and of all below it, and the joint if it is there.
    fn body(
        &mut self,
        node: &'n Node,
        rotation: Rotation3<f64>,
        origin_m: Vector3<f64>,
        class: Option<&str>,
    ) -> (Vec<Mass>, Option<Place<'n>>) {
        let rotation = rotation * self.orientation(node);
        let mut masses: Vec<Mass> = self.own_mass(node, rotation, origin_m).into_iter().collect();
        let class = node.text("childclass").or(class);
        let mut found: Option<Place<'n>> = None;
        for child in node.all("body") {
            let at = vector(child.numbers("pos").as_deref()).unwrap_or_default();
            let (below, inner) = self.body(child, rotation, origin_m + rotation * at, class);
            masses.extend(below);
            found = found.or(inner);
        }
        for joint in node.all("joint") {
            self.names.extend(joint.text("name").map(str::to_string));
            if joint.text("name") != Some(self.joint) {
                continue;
            }
            let at = vector(joint.numbers("pos").as_deref()).unwrap_or_default();
            let class = joint.text("class").or(class).map(str::to_string);
            let mut place = Place {
                node: joint,
                class,
                anchor_m: origin_m + rotation * at,
                axis: Vector3::z(),
                masses: Vec::new(),
            };
            let axis = self.attribute(&place, "axis").map(|text| numbers(&text));
            place.axis = rotation * vector(axis.as_deref()).unwrap_or(Vector3::z()).normalize();
            place.masses = std::mem::take(&mut masses);
            return (Vec::new(), Some(place));
        }
        (masses, found)
    }

    /// The rotation of an element in its parent.
    fn orientation(&mut self, node: &Node) -> Rotation3<f64> {
        let angle = self.angle;
        match (node.numbers("quat").as_deref(), node.numbers("axisangle").as_deref(), node.numbers("euler").as_deref())
        {
            (Some([w, x, y, z]), ..) => {
                UnitQuaternion::from_quaternion(Quaternion::new(*w, *x, *y, *z)).to_rotation_matrix()
            }
            (_, Some([x, y, z, turn]), _) => {
                let axis = nalgebra::Unit::new_normalize(Vector3::new(*x, *y, *z));
                Rotation3::from_axis_angle(&axis, angle * turn)
            }
            // Intrinsic rotations about x, y, z, one after the other, as the compiler has it by default.
            (_, _, Some([x, y, z])) => {
                Rotation3::from_axis_angle(&Vector3::x_axis(), angle * x)
                    * Rotation3::from_axis_angle(&Vector3::y_axis(), angle * y)
                    * Rotation3::from_axis_angle(&Vector3::z_axis(), angle * z)
            }
            _ => {
                if ["xyaxes", "zaxis"].iter().any(|key| node.text(key).is_some()) {
                    let name = node.text("name").unwrap_or("without name");
                    self.unknown
                        .push(format!("dynamics: the orientation of body `{name}` (xyaxes, zaxis) is not read"));
                }
                Rotation3::identity()
            }
        }
    }

    fn own_mass(&mut self, node: &Node, rotation: Rotation3<f64>, origin_m: Vector3<f64>) -> Vec<Mass> {
        let centre = |of: &Node| origin_m + rotation * vector(of.numbers("pos").as_deref()).unwrap_or_default();
        if let Some(inertial) = node.all("inertial").next() {
            let kg = inertial.numbers("mass").and_then(|mass| mass.first().copied()).unwrap_or(0.0);
            let turned = rotation * self.orientation(inertial);
            let local = match (inertial.numbers("diaginertia").as_deref(), inertial.numbers("fullinertia").as_deref()) {
                (Some([x, y, z]), _) => Matrix3::from_diagonal(&Vector3::new(*x, *y, *z)),
                (_, Some([xx, yy, zz, xy, xz, yz])) => Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz),
                _ => Matrix3::zeros(),
            };
            let inertia_kg_m2 = turned.matrix() * local * turned.matrix().transpose();
            return vec![Mass { kg, centre_m: centre(inertial), inertia_kg_m2 }];
        }
        let mut masses = Vec::new();
        let name = node.text("name").unwrap_or("without name");
        for geom in node.all("geom").filter(|_| node.name == "body") {
            match geom.numbers("mass").as_deref() {
                Some([kg]) => {
                    masses.push(Mass { kg: *kg, centre_m: centre(geom), inertia_kg_m2: Matrix3::zeros() });
                    self.unknown.push(format!("dynamics.inertia_kg_m2: a geom of body `{name}` counts as a point; give the body an <inertial>"));
                }
                _ => self.unknown.push(format!(
                    "dynamics: the mass of a geom of body `{name}`, which MuJoCo takes from its shape and density; give the body an <inertial>"
                )),
            }
        }
        masses
    }

    /// An attribute of the joint, or what the defaults of its class and those above say.
    fn attribute(&self, place: &Place<'_>, key: &str) -> Option<String> {
        let own = place.node.text(key).map(str::to_string);
        own.or_else(|| {
            // Included files bring a <default> of their own: classes of all, the outermost of each.
            let tops = || self.root.all("default");
            let of_class = place.class.as_deref().and_then(|class| tops().find_map(|top| path_to(top, class)));
            let path = tops().chain(of_class.into_iter().flatten()).collect::<Vec<&Node>>();
            path.iter().rev().find_map(|node| node.all("joint").find_map(|joint| joint.text(key)).map(str::to_string))
        })
    }

    fn number(&self, place: &Place<'_>, key: &str) -> Option<f64> {
        numbers(&self.attribute(place, key)?).first().copied()
    }
}

/// The defaults from the outermost to those of `class`.
fn path_to<'n>(node: &'n Node, class: &str) -> Option<Vec<&'n Node>> {
    if node.text("class") == Some(class) {
        return Some(vec![node]);
    }
    node.all("default").find_map(|child| {
        let below = path_to(child, class)?;
        Some(std::iter::once(node).chain(below).collect())
    })
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn vector(numbers: Option<&[f64]>) -> Option<Vector3<f64>> {
    match numbers {
        Some([x, y, z]) => Some(Vector3::new(*x, *y, *z)),
        _ => None,
    }
}
