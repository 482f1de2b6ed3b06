//! What the drive itself watches over: it is read, set and read back before there is torque, and must be as it should.

use super::drive::brakes;
use super::line::Line;
use super::master::{NotStarted, while_doing};
use super::rig::Drive;
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
    drive: &Drive,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
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
