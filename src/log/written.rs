//! A campaign as the text of its `campaign.toml`.

use super::campaign::{Campaign, TrialEntry};
use crate::document::write_pairs;
use crate::dynamics::Dynamics;
use crate::trajectory::Protocol;
use toml::Value;

impl Campaign {
    /// The text of `campaign.toml`. The order of keys is ours, so that it reads well; every value goes through the
    /// `toml` crate, so that names are escaped and numbers survive.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        write_pairs(&mut text, "", &[("format", "campaign/1".into())]);
        let joint = &self.joint;
        write_pairs(
            &mut text,
            "\n[joint]\n",
            &[
                ("name", joint.name.as_str().into()),
                ("kind", joint.kind.name().into()),
                ("winch_radius_m", joint.winch_radius_m.into()),
                ("pulley_radius_m", joint.pulley_radius_m.into()),
                ("backlash_m", joint.backlash_m.into()),
            ],
        );
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
        let columns = self.columns.wanted();
        let pairs: Vec<_> = columns.iter().map(|wanted| (wanted.key.as_str(), column(wanted))).collect();
        write_pairs(&mut text, "\n[columns]\n", &pairs);
        for entry in &self.trials {
            write_pairs(&mut text, "\n[[trials]]\n", &trial(entry));
        }
        text
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
    table.extend(wanted.arm_m.map(|arm_m| ("arm_m".to_string(), arm_m.into())));
    table.extend(wanted.joint.as_ref().map(|joint| ("joint".to_string(), joint.as_str().into())));
    table.into()
}

fn trial(entry: &TrialEntry) -> Vec<(&'static str, Value)> {
    let mut pairs = vec![("file", entry.file.as_str().into()), ("protocol", entry.protocol.name().into())];
    if let Protocol::Uniform { speed_rad_s } = entry.protocol {
        pairs.push(("speed_rad_s", speed_rad_s.into()));
    }
    pairs.push(("repeat", i64::from(entry.repeat).into()));
    pairs.extend(entry.trajectory.as_ref().map(|name| ("trajectory", name.as_str().into())));
    pairs.extend(entry.capture.iter().flat_map(|capture| capture.pairs()));
    pairs
}
