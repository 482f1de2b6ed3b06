//! A motion's plan: position over time, from rest to rest, as a list of segments.
//!
//! ```
//! use tautline_core::trajectory::{Path, Protocol, Segment, Trajectory};
//!
//! let there = |to_rad| Segment::Sweep { to_rad, speed_rad_s: 0.5, acceleration_rad_s2: 4.0 };
//! let own = Path { start_rad: 0.0, segments: vec![there(1.0), Segment::Rest { duration_s: 0.5 }, there(0.0)] };
//! let (name, protocol) = ("there_and_back".to_string(), Protocol::Free);
//! let trajectory = Trajectory { name, protocol, repeats: Some(2), own, others: Vec::new() };
//! assert_eq!(trajectory.positions_rad(100.0).len(), trajectory.samples(100.0));
//! assert!(trajectory.to_toml().starts_with("format = \"trajectory/1\""));
//! ```

mod extremes;
mod file;
mod kind;
mod list;
mod protocol;
mod segment;

pub use extremes::Extremes;
pub use kind::Protocol;
pub use list::read_all;
pub use protocol::{ACCELERATION_RAD_S2, CASCADE_S, Uniform};
pub use segment::{Segment, Wave};

/// A prescribed motion of one joint, angles in rad; other joints may move along.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// What campaigns call it.
    pub name: String,
    /// What it is for.
    pub protocol: Protocol,
    /// How many times it should be recorded, where it says so.
    pub repeats: Option<u32>,
    /// The joint itself.
    pub own: Path,
    /// The other joints, in the order of a campaign's columns.
    pub others: Vec<Path>,
}

/// One joint's motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Where it starts, rad.
    pub start_rad: f64,
    /// What follows, one after the other.
    pub segments: Vec<Segment>,
}

impl Trajectory {
    /// What `[[trials]]` call it: nothing where protocol and speed say all.
    pub fn name_in_a_campaign(&self) -> Option<String> {
        let says_all = self.protocol.speed_rad_s().is_some() || self.name == self.protocol.name();
        (!says_all).then(|| self.name.clone())
    }

    /// Positions in rad, `rate_hz` a second.
    pub fn positions_rad(&self, rate_hz: f64) -> Vec<f64> {
        self.own.positions_rad(rate_hz)
    }

    /// How many positions there are, `rate_hz` a second.
    pub fn samples(&self, rate_hz: f64) -> usize {
        self.own.walk().map(|(from_rad, segment)| segment.samples(from_rad, rate_hz)).sum()
    }
}

impl Path {
    /// Positions in rad, `rate_hz` a second.
    pub fn positions_rad(&self, rate_hz: f64) -> Vec<f64> {
        let mut positions_rad = Vec::new();
        self.walk().for_each(|(from_rad, segment)| segment.append(from_rad, rate_hz, &mut positions_rad));
        positions_rad
    }

    /// How long it takes, s.
    pub fn duration_s(&self) -> f64 {
        self.walk().map(|(from_rad, segment)| segment.duration_s(from_rad)).sum()
    }

    /// Where it ends, rad.
    pub fn end_rad(&self) -> f64 {
        self.segments.iter().fold(self.start_rad, |at, segment| segment.end_rad(at))
    }

    /// Each segment with where it begins, rad.
    pub(crate) fn walk(&self) -> impl Iterator<Item = (f64, &Segment)> {
        self.segments.iter().scan(self.start_rad, |at, segment| {
            let from_rad = *at;
            *at = segment.end_rad(from_rad);
            Some((from_rad, segment))
        })
    }
}
