//! Where effects show.

/// Where an effect shows most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Region {
    /// Travel since the last reversal.
    AfterReversal,
    /// The joint rests.
    Rest,
    /// Slow motion.
    LowSpeed,
    /// Fast motion.
    HighSpeed,
    /// Moving up.
    Up,
    /// Moving down.
    Down,
    /// Some positions.
    Position,
    /// Large load.
    Load,
    /// Some times.
    Time,
    /// In step with acceleration.
    Acceleration,
    /// In step with another joint.
    OtherJoint,
    /// One frequency in time.
    Frequency,
    /// The sensor at the end of its range.
    Clipped,
    /// Short stretches that are not repeated.
    Bursts,
    /// No place more than any other.
    Everywhere,
}

impl Region {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::AfterReversal,
        Self::Rest,
        Self::LowSpeed,
        Self::HighSpeed,
        Self::Up,
        Self::Down,
        Self::Position,
        Self::Load,
        Self::Time,
        Self::Acceleration,
        Self::OtherJoint,
        Self::Frequency,
        Self::Clipped,
        Self::Bursts,
        Self::Everywhere,
    ];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::AfterReversal => "after_reversal",
            Self::Rest => "rest",
            Self::LowSpeed => "low_speed",
            Self::HighSpeed => "high_speed",
            Self::Up => "up",
            Self::Down => "down",
            Self::Position => "position",
            Self::Load => "load",
            Self::Time => "time",
            Self::Acceleration => "acceleration",
            Self::OtherJoint => "other_joint",
            Self::Frequency => "frequency",
            Self::Clipped => "clipped",
            Self::Bursts => "bursts",
            Self::Everywhere => "everywhere",
        }
    }
}
