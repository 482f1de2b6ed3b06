//! `tautline rig emulate`: the demo's devices on a network interface, for any EtherCAT master.

use crate::bus::{Bus, Reply};
use crate::capture::wire::{FRAME_BYTES, Wire};
use crate::cli::wire::{demo_bus, open};
use crate::problem::{Problem, Result};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example, without root and without hardware:
  unshare -Urn sh -c 'ip link add ec0 type veth peer name ec1; ip link set ec0 up; ip link set ec1 up;
    tautline rig emulate --interface ec1 & sleep 1; tautline rig scan --interface ec0'")]
pub struct Arguments {
    /// The network interface at which the devices hang
    #[arg(long)]
    interface: String,
    /// Seed of the torque sensor's noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Time passes for the joint at least this often while no frame comes, ns.
const IDLE_NS: u64 = 5_000_000;

/// Answers until the program is ended.
///
/// Errors: the interface cannot be opened, or fails.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut wire = open(&arguments.interface, true, arguments.seed)?;
    let mut bus = demo_bus(arguments.seed)?;
    match serve(&mut *wire, &mut bus) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(error) => Problem::error(&arguments.interface, format!("failed: {error}"), "is it still up?").alone(),
    }
}

fn serve(wire: &mut dyn Wire, bus: &mut Bus) -> std::io::Result<()> {
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
    }
}

/// What a frame takes on the emulated wire at most, ns: here the real one takes it.
const WIRE_NS: u64 = 200_000;
