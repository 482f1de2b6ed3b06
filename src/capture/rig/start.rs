//! A rig to fill in, from what is on the bus.

use super::super::found::Found;
use super::super::limits::Limits;
use super::{Bus, Drive, Gains, Identity, Kind, ProcessData, Rig, Sensor, StaleBy};
use crate::capture::drive::Mode;
use crate::dynamics::{Dynamics, JointKind};
use crate::log::Signal;
use crate::model::Joint;

/// What the file begins with: every number that no device tells.
const TO_DO: &str = "\
# Written by `tautline rig scan`: the devices are as they report themselves. FILL IN what no device can tell, marked 1.0 here or
# taken from an example: counts_per_rad, zero_counts, sign, rated_torque_nm, torque_max_nm, nm_per_count, which of the sensor's
# entries is the torque, and all of [limits], [joint], [dynamics]. Then `tautline rig check --rig` this file.
";

/// The text of a rig of the first drive among `found` and the first other device that sends something.
pub fn starting_rig(interface: &str, found: &[Found]) -> Option<String> {
    let role = |data: &ProcessData, role: &str| data.place(role).is_some();
    let drive = found.iter().find(|device| device.outputs.iter().any(|data| role(data, "control_word")))?;
    let sensor = found.iter().find(|device| device.place != drive.place && !device.inputs.is_empty())?;
    let rig = Rig {
        bus: Bus { interface: interface.to_string(), cycle_us: 1000, missed_cycles_max: 1, clocks: drive.has_clock },
        drive: Drive {
            identity: identity(drive, "winch drive"),
            mode: Mode::Position,
            counts_per_rad: 1.0,
            zero_counts: 0.0,
            sign: 1.0,
            rated_torque_nm: 1.0,
            torque_max_nm: 1.0,
            following_error_rad: 0.05,
            following_error_s: 0.01,
            gains: Gains::default(),
            outputs: drive.outputs.iter().find(|data| role(data, "control_word"))?.clone(),
            inputs: drive.inputs.iter().find(|data| role(data, "status_word"))?.clone(),
        },
        sensor: Sensor {
            identity: identity(sensor, "torque terminal"),
            nm_per_count: 1.0,
            zero_counts: 0.0,
            saturated_counts: 32_760.0,
            stale_by: StaleBy::Toggle,
            stale_cycles: 3,
            inputs: as_terminal(sensor.inputs.first()?),
        },
        limits: Limits {
            low_rad: 0.0,
            high_rad: 1.6,
            speed_rad_s: 0.5,
            acceleration_rad_s2: 5.0,
            torque_nm: 1.0,
            torque_step_nm: 0.3,
            lag_rad: 0.05,
            approach_rad_s: 0.1,
        },
        joint: Joint {
            name: "elbow".to_string(),
            kind: JointKind::Revolute,
            winch_radius_m: 0.012,
            pulley_radius_m: 0.04,
            backlash_m: 0.0008,
        },
        dynamics: Dynamics { gravity_nm: 1.0, inertia_kg_m2: 0.0 },
        signal: Signal { torque_sign: 1.0, lowpass_hz: 5.0, lowpass_order: 4 },
    };
    let rig = Rig { sensor: Sensor { stale_by: stale_by(&rig.sensor.inputs), ..rig.sensor }, ..rig };
    Some(format!("{TO_DO}{}", rig.to_toml()))
}

fn stale_by(inputs: &ProcessData) -> StaleBy {
    let has_toggle = ["toggle", "status"].iter().any(|role| inputs.place(role).is_some());
    if has_toggle { StaleBy::Toggle } else { StaleBy::Nothing }
}

fn identity(found: &Found, name: &str) -> Identity {
    let Found { place, vendor, product, revision, .. } = *found;
    Identity { place, name: name.to_string(), vendor, product, revision: Some(revision) }
}

/// The roles that entries of an analog terminal have by their place in object 0x6000, as EL3xxx terminals have them.
fn as_terminal(data: &ProcessData) -> ProcessData {
    let mut data = data.clone();
    for entry in &mut data.entries {
        let (role, kind) = match (entry.index, entry.sub, entry.kind.bits()) {
            (0x6000, 1, 16) => ("status", Kind::Unsigned(16)),
            (0x6000, 1, 1) => ("underrange", Kind::Bits(1)),
            (0x6000, 2, 1) => ("overrange", Kind::Bits(1)),
            (0x6000, 7, 1) => ("error", Kind::Bits(1)),
            (0x6000, 0x10, 1) => ("toggle", Kind::Bits(1)),
            (0x6000, 0x11, bits @ (16 | 32)) => ("torque", Kind::Signed(bits as u8)),
            _ => continue,
        };
        entry.role = Some(role.to_string());
        entry.kind = kind;
    }
    data
}
