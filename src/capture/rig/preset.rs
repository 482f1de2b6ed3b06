//! What is known of some devices beforehand, from public documents: sections of a rig to begin with, and what to mind.
//!
//! None of them was tried on the device itself. What a device on the bus reports always counts: `tautline rig scan` writes its own
//! process data, and adds the notes here as comments.

/// A device, or a family of devices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Vendor.
    pub vendor: u32,
    /// Product codes, from first to last; only those that end in the same 16 bits.
    pub products: (u32, u32),
    /// What to mind.
    pub notes: &'static [&'static str],
    /// Process data as the device has them by default; the section of a rig that holds them.
    pub section: &'static str,
    /// Where this is from.
    pub source: &'static str,
}

/// All of them.
pub const PRESETS: [Preset; 6] = [
    Preset {
        name: "el3xxx",
        title: "Beckhoff EL30xx and EL31xx, analog inputs",
        vendor: 0x0000_0002,
        products: (0x0BB8_3052, 0x0C7F_3052),
        notes: &[
            "a PDO for each channel: status (16 bit, its highest the toggle bit) and value (16 bit); +-10 V are +-32767",
            "the `Compact` PDOs have no status: take the standard ones",
        ],
        section: "[sensor.inputs]\npdo = 0x1A00\nentries = [\n    { as = \"underrange\", index = 0x6000, sub = 0x01, type = \"bit\" },\n    \
                  { as = \"overrange\", index = 0x6000, sub = 0x02, type = \"bit\" },\n    { index = 0x6000, sub = 0x03, type = \"bit2\" },\n    \
                  { index = 0x6000, sub = 0x05, type = \"bit2\" },\n    { as = \"error\", index = 0x6000, sub = 0x07, type = \"bit\" },\n    \
                  { index = 0, bits = 7 },\n    { index = 0x6000, sub = 0x0F, type = \"bit\" },\n    \
                  { as = \"toggle\", index = 0x6000, sub = 0x10, type = \"bit\" },\n    \
                  { as = \"torque\", index = 0x6000, sub = 0x11, type = \"i16\" },\n]\n",
        source: "https://infosys.beckhoff.com/content/1033/el31xx/1710364299.html",
    },
    Preset {
        name: "el3351",
        title: "Beckhoff EL3351, resistor bridge",
        vendor: 0x0000_0002,
        products: (0x0D17_3052, 0x0D17_3052),
        notes: &[
            "two PDOs are assigned, bridge and supply voltage; the toggle bit is 0x1800:09 and not in object 0x6000",
            "the torque is the ratio of both, which is not computed here: scale by the nominal supply, or take an EL3356",
        ],
        section: "",
        source: "https://infosys.beckhoff.com/content/1033/el3351/1994747147.html",
    },
    Preset {
        name: "somanet",
        title: "Synapticon SOMANET",
        vendor: 0x0000_22D2,
        products: (0x0000_0201, 0x0000_0201),
        notes: &[
            "the mode (0x6060) is exchanged every cycle",
            "several PDOs are assigned each way: keep all that `rig scan` lists",
        ],
        section: "[drive.outputs]\npdo = 0x1600\nentries = [\n    { as = \"control_word\", index = 0x6040, type = \"u16\" },\n    \
                  { as = \"mode\", index = 0x6060, type = \"i8\" },\n    { as = \"target_torque\", index = 0x6071, type = \"i16\" },\n    \
                  { as = \"target_position\", index = 0x607A, type = \"i32\" },\n    \
                  { as = \"target_velocity\", index = 0x60FF, type = \"i32\" },\n]\n",
        source: "`ethercat cstruct` output published with drivers for it",
    },
    Preset {
        name: "erob",
        title: "ZeroErr eRob, joint modules",
        vendor: 0x5A65_726F,
        products: (0x0002_9252, 0x0002_9252),
        notes: &[
            "by default neither torque (0x6077) nor mode (0x6061) is exchanged: add 0x6077 to the inputs for a torque without a sensor",
            "digital outputs and inputs (0x60FE, 0x60FD) stand between the others",
        ],
        section: "[drive.outputs]\npdo = 0x1600\nentries = [\n    { as = \"target_position\", index = 0x607A, type = \"i32\" },\n    \
                  { index = 0x60FE, type = \"u32\" },\n    { as = \"control_word\", index = 0x6040, type = \"u16\" },\n]\n\n\
                  [drive.inputs]\npdo = 0x1A00\nentries = [\n    { as = \"position\", index = 0x6064, type = \"i32\" },\n    \
                  { index = 0x60FD, type = \"u32\" },\n    { as = \"status_word\", index = 0x6041, type = \"u16\" },\n    \
                  { as = \"torque\", index = 0x6077, type = \"i16\" },\n]\n",
        source: "the maker's published examples for the IgH master",
    },
    Preset {
        name: "nanotec",
        title: "Nanotec PD4-E and PD6-E",
        vendor: 0x0000_026C,
        products: (0, u32::MAX),
        notes: &[
            "following error: window 0x6065 in user units, time 0x6066 in ms; what follows from it is set in 0x3700: set it to a reaction \
             that stops",
        ],
        section: "",
        source: "https://manualshive.com/en/manual/nanotec/pd4-e-m/pd4-e-m_technical-manual_3239651-240.html",
    },
    Preset {
        name: "epos4",
        title: "maxon EPOS4",
        vendor: 0x0000_00FB,
        products: (0, u32::MAX),
        notes: &[
            "torques are per mille of the motor's rated torque (0x6076): rated_torque_nm is that times the gear",
            "objects that it lacks are named by `rig check`: put them into `without` once its firmware specification says how it stops",
        ],
        section: "",
        source: "EPOS4 Firmware Specification, maxon",
    },
];

impl Preset {
    /// What is known of a device.
    pub fn of(vendor: u32, product: u32) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| {
            let (first, last) = preset.products;
            let is_family = (first, last) == (0, u32::MAX) || product & 0xFFFF == first & 0xFFFF;
            preset.vendor == vendor && is_family && (first..=last).contains(&product)
        })
    }

    /// Its notes as comments of a rig.
    pub fn comment(&self) -> String {
        let notes: String = self.notes.iter().map(|note| format!("# {}: {note}.\n", self.title)).collect();
        format!("{notes}# Not tried on the device; from {}.\n", self.source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::rig::Rig;

    const DEMO: &str = include_str!("../../../data/rigs/demo/rig.toml");

    #[test]
    fn devices_are_known_by_vendor_and_product() {
        assert_eq!(Preset::of(2, 0x0C1E_3052).map(|preset| preset.name), Some("el3xxx"));
        assert_eq!(Preset::of(2, 0x0D17_3052).map(|preset| preset.name), Some("el3351"));
        assert_eq!(Preset::of(0xFB, 0x6950_0000).map(|preset| preset.name), Some("epos4"));
        assert_eq!([Preset::of(2, 0x07D4_3052), Preset::of(2, 0x0C1E_0001), Preset::of(7, 1)], [None; 3]);
    }

    /// Every section reads as a part of a rig.
    #[test]
    fn sections_read() {
        for preset in PRESETS.iter().filter(|preset| !preset.section.is_empty()) {
            let mut text = DEMO.to_string();
            for part in preset.section.split("\n\n") {
                let name = part.lines().next().unwrap();
                let at = text.find(name).unwrap_or_else(|| panic!("{name}"));
                let end = text[at..].find("\n\n").map_or(text.len(), |length| at + length);
                text.replace_range(at..end, part.trim_end());
            }
            Rig::parse("rig.toml".as_ref(), &text).unwrap_or_else(|why| panic!("{}: {why}\n{text}", preset.name));
        }
    }
}
