//! The two directions of motion.

/// The two directions of motion, and one of anything for each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Both<T> {
    /// For v >= 0: cable 1.
    pub up: T,
    /// For v < 0: cable 2.
    pub down: T,
}

/// Below this speed a joint rests, rad/s: no motion is as slow, and a filter leaves some 1e-13 of rounding, whose sign means nothing.
pub const AT_REST_RAD_S: f64 = 1e-9;

/// A direction of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Direction {
    /// v >= 0.
    Up,
    /// v < 0.
    Down,
}

impl Direction {
    /// Both, `Up` first.
    pub const BOTH: [Self; 2] = [Self::Up, Self::Down];

    /// That of a speed; none at rest.
    pub fn of(velocity_rad_s: f64) -> Option<Self> {
        let moving = if velocity_rad_s > 0.0 { Self::Up } else { Self::Down };
        (velocity_rad_s.abs() >= AT_REST_RAD_S).then_some(moving)
    }

    /// +1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Up => 1.0,
            Self::Down => -1.0,
        }
    }

    /// K~ of friction that is fully on this branch: 1 moving up, 0 moving down.
    pub fn k_tilde(self) -> f64 {
        match self {
            Self::Up => 1.0,
            Self::Down => 0.0,
        }
    }

    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Self::Up => Self::Down,
            Self::Down => Self::Up,
        }
    }

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Up => "up",
            Self::Down => "down",
        }
    }
}

impl<T> Both<T> {
    /// Makes one for each direction, or stops at the first failure.
    pub fn try_make<E>(mut make: impl FnMut(Direction) -> Result<T, E>) -> Result<Self, E> {
        Ok(Self { up: make(Direction::Up)?, down: make(Direction::Down)? })
    }

    /// Makes one for each direction.
    pub fn make(mut make: impl FnMut(Direction) -> T) -> Self {
        Self { up: make(Direction::Up), down: make(Direction::Down) }
    }

    /// The one of `direction`.
    pub fn of(&self, direction: Direction) -> &T {
        match direction {
            Direction::Up => &self.up,
            Direction::Down => &self.down,
        }
    }

    /// The one of `direction`, to change.
    pub fn of_mut(&mut self, direction: Direction) -> &mut T {
        match direction {
            Direction::Up => &mut self.up,
            Direction::Down => &mut self.down,
        }
    }
}
