//! Process data: what stands where in the bytes that a device exchanges every cycle.

use crate::document::Section;

/// How a number is written on the wire, little end first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// So many bits, 1 to 7.
    Bits(u8),
    /// Signed, of so many bits: 8, 16 or 32.
    Signed(u8),
    /// Unsigned, of so many bits.
    Unsigned(u8),
    /// IEEE 754, 32 bits.
    Real,
    /// So many bits that are left alone.
    Gap(u8),
}

impl Kind {
    /// Those that objects of a dictionary have.
    pub const OBJECTS: [(&'static str, Self); 7] = [
        ("i8", Self::Signed(8)),
        ("i16", Self::Signed(16)),
        ("i32", Self::Signed(32)),
        ("u8", Self::Unsigned(8)),
        ("u16", Self::Unsigned(16)),
        ("u32", Self::Unsigned(32)),
        ("f32", Self::Real),
    ];
    const BITS: [(&'static str, Self); 7] = [
        ("bit", Self::Bits(1)),
        ("bit2", Self::Bits(2)),
        ("bit3", Self::Bits(3)),
        ("bit4", Self::Bits(4)),
        ("bit5", Self::Bits(5)),
        ("bit6", Self::Bits(6)),
        ("bit7", Self::Bits(7)),
    ];

    /// All that have a name.
    fn named() -> Vec<(&'static str, Self)> {
        [Self::OBJECTS, Self::BITS].concat()
    }

    /// Its length in bits.
    pub fn bits(self) -> usize {
        match self {
            Self::Bits(bits) | Self::Signed(bits) | Self::Unsigned(bits) | Self::Gap(bits) => usize::from(bits),
            Self::Real => 32,
        }
    }

    /// The name used in files; a gap has none.
    pub fn name(self) -> &'static str {
        Self::named().iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    /// The unsigned kind of that length, where there is one.
    pub fn of_bits(bits: usize) -> Option<Self> {
        let plain = |kind: &Self| !matches!(kind, Self::Signed(_) | Self::Real) && kind.bits() == bits;
        Self::named().into_iter().map(|(_, kind)| kind).find(plain)
    }
}

/// One object in the process data.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it is to us; nothing where we leave it alone.
    pub role: Option<String>,
    /// Index in the device's object dictionary; 0 fills a gap.
    pub index: u16,
    /// Subindex.
    pub sub: u8,
    /// How it is written.
    pub kind: Kind,
}

impl Entry {
    /// The mapping word that a device's dictionary holds for it: index, subindex, bits.
    pub fn mapping(&self) -> u32 {
        u32::from(self.index) << 16 | u32::from(self.sub) << 8 | self.kind.bits() as u32
    }
}

/// A PDO with its entries, in the order in which they stand.
#[derive(Debug, Clone, PartialEq)]
pub struct Pdo {
    /// Its index: 0x1600 and on to the device, 0x1A00 and on from it.
    pub index: u16,
    /// What it holds.
    pub entries: Vec<Entry>,
}

impl Pdo {
    /// The mapping words of its entries.
    pub fn mapping(&self) -> Vec<u32> {
        self.entries.iter().map(Entry::mapping).collect()
    }

    fn read(section: &Section<'_>, roles: &[&str]) -> Option<Self> {
        let pdo = section.need("pdo").such_as("0x1A00", "the PDO's index").whole(0x1600, 0x1BFF);
        let list = section.need("entries").such_as("[]", "its entries, each { as, index, sub, type }");
        let entries = list.sections(|entry| {
            let choices: Vec<(&str, String)> = roles.iter().map(|role| (*role, role.to_string())).collect();
            let role = entry.may("as").choice(&choices);
            let index = entry.need("index").whole(0, 0xFFFF);
            let sub = entry.may("sub").whole(0, 0xFF).unwrap_or(0);
            let kind = match entry.may("bits").whole(1, 255).and_then(|bits| u8::try_from(bits).ok()) {
                Some(bits) => Some(Kind::Gap(bits)),
                None => {
                    entry.need("type").such_as("\"u16\"", "or `bits = 24` of what is left alone").choice(&Kind::named())
                }
            };
            if role.is_some() && matches!(kind, Some(Kind::Gap(_))) {
                entry.reject("bits", "tell no number", "give what is read or written a `type`");
            }
            Some(Entry { role, index: u16::try_from(index?).ok()?, sub: u8::try_from(sub).ok()?, kind: kind? })
        });
        Some(Self { index: u16::try_from(pdo?).ok()?, entries: entries? })
    }
}

/// What one direction of a device carries: the PDOs assigned to it, one behind the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProcessData {
    /// In the order of the assignment (0x1C12, 0x1C13).
    pub pdos: Vec<Pdo>,
}

impl ProcessData {
    /// Reads one direction, whose entries may play `roles`; those of `needed` must be there. One PDO is written by its `pdo` and
    /// `entries`, several as a list `pdos` of such.
    pub fn read(section: &Section<'_>, roles: &[&str], needed: &[&str]) -> Option<Self> {
        let (key, pdos) = match section.keys().any(|key| key == "pdos") {
            true => ("pdos", section.need("pdos").sections(|pdo| Pdo::read(pdo, roles))?),
            false => ("entries", vec![Pdo::read(section, roles)?]),
        };
        let found = Self { pdos };
        for role in roles {
            let times = found.entries().filter(|entry| entry.role.as_deref() == Some(*role)).count();
            if times > 1 {
                section.reject(key, format!("hold `{role}` {times} times"), "leave one");
            } else if times == 0 && needed.contains(role) {
                section.reject(key, format!("lack `{role}`"), format!("add one with `as = \"{role}\"`"));
            }
        }
        Some(found)
    }

    /// What a single PDO carries.
    pub fn one(index: u16, entries: Vec<Entry>) -> Self {
        Self { pdos: vec![Pdo { index, entries }] }
    }

    /// All entries, in the order in which they stand.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.pdos.iter().flat_map(|pdo| &pdo.entries)
    }

    /// The indexes of its PDOs.
    pub fn assignment(&self) -> Vec<u16> {
        self.pdos.iter().map(|pdo| pdo.index).collect()
    }

    /// Its length in whole bytes.
    pub fn bytes(&self) -> usize {
        self.entries().map(|entry| entry.kind.bits()).sum::<usize>().div_ceil(8)
    }

    /// Whether the same objects stand in the same places, whatever they are to us.
    pub fn is_alike(&self, other: &Self) -> bool {
        let words = |data: &Self| data.pdos.iter().map(|pdo| (pdo.index, pdo.mapping())).collect::<Vec<_>>();
        words(self) == words(other)
    }

    /// The same bytes with other roles: what plays `from` plays `to`, nothing else plays any.
    pub fn with_roles(&self, roles: &[(&str, &str)]) -> Self {
        let mut other = self.clone();
        for entry in other.pdos.iter_mut().flat_map(|pdo| &mut pdo.entries) {
            let role = roles.iter().find(|(from, _)| entry.role.as_deref() == Some(*from));
            entry.role = role.map(|(_, to)| to.to_string());
        }
        other
    }

    /// Where `role` stands.
    pub fn place(&self, role: &str) -> Option<Place> {
        let mut bit = 0;
        for entry in self.entries() {
            if entry.role.as_deref() == Some(role) {
                return Some(Place { bit, kind: entry.kind });
            }
            bit += entry.kind.bits();
        }
        None
    }
}

/// Where a number stands among the bytes of its device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    bit: usize,
    kind: Kind,
}

impl Place {
    /// The number that stands in `bytes`; NaN past their end, where a real holds none, never a panic.
    pub fn get(&self, bytes: &[u8]) -> f64 {
        let bits = self.kind.bits();
        if self.bit + bits > 8 * bytes.len() || matches!(self.kind, Kind::Gap(_)) {
            return f64::NAN;
        }
        let raw = (0..bits).fold(0u32, |raw, i| {
            let bit = self.bit + i;
            raw | u32::from(bytes[bit / 8] >> (bit % 8) & 1) << i
        });
        match self.kind {
            Kind::Signed(_) => f64::from(((raw << (32 - bits)) as i32) >> (32 - bits)),
            Kind::Real => f64::from(f32::from_bits(raw)),
            Kind::Bits(_) | Kind::Unsigned(_) | Kind::Gap(_) => f64::from(raw),
        }
    }

    /// Whether it can hold `value`.
    pub fn holds(&self, value: f64) -> bool {
        let bits = self.kind.bits() as i32;
        match self.kind {
            Kind::Signed(_) => (-2f64.powi(bits - 1)..2f64.powi(bits - 1)).contains(&value.round()),
            Kind::Bits(_) | Kind::Unsigned(_) => (0.0..2f64.powi(bits)).contains(&value.round()),
            Kind::Real => (value as f32).is_finite(),
            Kind::Gap(_) => false,
        }
    }

    /// Writes `value`, rounded and kept within what fits; nothing past the end of `bytes`.
    pub fn set(&self, bytes: &mut [u8], value: f64) {
        let bits = self.kind.bits();
        if self.bit + bits > 8 * bytes.len() || matches!(self.kind, Kind::Gap(_)) {
            return;
        }
        let raw = match self.kind {
            Kind::Signed(_) => {
                let top = 2f64.powi(bits as i32 - 1);
                value.round().clamp(-top, top - 1.0) as i32 as u32
            }
            Kind::Real => (value as f32).to_bits(),
            Kind::Bits(_) | Kind::Unsigned(_) | Kind::Gap(_) => {
                value.round().clamp(0.0, 2f64.powi(bits as i32) - 1.0) as u32
            }
        };
        for i in 0..bits {
            let (byte, bit) = ((self.bit + i) / 8, (self.bit + i) % 8);
            bytes[byte] = bytes[byte] & !(1 << bit) | ((raw >> i & 1) as u8) << bit;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(role: &str, kind: Kind) -> Entry {
        Entry { role: Some(role.to_string()), index: 0x6000, sub: 1, kind }
    }

    #[test]
    fn numbers_survive_the_wire() {
        let kinds = [
            ("a", Kind::Bits(3)),
            ("b", Kind::Signed(16)),
            ("c", Kind::Real),
            ("d", Kind::Signed(32)),
            ("e", Kind::Unsigned(8)),
        ];
        let data = ProcessData::one(0x1A00, kinds.iter().map(|(role, kind)| entry(role, *kind)).collect());
        let mut bytes = vec![0u8; data.bytes()];
        let values = [("a", 5.0), ("b", -12345.0), ("c", 0.25), ("d", -2147483648.0), ("e", 200.0)];
        for (role, value) in values {
            data.place(role).unwrap().set(&mut bytes, value);
        }
        for (role, value) in values {
            assert_eq!(data.place(role).unwrap().get(&bytes), value, "{role}");
        }
        assert_eq!((bytes.len(), data.place("f")), (12, None));
        assert!(data.place("e").unwrap().get(&bytes[..3]).is_nan());
    }

    #[test]
    fn what_does_not_fit_is_kept_within() {
        let place = Place { bit: 0, kind: Kind::Signed(16) };
        let mut bytes = [0u8; 2];
        for (value, expected) in [(1e9, 32767.0), (-1e9, -32768.0), (f64::NAN, 0.0), (0.6, 1.0)] {
            place.set(&mut bytes, value);
            assert_eq!(place.get(&bytes), expected);
        }
        assert!([-32768.4, 0.0, 32767.4].into_iter().all(|value| place.holds(value)));
        assert!(![-32769.0, 32768.0, f64::NAN, f64::INFINITY].into_iter().any(|value| place.holds(value)));
    }

    #[test]
    fn gaps_are_left_alone() {
        let gap = Entry { role: None, index: 0, sub: 0, kind: Kind::Gap(40) };
        let data = ProcessData::one(0x1A00, vec![gap, entry("a", Kind::Unsigned(8))]);
        let mut bytes = [0x55u8; 6];
        data.place("a").unwrap().set(&mut bytes, 7.0);
        assert_eq!((bytes, data.bytes()), ([0x55, 0x55, 0x55, 0x55, 0x55, 7], 6));
        let within = Place { bit: 0, kind: Kind::Gap(40) };
        within.set(&mut bytes, 1.0);
        assert!(within.get(&bytes).is_nan() && bytes[0] == 0x55);
    }

    #[test]
    fn several_pdos_stand_one_behind_the_other() {
        let pdo = |index, role, kind| Pdo { index, entries: vec![entry(role, kind)] };
        let data = ProcessData { pdos: vec![pdo(0x1A00, "a", Kind::Unsigned(16)), pdo(0x1A03, "b", Kind::Signed(32))] };
        assert_eq!((data.bytes(), data.assignment()), (6, vec![0x1A00, 0x1A03]));
        let mut bytes = [0u8; 6];
        data.place("b").unwrap().set(&mut bytes, -2.0);
        assert_eq!(bytes, [0, 0, 0xFE, 0xFF, 0xFF, 0xFF]);
        let other = data.with_roles(&[("b", "torque")]);
        assert_eq!((other.place("torque"), other.place("a")), (data.place("b"), None));
    }

    #[test]
    fn a_mapping_word_is_index_sub_and_bits() {
        assert_eq!(Entry { role: None, index: 0x6064, sub: 0, kind: Kind::Signed(32) }.mapping(), 0x6064_0020);
    }
}
