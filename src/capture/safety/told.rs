//! What is told in each state: the drive by its control word, the target, the brake.

use super::{Seen, State};
use crate::capture::drive::{Condition, Control};

/// What becomes of the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// It is where the joint is.
    Actual,
    /// It stays where it is.
    Held,
    /// It goes along the trajectory.
    Follows,
    /// It comes to rest along a ramp of its own, whatever is measured: a drive that does not obey must not run after a position
    /// that runs away.
    Brakes,
}

/// Cycles at a fault-reset bit that is low, then high: its rise is what counts.
const RESET_CYCLES: u32 = 10;

impl State {
    /// What the drive is told in this state, where it stands so.
    pub fn control(self, seen: &Seen) -> Control {
        match self {
            Self::Watching | Self::Cutting | Self::Leaving | Self::Lost | Self::Stopped => Control::DisableVoltage,
            // Braking first, and no voltage once the joint rests.
            Self::Disarming if seen.drive.has_torque() && !seen.at_rest => Control::QuickStop,
            Self::Disarming => Control::DisableVoltage,
            Self::Clearing if seen.cycles < RESET_CYCLES => Control::DisableVoltage,
            Self::Clearing => Control::ResetFault,
            // A step before torque it waits for the joint and the mode.
            Self::Readying if seen.drive == Condition::SwitchedOn && !(seen.at_rest && seen.in_mode) => {
                Control::SwitchOn
            }
            Self::Readying => seen.drive.towards_enabled(),
            Self::Holding | Self::Moving => Control::Enable,
            Self::Releasing if seen.drive == Condition::Enabled && seen.cycles < seen.engage => Control::Enable,
            Self::Releasing if seen.drive == Condition::Enabled => Control::SwitchOn,
            Self::Releasing => Control::DisableVoltage,
            Self::Stopping | Self::Held => Control::QuickStop,
        }
    }

    /// What becomes of the target in this state.
    pub fn target(self) -> Target {
        match self {
            Self::Holding | Self::Releasing => Target::Held,
            Self::Moving => Target::Follows,
            Self::Stopping | Self::Held | Self::Cutting | Self::Leaving | Self::Lost => Target::Brakes,
            Self::Watching | Self::Disarming | Self::Clearing | Self::Readying | Self::Stopped => Target::Actual,
        }
    }

    /// Whether a brake is let go in this state: while there is torque that holds or moves the joint, and in a stop until it rests. It
    /// falls in before torque is taken away.
    pub fn lets_brake_go(self, seen: &Seen) -> bool {
        match self {
            Self::Holding | Self::Moving => true,
            Self::Stopping => seen.drive.has_torque() && (seen.is_blind || !seen.at_rest),
            _ => false,
        }
    }
}
