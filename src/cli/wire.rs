//! Which wire a command works on: a network interface, or the demo's bus in this process.

use crate::bus::Bus;
use crate::capture::in_process::InProcess;
use crate::capture::rig::Rig;
use crate::capture::wire::Wire;
use crate::model::Model;
use crate::problem::{Problem, Result};
use std::path::Path;

/// What the demo's rig and its interface are called.
pub const DEMO: &str = "demo";
/// The same with a second drive, which holds a tension.
pub const DEMO_TWO: &str = "demo-two";
/// The demo's joint.
const MODEL: &str = include_str!("../../data/elbow/truth/model.json");
pub const RIG: &str = include_str!("../../data/rigs/demo/rig.toml");
const AXES: &str = include_str!("../../data/rigs/demo/axes.toml");
/// Noise of the demo's torque sensor, N m.
const NOISE_NM: f64 = 0.005;

/// A rig with the text of its file.
pub struct Described {
    pub rig: Rig,
    pub text: String,
    /// Whether it is the demo: nothing can be hurt.
    pub is_demo: bool,
    /// Whether it stands in a file of the user's, which may be written to.
    pub has_file: bool,
}

impl Described {
    /// Reads the rig in `file`, or the demo's.
    ///
    /// Errors: everything that is wrong with the file.
    pub fn read(file: &Path) -> Result<Self> {
        let (text, has_file) = match file.to_str() {
            Some(DEMO) => (RIG.to_string(), false),
            Some(DEMO_TWO) => (rig_of_two(), false),
            _ => (text_of(file)?, true),
        };
        let rig = Rig::parse(file, &text)?;
        Ok(Self { is_demo: [DEMO, DEMO_TWO].contains(&rig.bus.interface.as_str()), rig, text, has_file })
    }
}

/// The text of `file`.
///
/// Errors: it cannot be read.
pub fn text_of(file: &Path) -> Result<String> {
    std::fs::read_to_string(file).or_else(|error| {
        Problem::error(file, format!("cannot be read: {error}"), "check the path and its permissions").alone()
    })
}

/// Opens `interface`; the demo's in virtual time unless in `real_time`, its noise repeatable by `seed`.
///
/// Errors: there is none such, or the process may not.
pub fn open(interface: &str, real_time: bool, seed: u64) -> Result<Box<dyn Wire>> {
    let mut bus = match interface {
        DEMO => demo_bus(seed)?,
        DEMO_TWO => demo_bus_of_two(seed)?,
        _ => return socket(interface),
    };
    let answers = move |now_ns: u64, frame: &[u8]| {
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    };
    Ok(match real_time {
        true => Box::new(InProcess::in_real_time(answers)),
        false => Box::new(InProcess::new(answers)),
    })
}

/// The rig of the demo with two drives.
pub fn rig_of_two() -> String {
    format!("{}{AXES}", RIG.replace("interface = \"demo\"", "interface = \"demo-two\""))
}

/// The demo's devices on the bundled elbow.
pub fn demo_bus(seed: u64) -> Result<Bus> {
    Ok(Bus::demo(elbow()?, NOISE_NM, seed))
}

/// The same with a second drive, whose cable pulls the elbow down.
pub fn demo_bus_of_two(seed: u64) -> Result<Bus> {
    Ok(Bus::demo_antagonistic(elbow()?, NOISE_NM, seed))
}

fn elbow() -> Result<Model> {
    Model::parse(Path::new("data/elbow/truth/model.json"), MODEL)
}

#[cfg(target_os = "linux")]
fn socket(interface: &str) -> Result<Box<dyn Wire>> {
    match crate::capture::socket::RawSocket::open(interface) {
        Ok(socket) => Ok(Box::new(socket)),
        Err(error) if error.kind() == std::io::ErrorKind::AddrInUse => Problem::error(
            interface,
            format!("is in use: {error}"),
            "wait until it has ended: two masters on one bus would \
                        reset each other's devices under a moving joint",
        )
        .alone(),
        Err(error) => {
            let cure = "name an interface that `ip link` shows, up; a raw socket takes CAP_NET_RAW: \
                        `sudo setcap cap_net_raw,cap_sys_nice,cap_ipc_lock+ep $(which tautline)`";
            Problem::error(interface, format!("cannot be opened: {error}"), cure).alone()
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn socket(interface: &str) -> Result<Box<dyn Wire>> {
    Problem::error(interface, "raw sockets are known on Linux only", "use Linux, or `--rig demo`").alone()
}
