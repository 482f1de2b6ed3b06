//! A trajectory.

use super::campaign::Protocol;
use schemars::JsonSchema;
use serde::Deserialize;

/// A motion: segments one after the other.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Trajectory {
    /// Always trajectory/1.
    pub format: TrajectoryFormat,
    /// Its name; the file's where absent.
    pub name: Option<String>,
    /// What it is for; free where absent.
    pub protocol: Option<Protocol>,
    /// How often it is to be recorded.
    pub repeats: Option<u32>,
    /// Where the joint starts, rad.
    pub start_rad: f64,
    /// Pieces of the motion.
    pub segments: Vec<Segment>,
    /// Motions of other joints at the same time.
    #[serde(default)]
    pub others: Vec<Path>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum TrajectoryFormat {
    /// Version 1.
    #[serde(rename = "trajectory/1")]
    V1,
}

/// The motion of another joint.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Where it starts, rad.
    pub start_rad: f64,
    /// Pieces of its motion.
    pub segments: Vec<Segment>,
}

/// A piece of a motion.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Segment {
    /// Stands still.
    Rest {
        /// s.
        duration_s: f64,
    },
    /// Moves to a position at constant speed.
    Sweep {
        /// rad.
        to_rad: f64,
        /// rad/s.
        speed_rad_s: f64,
        /// rad/s^2 at both ends.
        acceleration_rad_s2: Option<f64>,
    },
    /// Swings between two positions.
    Cosine {
        /// rad.
        low_rad: f64,
        /// rad.
        high_rad: f64,
        /// s.
        period_s: f64,
        /// How many; 1 where absent.
        periods: Option<u32>,
    },
    /// A sum of sines.
    Multisine {
        /// s.
        duration_s: f64,
        /// Over which it grows at the beginning and dies away at the end, s.
        fade_s: f64,
        /// The sines.
        waves: Vec<Wave>,
    },
}

/// One sine.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// rad.
    pub amplitude_rad: f64,
    /// Hz.
    pub frequency_hz: f64,
    /// rad; 0 where absent.
    pub phase_rad: Option<f64>,
}
