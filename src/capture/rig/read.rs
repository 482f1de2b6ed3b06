//! `rig.toml` -> a rig: every key, and what the keys must be together.

use super::StaleBy;
use super::{
    Brake, Bus, DRIVE_INPUTS, DRIVE_OUTPUTS, Drive, FORMAT, Gains, HeldAxis, Identity, Place, ProcessData, Rig,
    SENSOR_INPUTS, Sensor, Setup, Target,
};
use crate::capture::drive::Mode;
use crate::capture::limits::Limits;
use crate::document::Section;
use crate::dynamics::Dynamics;
use crate::log::{Signal, longest_gap_s};
use crate::model::Joint;

/// The longest that a drive may be off its command, s: longer would be no watch.
const LONGEST_ERROR_S: f64 = 10.0;

/// No brake takes longer than that, s.
const SLOWEST_BRAKE_S: f64 = 2.0;

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
    let watchdog_ms = section.may("watchdog_ms").whole(2, 1000).unwrap_or(100);
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

/// A gap that is let pass must not come near the devices' watchdog, which would then stop the drive by itself, without a ramp.
fn check_watchdog(section: &Section<'_>, watchdog_ms: i64, missed: i64, cycle_us: i64) {
    let gap_ms = (missed + 1) as f64 * cycle_us as f64 * 1e-3;
    if gap_ms > watchdog_ms as f64 / 2.0 {
        let what = format!("lets a gap of {gap_ms} ms pass, and the devices' watchdog ends OP after {watchdog_ms} ms");
        section.reject("missed_cycles_max", what, "allow half of that at most, or set watchdog_ms");
    }
}

fn read_identity(section: &Section<'_>) -> Option<Identity> {
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

/// A drive, which follows a path or holds a tension.
pub(super) fn read_drive(section: &Section<'_>, follows: Target) -> Option<Drive> {
    let positive = |key, example, means| section.need(key).such_as(example, means).positive();
    let identity = read_identity(section);
    let setup = Setup::read(section);
    let axis = section.may("axis").whole(0, 7).unwrap_or(0);
    let without = section.may("without").wholes(0x6000, 0x67FF).unwrap_or_default();
    let mode = read_mode(section, follows);
    let counts_per_rad = positive("counts_per_rad", "83443.0", "counts of the position for a rad of the joint");
    let zero_counts = section.need("zero_counts").such_as("0", "counts where the joint is at 0 rad").number();
    let sign = read_sign(section, "1", "-1 where counts grow as the joint goes down");
    let rated_torque_nm = positive("rated_torque_nm", "2.0", "the torque at the winch that the drive calls 1000, N m");
    let torque_max_nm = positive("torque_max_nm", "2.0", "the most that the drive may give, N m at the winch");
    let following_error_rad = positive("following_error_rad", "0.05", "the drive's window, rad");
    let following_error_s = section.may("following_error_s").not_negative().unwrap_or(0.01);
    if following_error_s > LONGEST_ERROR_S {
        let cure = format!("expected {LONGEST_ERROR_S} s at most");
        section.reject("following_error_s", format!("is {following_error_s}"), cure);
    }
    let gains = section.may("gains").section(read_gains).unwrap_or_default();
    let target = match mode {
        Mode::Position => "target_position",
        Mode::Velocity => "target_velocity",
        Mode::Torque => "target_torque",
    };
    let outputs = section.need("outputs").such_as("[drive.outputs]", "its RxPDO");
    let outputs = outputs.section(|s| ProcessData::read(s, &DRIVE_OUTPUTS, &["control_word", target]));
    let brake = section.may("brake").section(read_brake);
    if brake.is_some() != outputs.as_ref().is_some_and(|data: &ProcessData| data.place("brake").is_some()) {
        let cure = "write both: the output that lets it go (`as = \"brake\"`), and [drive.brake] with its times";
        section.reject("brake", "has an output and no times, or times and no output", cure);
    }
    let inputs = section.need("inputs").such_as("[drive.inputs]", "its TxPDO");
    let inputs = inputs.section(|s| ProcessData::read(s, &DRIVE_INPUTS, &["status_word", "position"]));
    let is_closed = match mode {
        Mode::Position => true,
        Mode::Velocity => gains.position_per_s > 0.0,
        Mode::Torque => follows == Target::Tension || gains.stiffness_nm_rad > 0.0 && gains.damping_nm_s_rad > 0.0,
    };
    if !is_closed {
        let what = "leave the position open in this mode";
        section.reject("gains", what, "csv needs position_per_s; cst stiffness_nm_rad and damping_nm_s_rad");
    }
    Some(Drive {
        identity: identity?,
        setup,
        axis: u16::try_from(axis).ok()?,
        without: without.into_iter().filter_map(|index| u16::try_from(index).ok()).collect(),
        mode,
        counts_per_rad: counts_per_rad?,
        zero_counts: zero_counts?,
        sign: sign?,
        rated_torque_nm: rated_torque_nm?,
        torque_max_nm: torque_max_nm?,
        following_error_rad: following_error_rad?,
        following_error_s,
        gains,
        brake,
        outputs: outputs?,
        inputs: inputs?,
    })
}

/// What the drive is told to follow. A tension is a torque.
fn read_mode(section: &Section<'_>, follows: Target) -> Mode {
    let mode = section.may("mode").choice(&Mode::NAMES);
    if follows == Target::Tension {
        if mode.is_some_and(|mode| mode != Mode::Torque) {
            section.reject("mode", "is not \"cst\", which holding a tension takes", "leave it out");
        }
        return Mode::Torque;
    }
    mode.unwrap_or(Mode::Position)
}

fn read_brake(section: &Section<'_>) -> Option<Brake> {
    let bit = section.may("bit").whole(0, 31).unwrap_or(0);
    let time = |key, means| section.need(key).such_as("0.1", means).not_negative();
    let release_s = time("release_s", "from letting it go until the joint may move, s");
    let engage_s = time("engage_s", "from closing it until it holds, s");
    for (key, time_s) in [("release_s", release_s), ("engage_s", engage_s)] {
        if time_s.is_some_and(|time_s| time_s > SLOWEST_BRAKE_S) {
            section.reject(
                key,
                format!("is {}", time_s.unwrap_or(0.0)),
                format!("expected {SLOWEST_BRAKE_S} s at most"),
            );
        }
    }
    Some(Brake { bit: u32::try_from(bit).ok()?, release_s: release_s?, engage_s: engage_s? })
}

fn read_gains(section: &Section<'_>) -> Option<Gains> {
    let gain = |key| section.may(key).not_negative().unwrap_or(0.0);
    Some(Gains {
        position_per_s: gain("position_per_s"),
        stiffness_nm_rad: gain("stiffness_nm_rad"),
        damping_nm_s_rad: gain("damping_nm_s_rad"),
    })
}

/// Names of `sensor.from`, with the role that the drive's entry plays.
const IN_DRIVE: [(&str, &str); 2] = [("drive_torque", "torque"), ("drive_sensor", "sensor")];

/// The torque of the drive itself, or of a sensor that is wired to it: its entries are among the drive's.
fn read_sensor_in_drive(section: &Section<'_>, drive: &Drive) -> Option<Sensor> {
    let role = section.need("from").choice(&IN_DRIVE)?;
    let is_own = role == "torque";
    let own = sensor_in_drive(drive);
    let nm_per_count = match is_own {
        true => section.may("nm_per_count").number().or(Some(own.nm_per_count)),
        false => section.need("nm_per_count").such_as("0.0001526", "torque for a count, N m").number(),
    };
    let zero_counts = section.may("zero_counts").number().unwrap_or(own.zero_counts);
    let saturated_counts = section.may("saturated_counts").positive().unwrap_or(own.saturated_counts);
    let stale_by = section.may("stale_by").choice(&StaleBy::NAMES).unwrap_or(own.stale_by);
    let stale_cycles = section.may("stale_cycles").whole(1, 10_000).unwrap_or(own.stale_cycles.into());
    let inputs = drive.inputs.with_roles(&[(role, "torque"), ("sensor_status", "status")]);
    if inputs.place("torque").is_none() {
        let cure = if is_own { "object 0x6077" } else { "the object that holds the sensor's value" };
        let what = format!("takes the torque from the drive, whose inputs lack `{role}`");
        section.reject("from", what, format!("map {cure} in [drive.inputs], with `as = \"{role}\"`"));
    }
    Some(Sensor {
        nm_per_count: nm_per_count?,
        zero_counts,
        saturated_counts,
        stale_by,
        stale_cycles: u32::try_from(stale_cycles).ok()?,
        inputs,
        ..own
    })
}

/// The torque of `drive` itself (0x6077), per mille of its rated torque with the drive's sign.
pub(super) fn sensor_in_drive(drive: &Drive) -> Sensor {
    Sensor {
        identity: drive.identity.clone(),
        is_in_drive: true,
        setup: Setup::default(),
        nm_per_count: drive.sign * drive.rated_torque_nm * 1e-3,
        zero_counts: 0.0,
        saturated_counts: 32_767.0,
        stale_by: StaleBy::Nothing,
        stale_cycles: 3,
        inputs: drive.inputs.with_roles(&[("torque", "torque")]),
    }
}

fn read_sensor(section: &Section<'_>, drive: Option<&Drive>) -> Option<Sensor> {
    if section.keys().any(|key| key == "from") {
        // What is wrong with the drive is reported there.
        section.keys().filter(|_| drive.is_none()).for_each(|key| section.may(key).ignore());
        return read_sensor_in_drive(section, drive?);
    }
    let identity = read_identity(section);
    let setup = Setup::read(section);
    let nm_per_count = section.need("nm_per_count").such_as("0.0001526", "torque for a count, N m").number();
    let zero_counts = section.need("zero_counts").such_as("0", "counts without torque: `tautline rig tare`").number();
    let saturated_counts = section.may("saturated_counts").positive().unwrap_or(32_767.0);
    let stale_by = section.may("stale_by").choice(&StaleBy::NAMES).unwrap_or(StaleBy::Toggle);
    let stale_cycles = section.may("stale_cycles").whole(1, 10_000).unwrap_or(3);
    if nm_per_count == Some(0.0) {
        section.reject("nm_per_count", "is 0", "expected the torque for a count, N m");
    }
    let inputs = section.need("inputs").such_as("[sensor.inputs]", "its TxPDO");
    let inputs = inputs.section(|s| ProcessData::read(s, &SENSOR_INPUTS, &["torque"]));
    let has_toggle = |data: &ProcessData| ["toggle", "status"].iter().any(|role| data.place(role).is_some());
    if stale_by == StaleBy::Toggle && inputs.as_ref().is_some_and(|data: &ProcessData| !has_toggle(data)) {
        let cure =
            "set it to \"value\", with as many stale_cycles as the value never stands still for, or to \"nothing\"";
        section.reject("stale_by", "is by a toggle bit, and the inputs have neither `status` nor `toggle`", cure);
    }
    Some(Sensor {
        identity: identity?,
        is_in_drive: false,
        setup,
        nm_per_count: nm_per_count?,
        zero_counts: zero_counts?,
        saturated_counts,
        stale_by,
        stale_cycles: u32::try_from(stale_cycles).ok()?,
        inputs: inputs?,
    })
}

fn read_sign(section: &Section<'_>, example: &str, means: &str) -> Option<f64> {
    let sign = section.need("sign").such_as(example, means).number()?;
    if sign.abs() != 1.0 {
        section.reject("sign", format!("is {sign}"), "expected 1 or -1");
    }
    Some(sign)
}
