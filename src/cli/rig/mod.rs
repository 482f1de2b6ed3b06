//! `tautline rig`: what is on the bus, whether it is what the rig says, where the sensor's zero is.

mod check;
mod emulate;
mod faults;
mod jog;
mod preset;
mod propose;
mod rewrite;
mod scan;
mod tare;
mod zero;

use super::outcome::Talk;
use crate::problem::Result;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline rig scan --interface eth1 -o rig.toml     lists the bus, writes a rig to fill in
  tautline rig check --rig rig.toml                  verifies everything without enabling the drive
  tautline rig tare --rig rig.toml                   zeroes the torque sensor
  tautline rig zero --rig rig.toml --at-rad 0        zeroes the joint, in a pose that you know
  tautline rig jog --rig rig.toml                    moves the joint while a key is held

`demo` serves as interface and as rig. Of these only `jog` gives the drive torque, after asking.")]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// List the devices on a bus; write a rig.toml to fill in
    Scan(scan::Arguments),
    /// Check devices, process data, the drive's limits, clocks, timing and sensor against a rig
    Check(check::Arguments),
    /// Set the torque sensor's zero to what it reads now
    Tare(tare::Arguments),
    /// Set the joint's zero from a pose whose angle you know
    Zero(zero::Arguments),
    /// Move the joint slowly while a key is held
    Jog(jog::Arguments),
    /// List what is known of common drives and terminals, or print a section of a rig for one
    Preset(preset::Arguments),
    /// Be the demo's devices on a network interface
    Emulate(emulate::Arguments),
    /// Play every fault of the software bus to a capture, in virtual time, and tell what became of the joint
    #[command(hide = true)]
    Faults(faults::Arguments),
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    match &arguments.command {
        Command::Scan(arguments) => scan::run(arguments, talk),
        Command::Check(arguments) => check::run(arguments, talk),
        Command::Tare(arguments) => tare::run(arguments, talk),
        Command::Zero(arguments) => zero::run(arguments, talk),
        Command::Jog(arguments) => jog::run(arguments, talk),
        Command::Preset(arguments) => preset::run(arguments, talk),
        Command::Emulate(arguments) => emulate::run(arguments),
        Command::Faults(arguments) => faults::run(arguments, talk),
    }
}
