//! What devices report of themselves, and whether it is what the rig says.

use super::line::{Failure, Line};
use super::rig::{AXIS_OBJECTS, Entry, Identity, Kind, Pdo, ProcessData, Pulses};
use super::wire::Wire;
use ethercrab::error::{Error, MailboxError};
use ethercrab::{MainDevice, SubDeviceRef};

/// A device as it reports itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Its place on the bus, from 0.
    pub place: usize,
    /// The name in its EEPROM.
    pub name: String,
    /// Vendor, product code, revision, serial number, from its EEPROM.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision.
    pub revision: u32,
    /// Serial number.
    pub serial: u32,
    /// Station alias, 0 where it has none.
    pub alias: u16,
    /// Whether it has a clock of its own that can be held to the others'.
    pub has_clock: bool,
    /// Its distributed-clock settings by the ESI file, where they differ from one SYNC0 pulse per cycle; a device on the bus does not report them.
    pub clock: Option<Pulses>,
    /// What it sends as it is set up now; nothing of a device without an object dictionary.
    pub inputs: ProcessData,
    /// What is sent to it.
    pub outputs: ProcessData,
}

impl Found {
    /// What of `identity` it is not, in words.
    pub fn mismatch(&self, identity: &Identity) -> Option<String> {
        let differs = |what: &str, found: u32, wanted: u32| {
            (found != wanted).then(|| format!("its {what} is {found:#010x}, the rig says {wanted:#010x}"))
        };
        differs("vendor", self.vendor, identity.vendor)
            .or_else(|| differs("product code", self.product, identity.product))
            .or_else(|| identity.revision.and_then(|revision| differs("revision", self.revision, revision)))
            .or_else(|| identity.serial.and_then(|serial| differs("serial number", self.serial, serial)))
            .or_else(|| identity.alias.and_then(|alias| differs("station alias", self.alias.into(), alias.into())))
    }
}

/// Objects that list the PDOs of each direction.
pub const ASSIGNED_OUTPUTS: u16 = 0x1C12;
/// The same of what the device sends.
pub const ASSIGNED_INPUTS: u16 = 0x1C13;

/// Whether a device has an object dictionary: the simplest have no mailbox.
pub fn has_objects<W: Wire, S>(line: &mut Line<'_, W>, device: &SubDeviceRef<'_, S>) -> bool
where
    S: std::ops::Deref<Target = ethercrab::SubDevice>,
{
    // Every device that has one has this object, its type.
    let asked = line.run(device.sdo_read::<u32>(0x1000, 0u8));
    !matches!(asked, Err(Failure::Stack(Error::Mailbox(MailboxError::NoReadMailbox | MailboxError::NoWriteMailbox))))
}

/// The PDOs that a device has in one direction, with what is mapped to them; nothing where it does not tell.
pub fn mapped<W: Wire, S>(line: &mut Line<'_, W>, device: &SubDeviceRef<'_, S>, assigned: u16) -> ProcessData
where
    S: std::ops::Deref<Target = ethercrab::SubDevice>,
{
    let Ok(count) = line.run(device.sdo_read::<u8>(assigned, 0u8)) else { return ProcessData::default() };
    let pdos = (1..=count).filter_map(|sub| line.run(device.sdo_read::<u16>(assigned, sub)).ok()).collect::<Vec<_>>();
    let pdo = |index| Some(Pdo { index, entries: entries(line, device, index).ok()? });
    ProcessData { pdos: pdos.into_iter().filter_map(pdo).collect() }
}

/// What is mapped to `pdo`.
///
/// Errors: the device does not tell.
pub fn entries<W: Wire, S>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    pdo: u16,
) -> Result<Vec<Entry>, Failure>
where
    S: std::ops::Deref<Target = ethercrab::SubDevice>,
{
    let count = line.run(device.sdo_read::<u8>(pdo, 0u8))?;
    (1..=count).map(|sub| Ok(entry(line.run(device.sdo_read::<u32>(pdo, sub))?))).collect()
}

/// The entry of a mapping word; its kind is a guess by the object, where that is one of a drive's.
pub(super) fn entry(mapping: u32) -> Entry {
    let (index, sub, bits) = ((mapping >> 16) as u16, (mapping >> 8) as u8, (mapping & 0xFF) as usize);
    // Of a drive with several axes the objects of each are those of the first, further on.
    let of_first = if index >= 0x6000 { 0x6000 + (index - 0x6000) % AXIS_OBJECTS } else { index };
    let (role, signed) = match of_first {
        0x6040 => (Some("control_word"), false),
        0x6041 => (Some("status_word"), false),
        0x6060 | 0x6061 => (Some("mode"), true),
        0x6064 => (Some("position"), true),
        0x606C => (Some("velocity"), true),
        0x6071 => (Some("target_torque"), true),
        0x6077 => (Some("torque"), true),
        0x6078 => (Some("current"), true),
        0x607A => (Some("target_position"), true),
        0x60FF => (Some("target_velocity"), true),
        0x603F => (Some("error_code"), false),
        _ => (None, false),
    };
    let unsigned = Kind::of_bits(bits).unwrap_or(Kind::Gap(mapping as u8));
    let kind = if signed && matches!(bits, 8 | 16 | 32) { Kind::Signed(bits as u8) } else { unsigned };
    let role = role.filter(|_| !matches!(kind, Kind::Gap(_)));
    Entry { role: role.map(str::to_string), index, sub, kind }
}

/// What all devices on the bus report; it is left in PRE-OP.
///
/// Errors: the bus cannot be set up.
pub fn scan<W: Wire>(line: &mut Line<'_, W>, main: &MainDevice<'_>) -> Result<Vec<Found>, Failure> {
    let group = super::group::pre_op(line, main)?;
    let devices: Vec<_> = group.iter(main).collect();
    Ok(devices.into_iter().enumerate().map(|(place, device)| found(line, place, &device)).collect())
}

/// What one device reports.
pub fn found<W: Wire, S>(line: &mut Line<'_, W>, place: usize, device: &SubDeviceRef<'_, S>) -> Found
where
    S: std::ops::Deref<Target = ethercrab::SubDevice>,
{
    let identity = device.identity();
    Found {
        place,
        name: device.name().to_string(),
        vendor: identity.vendor_id,
        product: identity.product_id,
        revision: identity.revision,
        serial: identity.serial,
        alias: device.alias_address(),
        has_clock: device.dc_support().any(),
        clock: None,
        inputs: mapped(line, device, ASSIGNED_INPUTS),
        outputs: mapped(line, device, ASSIGNED_OUTPUTS),
    }
}
