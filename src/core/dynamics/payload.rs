//! What the last link of a chain carries beyond what the URDF says of it: a tool, a load, a wrong mass.

use crate::numerics::scalar::Scalar;

/// A mass on the last link, in that link's frame: its inertial parameters, of which the second moment is alike about each axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Payload<S = f64> {
    /// kg; negative where the URDF's link is too heavy.
    pub mass_kg: S,
    /// First moment of mass: the mass times the place of its centre, kg m.
    pub moment_kg_m: [S; 3],
    /// Inertia about the frame's origin, kg m^2.
    pub inertia_kg_m2: S,
}

/// How many numbers a payload has.
pub const NUMBERS: usize = 5;
/// Which of them is the inertia.
pub const INERTIA: usize = NUMBERS - 1;

impl<S: Scalar> Payload<S> {
    /// Names of its numbers, in order.
    pub const NAMES: [&'static str; NUMBERS] =
        ["mass_kg", "moment_x_kg_m", "moment_y_kg_m", "moment_z_kg_m", "inertia_kg_m2"];

    /// Its numbers, in order.
    pub fn numbers(&self) -> [S; NUMBERS] {
        let [x, y, z] = self.moment_kg_m;
        [self.mass_kg, x, y, z, self.inertia_kg_m2]
    }

    /// Of such `numbers`.
    pub fn of([mass_kg, x, y, z, inertia_kg_m2]: [S; NUMBERS]) -> Self {
        Self { mass_kg, moment_kg_m: [x, y, z], inertia_kg_m2 }
    }
}

impl<S> Payload<S> {
    /// Number `at`.
    pub fn number_mut(&mut self, at: usize) -> Option<&mut S> {
        let [x, y, z] = &mut self.moment_kg_m;
        [&mut self.mass_kg, x, y, z, &mut self.inertia_kg_m2].into_iter().nth(at)
    }
}

impl Payload {
    /// Whether the link carries nothing beyond the URDF.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
