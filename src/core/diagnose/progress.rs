//! What a diagnosis is at, told as it goes on: for a progress bar, and to see where the time goes.

/// Who listens.
pub type Listener<'l> = &'l (dyn Fn(Progress<'_>) + Sync);

/// What is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress<'p> {
    /// A phase begins, and ends the one before.
    Begins(Phase),
    /// So many steps more are known to lie ahead in this phase.
    Ahead(usize),
    /// A step was taken: the trial of this log was read, or this cause tried.
    Done(&'p str),
}

/// A part of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Trials are read.
    Reading,
    /// The noise floor is estimated.
    NoiseFloor,
    /// Contact events are set aside.
    ContactEvents,
    /// A further cause is looked for; the first has number 1.
    Cause(usize),
    /// Two causes are tried together.
    Pairs,
    /// All other causes are tried in the place of this one.
    Rivals(&'static str),
    /// All is done again with motion cycles held out.
    MotionCycles,
    /// The verdict is drawn.
    Verdict,
    /// The next experiment is designed.
    NextExperiment,
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reading => f.write_str("reading"),
            Self::NoiseFloor => f.write_str("noise floor"),
            Self::ContactEvents => f.write_str("contact events"),
            Self::Cause(number) => write!(f, "cause {number}"),
            Self::Pairs => f.write_str("pairs of causes"),
            Self::Rivals(cause) => write!(f, "rivals of {cause}"),
            Self::MotionCycles => f.write_str("again on motion cycles"),
            Self::Verdict => f.write_str("verdict"),
            Self::NextExperiment => f.write_str("next experiment"),
        }
    }
}
