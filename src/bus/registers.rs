//! Where things stand in a device's memory (ETG.1000.4; Beckhoff's ESC data sheet, section II).

/// Type, revision, build, FMMUs, sync managers, RAM in KiB, ports, features.
pub const INFORMATION: u16 = 0x0000;
/// What the bus interface can, 2 bytes: bit 2 has a clock, bit 3 one of 64 bits.
pub const FEATURES: u16 = 0x0008;
/// Station address that the master gives.
pub const STATION: u16 = 0x0010;
/// Station address out of the EEPROM.
pub const ALIAS: u16 = 0x0012;
/// Data link control; bit 24 lets the alias address the device.
pub const DL_CONTROL: u16 = 0x0100;
/// Data link status: which ports have a link.
pub const DL_STATUS: u16 = 0x0110;
/// State that the master asks for.
pub const AL_CONTROL: u16 = 0x0120;
/// State that the device is in; bit 4 is the error flag.
pub const AL_STATUS: u16 = 0x0130;
/// Why the error flag is set.
pub const AL_CODE: u16 = 0x0134;
/// Which events a datagram's event field tells of.
pub const EVENT_MASK: u16 = 0x0200;
/// The events: bit 2, the AL status has changed since it was read; bits 4 to 11, sync manager 0 to 7 has something for the master.
pub const EVENTS: u16 = 0x0210;
/// Invalid frames at port 0, receive errors there, and so on for each port.
pub const PORT_ERRORS: u16 = 0x0300;
/// Lost links at port 0, and so on.
pub const LOST_LINKS: u16 = 0x0310;
/// What processor interface the device has.
pub const PDI_CONTROL: u16 = 0x0140;
/// Divider of the watchdogs' clock: a tick is 40 ns times this + 2.
pub const WATCHDOG_DIVIDER: u16 = 0x0400;
/// Ticks until the processor watchdog expires.
pub const WATCHDOG_PDI: u16 = 0x0410;
/// Ticks until the output watchdog expires; 0 switches it off.
pub const WATCHDOG_OUTPUTS: u16 = 0x0420;
/// Bit 0: the output watchdog is content.
pub const WATCHDOG_STATUS: u16 = 0x0440;
/// How often the output watchdog expired, one byte.
pub const WATCHDOG_COUNT: u16 = 0x0442;
/// Who owns the EEPROM.
pub const EEPROM_OWNER: u16 = 0x0500;
/// Its command and status.
pub const EEPROM_CONTROL: u16 = 0x0502;
/// The word that is asked for.
pub const EEPROM_ADDRESS: u16 = 0x0504;
/// What stands there, 8 bytes.
pub const EEPROM_DATA: u16 = 0x0508;
/// FMMUs, 16 bytes each.
pub const FMMU: u16 = 0x0600;
/// Sync managers, 8 bytes each.
pub const SYNC_MANAGER: u16 = 0x0800;
/// Receive times of the four ports; a write latches them.
pub const RECEIVE_TIMES: u16 = 0x0900;
/// System time; a write is a sample of the reference clock.
pub const SYSTEM_TIME: u16 = 0x0910;
/// Local time at which the frame with the last latch came in, 8 bytes.
pub const RECEIVE_TIME: u16 = 0x0918;
/// What is added to the local time, 8 bytes.
pub const TIME_OFFSET: u16 = 0x0920;
/// Delay from the reference clock to here, 4 bytes.
pub const TIME_DELAY: u16 = 0x0928;
/// How far the system time is off, 4 bytes, bit 31 when it is behind.
pub const TIME_DIFFERENCE: u16 = 0x092C;
/// Bit 0 starts cyclic pulses, bit 1 lets SYNC0 have them.
pub const SYNC_ACTIVATION: u16 = 0x0981;
/// When the first pulse comes, 8 bytes of system time.
pub const SYNC_START: u16 = 0x0990;
/// Period of SYNC0, ns, 4 bytes.
pub const SYNC0_CYCLE: u16 = 0x09A0;
/// Where registers end and process memory begins.
pub const PROCESS_MEMORY: u16 = 0x1000;

/// What a master may write among the registers: first address and the one after the last.
pub const WRITABLE: [(u16, u16); 19] = [
    (STATION, 0x0012),
    (0x0020, 0x0022),
    (DL_CONTROL, 0x010A),
    (AL_CONTROL, 0x0122),
    (0x0200, 0x0202),
    (0x0300, 0x0314),
    (WATCHDOG_DIVIDER, 0x0402),
    (WATCHDOG_PDI, 0x0412),
    (WATCHDOG_OUTPUTS, 0x0422),
    (WATCHDOG_COUNT, 0x0444),
    (EEPROM_OWNER, 0x0510),
    (RECEIVE_TIMES, 0x0904),
    (SYSTEM_TIME, 0x0918),
    (TIME_OFFSET, TIME_DIFFERENCE),
    (0x0930, 0x0937),
    (0x0980, 0x0984),
    (SYNC_START, 0x0998),
    (SYNC0_CYCLE, 0x09A8),
    (0x09A8, 0x09AA),
];
