//! A software EtherCAT bus: devices that answer frames as real ones do, faults included, in virtual time.
//!
//! The same bus serves tests in process (a frame in, replies out, the clock whatever the caller says) and, behind a raw socket,
//! any other master. What is sent at one time with one seed always gives the same replies.
//!
//! A frame passes every device in the order of the wire, datagram by datagram (`frame`, `device`), and each lays hands on its
//! own memory (`memory`, `fmmu`). Between frames, time passes: clocks give pulses, mailboxes answer, states change, watchdogs
//! expire (`clock`, `coe`, `states`), and the drive's motor moves the joint (`drive`, `world`) whose torque the terminal reads.

mod application;
mod clock;
mod coe;
mod description;
mod device;
mod drive;
mod eeprom;
mod fault;
mod fmmu;
mod frame;
mod inject;
mod line;
mod memory;
mod motor;
mod outputs;
mod passing;
mod process;
mod registers;
mod states;
mod terminal;
mod world;

pub use application::{Application, Moment};
pub use clock::Clock;
pub use coe::{Access, Dictionary, Emergency, Entry};
pub use description::Description;
pub use device::Device;
pub use drive::{COUNTS_PER_REVOLUTION, RATED_TORQUE_MNM, device as drive, device_with as drive_with, two_axes};
pub use fault::{Fault, When};
pub use motor::{Law, Motor};
pub use outputs::device as outputs;
pub use terminal::{Terminal, VOLTS_PER_NM};
pub use world::{BrakeBy, Joint, MOTOR_INERTIA_KG_M2, SecondCable, World};

use crate::model::Model;
use frame::{Addressing, datagrams};
use inject::Struck;
use line::Line;

/// How long a frame takes from one device to the next, and back, ns.
const HOP_NS: u64 = 700;
/// How long a byte takes at 100 Mbit/s, ns, and how many go before and behind a frame.
const BYTE_NS: u64 = 80;
const AROUND_BYTES: usize = 24;
/// The port behind which the next device hangs.
const BEHIND: u16 = 1;
/// How much too fast the clocks of the demo's devices run, parts per billion: what cheap crystals do.
const DRIFTS_PPB: [i64; 2] = [3_000, -8_000];

/// What is slack of an antagonistic joint's second cable at first, rad of the joint.
const SLACK_RAD: f64 = 0.02;

/// A bus of devices on one wire, in virtual time.
#[derive(Debug)]
pub struct Bus {
    devices: Vec<Device>,
    world: World,
    line: Line,
    to_come: Vec<(When, Struck, Fault)>,
    /// How many devices the wire still reaches.
    reached: usize,
    cycles: u64,
    now_ns: u64,
}

/// What comes back on the wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// When it arrives, ns of virtual time.
    pub at_ns: u64,
    /// The whole Ethernet frame.
    pub frame: Vec<u8>,
}

/// The joint as it really is, for tests to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Truth {
    /// Position, rad.
    pub position_rad: f64,
    /// Speed, rad/s.
    pub velocity_rad_s: f64,
    /// That of its winch, rad/s of the joint: another one only once the cable has broken.
    pub winch_rad_s: f64,
    /// y at the winch before the sensor, N m.
    pub torque_nm: f64,
}

impl Bus {
    /// Devices in the order of the wire, without a joint.
    pub fn new(devices: Vec<Device>) -> Self {
        let reached = devices.len();
        let mut bus = Self {
            devices,
            world: World::default(),
            line: Line::default(),
            to_come: Vec::new(),
            reached,
            cycles: 0,
            now_ns: 0,
        };
        bus.link();
        bus
    }

    /// The same with a joint for its devices to move and measure; with another, for the next drive to move.
    pub fn with_joint(mut self, joint: Joint) -> Self {
        self.world.joints.push(joint);
        self
    }

    /// A drive and an analog input terminal (its torque sensor) on a joint that behaves like `model`, hanging.
    /// The torque has white noise of `noise_nm`, N m, repeatable by `seed`.
    pub fn demo(model: Model, noise_nm: f64, seed: u64) -> Self {
        let devices = vec![drive(DRIFTS_PPB[0]), Terminal::default().device(DRIFTS_PPB[1])];
        Self::new(devices).with_joint(Joint::new(model, 0.0, noise_nm, seed))
    }

    /// The same with a second drive behind, on a load of its own, which behaves like `model` too.
    pub fn demo_of_two(model: Model, noise_nm: f64, seed: u64) -> Self {
        let second = drive::device_on(1, DRIFTS_PPB[0]);
        let devices = vec![drive(DRIFTS_PPB[0]), Terminal::default().device(DRIFTS_PPB[1]), second];
        let joints = [Joint::new(model.clone(), 0.0, noise_nm, seed), Joint::new(model, 0.0, noise_nm, seed)];
        joints.into_iter().fold(Self::new(devices), Self::with_joint)
    }

    /// An antagonistic joint: the second drive's cable pulls it down, against the first one's. A little of that cable is slack at first.
    pub fn demo_antagonistic(model: Model, noise_nm: f64, seed: u64) -> Self {
        let devices =
            vec![drive(DRIFTS_PPB[0]), Terminal::default().device(DRIFTS_PPB[1]), drive::device_on(1, DRIFTS_PPB[0])];
        let winch = Joint::new(model.clone(), 0.0, noise_nm, seed).unloaded();
        let mut bus = Self::new(devices).with_joint(Joint::new(model, 0.0, noise_nm, seed)).with_joint(winch);
        bus.world.cable = Some(SecondCable { slack_rad: SLACK_RAD });
        bus
    }

    /// Sends `frame`, a whole Ethernet frame, at `now_ns`, which never goes back; devices and joint advance to then first.
    /// Replies are in order of arrival; late frames come later, lost ones not at all, doubled ones twice.
    pub fn send(&mut self, now_ns: u64, frame: &[u8]) -> Vec<Reply> {
        let Some(datagrams) = datagrams(frame) else {
            self.advance(now_ns);
            return Vec::new();
        };
        let process_data = datagrams.iter().any(|datagram| datagram.command.to == Addressing::Logical);
        self.advance(now_ns);
        let faults = if process_data { self.next_cycle() } else { self.line.lasting() };
        let now_ns = self.now_ns;
        if !faults.iter().any(|fault| matches!(fault, Fault::Unsent { .. })) {
            self.world.advance(now_ns);
            let world = &mut self.world;
            self.devices[..self.reached].iter_mut().for_each(|device| device.expect(world, now_ns, process_data));
        }
        if self.reached == 0 || faults.iter().any(|fault| matches!(fault, Fault::Unsent { .. })) {
            return Vec::new();
        }
        // Frames are damaged on their way back, behind the first device.
        if faults.iter().any(|fault| matches!(fault, Fault::Corrupted { .. })) {
            self.devices[0].count_damage(BEHIND);
        }
        let mut frame = frame.to_vec();
        let there_and_back_ns = 2 * HOP_NS * self.reached as u64;
        for datagram in &datagrams {
            for (place, device) in self.devices[..self.reached].iter_mut().enumerate() {
                let in_ns = now_ns + HOP_NS * (place as u64 + 1);
                let back_ns = (place + 1 < self.reached).then(|| now_ns + there_and_back_ns - HOP_NS * place as u64);
                let short =
                    |fault: &Fault| matches!(fault, Fault::WorkingCounterShort { device, .. } if *device == place);
                device.pass(datagram, &mut frame, (in_ns, back_ns), !faults.iter().any(short));
            }
        }
        frame[6] |= 2; // the first device turns this bit of the sender's address over: so a master tells replies
        let lasts_ns = (frame.len() + AROUND_BYTES) as u64 * BYTE_NS;
        self.line.replies(Reply { at_ns: now_ns + there_and_back_ns + lasts_ns, frame }, &faults)
    }

    /// Lets time pass up to `now_ns` without a frame.
    pub fn advance(&mut self, now_ns: u64) {
        let now_ns = now_ns.max(self.now_ns);
        loop {
            let at = self.now_ns;
            let device_ns = self.devices.iter().map(|device| device.due_ns(at)).min();
            let fault_ns = self.to_come.iter().filter_map(|(when, ..)| match when {
                When::Time(ns) => Some(*ns),
                When::Cycle(_) => None,
            });
            let next_ns = fault_ns.chain(device_ns).min().unwrap_or(u64::MAX).max(at);
            if next_ns > now_ns {
                break;
            }
            self.now_ns = next_ns;
            self.strike(|when| matches!(when, When::Time(ns) if ns <= next_ns));
            for device in self.devices.iter_mut().filter(|device| device.due_ns(next_ns) <= next_ns) {
                self.world.advance(next_ns);
                device.act(&mut self.world, next_ns);
            }
        }
        self.now_ns = now_ns;
    }

    /// Counts a frame of process data; returns the faults of the wire that strike it.
    fn next_cycle(&mut self) -> Vec<Fault> {
        let cycle = self.cycles;
        self.cycles += 1;
        self.strike(|when| matches!(when, When::Cycle(at) if at <= cycle));
        self.line.strike()
    }

    /// Tells every device whether there is one behind it.
    fn link(&mut self) {
        let reached = self.reached;
        self.devices.iter_mut().enumerate().for_each(|(place, device)| device.link(place + 1 < reached));
    }

    /// Frames that carried process data so far.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// The joint as it is.
    pub fn truth(&self) -> Truth {
        self.truth_of(0)
    }

    /// The joint that the drive `index` moves, from 0, as it is.
    pub fn truth_of(&self, index: usize) -> Truth {
        self.world.joints.get(index).map_or(Truth::default(), |joint| Truth {
            position_rad: joint.carried().0,
            velocity_rad_s: joint.carried().1,
            winch_rad_s: joint.velocity_rad_s(),
            torque_nm: joint.torque_nm(),
        })
    }

    /// What the second winch's cable pulls an antagonistic joint down with, N m at its winch.
    pub fn pull_nm(&self) -> f64 {
        self.world.pull_nm()
    }

    /// Sets a number in the object dictionary of the device at `place`, as the maker's own tool would.
    pub fn set_object(&mut self, place: usize, index: u16, number: i64) {
        if let Some(device) = self.devices.get_mut(place) {
            device.dictionary.set(index, 0, number);
        }
    }

    /// The devices, in the order of the wire.
    pub fn devices(&self) -> &[Device] {
        &self.devices
    }

    /// The CiA 402 status word of the first device that has one.
    pub fn drive_status(&self) -> Option<u16> {
        self.drive_statuses().next()
    }

    /// Those of all devices that have one.
    pub fn drive_statuses(&self) -> impl Iterator<Item = u16> {
        let words = self.devices.iter().filter_map(|device| device.object(0x6041, 0)?.first_chunk::<2>());
        words.map(|bytes| u16::from_le_bytes(*bytes))
    }
}
