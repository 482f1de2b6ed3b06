//! A campaign as the text of its `campaign.toml`.

use super::campaign::{Campaign, Protocol, TrialEntry};
use std::fmt::Write;
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
        let dynamics = &self.dynamics;
        let pairs = [("gravity_nm", dynamics.gravity_nm.into()), ("inertia_kg_m2", dynamics.inertia_kg_m2.into())];
        write_pairs(&mut text, "\n[dynamics]\n", &pairs);
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
}

fn column(wanted: &super::columns::Wanted) -> Value {
    let mut table = toml::Table::new();
    table.insert("name".to_string(), wanted.column.name.as_str().into());
    table.insert("unit".to_string(), wanted.column.unit.name().into());
    table.extend(wanted.arm_m.map(|arm_m| ("arm_m".to_string(), arm_m.into())));
    table.into()
}

fn trial(entry: &TrialEntry) -> Vec<(&'static str, Value)> {
    let mut pairs = vec![("file", entry.file.as_str().into()), ("protocol", entry.protocol.name().into())];
    if let Protocol::Uniform { speed_rad_s } = entry.protocol {
        pairs.push(("speed_rad_s", speed_rad_s.into()));
    }
    pairs.push(("repeat", i64::from(entry.repeat).into()));
    pairs.extend(entry.trajectory.as_ref().map(|name| ("trajectory", name.as_str().into())));
    pairs
}

fn write_pairs(text: &mut String, heading: &str, pairs: &[(&str, Value)]) {
    text.push_str(heading);
    for (key, value) in pairs {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    }
}
