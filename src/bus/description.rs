//! A device as it leaves its maker: what its EEPROM, its registers and its objects say of it.

use super::application::Application;
use super::clock::Clock;
use super::coe::{Dictionary, Mailbox};
use super::device::Device;
use super::eeprom::{Eeprom, Information, Pdo};
use super::memory::Memory;
use super::process::{self, Mapping};
use super::registers as at;
use super::states::{SYNC_ERROR_LIMIT, States};

/// Where process data stand.
const OUTPUTS_AT: u16 = 0x1100;
const INPUTS_AT: u16 = 0x1400;
/// The mailboxes, from and to the master: start and length.
const MAILBOX: [(u16, u16); 2] = [(0x1000, 128), (0x1080, 128)];
/// How a sync manager is controlled: mailboxes, outputs with watchdog, inputs.
const CONTROLS: [u8; 4] = [0x26, 0x22, 0x64, 0x20];
/// Pulses that may go by without outputs, by default.
const SYNC_ERRORS: i64 = 150;
/// The bit of it that has outputs feed the watchdog.
const FEEDS_WATCHDOG: u8 = 0x40;

/// What a device is, for [`Device::new`].
#[derive(Debug)]
pub struct Description<'a> {
    /// Vendor, product, revision, serial number.
    pub identity: [u32; 4],
    /// Order number, group, name.
    pub names: [&'a str; 3],
    /// Its objects, process data mappings among them; 0x1018, 0x1C00 and the names are added.
    pub dictionary: Dictionary,
    /// Whether it has a mailbox (CoE); without one only its EEPROM tells of its process data.
    pub mailbox: bool,
    /// Its clock, if it has one.
    pub clock: Option<Clock>,
    /// Whether the EEPROM has the outputs' sync manager feed the watchdog (bit 6 of its control byte).
    pub feeds_watchdog: bool,
}

impl Device {
    /// A device as described, switched on and in INIT.
    pub fn new(description: Description<'_>, application: Box<dyn Application>) -> Self {
        let Description { identity, names, mut dictionary, mailbox, clock, feeds_watchdog } = description;
        let pdos = |assignment: u16, sync_manager: usize| -> Vec<Pdo> {
            let entries = dictionary.mapping(assignment);
            let index = dictionary.unsigned(assignment, 1) as u16;
            let sync_manager = sync_manager as u8;
            if entries.is_empty() { Vec::new() } else { vec![Pdo { index, sync_manager, entries }] }
        };
        let first = if mailbox { 2 } else { 0 };
        let (outputs, inputs) = (pdos(0x1C12, first), pdos(0x1C13, first + 1));
        let length = |pdos: &[Pdo]| pdos.iter().map(|pdo| process::length(&pdo.entries) as u16).sum();
        let mut managers: Vec<(u16, u16, u8, u8)> = Vec::new();
        if mailbox {
            managers.extend((0..2).map(|i| (MAILBOX[i].0, MAILBOX[i].1, CONTROLS[i], i as u8 + 1)));
        }
        let control = if feeds_watchdog { CONTROLS[2] } else { CONTROLS[2] & !FEEDS_WATCHDOG };
        managers.push((OUTPUTS_AT, length(&outputs), control, 3));
        managers.push((INPUTS_AT, length(&inputs), CONTROLS[3], 4));
        let eeprom = Eeprom::new(&Information {
            identity,
            alias: 0,
            names,
            mailbox: mailbox.then_some(MAILBOX),
            sync_managers: &managers,
            inputs: &inputs,
            outputs: &outputs,
        });
        let mut memory = Memory::new(managers.len(), 4);
        describe(&mut memory, managers.len() as u8, clock.is_some());
        describe_objects(&mut dictionary, identity, names, managers.iter().map(|manager| manager.3));
        let mut device = Self {
            memory,
            clock,
            dictionary,
            mailbox: mailbox.then(Mailbox::default),
            states: States::default(),
            inputs: Mapping::new(),
            outputs: Mapping::new(),
            fed_ns: None,
            eeprom,
            application,
            worked_ns: 0,
            is_frozen: false,
            is_unwatched: false,
            missed_outputs: 0,
            has_news: false,
        };
        device.show_state();
        device
    }
}

/// Features of the bus interface (register 0x0008): frames checked and counted; with bits 2 and 3 a clock of 64 bits.
const FEATURES: u16 = 0x00C0;
const CLOCK_FEATURES: u16 = 0x000C;

impl Device {
    /// The same without a distributed clock, as many simple devices are.
    pub fn without_clock(mut self) -> Self {
        self.clock = None;
        self.memory.put(at::FEATURES, &FEATURES.to_le_bytes());
        self
    }
}

/// What stands in the registers when a device is switched on.
fn describe(memory: &mut Memory, sync_managers: u8, has_clock: bool) {
    let features = FEATURES | if has_clock { CLOCK_FEATURES } else { 0 };
    let features = features.to_le_bytes();
    memory.put(at::INFORMATION, &[0x11, 0, 2, 0, 4, sync_managers, 8, 0x0F, features[0], features[1]]);
    memory.put(at::PDI_CONTROL, &[0x80, 0x0C]);
    memory.put(at::WATCHDOG_DIVIDER, &2498u16.to_le_bytes());
    memory.put(at::WATCHDOG_PDI, &1000u16.to_le_bytes());
    memory.put(at::WATCHDOG_OUTPUTS, &1000u16.to_le_bytes());
    memory.put(at::EEPROM_CONTROL, &0x00C0u16.to_le_bytes());
}

/// The objects that every device has.
fn describe_objects(
    dictionary: &mut Dictionary,
    identity: [u32; 4],
    names: [&str; 3],
    managers: impl Iterator<Item = u8>,
) {
    use super::coe::Access::Read;
    dictionary.text((0x1008, 0), names[2]).text((0x1009, 0), "1").text((0x100A, 0), env!("CARGO_PKG_VERSION"));
    dictionary.list(0x1018, Read, 4, &identity.map(i64::from));
    let (limit, sub) = SYNC_ERROR_LIMIT;
    dictionary.number((limit, 0), Read, 1, 2).within((limit, 1), 4, 1, (0, 4));
    dictionary.within((limit, sub), 2, SYNC_ERRORS, (0, 65535));
    dictionary.list(0x1C00, Read, 1, &managers.map(i64::from).collect::<Vec<i64>>());
    if dictionary.entry(0x1001, 0).is_err() {
        dictionary.number((0x1001, 0), Read, 1, 0);
    }
}
