//! A device's object dictionary (CiA 301): its entries, who may write them and to what.

use super::abort::Abort;

/// Who may write an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Nobody.
    Read,
    /// The master.
    Write,
    /// The master, in PRE-OP: what decides how long process data are.
    WritePreOp,
}

/// One entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Index and subindex.
    pub at: (u16, u8),
    /// Who may write it.
    pub access: Access,
    /// What it holds, little endian.
    pub value: Vec<u8>,
    /// Lowest and highest number that it takes.
    pub range: Option<(i64, i64)>,
    /// How long it may become, for texts and other bytes.
    pub grows_to: Option<usize>,
}

/// Entries in order.
#[derive(Debug, Clone, Default)]
pub struct Dictionary {
    entries: Vec<Entry>,
}

impl Dictionary {
    /// Adds an entry, or puts it in another's place.
    pub fn add(&mut self, entry: Entry) {
        match self.place(entry.at.0, entry.at.1) {
            Ok(place) => self.entries[place] = entry,
            Err(place) => self.entries.insert(place, entry),
        }
    }

    /// Adds a number of `bytes` bytes.
    pub fn number(&mut self, at: (u16, u8), access: Access, bytes: usize, value: i64) -> &mut Self {
        let value = value.to_le_bytes()[..bytes].to_vec();
        self.add(Entry { at, access, value, range: None, grows_to: None });
        self
    }

    /// Adds a number of `bytes` bytes that the master may set between `low` and `high`.
    pub fn within(&mut self, at: (u16, u8), bytes: usize, value: i64, range: (i64, i64)) -> &mut Self {
        let value = value.to_le_bytes()[..bytes].to_vec();
        self.add(Entry { at, access: Access::Write, value, range: Some(range), grows_to: None });
        self
    }

    /// Adds a text that nobody writes.
    pub fn text(&mut self, at: (u16, u8), text: &str) -> &mut Self {
        self.add(Entry { at, access: Access::Read, value: text.into(), range: None, grows_to: None });
        self
    }

    /// Adds bytes that the master may replace by up to `grows_to`.
    pub fn bytes(&mut self, at: (u16, u8), value: Vec<u8>, grows_to: usize) -> &mut Self {
        self.add(Entry { at, access: Access::Write, value, range: None, grows_to: Some(grows_to) });
        self
    }

    /// Adds a list: its length as subindex 0, then its numbers of `bytes` bytes.
    pub fn list(&mut self, index: u16, access: Access, bytes: usize, values: &[i64]) -> &mut Self {
        self.number((index, 0), access, 1, values.len() as i64);
        for (i, value) in values.iter().enumerate() {
            self.number((index, i as u8 + 1), access, bytes, *value);
        }
        self
    }

    /// Takes an object out, with all its subindices.
    pub fn remove(&mut self, index: u16) {
        self.entries.retain(|entry| entry.at.0 != index);
    }

    /// All entries, in order.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter()
    }

    fn place(&self, index: u16, sub: u8) -> Result<usize, usize> {
        self.entries.binary_search_by_key(&(index, sub), |entry| entry.at)
    }

    /// An entry, or why there is none.
    pub fn entry(&self, index: u16, sub: u8) -> Result<&Entry, Abort> {
        match self.place(index, sub) {
            Ok(place) => Ok(&self.entries[place]),
            Err(place) => {
                let near = [place.wrapping_sub(1), place].map(|i| self.entries.get(i));
                let known = near.into_iter().flatten().any(|entry| entry.at.0 == index);
                Err(if known { Abort::NoSubindex } else { Abort::NoObject })
            }
        }
    }

    /// A number without its sign; 0 where there is none.
    pub fn unsigned(&self, index: u16, sub: u8) -> u64 {
        let value = self.entry(index, sub).map_or(&[][..], |entry| &entry.value);
        value.iter().take(8).rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
    }

    /// A number with its sign; 0 where there is none.
    pub fn signed(&self, index: u16, sub: u8) -> i64 {
        let value = self.entry(index, sub).map_or(&[][..], |entry| &entry.value);
        let missing = 64 - 8 * value.len().clamp(1, 8) as u32;
        (self.unsigned(index, sub) << missing) as i64 >> missing
    }

    /// Sets a number from inside the device, whoever may write it; one that does not fit goes to the end of its range.
    pub fn set(&mut self, index: u16, sub: u8, number: i64) {
        if let Ok(place) = self.place(index, sub) {
            let value = &mut self.entries[place].value;
            let length = value.len().min(8);
            value[..length].copy_from_slice(&number.to_le_bytes()[..length]);
        }
    }

    /// The bytes of an entry to be changed from inside the device.
    pub fn value_mut(&mut self, index: u16, sub: u8) -> Option<&mut Vec<u8>> {
        let place = self.place(index, sub).ok()?;
        Some(&mut self.entries[place].value)
    }

    /// The master writes an entry, the device being in PRE-OP or not.
    pub fn write(&mut self, index: u16, sub: u8, value: &[u8], in_pre_op: bool) -> Result<(), Abort> {
        let entry = self.entry(index, sub)?;
        match entry.access {
            Access::Read => return Err(Abort::ReadOnly),
            Access::WritePreOp if !in_pre_op => return Err(Abort::State),
            _ => {}
        }
        match entry.grows_to {
            Some(most) if value.len() > most => return Err(Abort::TooLong),
            None if value.len() > entry.value.len() => return Err(Abort::TooLong),
            None if value.len() < entry.value.len() => return Err(Abort::TooShort),
            _ => {}
        }
        if let Some((low, high)) = entry.range {
            let missing = 64 - 8 * value.len().clamp(1, 8) as u32;
            let unsigned = value.iter().take(8).rev().fold(0u64, |number, byte| number << 8 | u64::from(*byte));
            // What is never negative is unsigned.
            let number = if low < 0 { (unsigned << missing) as i64 >> missing } else { unsigned as i64 };
            if number < low {
                return Err(Abort::TooLow);
            }
            if number > high {
                return Err(Abort::TooHigh);
            }
        }
        self.mapping_allows(index, sub, value)?;
        if let Ok(place) = self.place(index, sub) {
            self.entries[place].value = value.to_vec();
        }
        Ok(())
    }

    /// What a whole object holds, from subindex 0 or 1 on: subindex 0 is followed by a byte to fill (ETG.1000.6, 5.6.2).
    pub fn whole(&self, index: u16, from: u8) -> Result<Vec<u8>, Abort> {
        let count = self.count(index)?;
        let mut bytes = if from == 0 { vec![count, 0] } else { Vec::new() };
        for sub in 1..=count {
            bytes.extend(self.entry(index, sub).map_or(&[][..], |entry| &entry.value));
        }
        Ok(bytes)
    }

    /// The master writes a whole object, all of it or nothing. Of mappings and assignments the count is taken away first, and set last.
    pub fn write_whole(&mut self, index: u16, from: u8, bytes: &[u8], in_pre_op: bool) -> Result<(), Abort> {
        let old = self.entries.clone();
        let count = self.count(index)?;
        let (count, values) = match from {
            0 => (*bytes.first().ok_or(Abort::TooShort)?, bytes.get(2..).unwrap_or_default()),
            _ => (count, bytes),
        };
        let done = self.write_subs(index, count, values, in_pre_op);
        done.inspect_err(|_| self.entries = old)
    }

    fn write_subs(&mut self, index: u16, count: u8, values: &[u8], in_pre_op: bool) -> Result<(), Abort> {
        let counts = self.entry(index, 0)?.access != Access::Read;
        if counts {
            self.write(index, 0, &[0], in_pre_op)?;
        }
        let mut left = values;
        for sub in 1..=count {
            let length = self.entry(index, sub)?.value.len();
            let (value, rest) = left.split_at_checked(length).ok_or(Abort::TooShort)?;
            self.write(index, sub, value, in_pre_op)?;
            left = rest;
        }
        if !left.is_empty() {
            return Err(Abort::TooLong);
        }
        if counts { self.write(index, 0, &[count], in_pre_op) } else { Ok(()) }
    }

    /// How many subindices an object has that can be accessed as a whole.
    fn count(&self, index: u16) -> Result<u8, Abort> {
        self.entry(index, 0)?;
        // Mappings and assignments are lists even while they are empty.
        let is_list = matches!(index, 0x1600..=0x17FF | 0x1A00..=0x1BFF | 0x1C00..=0x1C2F);
        let has_subs = self.entries.iter().any(|entry| entry.at.0 == index && entry.at.1 > 0);
        if is_list || has_subs { Ok(self.unsigned(index, 0) as u8) } else { Err(Abort::Access) }
    }

    /// The indexes of all objects, in order.
    pub fn indexes(&self) -> Vec<u16> {
        let mut indexes: Vec<u16> = self.entries.iter().map(|entry| entry.at.0).collect();
        indexes.dedup();
        indexes
    }

    /// The highest subindex of an object.
    pub fn highest_sub(&self, index: u16) -> Option<u8> {
        self.entries.iter().rfind(|entry| entry.at.0 == index).map(|entry| entry.at.1)
    }

    /// Mappings and assignments are changed while their length is 0; a length is taken once all that it counts exists.
    fn mapping_allows(&self, index: u16, sub: u8, value: &[u8]) -> Result<(), Abort> {
        let assigns = matches!(index, 0x1C12 | 0x1C13);
        if !assigns && !matches!(index, 0x1600..=0x17FF | 0x1A00..=0x1BFF) {
            return Ok(());
        }
        let number = value.iter().rev().fold(0u64, |number, byte| number << 8 | u64::from(*byte));
        if sub > 0 {
            return if self.unsigned(index, 0) == 0 { Ok(()) } else { Err(Abort::State) };
        }
        for sub in 1..=number as u8 {
            let named = self.entry(index, sub)?;
            let number = self.unsigned(named.at.0, sub);
            if assigns {
                let direction = if index == 0x1C12 { 0x1600..=0x17FF } else { 0x1A00..=0x1BFF };
                if !direction.contains(&(number as u16)) || self.entry(number as u16, 0).is_err() {
                    return Err(Abort::NotMappable);
                }
            } else {
                let (object, sub, bits) = mapped(number as u32);
                let fits = |entry: &Entry| entry.value.len() * 8 == usize::from(bits) && entry.grows_to.is_none();
                if object != 0 && !self.entry(object, sub).is_ok_and(fits) {
                    return Err(Abort::NotMappable);
                }
            }
        }
        Ok(())
    }

    /// What the process data of an assignment (0x1C12 or 0x1C13) hold: index, subindex and bits, one after the other.
    pub fn mapping(&self, assignment: u16) -> Vec<(u16, u8, u8)> {
        let mut all = Vec::new();
        for sub in 1..=self.unsigned(assignment, 0) as u8 {
            let pdo = self.unsigned(assignment, sub) as u16;
            all.extend((1..=self.unsigned(pdo, 0) as u8).map(|sub| mapped(self.unsigned(pdo, sub) as u32)));
        }
        all
    }
}

/// An entry of a mapping: index, subindex, bits.
fn mapped(number: u32) -> (u16, u8, u8) {
    ((number >> 16) as u16, (number >> 8) as u8, number as u8)
}
