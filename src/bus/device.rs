//! One device on the wire.

/// A device: registers, EEPROM, state machine, mailbox, and what it is for.
#[derive(Debug)]
pub struct Device {}
