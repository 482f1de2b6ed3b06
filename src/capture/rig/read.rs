//! `rig.toml` -> a rig: every key, and what the keys must be together.

use super::read_drive::read_drive;
use super::read_sensor::read_sensor;
use super::{BrakeDevice, Bus, Drive, FORMAT, HeldAxis, Identity, Place, Rig, Target};
use crate::capture::limits::Limits;
use crate::document::Section;
use crate::dynamics::Dynamics;
use crate::log::{Signal, longest_gap_s};
use crate::model::Joint;

/// A whole rig.
pub(super) fn rig(root: &Section<'_>) -> Option<Rig> {
    root.need("format").choice(&[(FORMAT, ())]);
    let bus = root.need("bus").such_as("[bus]", "a section with the interface").section(read_bus);
    let drive = root.need("drive").such_as("[drive]", "a section on the drive");
    let drive = drive.section(|section| read_drive(section, Target::Path));
    let axes = root.may("axes").sections(HeldAxis::read);
    let sensor = root.need("sensor").such_as("[sensor]", "where the torque comes from");
    let sensor = sensor.section(|section| read_sensor(section, drive.as_ref()));
    let limits = root.need("limits").such_as("[limits]", "what the joint may do").section(Limits::read);
    let joint = root.need("joint").such_as("[joint]", "as in campaign.toml");
    let joint = joint.section(|section| Joint::read(section, Joint::read_kind(section)));
    let dynamics = root.need("dynamics").such_as("[dynamics]", "as in campaign.toml").section(read_dynamics);
    let signal = root.need("signal").such_as("[signal]", "as in campaign.toml").section(Signal::read);
    if let (Some(drive), Some(sensor)) = (&drive, &sensor)
        && !sensor.is_in_drive
        && drive.identity.place == sensor.identity.place
    {
        root.reject("sensor", "has the drive's place on the bus", "count the devices from 0: `tautline rig scan`");
    }
    if let (Some(drive), Some(limits)) = (&drive, &limits) {
        check_counts(root, drive, limits);
    }
    if let (Some(bus), Some(signal)) = (&bus, &signal) {
        check_gaps(root, bus, signal);
    }
    let rig = Rig {
        bus: bus?,
        drive: drive?,
        sensor: sensor?,
        limits: limits?,
        joint: joint?,
        dynamics: dynamics?,
        signal: signal?,
        axes: axes.unwrap_or_default(),
    };
    for (index, axis) in rig.axes.iter().enumerate() {
        axis.check(root, &rig, index);
        check_counts(root, &axis.drive, &axis.limits);
    }
    check_brakes(root, &rig);
    Some(rig)
}

/// What the joint may go on through must leave a log that opens; two missed cycles always do.
fn check_gaps(root: &Section<'_>, bus: &Bus, signal: &Signal) {
    let period_s = f64::from(bus.cycle_us) * 1e-6;
    let allowed = ((longest_gap_s(signal.lowpass_hz) / period_s * (1.0 + 1e-9)).floor() - 1.0).max(2.0);
    if f64::from(bus.missed_cycles_max) > allowed {
        let gap_s = f64::from(bus.missed_cycles_max + 1) * period_s;
        let what =
            format!("lets a gap of {gap_s} s pass, which spoils a log at a low-pass of {} Hz", signal.lowpass_hz);
        root.reject("bus", what, format!("missed_cycles_max = {allowed} at most"));
    }
}

/// What a drive counts in must hold what the joint may do: a target that is cut off would be a jump.
fn check_counts(root: &Section<'_>, drive: &Drive, limits: &Limits) {
    let ends_rad = [limits.low_rad - limits.lag_rad, limits.high_rad + limits.lag_rad];
    let places = [drive.inputs.place("position"), drive.outputs.place("target_position")];
    let beyond = ends_rad.map(|end_rad| drive.counts(end_rad)).into_iter().find(|counts| {
        let holds = |place: Option<Place>| place.is_none_or(|place| place.holds(*counts));
        !places.into_iter().all(holds)
    });
    if let Some(counts) = beyond {
        let what = format!("puts an end of [limits] at {counts:.0} counts, which its position cannot hold");
        root.reject("drive", what, "check counts_per_rad and zero_counts, and the limits");
    }
    let window = drive.following_error_rad * drive.counts_per_rad;
    // The largest number switches it off (CiA 402-2, object 0x6065).
    if !(1.0..f64::from(u32::MAX)).contains(&window.round()) {
        let what = format!("makes a following error of {window:.1} counts");
        root.reject("drive", what, "check following_error_rad and counts_per_rad");
    }
    let torque = drive.torque_max_nm / drive.rated_torque_nm * 1e3;
    if !(1.0..=f64::from(i16::MAX)).contains(&torque.round()) {
        let what = format!("may give {torque:.1} per mille of its rated torque");
        root.reject("drive", what, "check torque_max_nm and rated_torque_nm");
    }
}

/// Devices that only let a brake go: no other of the rig, unless they let several go.
fn check_brakes(root: &Section<'_>, rig: &Rig) {
    let taken = |place: usize| {
        rig.drives().any(|drive| drive.identity.place == place)
            || !rig.sensor.is_in_drive && rig.sensor.identity.place == place
    };
    let devices: Vec<&BrakeDevice> = rig.brake_devices().collect();
    for (i, device) in devices.iter().enumerate() {
        let place = device.identity.place;
        let name = &device.identity.name;
        if taken(place) {
            let cure = "an output of the drive itself takes no `device`: `as = \"brake\"` among the drive's outputs";
            root.reject("drive", format!("has its brake on `{name}`, at the place of a drive or the sensor"), cure);
        }
        let other = devices[..i].iter().find(|other| other.identity.place == place);
        if other.is_some_and(|other| !other.outputs.is_alike(&device.outputs)) {
            let cure = "list the same PDOs with all entries, each with its own `as = \"brake\"`";
            root.reject("drive", format!("has brakes on `{name}` that map its outputs differently"), cure);
        }
    }
}

fn read_dynamics(section: &Section<'_>) -> Option<Dynamics> {
    let gravity_nm = section.need("gravity_nm").such_as("0.7", "gravity torque about the joint at 90 deg, N m");
    let gravity_nm = gravity_nm.number();
    let inertia_kg_m2 = section.may("inertia_kg_m2").not_negative().unwrap_or(0.0);
    Some(Dynamics { gravity_nm: gravity_nm?, inertia_kg_m2, ..Dynamics::default() })
}

fn read_bus(section: &Section<'_>) -> Option<Bus> {
    let interface = section.need("interface").such_as("\"eth0\"", "the network interface").text();
    let cycle_us = section.may("cycle_us").whole(250, 20_000).unwrap_or(1000);
    let missed = section.may("missed_cycles_max").whole(0, 1000).unwrap_or(2);
    let clocks = section.may("clocks").flag().unwrap_or(true);
    let watchdog_ms = section.may("watchdog_ms").whole(2, 1000).unwrap_or(default_watchdog_ms(missed, cycle_us));
    let others = section.may("others").wholes(0, 63).unwrap_or_default();
    check_watchdog(section, watchdog_ms, missed, cycle_us);
    Some(Bus {
        interface: interface?,
        cycle_us: u32::try_from(cycle_us).ok()?,
        missed_cycles_max: u32::try_from(missed).ok()?,
        clocks,
        watchdog_ms: u32::try_from(watchdog_ms).ok()?,
        others: others.into_iter().filter_map(|place| usize::try_from(place).ok()).collect(),
    })
}

/// The output watchdog where the rig sets none, ms: as short as the gaps allow that are let pass, since a drive that no frame reaches goes on
/// for so long.
fn default_watchdog_ms(missed: i64, cycle_us: i64) -> i64 {
    const SHORTEST_MS: i64 = 10;
    const LONGEST_MS: i64 = 100;
    let gap_ms = ((missed + 1) * cycle_us + 999) / 1000;
    (2 * gap_ms).clamp(SHORTEST_MS, LONGEST_MS)
}

/// A gap that is let pass must not come near the devices' watchdog, which would then stop the drive by itself, without a ramp.
fn check_watchdog(section: &Section<'_>, watchdog_ms: i64, missed: i64, cycle_us: i64) {
    let gap_ms = (missed + 1) as f64 * cycle_us as f64 * 1e-3;
    if gap_ms > watchdog_ms as f64 / 2.0 {
        let what = format!("lets a gap of {gap_ms} ms pass, and the devices' watchdog ends OP after {watchdog_ms} ms");
        section.reject("missed_cycles_max", what, "allow half of that at most, or set watchdog_ms");
    }
}

pub(super) fn read_identity(section: &Section<'_>) -> Option<Identity> {
    let number =
        |key: &str| section.need(key).such_as("0x00000002", "as `rig scan` shows it").whole(0, u32::MAX.into());
    let place = section.need("place").such_as("0", "its place on the bus, from 0").whole(0, 63);
    let name = section.need("name").such_as("\"drive\"", "any name").text();
    let (vendor, product) = (number("vendor"), number("product"));
    let revision = section.may("revision").whole(0, u32::MAX.into());
    let serial = section.may("serial").whole(0, u32::MAX.into());
    let alias = section.may("alias").whole(0, u16::MAX.into());
    Some(Identity {
        place: usize::try_from(place?).ok()?,
        name: name?,
        vendor: u32::try_from(vendor?).ok()?,
        product: u32::try_from(product?).ok()?,
        revision: revision.and_then(|revision| u32::try_from(revision).ok()),
        serial: serial.and_then(|serial| u32::try_from(serial).ok()),
        alias: alias.and_then(|alias| u16::try_from(alias).ok()),
    })
}
