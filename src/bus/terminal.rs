//! An analog input terminal that reads the torque sensor: 10 V in 16 bits, or the torque as a float.

use super::application::{Application, Moment};
use super::clock::Clock;
use super::coe::{Access, Dictionary, Emergency};
use super::description::Description;
use super::device::Device;
use super::fault::Fault;
use super::world::World;

/// Vendor of the devices here: nobody's.
pub const VENDOR: u32 = 0x0ABC;
/// Product code of the terminal with 16 bits, and of the one with floats.
pub const PRODUCT: u32 = 0x0301;
/// The one with floats.
pub const PRODUCT_FLOAT: u32 = 0x0302;
/// What the torque sensor gives, V per N m.
pub const VOLTS_PER_NM: f64 = 2.0;
/// What the highest value stands for, V.
const FULL_SCALE_V: f64 = 10.0;

/// Bits of the status.
mod bit {
    pub const UNDERRANGE: u16 = 1;
    pub const OVERRANGE: u16 = 2;
    pub const ERROR: u16 = 0x40;
    pub const TOGGLE: u16 = 0x8000;
}

/// What the terminal is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terminal {
    /// Whether it gives the torque as a float, N m, rather than volts in 16 bits.
    pub float: bool,
    /// Whether it has a mailbox; the simplest have none.
    pub mailbox: bool,
    /// Whether it always sends a second PDO behind the first, of another channel.
    pub two_channels: bool,
    /// What it reads at no torque, V.
    pub offset_v: f64,
}

impl Default for Terminal {
    fn default() -> Self {
        Self { float: false, mailbox: true, two_channels: false, offset_v: 0.0 }
    }
}

#[derive(Debug)]
struct Input {
    terminal: Terminal,
    toggle: bool,
    fault: Option<Fault>,
}

impl Terminal {
    /// The device; its clock runs `drift_ppb` too fast.
    pub fn device(self, drift_ppb: i64) -> Device {
        let mut dictionary = Dictionary::default();
        let (bytes, bits) = if self.float { (4, 32) } else { (2, 16) };
        dictionary.number((0x1000, 0), Access::Read, 4, 0x0001_2C19);
        dictionary.number((0x6000, 0), Access::Read, 1, 0x11);
        dictionary.number((0x6000, 0x01), Access::Read, 2, 0).number((0x6000, 0x11), Access::Read, bytes, 0);
        dictionary.list(0x1A00, Access::Read, 4, &[0x6000_0110, 0x6000_1100 | bits]);
        dictionary.list(0x1C12, Access::WritePreOp, 2, &[]);
        if self.two_channels {
            dictionary.number((0x6010, 0), Access::Read, 1, 0x11).number((0x6010, 0x11), Access::Read, 2, 0);
            dictionary.list(0x1A01, Access::Read, 4, &[0x6010_1110]).list(0x1C13, Access::Read, 2, &[0x1A00, 0x1A01]);
        } else {
            dictionary.list(0x1C13, Access::WritePreOp, 2, &[0x1A00]);
        }
        let product = if self.float { PRODUCT_FLOAT } else { PRODUCT };
        let description = Description {
            identity: [VENDOR, product, 1, 77],
            names: ["TL3001", "AnaIn", if self.float { "Torque input, float" } else { "Analog input, 10 V" }],
            dictionary,
            mailbox: self.mailbox,
            clock: Some(Clock::new(9_876_543_210, drift_ppb)),
            feeds_watchdog: true,
        };
        Device::new(description, Box::new(Input { terminal: self, toggle: false, fault: None }))
    }
}

impl Application for Input {
    fn work(&mut self, dictionary: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency> {
        if !moment.samples || self.fault == Some(Fault::StaleSensor) {
            return None;
        }
        let torque_nm = world.joints.first_mut().map_or(0.0, |joint| joint.reading_nm());
        let volts = torque_nm * VOLTS_PER_NM + self.terminal.offset_v;
        let volts = if self.fault == Some(Fault::SaturatedSensor) { 2.0 * FULL_SCALE_V } else { volts };
        let not_a_number = self.fault == Some(Fault::NotANumber);
        self.toggle = !self.toggle;
        let mut status = if self.toggle { bit::TOGGLE } else { 0 };
        if not_a_number {
            status |= bit::ERROR;
        }
        if volts >= FULL_SCALE_V {
            status |= bit::OVERRANGE | bit::ERROR;
        }
        if volts <= -FULL_SCALE_V {
            status |= bit::UNDERRANGE | bit::ERROR;
        }
        dictionary.set(0x6000, 0x01, i64::from(status));
        let within_v = volts.clamp(-FULL_SCALE_V, FULL_SCALE_V);
        let value = if self.terminal.float {
            let nm = if not_a_number { f64::NAN } else { within_v / VOLTS_PER_NM };
            i64::from((nm as f32).to_bits())
        } else {
            (within_v / FULL_SCALE_V * f64::from(i16::MAX)).round() as i64
        };
        dictionary.set(0x6000, 0x11, value);
        None
    }

    fn fail(&mut self, fault: Fault) {
        if matches!(fault, Fault::StaleSensor | Fault::SaturatedSensor | Fault::NotANumber) {
            self.fault = Some(fault);
        }
    }
}
