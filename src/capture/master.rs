//! The way to OP: who is there, what is exchanged, the drive's own limits, the clocks, cyclic data.

use super::exchange::{Exchange, exchange};
use super::found::{ASSIGNED_INPUTS, ASSIGNED_OUTPUTS, Found, found};
use super::group::{Group, NotStarted, ailing, while_doing};
use super::history;
use super::line::{Failure, Line};
use super::mapping;
use super::own_limits;
use super::pulses;
use super::rig::{BrakeDevice, Drive, ProcessData, Rig};
use super::watchdog;
use super::wire::Wire;
use ethercrab::subdevice_group::{DcConfiguration, HasDc, NoDc, Op, PreOp, PreOpPdi};
use ethercrab::{DcSync, MainDevice, SubDevice, SubDeviceRef};
use serde_json::Value;
use std::ops::Deref;
use std::time::Duration;

/// Cycles between starting the exchange and the clocks' own pulses.
const CLOCK_START: Duration = Duration::from_millis(20);
/// Exchanges that bring the clocks together before their pulses are set.
const CLOCK_EXCHANGES: usize = 20;
/// Cycles with everybody at work that end the way up: by then the clocks' pulses have begun.
const SETTLED: u32 = 50;
/// How long that lasts at least, s: at short cycles a device may still send zeros for its first measurements.
const SETTLED_S: f64 = 0.05;
/// How long the devices may take to get to OP while data flow, s: what ETG.1020 gives to those that name no time of their own.
const TO_OP_S: f64 = 10.0;

/// What was found on the way up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Lines of a report.
    pub report: Vec<String>,
    /// The device without an output watchdog that works, and why.
    pub unwatched: Option<String>,
    /// What the drives remember of their faults, by name.
    pub histories: Vec<(String, Value)>,
    /// Of each axis, whether its drive holds it after a quick stop.
    pub holds: Vec<bool>,
}

/// What was asked of all devices together, with those named that are in error.
fn of_all<W: Wire, T>(
    line: &mut Line<'_, W>,
    main: &MainDevice<'_>,
    what: &str,
    done: Result<T, Failure>,
) -> Result<T, NotStarted> {
    done.map_err(|failure| NotStarted(format!("{what}: {failure}{}", ailing(line, main))))
}

/// Checks every device against `rig`, in PRE-OP and without enabling anything; sets up what the drive and its process data
/// need. Gives the devices, and the lines of a report.
///
/// Errors: the first mismatch, with device and cure.
pub fn prepare<W: Wire>(
    line: &mut Line<'_, W>,
    main: &MainDevice<'_>,
    group: &Group<PreOp, NoDc>,
    rig: &Rig,
) -> Result<Findings, NotStarted> {
    let mut report = Vec::new();
    let devices: Vec<_> = group.iter(main).collect();
    identify(line, &devices, rig, &mut report)?;
    for (identity, setup) in rig.devices() {
        mapping::start_up(line, &devices[identity.place], identity, setup, &mut report)?;
    }
    map_all(line, &devices, rig, &mut report)?;
    let mut holds = Vec::new();
    for own in rig.each_axis() {
        let device = &devices[own.drive.identity.place];
        let mut own_report = Vec::new();
        holds.push(own_limits::set_all(line, device, &own, &mut own_report)?);
        // With several drives each line names its drive.
        let name = if rig.axes.is_empty() { String::new() } else { format!("`{}`: ", own.drive.identity.name) };
        report.extend(own_report.into_iter().map(|told| format!("{name}{told}")));
    }
    let remembered =
        |drive: &Drive| Some((drive.identity.name.clone(), history::read(line, &devices[drive.identity.place])?));
    let histories: Vec<(String, Value)> = rig.drives().filter_map(remembered).collect();
    report.extend(histories.iter().filter_map(|(name, history)| faults_remembered(name, history)));
    Ok(Findings { report, unwatched: None, histories, holds })
}

/// Compares every device with the one that `rig` lists in its place; adds a line for each to `report`.
fn identify<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    devices: &[SubDeviceRef<'_, S>],
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    for (identity, _) in rig.devices() {
        let Some(device) = devices.get(identity.place) else {
            let (place, count) = (identity.place, devices.len());
            return NotStarted::of(format!("`{}` should be device {place}, and there are {count}", identity.name));
        };
        let found = found(line, identity.place, device);
        if let Some(mismatch) = found.mismatch(identity) {
            return NotStarted::of(format!("device {} is not `{}`: {mismatch}", identity.place, identity.name));
        }
        report.push(format!("{}: {}", identity.name, described(&found)));
    }
    Ok(())
}

/// Writes the mapping of every device's process data, once for each device.
fn map_all<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    devices: &[SubDeviceRef<'_, S>],
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    let mut mapped: Vec<usize> = Vec::new();
    for drive in rig.drives() {
        let (device, identity) = (&devices[drive.identity.place], &drive.identity);
        if !mapped.contains(&identity.place) {
            mapping::map(line, device, identity, ASSIGNED_OUTPUTS, &drive.outputs, report)?;
            mapping::map(line, device, identity, ASSIGNED_INPUTS, &drive.inputs, report)?;
            if rig.bus.clocks {
                report.extend(watchdog::give_up(line, device, drive, &rig.bus));
            }
            mapped.push(identity.place);
        }
    }
    for BrakeDevice { identity, outputs, .. } in rig.brake_devices() {
        if !mapped.contains(&identity.place) {
            mapping::map(line, &devices[identity.place], identity, ASSIGNED_OUTPUTS, outputs, report)?;
            mapped.push(identity.place);
        }
    }
    if !rig.sensor.is_in_drive {
        let (device, identity) = (&devices[rig.sensor.identity.place], &rig.sensor.identity);
        mapping::map(line, device, identity, ASSIGNED_INPUTS, &rig.sensor.inputs, report)?;
    }
    Ok(())
}

/// The line that reports the faults that a drive remembers; nothing without any.
fn faults_remembered(name: &str, history: &Value) -> Option<String> {
    let messages = history["messages"].as_array().filter(|messages| !messages.is_empty())?;
    let (count, object) = (messages.len(), &history["object"]);
    Some(format!("`{name}` remembers {count} faults ({object}), which drive_faults.jsonl lists"))
}

fn described(found: &Found) -> String {
    let clock = if found.has_clock { "with a clock" } else { "without a clock" };
    format!("`{}`, serial {:#010x}, revision {:#010x}, {clock}", found.name, found.serial, found.revision)
}

/// Prepares for clocks that pulse together every cycle.
///
/// Errors: there is no clock, or it is not taken.
pub fn with_clocks<'m, W: Wire>(
    line: &mut Line<'_, W>,
    main: &'m MainDevice<'m>,
    mut group: Group<PreOp, NoDc>,
    rig: &Rig,
    findings: &mut Findings,
) -> Result<Group<PreOpPdi, HasDc>, NotStarted> {
    let period = Duration::from_micros(rig.bus.cycle_us.into());
    for (place, mut device) in group.iter_mut(main).enumerate() {
        if device.dc_support().any() && pulses::of(rig, place).is_none_or(|pulses| pulses.activate != 0) {
            device.set_dc_sync(DcSync::Sync0);
        }
    }
    let group = with_data(line, main, group, rig, findings)?;
    for _ in 0..CLOCK_EXCHANGES {
        line.run(exchange(&group, main)).map_err(while_doing("bringing the clocks together"))?;
        let next_ns = line.wire.now_ns() + period.as_nanos() as u64;
        line.wire.sleep(next_ns);
    }
    let clocks = DcConfiguration { start_delay: CLOCK_START, sync0_period: period, sync0_shift: period / 2 };
    let group = line
        .run(group.configure_dc_sync(main, clocks))
        .map_err(while_doing("setting the clocks' pulses (a bus without clocks takes `clocks = false`)"))?;
    pulses::set_all(line, main, &group, rig, &mut findings.report)?;
    Ok(group)
}

/// Lays out the process data, and sets the watchdogs of what is sent.
///
/// Errors: a device whose data cannot be laid out, or that takes outputs and is unknown to the rig.
pub fn with_data<W: Wire>(
    line: &mut Line<'_, W>,
    main: &MainDevice<'_>,
    group: Group<PreOp, NoDc>,
    rig: &Rig,
    findings: &mut Findings,
) -> Result<Group<PreOpPdi, NoDc>, NotStarted> {
    let done = line.run(group.into_pre_op_pdi(main));
    let group = of_all(line, main, "laying out the process data", done)?;
    findings.unwatched = watchdog::set_all(line, main, &group, rig, &mut findings.report)?;
    Ok(group)
}

/// From PRE-OP to OP, data flowing all the way: a device that waits for them would stall otherwise. Outputs are zero.
///
/// Errors: a device that refuses, or is not in OP in time.
pub fn to_op<'m, W: Wire, C>(
    line: &mut Line<'_, W>,
    main: &'m MainDevice<'m>,
    group: Group<PreOpPdi, C>,
    rig: &Rig,
) -> Result<Exchange<C>, NotStarted> {
    let period_ns = u64::from(rig.bus.cycle_us) * 1000;
    let settled = SETTLED.max((SETTLED_S / rig.bus.period_s()) as u32);
    let done = line.run(group.into_safe_op(main));
    let group = of_all(line, main, "going to SAFE-OP", done)?;
    let done = line.run(group.request_into_op(main));
    let group = of_all(line, main, "asking for OP", done)?;
    check_lengths(main, &group, rig)?;
    let (began_ns, mut last, mut alike) = (line.wire.now_ns(), 0, 0);
    let mut next_ns = began_ns;
    while (line.wire.now_ns() - began_ns) as f64 * 1e-9 < TO_OP_S {
        next_ns = (next_ns + period_ns).max(line.wire.now_ns());
        line.wire.sleep(next_ns);
        let Ok(seen) = line.run_until(next_ns + period_ns, exchange(&group, main)) else { continue };
        // A working counter that has not settled cannot be compared with.
        alike = if seen.fallen.is_none() && seen.working_counter == last { alike + 1 } else { 0 };
        last = seen.working_counter;
        if alike >= settled && last > 0 {
            return Ok(Exchange { group, working_counter: last });
        }
    }
    let states = states(line, main, &group, rig);
    NotStarted::of(format!("not all devices got to OP within {TO_OP_S} s: {states}"))
}

/// The layout that the devices ended up with must be the one that the rig reads by.
fn check_lengths<C>(main: &MainDevice<'_>, group: &Group<Op, C>, rig: &Rig) -> Result<(), NotStarted> {
    let drives = rig.drives().map(|drive| (&drive.identity, Some(&drive.inputs), Some(&drive.outputs)));
    let sensor = (!rig.sensor.is_in_drive).then_some((&rig.sensor.identity, Some(&rig.sensor.inputs), None));
    let brakes = rig.brake_devices().map(|device| (&device.identity, None, Some(&device.outputs)));
    for (identity, inputs, outputs) in drives.chain(sensor).chain(brakes) {
        let Ok(device) = group.subdevice(main, identity.place) else {
            return NotStarted::of(format!("`{}` is gone", identity.name));
        };
        let (found_in, found_out) = (device.inputs_raw().len(), device.outputs_raw().len());
        let wanted_out = outputs.map_or(found_out, ProcessData::bytes);
        let wanted_in = inputs.map_or(0, ProcessData::bytes);
        if found_in < wanted_in || found_out < wanted_out {
            return NotStarted::of(format!(
                "`{}` exchanges {found_in} bytes in and {found_out} out, the rig reads {wanted_in} and writes {wanted_out}",
                identity.name,
            ));
        }
    }
    Ok(())
}

/// Where each device is, and why, in words.
pub fn states<W: Wire, C>(line: &mut Line<'_, W>, main: &MainDevice<'_>, group: &Group<Op, C>, rig: &Rig) -> String {
    let named = |place: usize| rig.name(place).unwrap_or_else(|| format!("device {place}"));
    let one = |(place, device): (usize, SubDeviceRef<'_, _>)| {
        let state = line.run(device.status());
        match state {
            Ok((state, code)) => format!("{} in {state:?} ({code})", named(place)),
            Err(failure) => format!("{} in error: {failure}", named(place)),
        }
    };
    group.iter(main).enumerate().map(one).collect::<Vec<_>>().join(", ")
}
