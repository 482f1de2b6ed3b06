//! A drive of `rig.toml`: every key, and what the keys must be together.

use super::read::read_identity;
use super::{Brake, BrakeDevice, DRIVE_INPUTS, DRIVE_OUTPUTS, Drive, Gains, ProcessData, Setup, Target};
use crate::capture::drive::Mode;
use crate::document::Section;

/// The longest that a drive may be off its command, s: longer would be no watch.
const LONGEST_ERROR_S: f64 = 10.0;
/// No brake takes longer than that, s.
const SLOWEST_BRAKE_S: f64 = 2.0;

/// A drive, which follows a path or holds a tension.
pub(super) fn read_drive(section: &Section<'_>, follows: Target) -> Option<Drive> {
    let positive = |key, example, means| section.need(key).such_as(example, means).positive();
    let identity = read_identity(section);
    let setup = Setup::read(section);
    let axis = section.may("axis").whole(0, 7).unwrap_or(0);
    let without = section.may("without").wholes(0x6000, 0x67FF).unwrap_or_default();
    let mode = read_mode(section, follows);
    let counts_per_rad = positive("counts_per_rad", "83443.0", "counts of the position for a rad of the joint");
    let zero_counts = section.need("zero_counts").such_as("0", "counts where the joint is at 0 rad").number();
    let sign = read_sign(section);
    let rated_torque_nm = positive("rated_torque_nm", "2.0", "the torque at the winch that the drive calls 1000, N m");
    let torque_max_nm = positive("torque_max_nm", "2.0", "the most that the drive may give, N m at the winch");
    let following_error_rad = positive("following_error_rad", "0.05", "the drive's window, rad");
    let following_error_s = read_following_error_s(section);
    let gains = section.may("gains").section(read_gains).unwrap_or_default();
    let (outputs, brake) = read_outputs(section, mode);
    let inputs = section.need("inputs").such_as("[drive.inputs]", "its TxPDO");
    let inputs = inputs.section(|s| ProcessData::read(s, &DRIVE_INPUTS, &["status_word", "position"]));
    check_loop(section, mode, follows, &gains);
    Some(Drive {
        identity: identity?,
        setup,
        axis: u16::try_from(axis).ok()?,
        without: without.into_iter().filter_map(|index| u16::try_from(index).ok()).collect(),
        mode,
        counts_per_rad: counts_per_rad?,
        zero_counts: zero_counts?,
        sign: sign?,
        rated_torque_nm: rated_torque_nm?,
        torque_max_nm: torque_max_nm?,
        following_error_rad: following_error_rad?,
        following_error_s,
        gains,
        brake,
        outputs: outputs?,
        inputs: inputs?,
    })
}

/// What the drive is told to follow. A tension is a torque.
fn read_mode(section: &Section<'_>, follows: Target) -> Mode {
    let mode = section.may("mode").choice(&Mode::NAMES);
    if follows == Target::Tension {
        if mode.is_some_and(|mode| mode != Mode::Torque) {
            section.reject("mode", "is not \"cst\", which holding a tension takes", "leave it out");
        }
        return Mode::Torque;
    }
    mode.unwrap_or(Mode::Position)
}

fn read_following_error_s(section: &Section<'_>) -> f64 {
    let following_error_s = section.may("following_error_s").not_negative().unwrap_or(0.01);
    if following_error_s > LONGEST_ERROR_S {
        let cure = format!("expected {LONGEST_ERROR_S} s at most");
        section.reject("following_error_s", format!("is {following_error_s}"), cure);
    }
    following_error_s
}

/// What is sent to it, and its brake, whose output may be another device's.
fn read_outputs(section: &Section<'_>, mode: Mode) -> (Option<ProcessData>, Option<Brake>) {
    let target = match mode {
        Mode::Position => "target_position",
        Mode::Velocity => "target_velocity",
        Mode::Torque => "target_torque",
    };
    let outputs = section.need("outputs").such_as("[drive.outputs]", "its RxPDO");
    let outputs = outputs.section(|s| ProcessData::read(s, &DRIVE_OUTPUTS, &["control_word", target]));
    let brake = section.may("brake").section(read_brake);
    let is_elsewhere = brake.as_ref().is_some_and(|brake| brake.device.is_some());
    let has_output = outputs.as_ref().is_some_and(|data| data.place("brake").is_some());
    if has_output && is_elsewhere {
        section.reject("brake", "has an output of the drive and one of another device", "leave one of them out");
    } else if brake.is_some() != has_output && !is_elsewhere {
        let cure = "write both: the output that lets it go (`as = \"brake\"`, or [drive.brake.device]), and [drive.brake] with \
                    its times";
        section.reject("brake", "has an output and no times, or times and no output", cure);
    }
    (outputs, brake)
}

/// The position must be closed by somebody.
fn check_loop(section: &Section<'_>, mode: Mode, follows: Target, gains: &Gains) {
    let is_closed = match mode {
        Mode::Position => true,
        Mode::Velocity => gains.position_per_s > 0.0,
        Mode::Torque => follows == Target::Tension || gains.stiffness_nm_rad > 0.0 && gains.damping_nm_s_rad > 0.0,
    };
    if !is_closed {
        let what = "leave the position open in this mode";
        section.reject("gains", what, "csv needs position_per_s; cst stiffness_nm_rad and damping_nm_s_rad");
    }
}

fn read_brake(section: &Section<'_>) -> Option<Brake> {
    let bit = section.may("bit").whole(0, 31).unwrap_or(0);
    let time = |key, means| section.need(key).such_as("0.1", means).not_negative();
    let release_s = time("release_s", "from letting it go until the joint may move, s");
    let engage_s = time("engage_s", "from closing it until it holds, s");
    let slow = |time_s: &f64| *time_s > SLOWEST_BRAKE_S;
    for (key, time_s) in [("release_s", release_s), ("engage_s", engage_s)] {
        if let Some(time_s) = time_s.filter(slow) {
            section.reject(key, format!("is {time_s}"), format!("expected {SLOWEST_BRAKE_S} s at most"));
        }
    }
    let device = section.may("device").section(read_brake_device);
    Some(Brake { bit: u32::try_from(bit).ok()?, release_s: release_s?, engage_s: engage_s?, device })
}

/// The device whose output lets a brake go, where that is not the drive.
fn read_brake_device(section: &Section<'_>) -> Option<BrakeDevice> {
    let identity = read_identity(section);
    let setup = Setup::read(section);
    let outputs = section.need("outputs").such_as("[drive.brake.device.outputs]", "its RxPDO");
    let outputs = outputs.section(|s| ProcessData::read(s, &["brake"], &["brake"]));
    Some(BrakeDevice { identity: identity?, setup, outputs: outputs? })
}

fn read_gains(section: &Section<'_>) -> Option<Gains> {
    let gain = |key| section.may(key).not_negative().unwrap_or(0.0);
    Some(Gains {
        position_per_s: gain("position_per_s"),
        stiffness_nm_rad: gain("stiffness_nm_rad"),
        damping_nm_s_rad: gain("damping_nm_s_rad"),
    })
}

/// 1 or -1.
fn read_sign(section: &Section<'_>) -> Option<f64> {
    let sign = section.need("sign").such_as("1", "-1 where counts grow as the joint goes down").number()?;
    if sign.abs() != 1.0 {
        section.reject("sign", format!("is {sign}"), "expected 1 or -1");
    }
    Some(sign)
}
