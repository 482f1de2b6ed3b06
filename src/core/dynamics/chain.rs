//! Inverse dynamics of a chain of rigid bodies: one joint's row of M a + C v + G (1), the others moving.
//!
//! Recursive Newton-Euler in body frames (Featherstone 2008, section 5.3; Craig 2005, section 6.5): outwards the motion of
//! each body, inwards the force and moment that each joint must carry. Gravity enters as an upward acceleration of the base.
//! Bodies are rigid and joints ideal; rotors' inertia is not in a URDF and so not here.

use super::{JointKind, NUMBERS, Payload};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Standard gravity as Pinocchio and most simulators have it, m/s^2, along -z of the root.
pub const GRAVITY_M_S2: f64 = 9.81;

/// Half the step over which gravity's slope is taken, rad: the error of the central difference is then below 1e-8 of gravity.
const SLOPE_STEP_RAD: f64 = 1e-4;

/// How a joint lets its body move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Freedom {
    /// Not at all.
    Fixed,
    /// About or along its axis.
    Moves(JointKind),
}

/// One body with the joint that carries it; vectors in the body's own frame unless said otherwise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    /// The joint's name.
    pub name: String,
    /// The body that carries the joint; `None` for the root link, which rests.
    pub parent: Option<usize>,
    pub freedom: Freedom,
    pub axis: Unit<Vector3<f64>>,
    /// Of the joint's frame in the parent's, at rest position.
    pub rotation: Rotation3<f64>,
    /// The joint's origin in the parent's frame, m.
    pub origin_m: Vector3<f64>,
    pub mass_kg: f64,
    /// First moment of mass about the frame's origin, kg m.
    pub moment_kg_m: Vector3<f64>,
    /// About the frame's origin, kg m^2.
    pub inertia_kg_m2: Matrix3<f64>,
}

/// The bodies that matter for one joint, parents before children.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    bodies: Vec<Body>,
    /// The joint whose torque is wanted.
    joint: usize,
}

/// Where a joint is and how it moves: rad, rad/s, rad/s^2; for a prismatic joint m, m/s, m/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion<S = f64> {
    /// Position.
    pub position: S,
    /// Velocity.
    pub velocity: S,
    /// Acceleration.
    pub acceleration: S,
}

/// A joint's row of the equation of motion, N m (N for a prismatic joint).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigidTorque {
    /// G: what holds the joint at rest.
    pub gravity_nm: f64,
    /// M a: what accelerates it and the other joints.
    pub inertia_nm: f64,
    /// C v: Coriolis and centrifugal.
    pub coriolis_nm: f64,
}

impl RigidTorque {
    /// M a + C v + G.
    pub fn total_nm(&self) -> f64 {
        self.gravity_nm + self.inertia_nm + self.coriolis_nm
    }
}

/// What the recursion knows of one body.
#[derive(Clone, Copy)]
struct State {
    /// From the body's frame to its parent's.
    to_parent: Rotation3<f64>,
    /// Its origin in the parent's frame, m.
    origin_m: Vector3<f64>,
    velocity_rad_s: Vector3<f64>,
    acceleration_rad_s2: Vector3<f64>,
    /// Of its origin.
    acceleration_m_s2: Vector3<f64>,
    /// That the joint carries, at its origin.
    force_n: Vector3<f64>,
    moment_nm: Vector3<f64>,
}

impl Chain {
    pub(super) fn new(bodies: Vec<Body>, joint: usize) -> Self {
        Self { bodies, joint }
    }

    /// Name of the joint whose torque is wanted.
    pub fn joint(&self) -> &str {
        self.bodies.get(self.joint).map_or("", |body| &body.name)
    }

    /// How that joint moves.
    pub fn kind(&self) -> JointKind {
        match self.bodies.get(self.joint).map(|body| body.freedom) {
            Some(Freedom::Moves(kind)) => kind,
            _ => JointKind::Revolute,
        }
    }

    /// The other joints that move and matter, from the root outwards: the order that `torque` wants them in.
    pub fn others(&self) -> impl Iterator<Item = (&str, JointKind)> {
        let moving = self.bodies.iter().enumerate().filter(|(at, _)| *at != self.joint);
        moving.filter_map(|(_, body)| match body.freedom {
            Freedom::Moves(kind) => Some((body.name.as_str(), kind)),
            Freedom::Fixed => None,
        })
    }

    /// The joint's row of M a + C v + G in parts, with the joint at `own` and the others at `others`, in their order; others
    /// that are not given rest at zero.
    pub fn torque(&self, own: Motion, others: &[Motion]) -> RigidTorque {
        let motions = self.motions(own, others);
        let still = |m: &Motion| Motion { velocity: 0.0, acceleration: 0.0, ..*m };
        let coasting = |m: &Motion| Motion { acceleration: 0.0, ..*m };
        let pushed = |m: &Motion| Motion { velocity: 0.0, ..*m };
        let row = |change: &dyn Fn(&Motion) -> Motion, gravity_m_s2: f64| {
            self.newton_euler(&motions.iter().map(change).collect::<Vec<Motion>>(), gravity_m_s2)
        };
        RigidTorque {
            gravity_nm: row(&still, GRAVITY_M_S2),
            inertia_nm: row(&pushed, 0.0),
            coriolis_nm: row(&coasting, 0.0),
        }
    }

    /// How G changes with the joint's position at `position`, N m/rad, the others where they are.
    pub fn gravity_slope_nm_rad(&self, position: f64, others: &[Motion]) -> f64 {
        let gravity_nm = |position| {
            let mut motions = self.motions(Motion { position, ..Motion::default() }, others);
            motions.iter_mut().for_each(|m| (m.velocity, m.acceleration) = (0.0, 0.0));
            self.newton_euler(&motions, GRAVITY_M_S2)
        };
        (gravity_nm(position + SLOPE_STEP_RAD) - gravity_nm(position - SLOPE_STEP_RAD)) / (2.0 * SLOPE_STEP_RAD)
    }

    /// The same chain whose last link carries `payload` beyond its own mass.
    pub fn carrying(&self, payload: &Payload) -> Self {
        let mut chain = self.clone();
        if let Some(last) = chain.bodies.get_mut(self.last()) {
            last.mass_kg += payload.mass_kg;
            last.moment_kg_m += Vector3::from(payload.moment_kg_m);
            last.inertia_kg_m2 += Matrix3::from_diagonal_element(payload.inertia_kg_m2);
        }
        chain
    }

    /// Chains without any mass but one unit of each number of a payload in turn: the torque is in proportion to them.
    pub fn units_of_payload(&self) -> [Self; NUMBERS] {
        std::array::from_fn(|at| {
            let mut chain = self.clone();
            for body in &mut chain.bodies {
                (body.mass_kg, body.moment_kg_m, body.inertia_kg_m2) = (0.0, Vector3::zeros(), Matrix3::zeros());
            }
            chain.carrying(&Payload::of(std::array::from_fn(|other| if other == at { 1.0 } else { 0.0 })))
        })
    }

    /// How large each number of a payload may well be: what hangs on the joint, all as far from the last link as the joint is.
    pub fn size_of_payload(&self) -> Payload {
        let beyond = &self.bodies[self.joint.min(self.bodies.len())..];
        let mass_kg: f64 = beyond.iter().map(|body| body.mass_kg).sum();
        let ways = self.path(self.last()).into_iter().filter(|at| *at > self.joint);
        let between_m: f64 = ways.map(|at| self.bodies[at].origin_m.norm()).sum();
        let own_m = |body: &Body| if body.mass_kg > 0.0 { body.moment_kg_m.norm() / body.mass_kg } else { 0.0 };
        let reach_m = between_m + beyond.iter().map(own_m).fold(0.0, f64::max);
        Payload { mass_kg, moment_kg_m: [mass_kg * reach_m; 3], inertia_kg_m2: mass_kg * reach_m.powi(2) }
    }

    /// The body that carries a payload: of those on the joint the one that most joints move.
    fn last(&self) -> usize {
        let moving = |at: usize| {
            let path = self.path(at);
            let moves = path.iter().filter(|at| self.bodies[**at].freedom != Freedom::Fixed).count();
            (path.contains(&self.joint), moves)
        };
        // The first of equals.
        (0..self.bodies.len()).rev().max_by_key(|at| moving(*at)).unwrap_or(0)
    }

    /// A body and all that carry it.
    fn path(&self, at: usize) -> Vec<usize> {
        std::iter::successors(Some(at), |at| self.bodies.get(*at)?.parent).collect()
    }

    /// The motion of each body's joint; fixed ones rest.
    fn motions(&self, own: Motion, others: &[Motion]) -> Vec<Motion> {
        let mut others = others.iter();
        let of = |(at, body): (usize, &Body)| match body.freedom {
            Freedom::Fixed => Motion::default(),
            Freedom::Moves(_) if at == self.joint => own,
            Freedom::Moves(_) => others.next().copied().unwrap_or_default(),
        };
        self.bodies.iter().enumerate().map(of).collect()
    }

    fn newton_euler(&self, motions: &[Motion], gravity_m_s2: f64) -> f64 {
        let mut states: Vec<State> = Vec::with_capacity(self.bodies.len());
        for (body, motion) in self.bodies.iter().zip(motions) {
            let carrier = body.parent.and_then(|at| states.get(at)).copied();
            states.push(outwards(body, *motion, carrier, gravity_m_s2));
        }
        for at in (self.joint..states.len()).rev() {
            let State { to_parent, origin_m, force_n, moment_nm, .. } = states[at];
            let carrier = self.bodies[at].parent.filter(|parent| *parent >= self.joint);
            if let Some(carrier) = carrier.and_then(|parent| states.get_mut(parent)) {
                let force_n = to_parent * force_n;
                carrier.force_n += force_n;
                carrier.moment_nm += to_parent * moment_nm + origin_m.cross(&force_n);
            }
        }
        let (Some(body), Some(state)) = (self.bodies.get(self.joint), states.get(self.joint)) else { return 0.0 };
        match body.freedom {
            Freedom::Moves(JointKind::Prismatic) => body.axis.dot(&state.force_n),
            _ => body.axis.dot(&state.moment_nm),
        }
    }
}

/// The motion of `body` from that of its carrier, and the force and moment that its own mass asks for.
fn outwards(body: &Body, motion: Motion, carrier: Option<State>, gravity_m_s2: f64) -> State {
    let zero = Vector3::zeros();
    let (turn, slide) = match body.freedom {
        Freedom::Moves(JointKind::Revolute) => (motion, Motion::default()),
        Freedom::Moves(JointKind::Prismatic) => (Motion::default(), motion),
        Freedom::Fixed => Default::default(),
    };
    let axis = body.axis.into_inner();
    let to_parent = body.rotation * Rotation3::from_axis_angle(&body.axis, turn.position);
    let origin_m = body.origin_m + body.rotation * (axis * slide.position);
    let (w0, dw0, a0) = match carrier {
        Some(c) => (c.velocity_rad_s, c.acceleration_rad_s2, c.acceleration_m_s2),
        None => (zero, zero, Vector3::new(0.0, 0.0, gravity_m_s2)),
    };
    let back = to_parent.inverse();
    let carried = back * w0;
    let w = carried + axis * turn.velocity;
    let dw = back * dw0 + carried.cross(&(axis * turn.velocity)) + axis * turn.acceleration;
    let a = back * (a0 + dw0.cross(&origin_m) + w0.cross(&w0.cross(&origin_m)))
        + 2.0 * w.cross(&(axis * slide.velocity))
        + axis * slide.acceleration;
    // In proportion to the mass, its first and its second moment, all about the frame's origin (Khalil and Dombre 2002, section 9.3).
    let (first, second) = (body.moment_kg_m, body.inertia_kg_m2);
    let force_n = body.mass_kg * a + dw.cross(&first) + w.cross(&w.cross(&first));
    let moment_nm = second * dw + w.cross(&(second * w)) + first.cross(&a);
    State { to_parent, origin_m, velocity_rad_s: w, acceleration_rad_s2: dw, acceleration_m_s2: a, force_n, moment_nm }
}
