//! A digital output terminal of four channels, of which the first lets a brake go.

use super::application::{Application, Moment};
use super::coe::{Access, Dictionary, Emergency};
use super::description::Description;
use super::device::Device;
use super::fault::Fault;
use super::terminal::VENDOR;
use super::world::{BrakeBy, World};

/// Product code of the terminal.
pub const PRODUCT: u32 = 0x0204;
/// Its channels, objects 0x7000, 0x7010 and so on with their first subindex, a PDO for each.
const CHANNELS: u16 = 4;

#[derive(Debug)]
struct Outputs;

/// The device, on the brake of the first joint.
pub fn device() -> Device {
    let mut dictionary = Dictionary::default();
    dictionary.number((0x1000, 0), Access::Read, 4, 0x0001_2C19);
    for channel in 0..CHANNELS {
        let object = 0x7000 + 0x10 * channel;
        dictionary.number((object, 0), Access::Read, 1, 1).number((object, 1), Access::Read, 1, 0);
        dictionary.list(0x1600 + channel, Access::Read, 4, &[i64::from(object) << 16 | 0x0101]);
    }
    dictionary.list(0x1C12, Access::Read, 2, &[0x1600, 0x1601, 0x1602, 0x1603]);
    dictionary.list(0x1C13, Access::Read, 2, &[]);
    let description = Description {
        identity: [VENDOR, PRODUCT, 1, 78],
        names: ["TL2004", "DigOut", "Digital outputs, 24 V"],
        dictionary,
        mailbox: true,
        clock: None,
        feeds_watchdog: true,
    };
    Device::new(description, Box::new(Outputs))
}

impl Application for Outputs {
    fn work(&mut self, dictionary: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency> {
        if let Some(joint) = world.joints.first_mut() {
            joint.brake(BrakeBy::Terminal, !moment.operational || dictionary.unsigned(0x7000, 1) == 0);
        }
        None
    }

    fn fail(&mut self, _: Fault) {}
}
