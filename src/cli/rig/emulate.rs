//! `tautline rig emulate`: the demo's devices on a network interface, for any EtherCAT master.

use crate::bus::{Bus, Fault, Reply};
use crate::capture::drive::Condition;
use crate::capture::wire::{FRAME_BYTES, Wire};
use crate::cli::wire::{demo_bus, demo_bus_of_two, open};
use crate::problem::{Problem, Result};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example, without root and without hardware:
  unshare -Urn sh -c 'ip link add ec0 type veth peer name ec1; ip link set ec0 up; ip link set ec1 up;
    tautline rig emulate --interface ec1 & sleep 1; tautline rig scan --interface ec0'

Faults strike when the joint moves up through --at-rad: late:FRAMES lost:FRAMES unsent:FRAMES corrupted:FRAMES
short:FRAMES safe-op:DEVICE gone:DEVICE second-master emergency:CODE watchdog watchdog-off drive-fault:CODE
quick-stop inhibit internal-limit blocked cable-break encoder-jump:RAD frozen-encoder frozen-inputs
ignored-control ignored-quick-stop stale-sensor saturated-sensor not-a-number runaway:FACTOR")]
pub struct Arguments {
    /// The network interface at which the devices hang
    #[arg(long)]
    interface: String,
    /// A second drive behind the torque sensor, whose cable pulls the joint down
    #[arg(long)]
    two: bool,
    /// Seed of the torque sensor's noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What goes wrong, once the joint moves; may be given more than once
    #[arg(long)]
    fault: Vec<String>,
    /// Where the joint is when it goes wrong, on its way up, rad
    #[arg(long, default_value_t = 0.3)]
    at_rad: f64,
    /// Write what became of the joint after the fault to this file, as JSON
    #[arg(long, requires = "fault")]
    report: Option<PathBuf>,
}

/// Time passes for the joint at least this often while no frame comes, ns.
const IDLE_NS: u64 = 5_000_000;
/// A joint that is slower than this does not move, rad/s.
const MOVES_RAD_S: f64 = 0.05;
/// What a frame takes on the emulated wire at most, ns: here the real one takes it.
const WIRE_NS: u64 = 200_000;

/// Answers until the program is ended.
///
/// Errors: the interface cannot be opened, or fails; a fault that is none.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut faults = Vec::new();
    for name in &arguments.fault {
        match Fault::named(name) {
            Some(fault) => faults.push(fault),
            None => {
                let cure = format!("name one of {}", Fault::NAMES.join(", "));
                return Problem::error("--fault", format!("`{name}` is no fault"), cure).alone();
            }
        }
    }
    let mut wire = open(&arguments.interface, true, arguments.seed)?;
    let mut bus = if arguments.two { demo_bus_of_two(arguments.seed)? } else { demo_bus(arguments.seed)? };
    let mut aftermath = Aftermath { faults, at_rad: arguments.at_rad, struck: None };
    match serve(&mut *wire, &mut bus, &mut aftermath, arguments.report.as_deref()) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(error) => Problem::error(&arguments.interface, format!("failed: {error}"), "is it still up?").alone(),
    }
}

fn serve(wire: &mut dyn Wire, bus: &mut Bus, aftermath: &mut Aftermath, report: Option<&Path>) -> std::io::Result<()> {
    let mut buffer = [0; FRAME_BYTES];
    let mut waiting: Vec<Reply> = Vec::new();
    loop {
        let now_ns = wire.now_ns();
        let next_ns = waiting.iter().map(|reply| reply.at_ns).min().unwrap_or(u64::MAX);
        match wire.receive(&mut buffer, next_ns.min(now_ns + IDLE_NS))? {
            Some(bytes) => waiting.extend(bus.send(wire.now_ns(), &buffer[..bytes])),
            None => bus.advance(wire.now_ns()),
        }
        let now_ns = wire.now_ns();
        // A real wire takes its own time: only what is meant to be late is kept.
        let (due, later): (Vec<_>, Vec<_>) = waiting.into_iter().partition(|r| r.at_ns <= now_ns + WIRE_NS);
        due.iter().try_for_each(|reply| wire.send(&reply.frame))?;
        waiting = later;
        if aftermath.look(bus, now_ns)
            && let Some(file) = report
        {
            std::fs::write(file, aftermath.to_json())?;
        }
    }
}

/// What became of the joint after its fault.
struct Aftermath {
    faults: Vec<Fault>,
    at_rad: f64,
    struck: Option<Struck>,
}

/// Since the fault.
#[derive(Debug, Clone, Copy)]
struct Struck {
    at_ns: u64,
    from_rad: f64,
    speed_rad_s: f64,
    travel_rad: f64,
    off_ns: Option<u64>,
}

impl Aftermath {
    /// Strikes when it is time, and watches until the drive has no torque; true in the moment in which that is so.
    fn look(&mut self, bus: &mut Bus, now_ns: u64) -> bool {
        let truth = bus.truth();
        let Some(struck) = &mut self.struck else {
            if !self.faults.is_empty() && truth.position_rad > self.at_rad && truth.velocity_rad_s > MOVES_RAD_S {
                self.faults.iter().for_each(|fault| bus.inject(*fault, now_ns));
                let (from_rad, speed_rad_s) = (truth.position_rad, truth.velocity_rad_s.abs());
                self.struck = Some(Struck { at_ns: now_ns, from_rad, speed_rad_s, travel_rad: 0.0, off_ns: None });
            }
            return false;
        };
        if struck.off_ns.is_some() {
            return false;
        }
        struck.speed_rad_s = struck.speed_rad_s.max(truth.velocity_rad_s.abs());
        struck.travel_rad = struck.travel_rad.max((truth.position_rad - struck.from_rad).abs());
        let is_off = !Condition::of(bus.drive_status().unwrap_or(0)).has_torque();
        struck.off_ns = is_off.then(|| now_ns - struck.at_ns);
        is_off
    }

    fn to_json(&self) -> String {
        let told = self.struck.map(|struck| {
            json!({
                "off_ms": struck.off_ns.map(|ns| ns as f64 * 1e-6), "speed_rad_s": struck.speed_rad_s,
                "travel_rad": struck.travel_rad,
            })
        });
        json!(told).to_string()
    }
}
