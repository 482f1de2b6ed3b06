//! The EEPROM with what a device says of itself (SII, ETG.2010), and the registers through which it is read and written.

use super::memory::Memory;
use super::registers as at;

/// Bytes of the EEPROM: 16 kbit.
const SIZE: usize = 2048;
/// Where categories begin, in bytes.
const CATEGORIES: usize = 0x80;

/// What stands in an EEPROM.
#[derive(Debug, Clone)]
pub struct Information<'a> {
    /// Vendor, product, revision, serial number.
    pub identity: [u32; 4],
    /// Second station address.
    pub alias: u16,
    /// Order number, group, name; some masters take the first for the name.
    pub names: [&'a str; 3],
    /// Start and length of the mailboxes out (from the master) and in; none without a mailbox.
    pub mailbox: Option<[(u16, u16); 2]>,
    /// Sync managers: start, length, control, type (1 and 2 mailbox out and in, 3 outputs, 4 inputs).
    pub sync_managers: &'a [(u16, u16, u8, u8)],
    /// PDOs from the device (TxPDO) and to it: number, sync manager, entries of index, subindex, bits.
    pub inputs: &'a [Pdo],
    /// To the device.
    pub outputs: &'a [Pdo],
}

/// A PDO: what travels together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pdo {
    /// 0x1600 and on to the device, 0x1A00 and on from it.
    pub index: u16,
    /// Which sync manager carries it.
    pub sync_manager: u8,
    /// Index, subindex and bits of each entry.
    pub entries: Vec<(u16, u8, u8)>,
}

/// The EEPROM itself.
#[derive(Debug, Clone)]
pub struct Eeprom {
    bytes: Vec<u8>,
}

impl Eeprom {
    /// Written as `information` says.
    pub fn new(information: &Information<'_>) -> Self {
        let mut bytes = vec![0xFF; SIZE];
        bytes[..CATEGORIES].fill(0);
        let mut put = |word: usize, value: u16| bytes[2 * word..2 * word + 2].copy_from_slice(&value.to_le_bytes());
        put(0, 0x0C80);
        put(4, information.alias);
        for (i, value) in information.identity.iter().enumerate() {
            put(8 + 2 * i, *value as u16);
            put(9 + 2 * i, (value >> 16) as u16);
        }
        if let Some(boxes) = information.mailbox {
            for (i, (start, length)) in boxes.into_iter().enumerate() {
                put(0x18 + 2 * i, start);
                put(0x19 + 2 * i, length);
            }
            put(0x1C, 4); // CoE
        }
        put(0x3E, (SIZE / 128 - 1) as u16);
        put(0x3F, 1);
        let checksum = checksum(&bytes[..14]);
        bytes[14] = checksum;
        let categories = categories(information);
        bytes[CATEGORIES..CATEGORIES + categories.len()].copy_from_slice(&categories);
        Self { bytes }
    }

    /// The word `address` and what follows it, 8 bytes.
    fn words(&self, address: u32) -> [u8; 8] {
        let from = address as usize * 2;
        std::array::from_fn(|i| self.bytes.get(from.saturating_add(i)).copied().unwrap_or(0xFF))
    }

    /// Obeys the command that the master just wrote.
    pub fn obey(&mut self, memory: &mut Memory) {
        let control = memory.u16(at::EEPROM_CONTROL);
        let address = memory.u32(at::EEPROM_ADDRESS);
        let mut error = 0;
        match control >> 8 & 7 {
            1 => memory.put(at::EEPROM_DATA, &self.words(address)),
            2 if control & 1 == 0 => error = 0x4000, // writing was not enabled in the same frame
            2 => {
                let (from, word) = (address as usize * 2, memory.u16(at::EEPROM_DATA).to_le_bytes());
                if let Some(to) = self.bytes.get_mut(from..from + 2) {
                    to.copy_from_slice(&word);
                }
            }
            4 => memory.put(at::ALIAS, &self.words(4)[..2]),
            _ => {}
        }
        // Bit 6: 8 bytes at a time; bit 7: two address bytes. Command bits fall when done.
        memory.put(at::EEPROM_CONTROL, &(0x00C0u16 | error).to_le_bytes());
    }
}

/// CRC-8 of the configuration area (polynomial 0x07, initial value 0xFF).
fn checksum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0xFF, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 != 0 { crc << 1 ^ 0x07 } else { crc << 1 })
    })
}

fn categories(information: &Information<'_>) -> Vec<u8> {
    let mut all = Vec::new();
    let mut add = |kind: u16, mut data: Vec<u8>| {
        if data.len() % 2 == 1 {
            data.push(0);
        }
        all.extend(kind.to_le_bytes());
        all.extend((data.len() as u16 / 2).to_le_bytes());
        all.extend(data);
    };
    let mut strings = vec![information.names.len() as u8];
    for name in information.names {
        strings.push(name.len() as u8);
        strings.extend(name.bytes());
    }
    add(10, strings);
    add(30, general(information));
    let fmmus = if information.mailbox.is_some() { vec![1, 2, 3, 0] } else { vec![1, 2] };
    add(40, fmmus);
    let managers = information.sync_managers.iter().flat_map(|(start, length, control, kind)| {
        let [start, length] = [start.to_le_bytes(), length.to_le_bytes()];
        [start[0], start[1], length[0], length[1], *control, 0, 1, *kind]
    });
    add(41, managers.collect());
    for (kind, pdos) in [(50, information.inputs), (51, information.outputs)] {
        if !pdos.is_empty() {
            add(kind, pdos.iter().flat_map(pdo).collect());
        }
    }
    all.extend([0xFF, 0xFF]);
    all
}

/// Category 30: 32 bytes.
fn general(information: &Information<'_>) -> Vec<u8> {
    let mut general = vec![0; 32];
    general[..4].copy_from_slice(&[2, 0, 1, 3]); // group, picture, order number, name
    if information.mailbox.is_some() {
        // SDO and SDO information; PDO assignment and configuration may be changed; complete access.
        general[5] = 0x01 | 0x02 | 0x04 | 0x08 | 0x20;
    }
    general[16] = 0x11; // ports 0 and 1 are MII
    general
}

fn pdo(pdo: &Pdo) -> Vec<u8> {
    let index = pdo.index.to_le_bytes();
    let mut bytes = vec![index[0], index[1], pdo.entries.len() as u8, pdo.sync_manager, 0, 0, 0, 0];
    for (index, sub, bits) in &pdo.entries {
        let index = index.to_le_bytes();
        bytes.extend([index[0], index[1], *sub, 0, 0, *bits, 0, 0]);
    }
    bytes
}
