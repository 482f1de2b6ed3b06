//! The devices of a bus together: their group in the stack, their stations, who of them is in error, why they did not start.

use super::clock;
use super::line::{BYTES, DEVICES, Failure, Line};
use super::rig::Rig;
use super::wire::Wire;
use ethercrab::subdevice_group::{NoDc, PreOp};
use ethercrab::{AlStatusCode, Command, DefaultLock, MainDevice, SubDeviceGroup};

/// A group of the stack in one of its states.
pub type Group<S, C> = SubDeviceGroup<DEVICES, BYTES, DefaultLock, S, C>;

/// The station address that the stack gives to the first device; the others follow.
const FIRST_STATION: u16 = 0x1000;

/// AL status, whose bit 4 flags an error; its code follows after 4 bytes.
const AL_STATUS: u16 = 0x0130;
const AL_ERROR: u8 = 1 << 4;

/// Why the bus did not start, in words with the device at fault.
#[derive(Debug, Clone, PartialEq)]
pub struct NotStarted(pub String);

impl NotStarted {
    pub(super) fn of<T>(what: impl Into<String>) -> Result<T, Self> {
        Err(Self(what.into()))
    }
}

/// A step that was not taken.
pub(super) fn while_doing(what: &str) -> impl Fn(Failure) -> NotStarted + '_ {
    move |failure| NotStarted(format!("{what}: {failure}"))
}

/// The station addresses of the devices of `rig`, as the stack gives them.
pub fn stations(rig: &Rig) -> Vec<u16> {
    rig.devices().map(|(identity, _)| station(identity.place)).collect()
}

fn station(place: usize) -> u16 {
    FIRST_STATION.wrapping_add(u16::try_from(place).unwrap_or(u16::MAX))
}

/// The devices that have refused a state or fallen from it, and why, in words; nothing where all are well.
pub fn ailing<W: Wire>(line: &mut Line<'_, W>, main: &MainDevice<'_>) -> String {
    (0..main.num_subdevices())
        .filter_map(|place| {
            let register = Command::fprd(station(place), AL_STATUS);
            let status = line.run(register.receive::<[u8; 6]>(main)).ok()?;
            let why = AlStatusCode::from(u16::from_le_bytes([status[4], status[5]]));
            (status[0] & AL_ERROR != 0).then(|| format!("; device {place} is in error {why}"))
        })
        .collect()
}

/// Emergency messages that came while objects were asked for, in words.
pub(super) fn heard<W: Wire>(line: &mut Line<'_, W>, rig: &Rig) -> Vec<String> {
    let words = |(station, code): (u16, u16)| {
        let place = usize::from(station.wrapping_sub(FIRST_STATION));
        let name = rig.name(place).unwrap_or_else(|| format!("device {place}"));
        format!("{name} sent emergency message {code:#06x}")
    };
    line.heard().into_iter().map(words).collect()
}

/// Brings all devices to PRE-OP.
///
/// Errors: nobody answers, or somebody does not go there.
pub fn pre_op<'m, W: Wire>(line: &mut Line<'_, W>, main: &'m MainDevice<'m>) -> Result<Group<PreOp, NoDc>, Failure> {
    line.run(main.init_single_group::<DEVICES, BYTES>(clock::now_ns))
}
