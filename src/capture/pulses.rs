//! The pulses of those clocks that the rig sets by hand: shifted, with SYNC1, or with more bits than a stack sets (ETG.1000.4, 6.8).

use super::group::{Group, NotStarted, while_doing};
use super::line::Line;
use super::rig::{Pulses, Rig};
use super::wire::Wire;
use ethercrab::MainDevice;
use ethercrab::subdevice_group::{HasDc, PreOpPdi};

/// Who may set the pulses (low byte of AssignActivate), and which are given (high byte).
const CONTROL: u16 = 0x0980;
const ACTIVATION: u16 = 0x0981;
/// System time of the first pulse, ns.
const START: u16 = 0x0990;
/// Period of SYNC0, and from it to SYNC1, ns.
const SYNC0: u16 = 0x09A0;
const SYNC1: u16 = 0x09A4;

/// How the rig sets the pulses of the device at `place`; nothing where they come with every cycle.
pub(super) fn of(rig: &Rig, place: usize) -> Option<Pulses> {
    rig.devices().find(|(identity, _)| identity.place == place).and_then(|(_, setup)| setup.clock)
}

/// Sets them on the devices that have such settings, after the stack has set those of all.
///
/// Errors: a register that is not taken.
pub(super) fn set_all<W: Wire>(
    line: &mut Line<'_, W>,
    main: &MainDevice<'_>,
    group: &Group<PreOpPdi, HasDc>,
    rig: &Rig,
    report: &mut Vec<String>,
) -> Result<(), NotStarted> {
    for (identity, setup) in rig.devices() {
        let (Some(pulses), Ok(device)) = (setup.clock, group.subdevice(main, identity.place)) else { continue };
        if pulses.activate == 0 {
            report.push(format!("`{}`: no pulses of its clock, it works as frames pass", identity.name));
            continue;
        }
        let what = format!("setting the clock's pulses of `{}`", identity.name);
        let failed = while_doing(&what);
        let period_ns = rig.bus.cycle_us * 1000;
        let start_ns: u64 = line.run(device.register_read(START)).map_err(&failed)?;
        let start_ns = start_ns.saturating_add_signed(pulses.sync0_shift_ns.into());
        let [low, high] = pulses.activate.to_le_bytes();
        line.run(device.register_write(ACTIVATION, 0u8)).map_err(&failed)?;
        line.run(device.register_write(CONTROL, low)).map_err(&failed)?;
        line.run(device.register_write(SYNC0, period_ns)).map_err(&failed)?;
        line.run(device.register_write(SYNC1, pulses.sync1_ns)).map_err(&failed)?;
        line.run(device.register_write(START, start_ns)).map_err(&failed)?;
        line.run(device.register_write(ACTIVATION, high)).map_err(&failed)?;
        let shift_us = f64::from(pulses.sync0_shift_ns) * 1e-3;
        let activate = pulses.activate;
        report.push(format!("`{}`: clock {activate:#06x}, SYNC0 shifted by {shift_us} us", identity.name));
    }
    Ok(())
}
