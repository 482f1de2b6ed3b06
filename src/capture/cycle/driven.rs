//! One axis with its drive's place in the exchange, and what is asked of that drive alone, beside the process data.

use super::{Exchange, Failure};
use crate::capture::axis::{Axis, Inputs, Now};
use crate::capture::cause::Cause;
use crate::capture::line::Line;
use crate::capture::managers::{Manager, managers};
use crate::capture::rig::{Place, Rig};
use crate::capture::safety::Request;
use crate::capture::watchdog;
use crate::capture::wire::Wire;
use ethercrab::{Command, MainDevice};
use serde_json::{Value, json};

/// An axis and its drive.
pub struct Driven {
    /// What the drive is called.
    pub name: String,
    /// As it is seen on the wire.
    pub axis: Axis,
    /// What was last seen.
    pub now: Option<Now>,
    /// Of drive and sensor, on the bus.
    place: usize,
    sensor_place: usize,
    status_word: Option<Place>,
    /// The device, on the bus and in its outputs, that lets the brake go, where that is not the drive.
    brake: Option<(usize, Place)>,
    /// Where the drive's inputs stand in its memory, if that is known.
    inputs: Option<Manager>,
    /// The drive's station address.
    station: Option<u16>,
    /// The cycle in which its buffer was last looked at.
    looked_at: u64,
    /// Lowest and highest position, rad, and torque, N m, since this was last told.
    position_rad: (f64, f64),
    torque_nm: (f64, f64),
}

/// No value yet.
const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn widened((low, high): (f64, f64), value: f64) -> (f64, f64) {
    (low.min(value), high.max(value))
}

impl Driven {
    /// The axis of `rig`, on the bus.
    pub fn new<'m, W: Wire, C>(
        line: &mut Line<'_, W>,
        main: &'m MainDevice<'m>,
        exchange: &Exchange<C>,
        rig: &Rig,
        axis: Axis,
    ) -> Self {
        let place = rig.drive.identity.place;
        let drive = exchange.group.subdevice(main, place).ok();
        let station = drive.as_ref().map(|drive| drive.configured_address());
        let inputs = drive.and_then(|drive| managers(line, &drive).into_iter().find(Manager::is_inputs));
        let brake = rig.drive.brake.as_ref().and_then(|brake| brake.device.as_ref());
        let brake = brake.and_then(|device| Some((device.identity.place, device.outputs.place("brake")?)));
        Self {
            name: rig.drive.identity.name.clone(),
            axis,
            now: None,
            place,
            sensor_place: rig.sensor.identity.place,
            status_word: rig.drive.inputs.place("status_word"),
            brake,
            inputs,
            station,
            looked_at: 0,
            position_rad: NOTHING,
            torque_nm: NOTHING,
        }
    }

    /// The drive's place on the bus.
    pub fn place(&self) -> usize {
        self.place
    }

    /// Takes in what an answer says of it, `periods` after the last one.
    pub fn take<'m, C>(&mut self, main: &'m MainDevice<'m>, exchange: &Exchange<C>, periods: u32) {
        let group = &exchange.group;
        let (Ok(drive), Ok(sensor)) = (group.subdevice(main, self.place), group.subdevice(main, self.sensor_place))
        else {
            return self.axis.blame(Cause::Stack("a device is gone from the stack's list".to_string()));
        };
        let now = self.axis.take(&Inputs { drive: &drive.inputs_raw(), sensor: &sensor.inputs_raw(), periods });
        self.position_rad = widened(self.position_rad, now.position_rad);
        self.torque_nm = widened(self.torque_nm, now.drive_torque_nm);
        self.now = Some(now);
    }

    /// Between which positions and torques of its drive it was since this was last asked for.
    pub fn tell(&mut self) -> Value {
        let (position_rad, torque_nm) =
            (std::mem::replace(&mut self.position_rad, NOTHING), std::mem::replace(&mut self.torque_nm, NOTHING));
        json!({ "name": self.name, "position_rad": position_rad, "drive_torque_nm": torque_nm })
    }

    /// Writes what the drive is told.
    pub fn write<'m, C>(&mut self, main: &'m MainDevice<'m>, exchange: &Exchange<C>) {
        if let Ok(drive) = exchange.group.subdevice(main, self.place) {
            self.axis.write(drive.io_raw_mut().outputs(), self.now.as_ref());
        }
        if let Some((at, place)) = self.brake
            && let Ok(device) = exchange.group.subdevice(main, at)
        {
            place.set(device.io_raw_mut().outputs(), self.axis.brake_word());
        }
    }

    /// Whether the drive has filled its buffer anew, where no counter of its own tells.
    ///
    /// Errors: the words of a panic of the stack.
    pub fn look_for_news<'m, W: Wire, C>(
        &mut self,
        line: &mut Line<'_, W>,
        main: &'m MainDevice<'m>,
        exchange: &Exchange<C>,
        number: u64,
        until_ns: u64,
    ) -> Result<(), String> {
        let Some(inputs) = self.inputs.filter(|_| !self.axis.has_counter()) else { return Ok(()) };
        let Ok(drive) = exchange.group.subdevice(main, self.place) else { return Ok(()) };
        match line.run_until(until_ns, drive.register_read::<u8>(inputs.status_at())) {
            Ok(status) => {
                let periods = u32::try_from(number - self.looked_at).unwrap_or(u32::MAX);
                self.looked_at = number;
                self.axis.freshen(u32::from(status >> 4 & 3), periods);
                Ok(())
            }
            Err(Failure::Panic(words)) => Err(words),
            Err(_) => Ok(()),
        }
    }

    /// Asks the drive alone where it stands, by its memory, in a stop in which not all devices answer: out of OP, or with another
    /// device gone, it still tells.
    pub fn ask<'m, W: Wire>(&mut self, line: &mut Line<'_, W>, main: &'m MainDevice<'m>, until_ns: u64) {
        let (Some(inputs), Some(place), Some(station)) = (self.inputs, self.status_word, self.station) else { return };
        let memory = Command::fprd(station, inputs.start);
        let asked = async { memory.receive_slice(main, inputs.length).await.map(|bytes| place.get(&bytes)) };
        if let Ok(status_word) = line.run_until(until_ns, asked) {
            self.axis.take_status(status_word as u16);
        }
    }

    /// Whether the drive's output watchdog runs now; nothing where it does not tell.
    pub fn is_watched<'m, W: Wire, C>(
        &self,
        line: &mut Line<'_, W>,
        main: &'m MainDevice<'m>,
        exchange: &Exchange<C>,
        until_ns: u64,
    ) -> Option<bool> {
        watchdog::is_fed(line, &exchange.group.subdevice(main, self.place).ok()?, until_ns)
    }

    /// The drive is told to leave OP, past the stack. Only this drive: the other devices on the bus continue.
    pub fn drop_out<W: Wire>(&self, line: &mut Line<'_, W>) {
        line.drop_out(self.station);
    }

    /// What is wanted of an axis that holds while `request` is wanted of the joint.
    pub fn held(request: Request) -> Request {
        match request {
            Request::Watch => Request::Watch,
            Request::Hold | Request::Move => Request::Hold,
        }
    }
}
