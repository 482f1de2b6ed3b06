//! How a device is set up before it exchanges data: objects written in PRE-OP, and its clock's pulses.

use super::Kind;
use crate::document::Section;

/// What is done to a device on the way up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setup {
    /// Objects to be written in PRE-OP, in order, before process data are mapped.
    pub startup: Vec<Startup>,
    /// Its clock, where it is not to pulse with every cycle.
    pub clock: Option<Pulses>,
}

/// An object and what it must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Startup {
    /// Its index.
    pub index: u16,
    /// Its subindex.
    pub sub: u8,
    /// How it is written.
    pub kind: Kind,
    /// As the `kind` counts.
    pub value: f64,
}

/// The pulses of a device's distributed clock (ETG.1000.4, 6.8; `AssignActivate`, `ShiftTimeSync0`, `CycleTimeSync1` of an ESI file).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pulses {
    /// What is written to registers 0x0980 (low byte) and 0x0981 (high byte): 0x0300 for SYNC0, 0x0700 for SYNC0 and SYNC1, 0 for none
    /// (the device then works as frames pass).
    pub activate: u16,
    /// How much later than those of the others SYNC0 comes, ns.
    pub sync0_shift_ns: i32,
    /// Register 0x09A4: from SYNC0 to SYNC1, ns.
    pub sync1_ns: u32,
}

/// Pulses with every cycle, as most drives take them.
const SYNC0: u16 = 0x0300;

impl Default for Pulses {
    /// With every cycle.
    fn default() -> Self {
        Self { activate: SYNC0, sync0_shift_ns: 0, sync1_ns: 0 }
    }
}

impl Setup {
    /// Reads `startup` and `clock` of a device's section.
    pub fn read(section: &Section<'_>) -> Self {
        let startup = section.may("startup").sections(Startup::read).unwrap_or_default();
        Self { startup, clock: section.may("clock").section(Pulses::read) }
    }
}

impl Startup {
    fn read(section: &Section<'_>) -> Option<Self> {
        let index = section.need("index").such_as("0x8010", "the object").whole(0x1000, 0xFFFF);
        let sub = section.may("sub").whole(0, 0xFF).unwrap_or(0);
        let kind = section.need("type").such_as("\"u16\"", "its type").choice(&Kind::OBJECTS);
        let value = section.need("value").such_as("1", "what it must hold").number();
        let found =
            Self { index: u16::try_from(index?).ok()?, sub: u8::try_from(sub).ok()?, kind: kind?, value: value? };
        if found.bytes().is_none() {
            section.reject("value", format!("is {}, which the type cannot hold", found.value), "check value and type");
        }
        Some(found)
    }

    /// The value as it stands in the object, little end first; nothing where the type cannot hold it.
    pub fn bytes(&self) -> Option<Vec<u8>> {
        let bits = self.kind.bits();
        let is_whole = self.value.fract() == 0.0;
        match self.kind {
            Kind::Real => Some((self.value as f32).to_le_bytes().to_vec()).filter(|_| (self.value as f32).is_finite()),
            Kind::Signed(_) => {
                let top = 2f64.powi(bits as i32 - 1);
                let fits = is_whole && (-top..top).contains(&self.value);
                fits.then(|| (self.value as i64).to_le_bytes()[..bits / 8].to_vec())
            }
            _ => {
                let fits = is_whole && (0.0..2f64.powi(bits as i32)).contains(&self.value);
                fits.then(|| (self.value as u64).to_le_bytes()[..bits.div_ceil(8)].to_vec())
            }
        }
    }
}

impl Pulses {
    /// As the key of a rig's device.
    pub(super) fn to_line(self) -> String {
        let [shift_us, sync1_us] = [f64::from(self.sync0_shift_ns), f64::from(self.sync1_ns)].map(|ns| ns * 1e-3);
        let activate = self.activate;
        format!(
            "clock = {{ assign_activate = {activate:#06x}, sync0_shift_us = {shift_us:?}, sync1_us = {sync1_us:?} }}\n"
        )
    }

    fn read(section: &Section<'_>) -> Option<Self> {
        let activate = section.may("assign_activate").whole(0, 0xFFFF).unwrap_or(SYNC0.into());
        let us = |key: &str| section.may(key).number().unwrap_or(0.0);
        let (shift_us, sync1_us) = (us("sync0_shift_us"), us("sync1_us"));
        const LONGEST_US: f64 = 1e6;
        if shift_us.abs() > LONGEST_US || !(0.0..=LONGEST_US).contains(&sync1_us) {
            section.reject(
                "sync0_shift_us",
                "or sync1_us is longer than a second",
                "both are times within a cycle, us",
            );
        }
        Some(Self {
            activate: u16::try_from(activate).ok()?,
            sync0_shift_ns: (shift_us * 1e3).round() as i32,
            sync1_ns: (sync1_us * 1e3).round() as u32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_as_their_type_has_them() {
        let bytes = |kind, value| Startup { index: 0x8000, sub: 1, kind, value }.bytes();
        assert_eq!(bytes(Kind::Unsigned(16), 258.0), Some(vec![2, 1]));
        assert_eq!(bytes(Kind::Signed(8), -1.0), Some(vec![0xFF]));
        assert_eq!(bytes(Kind::Real, 0.5), Some(0.5f32.to_le_bytes().to_vec()));
        assert_eq!(
            [bytes(Kind::Unsigned(8), 256.0), bytes(Kind::Signed(16), 0.5), bytes(Kind::Unsigned(8), -1.0)],
            [None; 3].map(|_: Option<u8>| None)
        );
    }
}
