//! Where the torque comes from: a terminal, the drive itself, or a sensor wired to the drive.

use super::read::read_identity;
use super::{Drive, ProcessData, SENSOR_INPUTS, Sensor, Setup, StaleBy};
use crate::document::Section;

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

/// `[sensor]`.
pub(super) fn read_sensor(section: &Section<'_>, drive: Option<&Drive>) -> Option<Sensor> {
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
