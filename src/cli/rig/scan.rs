//! `tautline rig scan`: who is on the bus.

use crate::capture::esi;
use crate::capture::found::{Found, scan};
use crate::capture::line::with_line;
use crate::capture::rig::{Pdo, ProcessData, starting_rig};
use crate::cli::outcome::Talk;
use crate::cli::wire;
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The network interface, or `demo`; with --esi the one that the rig will be on
    #[arg(long)]
    interface: String,
    /// Nothing on the wire: what the maker's slave information files (ESI, XML) say of their devices, in this order
    #[arg(long)]
    esi: Vec<PathBuf>,
    /// Of the ESI files only the devices with these product codes, such as 0x402; the newest revision of each
    #[arg(long, requires = "esi", value_parser = code)]
    product: Vec<u32>,
    /// Write a rig.toml to fill in, from the first drive and the first other device that sends something
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let found = if arguments.esi.is_empty() { on_the_bus(arguments)? } else { described(arguments)? };
    if let Some(file) = &arguments.output {
        write_rig(file, &arguments.interface, &found)?;
    }
    talk.result(
        || json!({ "devices": found.iter().map(to_json).collect::<Vec<_>>() }),
        |out| found.iter().try_for_each(|device| write_device(out, device)),
    )?;
    Ok(ExitCode::SUCCESS)
}

fn on_the_bus(arguments: &Arguments) -> Result<Vec<Found>> {
    let wire = wire::open(&arguments.interface, false, 1)?;
    let found = with_line(wire, scan).or_else(|failure| {
        let what = format!("the devices cannot be brought to PRE-OP: {failure}");
        let cure = match failure.is_capacity() {
            true => "take devices off the bus, or divide it",
            false => "check cables and power of the devices",
        };
        Problem::error(&arguments.interface, what, cure).alone()
    })?;
    if found.is_empty() {
        let cure = "check the cable, the devices' power, and that this is the interface they hang on";
        return Problem::error(&arguments.interface, "no device answers", cure).alone();
    }
    Ok(found)
}

/// The devices of the ESI files, numbered as they come: their places on the bus are not known from there.
fn described(arguments: &Arguments) -> Result<Vec<Found>> {
    let mut found: Vec<Found> = Vec::new();
    for file in &arguments.esi {
        found.extend(esi::read(file)?);
    }
    if !arguments.product.is_empty() {
        let newest = |product: &u32| {
            let of_it = found.iter().filter(|device| device.product == *product);
            of_it.max_by_key(|device| device.revision).cloned().ok_or(*product)
        };
        let chosen: std::result::Result<Vec<Found>, u32> = arguments.product.iter().map(newest).collect();
        found = match chosen {
            Ok(chosen) => chosen,
            Err(product) => {
                let what = format!("no device of the ESI files has product code {product:#010x}");
                return Problem::error("--product", what, "leave --product out to see all").alone();
            }
        };
    }
    Ok(found.into_iter().enumerate().map(|(place, device)| Found { place, ..device }).collect())
}

/// A product code, decimal or as 0x402.
fn code(text: &str) -> std::result::Result<u32, String> {
    let found = match text.strip_prefix("0x") {
        Some(hex) => u32::from_str_radix(hex, 16),
        None => text.parse(),
    };
    found.map_err(|_| "expected a product code such as 0x402".to_string())
}

fn write_rig(file: &PathBuf, interface: &str, found: &[Found]) -> Result<()> {
    let Some(text) = starting_rig(interface, found) else {
        let what = "no device on the bus takes a control word (0x6040) in its process data";
        return Problem::error(interface, what, "leave out -o; write the rig from data/rigs/demo/rig.toml").alone();
    };
    let mut new = match std::fs::File::create_new(file) {
        Ok(new) => new,
        Err(error) => {
            return Problem::error(file, format!("cannot be written: {error}"), "name a new file").alone();
        }
    };
    new.write_all(text.as_bytes())
        .or_else(|error| Problem::error(file, format!("cannot be written: {error}"), "make room").alone())
}

fn to_json(device: &Found) -> Value {
    let pdo = |pdo: &Pdo| {
        let entries = pdo.entries.iter().map(
            |entry| json!({ "index": entry.index, "sub": entry.sub, "bits": entry.kind.bits(), "as": entry.role }),
        );
        json!({ "pdo": pdo.index, "entries": entries.collect::<Vec<_>>() })
    };
    let data = |data: &ProcessData| data.pdos.iter().map(pdo).collect::<Vec<_>>();
    json!({
        "place": device.place, "name": device.name, "vendor": device.vendor, "product": device.product,
        "revision": device.revision, "serial": device.serial, "alias": device.alias, "clock": device.has_clock,
        "outputs": data(&device.outputs),
        "inputs": data(&device.inputs),
    })
}

fn write_device(out: &mut impl Write, device: &Found) -> io::Result<()> {
    let Found { place, name, vendor, product, revision, serial, alias, has_clock, clock, outputs, inputs } = device;
    writeln!(
        out,
        "{place}  {name}  vendor {vendor:#010x} product {product:#010x} revision {revision:#010x} serial {serial:#010x}{}{}",
        if *alias == 0 { String::new() } else { format!(" alias {alias}") },
        match (has_clock, clock) {
            (false, _) => String::new(),
            (true, None) => ", with a clock".to_string(),
            (true, Some(pulses)) => format!(", with a clock (AssignActivate {:#06x})", pulses.activate),
        }
    )?;
    for (direction, all) in [("takes", outputs), ("sends", inputs)] {
        for pdo in &all.pdos {
            writeln!(out, "   {direction} {:#06x}", pdo.index)?;
            for entry in &pdo.entries {
                let role = entry.role.as_deref().unwrap_or("");
                writeln!(out, "      {:#06x}:{:02x} {:>2} bit  {role}", entry.index, entry.sub, entry.kind.bits())?;
            }
        }
    }
    Ok(())
}
