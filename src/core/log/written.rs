//! A campaign as the text of its `campaign.toml`.

use super::campaign::{Campaign, Part, TrialEntry};
use super::columns::{FromCurrent, TorqueFrom};
use super::controller::Controller;
use crate::document::write_pairs;
use crate::dynamics::Dynamics;
use crate::model::Drive;
use crate::trajectory::Protocol;
use toml::Value;

impl Campaign {
    /// The text of `campaign.toml`. The order of keys is ours, so that it reads well; every value goes through the
    /// `toml` crate, so that names are escaped and numbers survive.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        write_pairs(&mut text, "", &[("format", "campaign/1".into())]);
        let files = self.files.pairs();
        if !files.is_empty() {
            write_pairs(&mut text, "\n[files]\n", &files);
        }
        write_pairs(&mut text, "\n[joint]\n", &self.joint_pairs());
        write_pairs(&mut text, "\n[dynamics]\n", &self.dynamics_pairs());
        let uncertain = self.uncertainty.pairs();
        if !uncertain.is_empty() {
            write_pairs(&mut text, "\n[uncertainty]\n", &uncertain);
        }
        let signal = &self.signal;
        write_pairs(
            &mut text,
            "\n[signal]\n",
            &[
                ("torque_sign", (signal.torque_sign as i64).into()),
                ("lowpass_hz", signal.lowpass_hz.into()),
                ("lowpass_order", (signal.lowpass_order as i64).into()),
            ],
        );
        if let Some(TorqueFrom::Controller(controller)) = self.columns.torque_from {
            text += &controller.to_toml();
        }
        let columns = self.columns.declared();
        let pairs: Vec<_> = columns.iter().map(|wanted| (wanted.key.as_str(), column(wanted))).collect();
        write_pairs(&mut text, "\n[columns]\n", &pairs);
        for entry in &self.trials {
            write_pairs(&mut text, "\n[[trials]]\n", &trial(entry));
        }
        text
    }

    fn joint_pairs(&self) -> Vec<(&'static str, Value)> {
        let joint = &self.joint;
        let mut pairs = vec![("name", joint.name.as_str().into()), ("kind", joint.kind.name().into())];
        if joint.drive != Drive::Cable {
            pairs.push(("drive", joint.drive.name().into()));
        }
        pairs.push(("winch_radius_m", joint.winch_radius_m.into()));
        pairs.push(("pulley_radius_m", joint.pulley_radius_m.into()));
        pairs.push(("backlash_m", joint.backlash_m.into()));
        if let Some(TorqueFrom::Current(FromCurrent { torque_constant_nm_a, gear_ratio })) = self.columns.torque_from {
            pairs.extend(torque_constant_nm_a.map(|constant| ("torque_constant_nm_a", constant.into())));
            if joint.drive == Drive::Cable && gear_ratio != 1.0 {
                pairs.push(("gear_ratio", gear_ratio.into()));
            }
        }
        pairs
    }

    fn dynamics_pairs(&self) -> Vec<(&'static str, Value)> {
        let Some(arm) = &self.arm else {
            let Dynamics { gravity_nm, inertia_kg_m2, .. } = self.dynamics;
            return vec![("gravity_nm", gravity_nm.into()), ("inertia_kg_m2", inertia_kg_m2.into())];
        };
        let mut pairs = vec![("urdf", arm.urdf.as_str().into()), ("joint", arm.chain.joint().into())];
        if !arm.held_rad.is_empty() {
            let held: toml::Table = arm.held_rad.iter().map(|(name, at)| (name.clone(), (*at).into())).collect();
            pairs.push(("held_rad", held.into()));
        }
        pairs
    }
}

fn column(wanted: &super::columns::Wanted) -> Value {
    let mut table = toml::Table::new();
    table.insert("name".to_string(), wanted.column.name.as_str().into());
    table.insert("unit".to_string(), wanted.column.unit.name().into());
    if wanted.column.scale != 1.0 {
        table.insert("scale".to_string(), wanted.column.scale.into());
    }
    if wanted.column.offset != 0.0 {
        table.insert("offset".to_string(), wanted.column.offset.into());
    }
    table.extend(wanted.arm_m.map(|arm_m| ("arm_m".to_string(), arm_m.into())));
    table.extend(wanted.joint.as_ref().map(|joint| ("joint".to_string(), joint.as_str().into())));
    table.into()
}

fn trial(entry: &TrialEntry) -> Vec<(&'static str, Value)> {
    let mut pairs = vec![("file", entry.log().into())];
    if let Some(Part { rows, .. }) = &entry.part {
        pairs.push(("rows", vec![rows.start as i64, rows.end as i64].into()));
    }
    pairs.push(("protocol", entry.protocol.name().into()));
    if let Protocol::Uniform { speed_rad_s } = entry.protocol {
        pairs.push(("speed_rad_s", speed_rad_s.into()));
    }
    pairs.push(("repeat", i64::from(entry.repeat).into()));
    pairs.extend(entry.trajectory.as_ref().map(|name| ("trajectory", name.as_str().into())));
    pairs.extend(entry.capture.iter().flat_map(|capture| capture.pairs()));
    let own = |controller: &Controller| {
        controller.pairs().into_iter().map(|(key, value)| (key.to_string(), value)).collect::<toml::Table>()
    };
    pairs.extend(entry.controller.as_ref().map(|controller| ("controller", own(controller).into())));
    pairs
}
