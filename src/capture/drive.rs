//! CiA 402, the profile of drives: what the words on the wire mean. (CiA 402-2 / IEC 61800-7-201, tables 25 to 33.)

use std::fmt;

/// Where the drive's own state machine stands, read from the status word (object 0x6041).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Starting up.
    NotReady,
    /// Waiting for voltage and permission.
    SwitchOnDisabled,
    /// Ready to be switched on.
    Ready,
    /// Switched on, without torque.
    SwitchedOn,
    /// Torque is on: the drive follows its target.
    Enabled,
    /// Braking, or held after a quick stop.
    QuickStop,
    /// Reacting to a fault.
    FaultReaction,
    /// In fault, without torque.
    Fault,
    /// A combination of bits that the profile does not have.
    Unknown,
}

impl Condition {
    /// Every condition that there is.
    pub const ALL: [Self; 9] = [
        Self::NotReady,
        Self::SwitchOnDisabled,
        Self::Ready,
        Self::SwitchedOn,
        Self::Enabled,
        Self::QuickStop,
        Self::FaultReaction,
        Self::Fault,
        Self::Unknown,
    ];

    /// Decodes a status word: bits 0 to 3 and 6 where bit 5 does not count (mask 0x4F), with bit 5 elsewhere (0x6F).
    pub fn of(status: u16) -> Self {
        match (status & 0x4F, status & 0x6F) {
            (0x00, _) => Self::NotReady,
            (0x40, _) => Self::SwitchOnDisabled,
            (0x0F, _) => Self::FaultReaction,
            (0x08, _) => Self::Fault,
            (_, 0x21) => Self::Ready,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::Enabled,
            (_, 0x07) => Self::QuickStop,
            _ => Self::Unknown,
        }
    }

    /// Whether the motor may give torque.
    pub fn has_torque(self) -> bool {
        matches!(self, Self::Enabled | Self::QuickStop | Self::FaultReaction | Self::Unknown)
    }

    /// The command that brings the drive a step nearer to giving torque.
    pub fn towards_enabled(self) -> Control {
        match self {
            Self::SwitchOnDisabled | Self::QuickStop => Control::Shutdown,
            Self::Ready => Control::SwitchOn,
            Self::SwitchedOn | Self::Enabled => Control::Enable,
            Self::NotReady | Self::FaultReaction | Self::Fault | Self::Unknown => Control::DisableVoltage,
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotReady => "not ready to switch on",
            Self::SwitchOnDisabled => "switch on disabled",
            Self::Ready => "ready to switch on",
            Self::SwitchedOn => "switched on",
            Self::Enabled => "operation enabled",
            Self::QuickStop => "quick stop active",
            Self::FaultReaction => "fault reaction active",
            Self::Fault => "fault",
            Self::Unknown => "unknown",
        })
    }
}

/// Commands of the control word (object 0x6040).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// No torque at once.
    DisableVoltage,
    /// Brake along the drive's own quick-stop ramp.
    QuickStop,
    /// Make ready.
    Shutdown,
    /// Switch on, without torque.
    SwitchOn,
    /// Torque on.
    Enable,
    /// Acknowledge a fault; acts on the rising bit.
    ResetFault,
}

impl Control {
    /// The word that is sent: bits 0 switch on, 1 enable voltage, 2 no quick stop, 3 enable operation, 7 fault reset.
    pub fn word(self) -> u16 {
        match self {
            Self::DisableVoltage => 0b0000_0000,
            Self::QuickStop => 0b0000_0010,
            Self::Shutdown => 0b0000_0110,
            Self::SwitchOn => 0b0000_0111,
            Self::Enable => 0b0000_1111,
            Self::ResetFault => 0b1000_0000,
        }
    }
}

/// Bit 11 of the status word: the drive holds back at a limit of its own.
pub const INTERNAL_LIMIT: u16 = 1 << 11;
/// Bit 13 of the status word in position mode: the following error is outside its window.
pub const FOLLOWING_ERROR: u16 = 1 << 13;

/// What the drive is told to follow (object 0x6060).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Cyclic synchronous position: without new targets the joint is held.
    Position,
    /// Cyclic synchronous velocity.
    Velocity,
    /// Cyclic synchronous torque.
    Torque,
}

impl Mode {
    /// The names used in `rig.toml`.
    pub const NAMES: [(&'static str, Self); 3] =
        [("csp", Self::Position), ("csv", Self::Velocity), ("cst", Self::Torque)];

    /// The number that the drive knows it by.
    pub fn code(self) -> i8 {
        match self {
            Self::Position => 8,
            Self::Velocity => 9,
            Self::Torque => 10,
        }
    }
}

/// Whether quick-stop option `code` (object 0x605A) brakes: 1 to 4 brake and switch off, 5 to 8 brake and hold. 0 lets the joint
/// coast, and what is negative is the maker's own: some drives use -1 to ignore the command.
pub fn brakes(code: i16) -> bool {
    (1..=8).contains(&code)
}

/// Whether quick-stop option `code` holds the joint at rest, with torque, until another command comes.
pub fn holds(code: i16) -> bool {
    (5..=8).contains(&code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_words_are_those_of_the_profile() {
        // As drives send them, with voltage (4), remote (9) and other bits set.
        for (status, condition) in [
            (0x0000, Condition::NotReady),
            (0x0250, Condition::SwitchOnDisabled),
            (0x0231, Condition::Ready),
            (0x0233, Condition::SwitchedOn),
            (0x1237, Condition::Enabled),
            (0x0237 | INTERNAL_LIMIT | FOLLOWING_ERROR, Condition::Enabled),
            (0x0217, Condition::QuickStop),
            (0x021F, Condition::FaultReaction),
            (0x0218, Condition::Fault),
            (0x0238, Condition::Fault),
            (0x0005, Condition::Unknown),
        ] {
            assert_eq!(Condition::of(status), condition, "{status:#06x}");
        }
    }

    #[test]
    fn only_one_command_gives_torque() {
        let gives_torque = |control: &Control| control.word() & 0b1000 != 0;
        let all = [
            Control::DisableVoltage,
            Control::QuickStop,
            Control::Shutdown,
            Control::SwitchOn,
            Control::Enable,
            Control::ResetFault,
        ];
        assert!(all.iter().all(|control| gives_torque(control) == (*control == Control::Enable)));
        // A quick stop is bit 2 low with voltage on: x01x.
        assert_eq!(Control::QuickStop.word() & 0b0110, 0b0010);
        for from in Condition::ALL.into_iter().filter(|c| !matches!(c, Condition::SwitchedOn | Condition::Enabled)) {
            assert_ne!(from.towards_enabled(), Control::Enable, "{from}");
        }
    }

    #[test]
    fn options_that_do_not_brake_are_told_apart() {
        assert!([-128, -1, 0, 9].into_iter().all(|code| !brakes(code)) && (1..=8).all(brakes));
    }
}
