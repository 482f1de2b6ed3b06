//! What the drive itself watches over: it is read, set and read back before there is torque, and must be as it should.

use super::drive::{Mode, brakes, holds};
use super::group::{NotStarted, while_doing};
use super::limits::SPEED_ROOM;
use super::line::Line;
use super::rig::{Drive, Rig};
use super::wire::Wire;
use ethercrab::{EtherCrabWireReadSized, EtherCrabWireWrite, SubDevice, SubDeviceRef};
use std::ops::Deref;

/// How many times the limit of speed a drive's own loops may go at, to catch up with their target: less than a measurement may be.
const CATCHING_UP: f64 = 1.1;

/// Reads what the drive does on a stop, and sets and reads back what it allows itself; adds lines to `report`. Whether the drive holds
/// the joint after a quick stop (option 5 to 8).
///
/// Errors: the first thing that the drive does not have, or not as it should be, with its object.
pub(super) fn set_all<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<bool, NotStarted> {
    let drive = &rig.drive;
    let option: Option<i16> = object(line, device, drive, 0x605A, "quick-stop option", report)?;
    if let Some(option) = option.filter(|option| !brakes(*option)) {
        return NotStarted::of(format!(
            "`{}` does not brake on a quick stop: its option (0x605A) is {option}; set it to 2 in the drive's own tool",
            drive.identity.name
        ));
    }
    let modes = line.run(device.sdo_read::<u32>(drive.object(0x6502), 0u8));
    let (name, code) = (&drive.identity.name, drive.mode.code());
    if modes.is_ok_and(|modes| modes >> (code - 1) & 1 == 0) {
        return NotStarted::of(format!(
            "`{name}` does not know mode {code} (0x6502): choose another `mode` in the rig"
        ));
    }
    let reaction: Option<i16> = object(line, device, drive, 0x605E, "fault reaction", report)?;
    let ramp: Option<u32> = object(line, device, drive, 0x6085, "quick-stop deceleration", report)?;
    if ramp == Some(0) {
        return NotStarted::of(format!("`{}` has a quick-stop deceleration (0x6085) of 0", drive.identity.name));
    }
    let told = |value: Option<i16>| value.map_or("unknown".to_string(), |value| value.to_string());
    let ramp = ramp.map_or("deceleration unknown".to_string(), |ramp| {
        format!("{:.1} rad/s^2 if its unit is counts/s^2", f64::from(ramp) / drive.counts_per_rad)
    });
    report.push(format!("quick stop: option {}, {ramp}; fault reaction: option {}", told(option), told(reaction)));
    report.extend(interpolate(line, device, drive, rig.bus.cycle_us));
    report.push(range(line, device, rig)?);
    report.push(speed(line, device, rig)?);
    allow(line, device, drive, report)?;
    Ok(option.is_some_and(holds))
}

/// Sets what the drive may do, and reads it back; only what was read back is reported as such.
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
    let mut read_back = Vec::new();
    if set(line, device, drive, 0x6065, "following-error window", window, report)? {
        read_back.push(format!("following error {window} counts"));
    }
    if set(line, device, drive, 0x6066, "following-error time", time_ms, report)? {
        read_back.push(format!("for {time_ms} ms"));
    }
    if set(line, device, drive, 0x6072, "maximum torque", torque, report)? {
        read_back.push(format!("torque {torque} per mille"));
    }
    // Where it is exchanged every cycle, that is what counts, and a drive need not take it otherwise.
    if drive.outputs.place("mode").is_none() && set(line, device, drive, 0x6060, "mode", mode, report)? {
        read_back.push(format!("mode {mode}"));
    }
    report.push(match read_back.is_empty() {
        true => "NONE OF THE DRIVE'S OWN LIMITS WAS READ BACK".to_string(),
        false => format!("drive's own limits, read back: {}", read_back.join(", ")),
    });
    Ok(())
}

/// Tells the drive how far its targets are apart, where it has an object for that (0x60C2): else it would rush to each and wait
/// there. In words.
fn interpolate<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    cycle_us: u32,
) -> Option<String> {
    let index = drive.object(0x60C2);
    let found = |line: &mut Line<'_, W>| {
        let exponent = line.run(device.sdo_read::<i8>(index, 2u8)).ok()?;
        Some((line.run(device.sdo_read::<u8>(index, 1u8)).ok()?, exponent))
    };
    let before = found(line)?;
    // As many of 1 ms, 0.1 ms, 10 us or 1 us as make the cycle, if they fit a byte.
    let wanted = [(1000, -3), (100, -4), (10, -5), (1, -6)].into_iter().find_map(|(unit_us, exponent)| {
        let units = u8::try_from(cycle_us / unit_us).ok().filter(|_| cycle_us.is_multiple_of(unit_us))?;
        Some((units, exponent))
    });
    if let Some((units, exponent)) = wanted.filter(|wanted| *wanted != before) {
        // What is not taken is seen when it is read back.
        let _ = line.run(device.sdo_write(index, 2u8, exponent));
        let _ = line.run(device.sdo_write(index, 1u8, units));
    }
    let after = found(line)?;
    let (units, exponent) = after;
    let stays = if Some(after) == wanted { "" } else { ", WHICH IS NOT THE CYCLE: set it in the drive's own tool" };
    Some(format!("time between targets: {units} x 10^{exponent} s{stays}"))
}

/// Sets the drive's own limits of position (0x607D) to the rig's range and the lag that it allows, where it has them, and reads them
/// back. In words.
///
/// Errors: it has them, and does not take them.
fn range<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    rig: &Rig,
) -> Result<String, NotStarted> {
    let (drive, limits) = (&rig.drive, &rig.limits);
    let index = drive.object(0x607D);
    if let Some(why) = missing::<_, _, i32>(line, device, drive, 0x607D, 1) {
        return Ok(format!("THE DRIVE HAS NO LIMITS OF POSITION of its own ({why}): only software keeps the range"));
    }
    let ends =
        [limits.low_rad - limits.lag_rad, limits.high_rad + limits.lag_rad].map(|end| drive.counts(end).round() as i32);
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    put(line, device, drive, (0x607D, 1), "limit of position", low)?;
    put(line, device, drive, (0x607D, 2), "limit of position", high)?;
    Ok(format!("drive's limits of position, read back: {low} to {high} counts ({index:#06x})"))
}

/// Sets the drive's own limit of speed (0x607F), where it has one, and reads it back. It bounds torque mode, to what a measurement may be,
/// and what the drive's own loops make of an encoder that jumps. In words.
///
/// Errors: a drive in torque mode has one, and does not take it: nothing else in it keeps the speed.
fn speed<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    rig: &Rig,
) -> Result<String, NotStarted> {
    let drive = &rig.drive;
    let index = drive.object(0x607F);
    if let Some(why) = missing::<_, _, u32>(line, device, drive, 0x607F, 0) {
        return Ok(format!("THE DRIVE HAS NO LIMIT OF SPEED of its own ({why}): only software keeps it"));
    }
    let room = if drive.mode == Mode::Torque { SPEED_ROOM } else { CATCHING_UP };
    let counts_s = (room * rig.limits.speed_rad_s * drive.counts_per_rad).round().min(f64::from(u32::MAX)) as u32;
    match put(line, device, drive, (0x607F, 0), "limit of speed", counts_s) {
        Ok(()) => Ok(format!("drive's limit of speed, read back: {counts_s} counts/s ({index:#06x})")),
        Err(refused) if drive.mode == Mode::Torque => Err(refused),
        Err(NotStarted(why)) => Ok(format!("THE DRIVE KEEPS ITS OWN LIMIT OF SPEED: {why}")),
    }
}

/// Why a limit that not every drive has cannot be set: the rig says so, or the drive does.
fn missing<W: Wire, S: Deref<Target = SubDevice>, T: EtherCrabWireReadSized>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    index: u16,
    sub: u8,
) -> Option<String> {
    let at = drive.object(index);
    if drive.without.contains(&index) {
        return Some(format!("{at:#06x}, which the rig says that it has not"));
    }
    line.run(device.sdo_read::<T>(at, sub)).err().map(|failure| format!("{at:#06x}: {failure}"))
}

/// What the drive says under `index`; nothing where it does not, and the rig says that it has no such object: then it is unknown, which
/// is reported.
///
/// Errors: it does not tell, and the rig does not say so.
fn object<W: Wire, S: Deref<Target = SubDevice>, T: EtherCrabWireReadSized>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    index: u16,
    what: &str,
    report: &mut Vec<String>,
) -> Result<Option<T>, NotStarted> {
    let at = drive.object(index);
    match line.run(device.sdo_read::<T>(at, 0u8)) {
        Ok(value) => Ok(Some(value)),
        Err(_) if drive.without.contains(&index) => {
            report
                .push(format!("THE DRIVE'S {} IS UNKNOWN: the rig says that it has no {at:#06x}", what.to_uppercase()));
            Ok(None)
        }
        Err(failure) => NotStarted::of(format!(
            "`{}` does not tell its {what} ({at:#06x}): {failure}; if its manual says that it has no such object and how it stops \
             without, add `without = [{index:#06x}]` to [drive]",
            drive.identity.name
        )),
    }
}

/// Sets the object `index` and reads it back. Where the rig says that the drive does not have it, it is left as it is, which is reported.
///
/// Errors: the drive does not take it.
fn set<W: Wire, S: Deref<Target = SubDevice>, T>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    index: u16,
    what: &str,
    value: T,
    report: &mut Vec<String>,
) -> Result<bool, NotStarted>
where
    T: EtherCrabWireReadSized + EtherCrabWireWrite + PartialEq + std::fmt::Display + Copy,
{
    let Some(before) = object::<_, _, T>(line, device, drive, index, what, report)? else { return Ok(false) };
    let at = drive.object(index);
    if drive.without.contains(&index) {
        let left = "and was not set: the rig says that the drive has no such object";
        report.push(format!("THE DRIVE'S {} IS {before} ({at:#06x}), {left}", what.to_uppercase()));
        return Ok(false);
    }
    put(line, device, drive, (index, 0), what, value).map(|()| true)
}

/// Writes `value` to the object that is `index` of a first axis, and reads it back.
///
/// Errors: the drive does not take it.
fn put<W: Wire, S: Deref<Target = SubDevice>, T>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    drive: &Drive,
    (index, sub): (u16, u8),
    what: &str,
    value: T,
) -> Result<(), NotStarted>
where
    T: EtherCrabWireReadSized + EtherCrabWireWrite + PartialEq + std::fmt::Display + Copy,
{
    let (name, at) = (&drive.identity.name, drive.object(index));
    let setting = format!("`{name}` does not take a {what} ({at:#06x}:{sub:02x}) of {value}");
    line.run(device.sdo_write(at, sub, value)).map_err(while_doing(&setting))?;
    match line.run(device.sdo_read::<T>(at, sub)).map_err(while_doing(&setting))? {
        found if found == value => Ok(()),
        found => NotStarted::of(format!("{setting}: it reads back {found}")),
    }
}
