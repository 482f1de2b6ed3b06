//! What is known of the drives' torque when a capture ends.

use super::axis::Axis;

/// The drive's torque at the end of a capture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Torque {
    /// A fresh answer of the drive has shown that it is off, or it was never asked for and not seen on.
    Off,
    /// Nothing has shown that it is off: what was last seen, in words.
    NotShownOff(String),
}

impl Torque {
    /// What the operator must be told, if it is not off.
    pub fn warning(&self) -> Option<String> {
        match self {
            Self::Off => None,
            Self::NotShownOff(seen) => Some(format!(
                "TORQUE IS NOT SHOWN TO BE OFF: {seen}. PRESS THE EMERGENCY STOP, AND KEEP AWAY FROM THE JOINT"
            )),
        }
    }

    /// Of all axes: the first that is not shown to be off.
    pub(super) fn of<'d>(mut axes: impl Iterator<Item = (&'d str, &'d Axis)>, watchdog_ms: u32) -> Self {
        let found = axes.find_map(|(name, axis)| match Self::of_one(axis, watchdog_ms) {
            Self::Off => None,
            Self::NotShownOff(seen) => Some(format!("of `{name}`: {seen}")),
        });
        found.map_or(Self::Off, Self::NotShownOff)
    }

    fn of_one(axis: &Axis, watchdog_ms: u32) -> Self {
        let drive = axis.drive();
        if axis.is_seen_off() || !axis.was_armed() && !drive.has_torque() {
            return Self::Off;
        }
        Self::NotShownOff(match axis.was_answered() {
            true => format!("the drive says `{drive}`"),
            false => format!(
                "the drive does not answer, or its answers are old; the last one said `{drive}`; its own watchdog of \
                 {watchdog_ms} ms may have stopped it, which cannot be seen from here"
            ),
        })
    }
}
