//! What the drive itself watches over: it is read, set and read back before there is torque, and must be as it should.

use super::drive::brakes;
use super::line::Line;
use super::master::{NotStarted, while_doing};
use super::rig::{Drive, Rig};
use super::wire::Wire;
use ethercrab::{EtherCrabWireReadSized, EtherCrabWireWrite, SubDevice, SubDeviceRef};
use std::ops::Deref;

/// Ticks of 40 ns, less 2, in a tick of the watchdogs; and how many of those the outputs' watchdog waits.
const WATCHDOG_DIVIDER: u16 = 0x0400;
const WATCHDOG_OUTPUTS: u16 = 0x0420;

/// Reads what the drive does on a stop, and sets and reads back what it allows itself; adds lines to `report`.
///
/// Errors: the first thing that the drive does not have, or not as it should be, with its object.
pub(super) fn set_all<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    let drive = &rig.drive;
    let option: i16 = object(line, device, drive, 0x605A, "quick-stop option")?;
    if !brakes(option) {
        return NotStarted::of(format!(
            "`{}` does not brake on a quick stop: its option (0x605A) is {option}; set it to 2 in the drive's own tool",
            drive.identity.name
        ));
    }
    let modes = line.run(device.sdo_read::<u32>(0x6502, 0u8));
    let (name, code) = (&drive.identity.name, drive.mode.code());
    if modes.is_ok_and(|modes| modes >> (code - 1) & 1 == 0) {
        return NotStarted::of(format!(
            "`{name}` does not know mode {code} (0x6502): choose another `mode` in the rig"
        ));
    }
    let reaction: i16 = object(line, device, drive, 0x605E, "fault reaction")?;
    let ramp: u32 = object(line, device, drive, 0x6085, "quick-stop deceleration")?;
    if ramp == 0 {
        return NotStarted::of(format!("`{}` has a quick-stop deceleration (0x6085) of 0", drive.identity.name));
    }
    let ramp_rad_s2 = f64::from(ramp) / drive.counts_per_rad;
    report.push(format!(
        "quick stop: option {option}, {ramp_rad_s2:.1} rad/s^2 if its unit is counts/s^2; fault reaction: option {reaction}"
    ));
    report.push(watchdog(line, device));
    report.extend(interpolate(line, device, rig.bus.cycle_us));
    allow(line, device, drive, report)
}

/// Sets what the drive may do, and reads it back.
fn allow<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    let window = (drive.following_error_rad * drive.counts_per_rad).round() as u32;
    let time_ms = (drive.following_error_s * 1e3).round() as u16;
    let torque = (drive.torque_max_nm / drive.rated_torque_nm * 1e3).round().clamp(0.0, 65_535.0) as u16;
    let mode = drive.mode.code();
    set(line, device, drive, 0x6065, "following-error window", window)?;
    set(line, device, drive, 0x6066, "following-error time", time_ms)?;
    set(line, device, drive, 0x6072, "maximum torque", torque)?;
    // Where it is exchanged every cycle, that is what counts, and a drive need not take it otherwise.
    if drive.outputs.place("mode").is_none() {
        set(line, device, drive, 0x6060, "mode", mode as u8)?;
    }
    report.push(format!(
        "drive's own limits, read back: following error {window} counts for {time_ms} ms, torque {torque} per mille"
    ));
    Ok(())
}

/// Tells the drive how far its targets are apart, where it has an object for that (0x60C2): else it would rush to each and wait
/// there. In words.
fn interpolate<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    cycle_us: u32,
) -> Option<String> {
    let found = |line: &mut Line<'_, W>| {
        let exponent = line.run(device.sdo_read::<i8>(0x60C2, 2u8)).ok()?;
        Some((line.run(device.sdo_read::<u8>(0x60C2, 1u8)).ok()?, exponent))
    };
    let before = found(line)?;
    // As many of 1 ms, 0.1 ms, 10 us or 1 us as make the cycle, if they fit a byte.
    let wanted = [(1000, -3), (100, -4), (10, -5), (1, -6)].into_iter().find_map(|(unit_us, exponent)| {
        let units = u8::try_from(cycle_us / unit_us).ok().filter(|_| cycle_us.is_multiple_of(unit_us))?;
        Some((units, exponent))
    });
    if let Some((units, exponent)) = wanted.filter(|wanted| *wanted != before) {
        // What is not taken is seen when it is read back.
        let _ = line.run(device.sdo_write(0x60C2, 2u8, exponent));
        let _ = line.run(device.sdo_write(0x60C2, 1u8, units));
    }
    let after = found(line)?;
    let (units, exponent) = after;
    let stays = if Some(after) == wanted { "" } else { ", WHICH IS NOT THE CYCLE: set it in the drive's own tool" };
    Some(format!("time between targets: {units} x 10^{exponent} s{stays}"))
}

/// After how long without data the device leaves OP by itself, which a drive answers by stopping: what is left of safety where this
/// program or its computer dies. In words.
fn watchdog<W: Wire, S: Deref<Target = SubDevice>>(line: &mut Line<'_, W>, device: &SubDeviceRef<'_, S>) -> String {
    let divider = line.run(device.register_read::<u16>(WATCHDOG_DIVIDER));
    let ticks = line.run(device.register_read::<u16>(WATCHDOG_OUTPUTS));
    match (divider, ticks) {
        (Ok(_), Ok(0)) => {
            "OUTPUT WATCHDOG OFF: should this computer die, the drive keeps its last target; switch it on".to_string()
        }
        (Ok(divider), Ok(ticks)) => {
            let ms = (f64::from(divider) + 2.0) * 40e-6 * f64::from(ticks);
            format!("output watchdog: {ms:.0} ms")
        }
        _ => "output watchdog: the drive does not tell".to_string(),
    }
}

fn object<W: Wire, S: Deref<Target = SubDevice>, T: EtherCrabWireReadSized>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    index: u16,
    what: &str,
) -> Result<T, NotStarted> {
    let asking = format!("`{}` does not tell its {what} ({index:#06x})", drive.identity.name);
    line.run(device.sdo_read::<T>(index, 0u8)).map_err(while_doing(&asking))
}

fn set<W: Wire, S: Deref<Target = SubDevice>, T>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    index: u16,
    what: &str,
    value: T,
) -> Result<(), NotStarted>
where
    T: EtherCrabWireReadSized + EtherCrabWireWrite + PartialEq + std::fmt::Display + Copy,
{
    let name = &drive.identity.name;
    let setting = format!("`{name}` does not take a {what} ({index:#06x}) of {value}");
    line.run(device.sdo_write(index, 0u8, value)).map_err(while_doing(&setting))?;
    let found: T = object(line, device, drive, index, what)?;
    match found == value {
        true => Ok(()),
        false => NotStarted::of(format!("{setting}: it reads back {found}")),
    }
}
