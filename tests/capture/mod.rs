//! A capture from the software bus, in virtual time: whole, under every fault, broken off and gone on with.

mod commands;
mod faults;
mod noise;
mod recording;
mod start;
mod whole;

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use tautline::bus::Bus;
use tautline::capture::folder::Folder;
use tautline::capture::in_process::InProcess;
use tautline::capture::plan::Plan;
use tautline::capture::rig::Rig;
use tautline::capture::session::{Live, Outcome, Task, capture};
use tautline::model::Model;

pub const RIG: &str = include_str!("../../data/rigs/demo/rig.toml");

/// A sweep up and down at 0.4 rad/s, 9 s.
pub const SWEEP: &str =
    "format = \"plan/1\"\nrest_s = 0.1\n[[motions]]\nprotocol = \"uniform\"\nspeed_rad_s = 0.4\nrepeats = 2\n";

pub fn rig() -> Rig {
    Rig::parse(Path::new("rig.toml"), RIG).unwrap()
}

pub fn plan(text: &str) -> Plan {
    Plan::parse(Path::new("plan.toml"), text, tautline::dynamics::JointKind::Revolute).unwrap()
}

pub fn truth() -> Model {
    Model::read(Path::new("data/elbow/truth/model.json")).unwrap()
}

pub fn demo() -> Bus {
    Bus::demo(truth(), 0.005, 1)
}

pub fn folder(path: &Path, rig: &Rig, resume: bool) -> Folder {
    let texts = [("rig.toml", RIG), ("plan.toml", SWEEP)];
    if resume { Folder::resume(path, rig, &texts).unwrap() } else { Folder::create(path, rig, &texts).unwrap() }
}

/// What was on the wire: the control word of every frame with process data, by its number.
pub struct Watched {
    pub outcome: Outcome,
    pub control: Vec<u16>,
    pub status: Vec<u16>,
}

/// Captures `plan` of `rig` from `bus` into `folder`, armed, with every frame watched.
pub fn run(bus: Bus, rig: &Rig, plan: &Plan, folder: Option<Folder>) -> Watched {
    let (control, status) = (Rc::new(RefCell::new(Vec::new())), Rc::new(RefCell::new(Vec::new())));
    let (controls, statuses) = (Rc::clone(&control), Rc::clone(&status));
    let mut bus = bus;
    let answers = move |now_ns: u64, frame: &[u8]| {
        let cycles = bus.cycles();
        let replies: Vec<(u64, Vec<u8>)> = bus.send(now_ns, frame).into_iter().map(|r| (r.at_ns, r.frame)).collect();
        if bus.cycles() > cycles {
            let word = bus.devices()[0].object(0x6040, 0).unwrap_or_default();
            controls.borrow_mut().push(u16::from_le_bytes([word[0], word[1]]));
            statuses.borrow_mut().push(bus.drive_status().unwrap_or(0));
        }
        replies
    };
    let interrupted = AtomicBool::new(false);
    let task = Task { rig, plan, armed: true, interrupted: &interrupted };
    let outcome = capture(InProcess::new(answers), &task, folder, &Arc::new(Mutex::new(Live::default()))).unwrap();
    Watched { outcome, control: control.take(), status: status.take() }
}
