//! A rig to fill in, from what is on the bus.

use super::preset::Preset;
use super::{Entry, Kind, Pdo, ProcessData, Pulses};
use crate::capture::found::Found;

/// The text of a rig of the first drive among `found` and the first other device that sends something; of a drive alone the torque is its
/// own. What no device can tell stands there as a comment with an example: until it is filled in the rig is refused, with each number
/// that is missing.
pub fn starting_rig(interface: &str, found: &[Found]) -> Option<String> {
    let drive = found.iter().find(|device| device.outputs.place("control_word").is_some())?;
    let sensor = found.iter().find(|device| device.place != drive.place && !device.inputs.pdos.is_empty());
    let (outputs, inputs) = (once(&drive.outputs), once(&drive.inputs));
    let preset = Preset::of(drive.vendor, drive.product).map_or(String::new(), |preset| preset.comment());
    Some(format!(
        "\
# Written by `tautline rig scan`: the devices are as they report themselves. FILL IN what no device can tell: take the `#` off
# the lines that begin with it, with your own numbers. Then `tautline rig check --rig` this file.
format = \"rig/1\"

[bus]
interface = \"{interface}\"
cycle_us = 1000
missed_cycles_max = 1           # more than so many, one after the other, end the motion
clocks = {clocks}

[drive]
{drive_identity}mode = \"csp\"
{preset}{DRIVE}
{outputs}{inputs}
{sensor}
{JOINT}",
        clocks = drive.has_clock,
        drive_identity = identity(drive, "winch drive"),
        outputs = process_data("drive.outputs", &outputs),
        inputs = process_data("drive.inputs", &inputs),
        sensor = sensor.map_or_else(|| sensor_in_drive(&inputs), sensor_of),
    ))
}

/// The section of a sensor's terminal.
fn sensor_of(found: &Found) -> String {
    let terminal = as_terminal(&found.inputs);
    let has_toggle = ["toggle", "status"].iter().any(|role| terminal.place(role).is_some());
    let preset = Preset::of(found.vendor, found.product).map_or(String::new(), |preset| preset.comment());
    format!(
        "[sensor]
{identity}{preset}{SENSOR}stale_by = \"{stale_by}\"            # \"toggle\", \"value\" where there is no toggle bit, or \"nothing\"
stale_cycles = 3

# The entry of the torque takes `as = \"torque\"`, and a signed type such as \"i16\".
{data}",
        identity = identity(found, "torque terminal"),
        stale_by = if has_toggle { "toggle" } else { "nothing" },
        data = process_data("sensor.inputs", &terminal),
    )
}

/// The section of a drive without another device that sends anything.
fn sensor_in_drive(inputs: &ProcessData) -> String {
    let missing = match inputs.place("torque") {
        Some(_) => "",
        None => {
            "# The drive does not send its torque yet: add { as = \"torque\", index = 0x6077, type = \"i16\" } to [drive.inputs].\n"
        }
    };
    format!(
        "# No other device sends anything: the torque is the drive's own (0x6077), with all that is between its motor and the winch.
{missing}[sensor]
from = \"drive_torque\"          # or \"drive_sensor\", of an entry with `as = \"sensor\"`
"
    )
}

/// Of a drive with several axes only the first one's objects play a role.
fn once(data: &ProcessData) -> ProcessData {
    let mut seen: Vec<String> = Vec::new();
    let mut data = data.clone();
    for entry in data.pdos.iter_mut().flat_map(|pdo| &mut pdo.entries) {
        match entry.role.take().filter(|role| !seen.contains(role)) {
            Some(role) => {
                seen.push(role.clone());
                entry.role = Some(role);
            }
            None => entry.role = None,
        }
    }
    data
}

/// What is to be filled in of the drive.
const DRIVE: &str = "\
# counts_per_rad = 83443.0      # counts of the position for a rad of the joint
# zero_counts = 0               # counts where the joint is at 0 rad
# sign = 1                      # -1 where counts grow as the joint goes down
# rated_torque_nm = 2.0         # at the winch: what the drive calls 1000
# torque_max_nm = 1.0           # the most that it may give
# following_error_rad = 0.05    # the drive stops beyond
following_error_s = 0.01
";

/// What is to be filled in of the sensor.
const SENSOR: &str = "\
# nm_per_count = 0.0001526      # torque for a count, N m; negative where counts fall as it grows
zero_counts = 0                 # `tautline rig tare` sets it
saturated_counts = 32760        # where its range ends
";

/// What is to be filled in of the joint.
const JOINT: &str = "\
[limits]
# low_rad = 0.0                 # the lowest position
# high_rad = 1.6
# speed_rad_s = 0.5
# acceleration_rad_s2 = 5.0     # of commands
# torque_nm = 1.0               # at the sensor
# torque_step_nm = 0.3          # the largest change from one sample to the next: a cable that breaks is more
# lag_rad = 0.05                # the largest distance from the command
# approach_rad_s = 0.1          # of moves between trials

[joint]
# name = \"elbow\"
# winch_radius_m = 0.012
# pulley_radius_m = 0.04
# backlash_m = 0.0008

[dynamics]
# gravity_nm = 0.7              # about the joint at 90 deg
# inertia_kg_m2 = 0.012

[signal]
torque_sign = 1
lowpass_hz = 5.0
lowpass_order = 4
";

fn identity(found: &Found, name: &str) -> String {
    let Found { place, vendor, product, revision, serial, clock, .. } = found;
    let own = found.name.replace(char::is_control, " ");
    // Of two like devices it tells which is which; many have none.
    let serial = if *serial == 0 { String::new() } else { format!("serial = {serial}\n") };
    let clock = clock.map_or(String::new(), Pulses::to_line);
    format!(
        "place = {place}                       # it calls itself {own}\nname = \"{name}\"\nvendor = {vendor:#010x}\n\
         product = {product:#010x}\nrevision = {revision:#010x}\n{serial}{clock}"
    )
}

fn process_data(name: &str, data: &ProcessData) -> String {
    let entry = |entry: &Entry| {
        let Entry { role, index, sub, kind } = entry;
        let role = role.as_ref().map_or(String::new(), |role| format!("as = \"{role}\", "));
        let sub = if *sub == 0 { String::new() } else { format!("sub = {sub:#04x}, ") };
        let kind = match kind {
            Kind::Gap(bits) => format!("bits = {bits}"),
            kind => format!("type = \"{}\"", kind.name()),
        };
        format!("    {{ {role}index = {index:#06x}, {sub}{kind} }},\n")
    };
    let one = |pdo: &Pdo| {
        let entries: String = pdo.entries.iter().map(entry).collect();
        format!("pdo = {:#06x}\nentries = [\n{entries}]\n", pdo.index)
    };
    match &data.pdos[..] {
        [single] => format!("[{name}]\n{}\n", one(single)),
        several => several.iter().map(|pdo| format!("[[{name}.pdos]]\n{}\n", one(pdo))).collect(),
    }
}

/// The roles that entries of an analog terminal have by their place in object 0x6000, as EL3xxx terminals have them.
fn as_terminal(data: &ProcessData) -> ProcessData {
    let mut data = data.clone();
    for entry in data.pdos.iter_mut().flat_map(|pdo| &mut pdo.entries) {
        let (role, kind) = match (entry.index, entry.sub, entry.kind.bits()) {
            (0x6000, 1, 16) => ("status", Kind::Unsigned(16)),
            (0x6000, 1, 1) => ("underrange", Kind::Bits(1)),
            (0x6000, 2, 1) => ("overrange", Kind::Bits(1)),
            (0x6000, 7, 1) => ("error", Kind::Bits(1)),
            (0x6000, 0x10, 1) | (0x1800, 0x09, 1) => ("toggle", Kind::Bits(1)),
            (0x6000, 0x11, bits @ (16 | 32)) => ("torque", Kind::Signed(bits as u8)),
            _ => continue,
        };
        entry.role = Some(role.to_string());
        entry.kind = kind;
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::rig::Rig;

    /// What a device maps that is no number of ours is written so that it is read back as it stands.
    #[test]
    fn entries_of_any_length_read_back() {
        let entry = |role: Option<&str>, kind| Entry { role: role.map(str::to_string), index: 0x6000, sub: 0x11, kind };
        let known = include_str!("../../../data/rigs/demo/rig.toml");
        let entries =
            vec![entry(Some("torque"), Kind::Signed(16)), entry(None, Kind::Gap(64)), entry(None, Kind::Bits(3))];
        let two = |first: &Entry| ProcessData {
            pdos: vec![
                Pdo { index: 0x1A00, entries: vec![first.clone()] },
                Pdo { index: 0x1A01, entries: entries[1..].to_vec() },
            ],
        };
        let (before, _) = known.split_once("[sensor.inputs]").unwrap();
        let (_, after) = known.split_once("[limits]").unwrap();
        let before = before.replace("stale_by = \"toggle\"", "stale_by = \"nothing\"");
        for data in [ProcessData::one(0x1A00, entries.clone()), two(&entries[0])] {
            let text = format!("{before}{}\n[limits]{after}", process_data("sensor.inputs", &data));
            assert_eq!(Rig::parse("rig.toml".as_ref(), &text).unwrap().sensor.inputs, data);
        }
    }
}
