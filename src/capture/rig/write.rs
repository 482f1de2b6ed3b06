//! A rig as the text of its `rig.toml`.

use super::{Drive, FORMAT, Identity, Rig, Sensor, StaleBy};
use crate::capture::drive::Mode;
use crate::document::write_pairs;
use toml::Value;

type Pairs = Vec<(&'static str, Value)>;

impl Rig {
    /// The text of its file.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        write_pairs(&mut text, "", &[("format", FORMAT.into())]);
        let bus = &self.bus;
        let pairs = [
            ("interface", bus.interface.as_str().into()),
            ("cycle_us", i64::from(bus.cycle_us).into()),
            ("missed_cycles_max", i64::from(bus.missed_cycles_max).into()),
            ("clocks", bus.clocks.into()),
        ];
        write_pairs(&mut text, "\n[bus]\n", &pairs);
        write_pairs(&mut text, "\n[drive]\n", &drive(&self.drive));
        write_pairs(&mut text, "\n[sensor]\n", &sensor(&self.sensor));
        let limits = &self.limits;
        let pairs = [
            ("low_rad", limits.low_rad.into()),
            ("high_rad", limits.high_rad.into()),
            ("speed_rad_s", limits.speed_rad_s.into()),
            ("acceleration_rad_s2", limits.acceleration_rad_s2.into()),
            ("torque_nm", limits.torque_nm.into()),
            ("torque_step_nm", limits.torque_step_nm.into()),
            ("lag_rad", limits.lag_rad.into()),
            ("approach_rad_s", limits.approach_rad_s.into()),
        ];
        write_pairs(&mut text, "\n[limits]\n", &pairs);
        let joint = &self.joint;
        let pairs = [
            ("name", joint.name.as_str().into()),
            ("kind", joint.kind.name().into()),
            ("winch_radius_m", joint.winch_radius_m.into()),
            ("pulley_radius_m", joint.pulley_radius_m.into()),
            ("backlash_m", joint.backlash_m.into()),
        ];
        write_pairs(&mut text, "\n[joint]\n", &pairs);
        let dynamics =
            [("gravity_nm", self.dynamics.gravity_nm.into()), ("inertia_kg_m2", self.dynamics.inertia_kg_m2.into())];
        write_pairs(&mut text, "\n[dynamics]\n", &dynamics);
        let signal = [
            ("torque_sign", (self.signal.torque_sign as i64).into()),
            ("lowpass_hz", self.signal.lowpass_hz.into()),
            ("lowpass_order", (self.signal.lowpass_order as i64).into()),
        ];
        write_pairs(&mut text, "\n[signal]\n", &signal);
        text
    }
}

fn identity(identity: &Identity) -> Pairs {
    let mut pairs: Pairs = vec![
        ("place", (identity.place as i64).into()),
        ("name", identity.name.as_str().into()),
        ("vendor", i64::from(identity.vendor).into()),
        ("product", i64::from(identity.product).into()),
    ];
    pairs.extend(identity.revision.map(|revision| ("revision", i64::from(revision).into())));
    pairs
}

fn drive(drive: &Drive) -> Pairs {
    let mode = Mode::NAMES.iter().find(|(_, mode)| *mode == drive.mode).map_or("", |(name, _)| name);
    let mut pairs = identity(&drive.identity);
    pairs.extend([
        ("mode", mode.into()),
        ("counts_per_rad", drive.counts_per_rad.into()),
        ("zero_counts", drive.zero_counts.into()),
        ("sign", (drive.sign as i64).into()),
        ("rated_torque_nm", drive.rated_torque_nm.into()),
        ("torque_max_nm", drive.torque_max_nm.into()),
        ("following_error_rad", drive.following_error_rad.into()),
        ("following_error_s", drive.following_error_s.into()),
    ]);
    if drive.mode != Mode::Position {
        let gains = [
            ("position_per_s", drive.gains.position_per_s),
            ("stiffness_nm_rad", drive.gains.stiffness_nm_rad),
            ("damping_nm_s_rad", drive.gains.damping_nm_s_rad),
        ];
        let table: toml::Table = gains.into_iter().map(|(name, gain)| (name.to_string(), gain.into())).collect();
        pairs.push(("gains", table.into()));
    }
    pairs.extend([("outputs", drive.outputs.to_value()), ("inputs", drive.inputs.to_value())]);
    pairs
}

fn sensor(sensor: &Sensor) -> Pairs {
    let stale_by = StaleBy::NAMES.iter().find(|(_, by)| *by == sensor.stale_by).map_or("", |(name, _)| name);
    let mut pairs = identity(&sensor.identity);
    pairs.extend([
        ("nm_per_count", sensor.nm_per_count.into()),
        ("zero_counts", sensor.zero_counts.into()),
        ("saturated_counts", sensor.saturated_counts.into()),
        ("stale_by", stale_by.into()),
        ("stale_cycles", i64::from(sensor.stale_cycles).into()),
        ("inputs", sensor.inputs.to_value()),
    ]);
    pairs
}
