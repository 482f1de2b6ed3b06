//! What causes and regions are called in a sentence.

use crate::diagnose::{Candidate, Cause, Diagnosis, Floor, FloorSource, Place};
use crate::effects::{Family, Region, find};

/// What `cause` means, in a few words without its name.
pub fn means(cause: Cause) -> &'static str {
    cause.means()
}

/// What `cause` would be, to stand beside rivals: "friction varies with position (friction_ripple)", "Coulomb friction out of
/// date (coulomb)".
pub fn claim(cause: Cause) -> String {
    match cause {
        Cause::Effect(id) => format!("{} ({id})", means(cause)),
        Cause::Stale(name) => format!("{} out of date ({name})", means(cause)),
    }
}

/// The same of a cause that is taken in the way `how`: "viscous friction out of date (viscous, up only)".
pub fn claim_as(cause: Cause, how: &str) -> String {
    match how {
        "" => claim(cause),
        how => format!("{}, {how})", claim(cause).trim_end_matches(')')),
    }
}

/// The formula that it adds; empty for the model's own parameters.
pub fn formula(cause: Cause) -> &'static str {
    match cause {
        Cause::Effect(id) => find(id).map_or("", |effect| effect.about().formula),
        Cause::Stale(_) => "the model's own parameters, refitted",
    }
}

/// What an effect is of; `None` for the model's own parameters.
pub fn family(cause: Cause) -> Option<Family> {
    cause.family()
}

/// What a part of the gap goes with, and the bounds within which most of it stands: "position 48.0 to 90.0 deg".
pub fn bounds(at: &Place) -> String {
    at.detail.replace(" -", " \u{2212}").replace("^2", "²")
}

/// Where a cause shows by its nature, as a sentence goes on.
pub fn place(region: Region) -> &'static str {
    match region {
        Region::AfterReversal => "after reversals",
        Region::Rest => "at rest",
        Region::LowSpeed => "at low speed",
        Region::HighSpeed => "at high speed",
        Region::Up => "moving up",
        Region::Down => "moving down",
        Region::Position => "with position",
        Region::Load => "with load",
        Region::Time => "over time",
        Region::Acceleration => "with acceleration",
        Region::OtherJoint => "with another joint",
        Region::Frequency => "at one frequency",
        Region::Clipped => "where the sensor clips",
        Region::Bursts => "in bursts",
        Region::Everywhere => "everywhere alike",
    }
}

/// Where a floor comes from.
pub fn floor_source(floor: &Floor) -> String {
    let noise = match floor.source {
        FloorSource::Repeats => "from repeats of one motion",
        FloorSource::Spectrum => {
            "from the torque's noise beyond the low-pass's cut-off, because no motion was repeated"
        }
        FloorSource::Unforeseen => {
            "the whole residual, because no fit predicts any of it on held-out data and no motion was repeated"
        }
    };
    match floor.encoder_nm.powi(2) > floor.rms_nm.powi(2) / 2.0 {
        true => format!("mostly the encoder's steps and noise, simulated; the rest {noise}"),
        false => noise.to_string(),
    }
}

/// What a candidate is to the verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The verdict rests on it.
    Taken,
    /// It does as well as one that was taken.
    Rival,
    /// It was tried only in addition to what was taken, and gains too little.
    Beside,
    /// It does worse.
    Other,
}

impl Role {
    /// Of `candidate` in `found`.
    pub fn of(candidate: &Candidate, found: &Diagnosis) -> Self {
        let is_rival = |taken: &Candidate| taken.taken && taken.trades_with.contains(&candidate.cause);
        match candidate.taken {
            true => Self::Taken,
            false if found.candidates.iter().any(is_rival) => Self::Rival,
            false if candidate.beside => Self::Beside,
            false => Self::Other,
        }
    }

    /// In a word; nothing for what the verdict does not name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Taken => "named",
            Self::Rival => "rival",
            Self::Beside => "in addition",
            Self::Other => "",
        }
    }
}
