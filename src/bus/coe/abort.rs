//! Why an SDO transfer is refused (CiA 301, table 22; ETG.1000.6, table 41).

/// The reasons that our devices know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Abort {
    /// The toggle bit did not change.
    Toggle = 0x0503_0000,
    /// No such command.
    Command = 0x0504_0001,
    /// The object cannot be accessed so, such as a single number as a whole.
    Access = 0x0601_0000,
    /// The entry is only read.
    ReadOnly = 0x0601_0002,
    /// No such object.
    NoObject = 0x0602_0000,
    /// The object cannot be in a PDO.
    NotMappable = 0x0604_0041,
    /// Too many bytes.
    TooLong = 0x0607_0012,
    /// Too few.
    TooShort = 0x0607_0013,
    /// No such subindex.
    NoSubindex = 0x0609_0011,
    /// The value is above what is allowed.
    TooHigh = 0x0609_0031,
    /// The value is below.
    TooLow = 0x0609_0032,
    /// Not in this state.
    State = 0x0800_0022,
}
