//! The output watchdog of every device that takes outputs: set, switched on, read back. It is what stops a drive when this program
//! or its computer dies; without it a drive keeps its last target, in speed mode for good.
//!
//! The bus interface counts ticks of (divider + 2) 40 ns (register 0x0400) and takes the device out of OP after so many (0x0420)
//! without outputs, if their sync manager has bit 6 of its control byte set (ETG.1000.4; Beckhoff's ESC data sheet, section II).

use super::group::{Group, NotStarted};
use super::line::Line;
use super::managers::{FEEDS_WATCHDOG, Manager, managers};
use super::rig::{Bus, Drive, Rig};
use super::wire::Wire;
use ethercrab::subdevice_group::{NoDc, PreOpPdi};
use ethercrab::{MainDevice, SubDevice, SubDeviceRef};
use std::ops::Deref;

const DIVIDER: u16 = 0x0400;
const OUTPUTS: u16 = 0x0420;
/// Bit 0: the watchdog runs and is fed.
const STATUS: u16 = 0x0440;
/// The divider with which a tick is 0.1 ms.
const TENTH_MS: u16 = 2498;

/// Sets the watchdog of every device with outputs, in PRE-OP with the process data laid out; adds lines to `report`. Gives what is
/// wrong with the first that has none.
///
/// Errors: a device that is not the rig's takes outputs, and the rig does not name it among `others`.
pub(super) fn set_all<W: Wire>(
    line: &mut Line<'_, W>,
    main: &MainDevice<'_>,
    group: &Group<PreOpPdi, NoDc>,
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<Option<String>, NotStarted> {
    let mut wrong = None;
    let count = group.iter(main).count();
    for place in 0..count {
        let Ok(device) = group.subdevice(main, place) else { continue };
        let outputs: Vec<Manager> = managers(line, &device).into_iter().filter(Manager::is_outputs).collect();
        if outputs.is_empty() {
            continue;
        }
        let name = rig.name(place).unwrap_or_else(|| format!("device {place} (`{}`)", device.name()));
        if rig.name(place).is_none() {
            if !rig.bus.others.contains(&place) {
                return NotStarted::of(format!(
                    "{name} takes outputs and is not in the rig: it would be brought to OP with all its outputs 0; take it off \
                     the bus, or, where that harms nobody, add its place to `others` in [bus]"
                ));
            }
            report.push(format!("{name} IS NOT IN THE RIG and is brought to OP too, all its outputs 0"));
        }
        match set(line, &device, &outputs, rig.bus.watchdog_ms) {
            Ok(()) => report.push(format!("{name}: output watchdog {} ms, read back", rig.bus.watchdog_ms)),
            Err(why) => {
                let why = format!(
                    "{name} HAS NO OUTPUT WATCHDOG of {} ms ({why}): should this computer die, it keeps its last target",
                    rig.bus.watchdog_ms
                );
                report.push(why.clone());
                wrong.get_or_insert(why);
            }
        }
    }
    Ok(wrong)
}

fn set<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    outputs: &[Manager],
    watchdog_ms: u32,
) -> Result<(), String> {
    let ticks = u16::try_from(10 * watchdog_ms).unwrap_or(u16::MAX);
    // What is not taken is seen when it is read back.
    let _ = line.run(device.register_write(DIVIDER, TENTH_MS));
    let _ = line.run(device.register_write(OUTPUTS, ticks));
    for manager in outputs.iter().filter(|manager| manager.control & FEEDS_WATCHDOG == 0) {
        // Its control can be written only while it is not active.
        let _ = line.run(device.register_write(manager.activation_at(), 0u8));
        let _ = line.run(device.register_write(manager.control_at(), manager.control | FEEDS_WATCHDOG));
        let _ = line.run(device.register_write(manager.activation_at(), manager.activation));
    }
    let divider = line.run(device.register_read::<u16>(DIVIDER)).map_err(|failure| failure.to_string())?;
    let found = line.run(device.register_read::<u16>(OUTPUTS)).map_err(|failure| failure.to_string())?;
    let ms = (f64::from(divider) + 2.0) * 40e-6 * f64::from(found);
    if found == 0 {
        return Err("it is switched off: register 0x0420 reads back 0".to_string());
    }
    if (ms - f64::from(watchdog_ms)).abs() > 0.5 {
        return Err(format!("it reads back {ms:.1} ms; set `watchdog_ms` in [bus] if that will do"));
    }
    for manager in outputs {
        let control =
            line.run(device.register_read::<u8>(manager.control_at())).map_err(|failure| failure.to_string())?;
        if control & FEEDS_WATCHDOG == 0 {
            return Err(format!("bit 6 of register {:#06x} stays 0: outputs do not feed it", manager.control_at()));
        }
    }
    Ok(())
}

/// The sync error counter limit (ETG.1020): a device that works by its clock's pulses gives up once its counter gets there. Each pulse for
/// which no outputs came counts `MISSED`, each other takes one off. Its makers' 4 gives up after two cycles, their 255 after 85.
const SYNC_ERROR_LIMIT: (u16, u8) = (0x10F1, 2);
const MISSED: u32 = 3;

/// Sets when a device in PRE-OP gives up because pulses of its clock come without outputs: just after its output watchdog, which it so
/// backs up, and beyond the gap that the rig lets pass. In words; nothing where the rig has that among its start-up objects.
pub(super) fn give_up<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    bus: &Bus,
) -> Option<String> {
    let ((index, sub), name) = (SYNC_ERROR_LIMIT, &drive.identity.name);
    if drive.setup.startup.iter().any(|object| (object.index, object.sub) == SYNC_ERROR_LIMIT) {
        return None;
    }
    let cycles = (1000 * bus.watchdog_ms).div_ceil(bus.cycle_us) + 1;
    let limit = u16::try_from(MISSED * cycles).unwrap_or(u16::MAX);
    // What is not taken is seen when it is read back.
    let _ = line.run(device.sdo_write(index, sub, limit));
    Some(match line.run(device.sdo_read::<u16>(index, sub)) {
        Ok(found) if found == limit => {
            format!(
                "`{name}`: gives up after {cycles} pulses of its clock without outputs ({index:#06x}:02 = {limit}, read back)"
            )
        }
        Ok(found) => format!(
            "`{name}`: GIVES UP AFTER {} PULSES OF ITS CLOCK WITHOUT OUTPUTS ({index:#06x}:02 stays {found}), not after {cycles}",
            u32::from(found).div_ceil(MISSED)
        ),
        Err(failure) => {
            format!(
                "`{name}`: when it gives up without outputs, beside its watchdog, is unknown ({index:#06x}:02: {failure})"
            )
        }
    })
}

/// Whether the watchdog of a device in OP runs and is fed by what is sent now.
pub(super) fn is_fed<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    until_ns: u64,
) -> Option<bool> {
    line.run_until(until_ns, device.register_read::<u8>(STATUS)).ok().map(|status| status & 1 != 0)
}
