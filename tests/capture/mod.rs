//! A capture from the software bus, in virtual time: whole, under every fault, broken off and gone on with.

mod brake;
mod commands;
mod devices;
mod faults;
mod gaps;
mod noise;
mod recording;
mod replay;
mod start;
mod stops;
mod two;
mod whole;

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock, Mutex};
use tautline::bus::Bus;
use tautline::capture::folder::Folder;
use tautline::capture::in_process::InProcess;
use tautline::capture::operator::{Agrees, Operator};
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

/// A cycle, in the number of frames with process data, in the middle of the first sweep up of `SWEEP` by `RIG`: the joint moves, and
/// more than 2 s of the trial are recorded.
pub static AT: LazyLock<u64> = LazyLock::new(|| moving_at(&rig(), &plan(SWEEP)));

/// The first cycle in which the joint is beyond 1 rad on its way up.
pub fn moving_at(rig: &Rig, plan: &Plan) -> u64 {
    let mut at = 0;
    traced(demo(), rig, plan, &Agrees, &mut |_, bus| {
        let truth = bus.truth();
        if at == 0 && truth.position_rad > 1.0 && truth.velocity_rad_s > 0.2 {
            at = bus.cycles();
        }
    });
    at
}

/// Captures `plan`, armed and unrecorded; `look` sees the time, ns, and the bus after every frame with process data, and for a second after
/// the end.
pub fn traced(bus: Bus, rig: &Rig, plan: &Plan, operator: &dyn Operator, look: &mut dyn FnMut(u64, &Bus)) -> Outcome {
    let bus = RefCell::new(bus);
    let (interrupted, mut last_ns) = (AtomicBool::new(false), 0);
    let answers = |now_ns: u64, frame: &[u8]| {
        let mut bus = bus.borrow_mut();
        let cycles = bus.cycles();
        let replies = bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect();
        if bus.cycles() > cycles {
            look(now_ns, &bus);
        }
        last_ns = now_ns;
        replies
    };
    let task = Task { rig, plan, armed: true, interrupted: &interrupted, operator };
    let outcome = capture(InProcess::new(answers), &task, None, &Arc::default()).unwrap();
    for _ in 0..1000 {
        last_ns += 1_000_000;
        bus.borrow_mut().advance(last_ns);
        look(last_ns, &bus.borrow());
    }
    outcome
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
    let task = Task { rig, plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let outcome = capture(InProcess::new(answers), &task, folder, &Arc::new(Mutex::new(Live::default()))).unwrap();
    Watched { outcome, control: control.take(), status: status.take() }
}
