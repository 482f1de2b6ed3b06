//! The power drive state machine (CiA 402-2, figure 2).

/// Its states, and how each shows in the status word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Power {
    /// No torque, and none before a shutdown command.
    SwitchOnDisabled,
    /// No torque.
    ReadyToSwitchOn,
    /// No torque, but the next command gives it.
    SwitchedOn,
    /// The motor follows.
    Enabled,
    /// Stopping, or stopped and held.
    QuickStop,
    /// Stopping because of a fault.
    FaultReaction,
    /// No torque until the fault is reset.
    Fault,
}

impl Power {
    /// Its bits of the status word, bits 4 (voltage) and 5 (no quick stop) with them.
    pub fn status(self) -> u16 {
        match self {
            Power::SwitchOnDisabled => 0x0050,
            Power::ReadyToSwitchOn => 0x0031,
            Power::SwitchedOn => 0x0033,
            Power::Enabled => 0x0037,
            Power::QuickStop => 0x0017,
            Power::FaultReaction => 0x003F,
            Power::Fault => 0x0038,
        }
    }

    /// Where a control word leads; `reset` is a rising edge of its bit 7, `holds` whether a stopped drive may go on,
    /// `stops` whether the quick stop does anything.
    pub fn commanded(self, control: u16, reset: bool, holds: bool, stops: bool) -> Self {
        let disable_voltage = control & 0x82 == 0;
        let quick_stop = control & 0x86 == 0x02;
        let shutdown = control & 0x87 == 0x06;
        let switch_on = control & 0x8F == 0x07;
        let enable = control & 0x8F == 0x0F;
        match self {
            Power::Fault if reset => Power::SwitchOnDisabled,
            Power::SwitchOnDisabled if shutdown => Power::ReadyToSwitchOn,
            Power::ReadyToSwitchOn | Power::SwitchedOn if disable_voltage || quick_stop => Power::SwitchOnDisabled,
            Power::ReadyToSwitchOn if switch_on || enable => Power::SwitchedOn,
            Power::SwitchedOn if enable => Power::Enabled,
            Power::SwitchedOn if shutdown => Power::ReadyToSwitchOn,
            Power::Enabled if disable_voltage => Power::SwitchOnDisabled,
            Power::Enabled if quick_stop && stops => Power::QuickStop,
            Power::Enabled if shutdown => Power::ReadyToSwitchOn,
            Power::Enabled if switch_on => Power::SwitchedOn,
            Power::QuickStop if disable_voltage => Power::SwitchOnDisabled,
            Power::QuickStop if enable && holds => Power::Enabled,
            other => other,
        }
    }
}
