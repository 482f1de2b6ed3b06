//! What is written to a device in PRE-OP: its start-up objects, and which PDOs it exchanges with what in them.

use super::found::{ASSIGNED_INPUTS, has_objects, mapped};
use super::group::{NotStarted, while_doing};
use super::line::{Failure, Line};
use super::rig::{Identity, ProcessData, Setup, Startup};
use super::wire::Wire;
use ethercrab::{SubDevice, SubDeviceRef};
use std::ops::Deref;

/// Writes the start-up objects of a device and reads them back; a line of `report` for each.
///
/// Errors: one that is not taken.
pub(super) fn start_up<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    identity: &Identity,
    setup: &Setup,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    for object in &setup.startup {
        let Startup { index, sub, value, .. } = object;
        let setting = format!("`{}` does not take {value} in {index:#06x}:{sub:02x}", identity.name);
        write(line, device, object).map_err(while_doing(&setting))?;
        let found = read(line, device, object).map_err(while_doing(&setting))?;
        if Some(&found) != object.bytes().as_ref() {
            return NotStarted::of(format!("{setting}: its bytes read back {found:02x?}"));
        }
        report.push(format!("`{}`: {index:#06x}:{sub:02x} set to {value}, read back", identity.name));
    }
    Ok(())
}

fn write<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    object: &Startup,
) -> Result<(), Failure> {
    let Startup { index, sub, .. } = *object;
    match object.bytes().unwrap_or_default()[..] {
        [a] => line.run(device.sdo_write(index, sub, a)),
        [a, b] => line.run(device.sdo_write(index, sub, u16::from_le_bytes([a, b]))),
        [a, b, c, d] => line.run(device.sdo_write(index, sub, u32::from_le_bytes([a, b, c, d]))),
        // The rig's reader has seen to it that there are bytes, and a type has no other length.
        _ => Ok(()),
    }
}

fn read<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    object: &Startup,
) -> Result<Vec<u8>, Failure> {
    let Startup { index, sub, kind, .. } = *object;
    Ok(match kind.bits() {
        8 => vec![line.run(device.sdo_read::<u8>(index, sub))?],
        16 => line.run(device.sdo_read::<u16>(index, sub))?.to_le_bytes().to_vec(),
        _ => line.run(device.sdo_read::<u32>(index, sub))?.to_le_bytes().to_vec(),
    })
}

/// Maps `wanted` to the device's process data, if it is not so mapped already, and reads it back.
///
/// Errors: the device does not take it.
pub(super) fn map<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    identity: &Identity,
    assigned: u16,
    wanted: &ProcessData,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    let name = &identity.name;
    if !has_objects(line, device) {
        let what =
            "has no object dictionary: its process data are taken to be as the rig says, and their length is checked";
        report.push(format!("`{name}` {what}"));
        return Ok(());
    }
    let before = mapped(line, device, assigned);
    if before.is_alike(wanted) {
        return Ok(());
    }
    let written = assign(line, device, assigned, &before, wanted);
    let found = mapped(line, device, assigned);
    if found.is_alike(wanted) {
        return Ok(());
    }
    // Of a device whose list is as it is the first PDOs are read, if they are the rig's.
    let more = found.pdos.len().saturating_sub(wanted.pdos.len());
    let first = ProcessData { pdos: found.pdos[..found.pdos.len() - more].to_vec() };
    if assigned == ASSIGNED_INPUTS && more > 0 && first.is_alike(wanted) {
        let last = wanted.assignment().last().copied().unwrap_or_default();
        report.push(format!("`{name}` sends {more} PDOs more behind {last:#06x}, which are left alone"));
        return Ok(());
    }
    let why = written.err().map_or(String::new(), |failure| format!(" ({failure})"));
    let [wanted, found] = [wanted, &found].map(words);
    NotStarted::of(format!(
        "`{name}` does not take the process data that the rig maps to {wanted}{why}: it has {found}; \
         correct the entries in the rig: `tautline rig scan` shows the device's own"
    ))
}

/// Takes the assignment away, maps those PDOs that are not as they should be, and assigns all. A PDO that the maker has fixed is only
/// assigned. The first failure, where there is one: some devices refuse a part and are as they should be all the same.
fn assign<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    assigned: u16,
    before: &ProcessData,
    wanted: &ProcessData,
) -> Result<(), Failure> {
    let mut done = vec![line.run(device.sdo_write(assigned, 0u8, 0u8))];
    for pdo in &wanted.pdos {
        let is_so = match before.pdos.iter().find(|found| found.index == pdo.index) {
            Some(found) => found.mapping() == pdo.mapping(),
            None => super::found::entries(line, device, pdo.index)
                .is_ok_and(|entries| entries.iter().map(|entry| entry.mapping()).eq(pdo.mapping())),
        };
        if !is_so {
            done.push(line.run(device.sdo_write_array(pdo.index, pdo.mapping())));
        }
    }
    done.push(line.run(device.sdo_write_array(assigned, wanted.assignment())));
    done.into_iter().collect()
}

fn words(data: &ProcessData) -> String {
    let one = |pdo: &super::rig::Pdo| {
        let entries: Vec<String> = pdo.mapping().iter().map(|word| format!("{word:#010x}")).collect();
        format!("{:#06x} [{}]", pdo.index, entries.join(", "))
    };
    let all: Vec<String> = data.pdos.iter().map(one).collect();
    if all.is_empty() { "nothing".to_string() } else { all.join(" ") }
}
