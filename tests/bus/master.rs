//! As much of a master as tests need: datagrams by hand, the way to OP, a cycle.

use std::path::Path;
use tautline::bus::{Bus, COUNTS_PER_REVOLUTION, Reply};
use tautline::model::Model;

pub const APRD: u8 = 1;
pub const APWR: u8 = 2;
pub const FPRD: u8 = 4;
pub const FPWR: u8 = 5;
pub const BRD: u8 = 7;
pub const BWR: u8 = 8;
pub const LRD: u8 = 10;
pub const LWR: u8 = 11;
pub const LRW: u8 = 12;
pub const ARMW: u8 = 13;
pub const FRMW: u8 = 14;

/// Stations of the demo's devices, and where their process data lie: 15 bytes out, 15 and 4 in.
pub const DRIVE: u16 = 0x1001;
pub const TERMINAL: u16 = 0x1002;
pub const OUT: u32 = 0x0001_0000;
pub const OUT_BYTES: usize = 13;
pub const IN_BYTES: usize = 15;
pub const SENSOR_BYTES: usize = 4;
pub const ALL: usize = OUT_BYTES + IN_BYTES + SENSOR_BYTES;

pub const MS: u64 = 1_000_000;

/// A datagram: command, address (position or station low, offset high; or logical), data.
pub struct Datagram(pub u8, pub u32, pub Vec<u8>);

/// The frame of some datagrams.
pub fn frame(datagrams: &[Datagram]) -> Vec<u8> {
    let mut body = Vec::new();
    for (i, Datagram(command, address, data)) in datagrams.iter().enumerate() {
        let more = if i + 1 < datagrams.len() { 0x8000 } else { 0 };
        body.extend([*command, i as u8]);
        body.extend(address.to_le_bytes());
        body.extend((data.len() as u16 | more).to_le_bytes());
        body.extend([0, 0]);
        body.extend(data);
        body.extend([0, 0]);
    }
    let mut frame = vec![0xFF; 6];
    frame.extend([0x10; 6]);
    frame.extend([0x88, 0xA4]);
    frame.extend((body.len() as u16 | 0x1000).to_le_bytes());
    frame.extend(body);
    frame
}

/// Data and working counter of each datagram of a frame.
pub fn answers(frame: &[u8]) -> Vec<(Vec<u8>, u16)> {
    let (mut at, mut all) = (16, Vec::new());
    loop {
        let length = u16::from_le_bytes([frame[at + 6], frame[at + 7]]);
        let end = at + 10 + usize::from(length & 0x7FF);
        all.push((frame[at + 10..end].to_vec(), u16::from_le_bytes([frame[end], frame[end + 1]])));
        if length & 0x8000 == 0 {
            return all;
        }
        at = end + 2;
    }
}

/// What the drive and the terminal told in a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    pub counter: u16,
    pub states: [u8; 2],
    pub status: u16,
    pub position: i32,
    pub velocity: i32,
    pub torque: i16,
    pub error: u16,
    pub sensor_status: u16,
    pub sensor: i16,
}

/// What the drive is told.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted {
    pub control: u16,
    pub position: i32,
    pub mode: i8,
    pub velocity: i32,
    pub torque: i16,
}

impl Wanted {
    pub fn bytes(self) -> Vec<u8> {
        let mut bytes = self.control.to_le_bytes().to_vec();
        bytes.extend(self.position.to_le_bytes());
        bytes.extend(self.mode.to_le_bytes());
        bytes.extend(self.velocity.to_le_bytes());
        bytes.extend(self.torque.to_le_bytes());
        bytes
    }
}

/// A master at its bus.
pub struct Master {
    pub bus: Bus,
    pub now_ns: u64,
    pub wanted: Wanted,
    /// Of the last message to a mailbox, 1 to 7.
    pub counter: u8,
}

pub fn truth() -> Model {
    Model::read(Path::new("data/elbow/truth/model.json")).unwrap()
}

pub fn counts(rad: f64) -> i32 {
    (rad / std::f64::consts::TAU * COUNTS_PER_REVOLUTION).round() as i32
}

pub fn rad(counts: i32) -> f64 {
    f64::from(counts) / COUNTS_PER_REVOLUTION * std::f64::consts::TAU
}

impl Master {
    /// Before the demo's bus, its devices just switched on.
    pub fn new() -> Self {
        Self::at(Bus::demo(truth(), 0.0, 1))
    }

    pub fn at(bus: Bus) -> Self {
        Self { bus, now_ns: 0, wanted: Wanted { mode: 8, ..Wanted::default() }, counter: 0 }
    }

    /// Sends datagrams and takes what comes.
    pub fn replies(&mut self, datagrams: &[Datagram]) -> Vec<Reply> {
        self.now_ns += 20_000;
        self.bus.send(self.now_ns, &frame(datagrams))
    }

    /// Data and working counter of one datagram.
    pub fn one(&mut self, command: u8, address: u32, data: &[u8]) -> (Vec<u8>, u16) {
        let replies = self.replies(&[Datagram(command, address, data.to_vec())]);
        answers(&replies[0].frame).remove(0)
    }

    pub fn read(&mut self, station: u16, register: u16, length: usize) -> Vec<u8> {
        let (data, counter) = self.one(FPRD, place(station, register), &vec![0; length]);
        assert_eq!(counter, 1, "{station:#x} lets {register:#x} not be read");
        data
    }

    pub fn read_u16(&mut self, station: u16, register: u16) -> u16 {
        let data = self.read(station, register, 2);
        u16::from_le_bytes([data[0], data[1]])
    }

    pub fn write(&mut self, station: u16, register: u16, data: &[u8]) {
        let (_, counter) = self.one(FPWR, place(station, register), data);
        assert_eq!(counter, 1, "{station:#x} lets {register:#x} not be written");
    }

    pub fn wait(&mut self, ns: u64) {
        self.now_ns += ns;
        self.bus.advance(self.now_ns);
    }

    /// Gives the demo's devices their stations.
    pub fn address(&mut self) {
        for (place_on_wire, station) in [(0u16, DRIVE), (0xFFFF, TERMINAL)] {
            let (_, counter) = self.one(APWR, place(place_on_wire, 0x0010), &station.to_le_bytes());
            assert_eq!(counter, 1);
        }
    }

    pub fn sync_manager(&mut self, station: u16, index: u16, start: u16, length: u16, control: u8) {
        let [start, length] = [start.to_le_bytes(), length.to_le_bytes()];
        let bytes = [start[0], start[1], length[0], length[1], control, 0, u8::from(length != [0, 0]), 0];
        self.write(station, 0x0800 + 8 * index, &bytes);
    }

    pub fn fmmu(&mut self, station: u16, index: u16, logical: u32, length: u16, physical: u16, kind: u8) {
        let mut bytes = logical.to_le_bytes().to_vec();
        bytes.extend(length.to_le_bytes());
        bytes.extend([0, 7]);
        bytes.extend(physical.to_le_bytes());
        bytes.extend([0, kind, 1, 0, 0, 0]);
        self.write(station, 0x0600 + 16 * index, &bytes);
    }

    /// Asks one device for a state; returns its AL status and code a while later.
    pub fn ask(&mut self, station: u16, control: u16) -> (u16, u16) {
        self.write(station, 0x0120, &control.to_le_bytes());
        self.wait(2 * MS);
        (self.read_u16(station, 0x0130), self.read_u16(station, 0x0134))
    }

    /// Mailboxes, and both devices in PRE-OP.
    pub fn reach_pre_op(&mut self) {
        self.address();
        for station in [DRIVE, TERMINAL] {
            self.sync_manager(station, 0, 0x1000, 128, 0x26);
            self.sync_manager(station, 1, 0x1080, 128, 0x22);
            assert_eq!(self.ask(station, 2), (2, 0));
        }
    }

    /// Process data mapped, and both devices in SAFE-OP.
    pub fn reach_safe_op(&mut self) {
        self.reach_pre_op();
        self.sync_manager(DRIVE, 2, 0x1100, OUT_BYTES as u16, 0x64);
        self.sync_manager(DRIVE, 3, 0x1400, IN_BYTES as u16, 0x20);
        self.sync_manager(TERMINAL, 2, 0x1100, 0, 0x64);
        self.sync_manager(TERMINAL, 3, 0x1400, SENSOR_BYTES as u16, 0x20);
        self.fmmu(DRIVE, 0, OUT, OUT_BYTES as u16, 0x1100, 2);
        self.fmmu(DRIVE, 1, OUT + OUT_BYTES as u32, IN_BYTES as u16, 0x1400, 1);
        self.fmmu(TERMINAL, 1, OUT + (OUT_BYTES + IN_BYTES) as u32, SENSOR_BYTES as u16, 0x1400, 1);
        for station in [DRIVE, TERMINAL] {
            assert_eq!(self.ask(station, 4), (4, 0));
        }
    }

    /// Both devices in OP, without pulses from their clocks.
    pub fn reach_op(&mut self) {
        self.reach_safe_op();
        for station in [DRIVE, TERMINAL] {
            self.write(station, 0x0120, &[8, 0]);
        }
        for _ in 0..5 {
            self.cycle();
        }
        assert_eq!(self.cycle().states, [8, 8]);
    }

    /// The same, and the drive enabled where it is.
    pub fn reach_enabled(&mut self) {
        self.reach_op();
        for control in [0x06, 0x07, 0x0F] {
            self.wanted.control = control;
            (0..3).for_each(|_| self.hold());
        }
        assert_eq!(self.cycle().status & 0x6F, 0x27);
    }

    /// A cycle with the drive's position as its target.
    pub fn hold(&mut self) {
        self.wanted.position = self.cycle().position;
    }

    /// The replies of one cycle of 1 ms: time, process data, states.
    pub fn cycle_replies(&mut self) -> Vec<Reply> {
        let mut data = self.wanted.bytes();
        data.resize(ALL, 0);
        let cycle = [
            Datagram(FRMW, place(DRIVE, 0x0910), vec![0; 8]),
            Datagram(LRW, OUT, data),
            Datagram(FPRD, place(DRIVE, 0x0130), vec![0; 2]),
            Datagram(FPRD, place(TERMINAL, 0x0130), vec![0; 2]),
        ];
        self.now_ns = (self.now_ns / MS + 1) * MS;
        self.bus.send(self.now_ns, &frame(&cycle))
    }

    /// One cycle whose reply comes.
    pub fn cycle(&mut self) -> Told {
        let replies = self.cycle_replies();
        told(&replies[0])
    }

    pub fn cycles(&mut self, count: usize) -> Vec<Told> {
        (0..count).map(|_| self.cycle()).collect()
    }
}

/// What a cycle's reply tells.
pub fn told(reply: &Reply) -> Told {
    let answers = answers(&reply.frame);
    let (data, counter) = &answers[1];
    let word = |at: usize| u16::from_le_bytes([data[at], data[at + 1]]);
    let double = |at: usize| i32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]]);
    Told {
        counter: *counter,
        states: [answers[2].0[0], answers[3].0[0]],
        status: word(OUT_BYTES),
        position: double(OUT_BYTES + 2),
        velocity: double(OUT_BYTES + 6),
        torque: word(OUT_BYTES + 10) as i16,
        error: word(OUT_BYTES + 13),
        sensor_status: word(OUT_BYTES + IN_BYTES),
        sensor: word(OUT_BYTES + IN_BYTES + 2) as i16,
    }
}

pub fn place(device: u16, register: u16) -> u32 {
    u32::from(device) | u32::from(register) << 16
}
