//! Motions held against a joint's limits: as `excitation.json`, on the terminal.

use super::number::{counted, significant};
use super::terminal::{BOLD, DIM, heading};
use crate::excite::{Asked, Limits};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::Path;

/// Motions that are listed one by one on the terminal.
const LISTED: usize = 6;

/// The name of a motion's file.
pub fn file_of(asked: &Asked) -> String {
    format!("{}.toml", asked.trajectory.name)
}

/// The motions of `asked` against the limits; limits that were not given are null.
pub fn to_json(asked: &[Asked], limits: &Limits) -> Value {
    let one = |of: &Asked| {
        json!({
            "file": file_of(of), "name": of.trajectory.name, "protocol": of.trajectory.protocol.name(),
            "repeats": of.trajectory.repeats, "duration_s": of.duration_s, "other_joints": of.trajectory.others.len(),
            "low_rad": of.extremes.low_rad, "high_rad": of.extremes.high_rad, "speed_rad_s": of.extremes.speed_rad_s,
            "acceleration_rad_s2": of.extremes.acceleration_rad_s2, "torque_nm": of.largest_nm(),
        })
    };
    json!({
        "format": "excitation/1",
        "motions": asked.iter().map(one).collect::<Vec<Value>>(),
        "runs": runs(asked),
        "duration_s": whole_s(asked),
        "limits": {
            "low_rad": limits.low_rad, "high_rad": limits.high_rad, "speed_rad_s": limits.speed_rad_s,
            "acceleration_rad_s2": limits.acceleration_rad_s2, "torque_nm": limits.torque_nm,
        },
        "provenance": { "tautline": env!("CARGO_PKG_VERSION") },
    })
}

fn runs(asked: &[Asked]) -> u32 {
    asked.iter().map(|one| one.trajectory.repeats.unwrap_or(1)).sum()
}

fn whole_s(asked: &[Asked]) -> f64 {
    asked.iter().map(Asked::whole_s).sum()
}

/// Writes what was made and how near it comes to the limits.
pub fn write_summary(out: &mut impl Write, asked: &[Asked], limits: &Limits, written: &Path) -> io::Result<()> {
    let (runs, whole) = (runs(asked), duration(whole_s(asked)));
    let (motions, runs) = (counted(asked.len(), "motion", "motions"), counted(runs as usize, "run", "runs"));
    writeln!(out, "{BOLD}{motions}{BOLD:#}  {DIM}{runs}, {whole} of motion in all{DIM:#}")?;
    for one in asked.iter().take(LISTED) {
        let times = one.trajectory.repeats.unwrap_or(1);
        writeln!(out, "  {:<20} {times} x {}", one.trajectory.name, duration(one.duration_s))?;
    }
    if asked.len() > LISTED {
        writeln!(out, "  ... and {} more", asked.len() - LISTED)?;
    }
    heading(out, "What they ask of the joint")?;
    for (name, unit, found, limit) in rows(asked, limits) {
        let limit =
            limit.map_or("no limit given".to_string(), |limit| format!("limit {} {unit}", significant(limit, 4)));
        writeln!(out, "  {name:<14} {:>10} {unit:<8} {DIM}{limit}{DIM:#}", significant(found, 4))?;
    }
    if asked.iter().all(|one| one.torque_nm.is_none()) {
        writeln!(out, "  {DIM}torque         not known without --model{DIM:#}")?;
    }
    writeln!(out, "\nwritten to {BOLD}{}{BOLD:#}: a file per motion, excitation.json, plan.svg", written.display())
}

fn rows(asked: &[Asked], limits: &Limits) -> Vec<(&'static str, &'static str, f64, Option<f64>)> {
    let Some(all) = asked.iter().map(|one| one.extremes).reduce(|a, b| a.and(b)) else { return Vec::new() };
    let mut rows = vec![
        ("lowest", "rad", all.low_rad, limits.low_rad),
        ("highest", "rad", all.high_rad, limits.high_rad),
        ("speed", "rad/s", all.speed_rad_s, limits.speed_rad_s),
        ("acceleration", "rad/s^2", all.acceleration_rad_s2, limits.acceleration_rad_s2),
    ];
    let torque_nm = asked.iter().filter_map(Asked::largest_nm).reduce(f64::max);
    rows.extend(torque_nm.map(|torque_nm| ("torque", "N m", torque_nm, limits.torque_nm)));
    rows
}

/// 3725 s as "1 h 02 min".
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..=599 => format!("{seconds:.1} s"),
        600..=3599 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}
