//! What is shown before there is torque: devices, what the drive would do, what is wrong, how well the cycle is kept, and the first
//! motion.

use super::cycle::Counts;
use super::drive::Condition;
use super::plan::Plan;
use super::rig::Rig;
use super::run::jog::SPEED_RAD_S;
use super::tried::TRIED_RAD;

/// What the operator types.
const WORD: &str = "arm";
/// The same where that clears a fault of the drive.
const WORD_WITH_FAULT: &str = "clear and arm";

/// What was seen of the joint without torque.
pub(super) struct Sight {
    /// Where the drive stands, and the code of its fault where it tells one.
    pub drive: Condition,
    /// Its error code (0x603F), where it is mapped.
    pub error_code: Option<u16>,
    /// Measured, rad.
    pub position_rad: f64,
    /// Whether it is known, cycle by cycle, that the drive's inputs are new.
    pub knows_fresh: bool,
    /// Cycles looked at, and those that were not as they should be.
    pub cycles: u32,
    /// Late and missed ones.
    pub counts: Counts,
    /// What would stop the joint now.
    pub doubt: Option<String>,
}

/// The lines to show, and the word to ask for.
pub(super) fn briefing(rig: &Rig, plan: &Plan, report: &[String], sight: &Sight) -> (Vec<String>, &'static str) {
    let (limits, minutes) = (&rig.limits, plan.duration_s(rig.bus.period_s()) / 60.0);
    let Sight { drive, error_code, position_rad, cycles, counts, .. } = sight;
    let mut lines = report.to_vec();
    lines.push(format!("cycle: of {cycles} cycles {} late, {} missed", counts.late, counts.missed));
    lines.push(match sight.knows_fresh {
        true => "drive's inputs: new every cycle, as seen; frozen ones stop the joint within a few cycles".to_string(),
        false => "NOTHING TELLS WHETHER THE DRIVE'S INPUTS ARE NEW: frozen ones are noticed only once the joint must move, and \
                  never while it is held; map a counter of the drive as `counter`, if it has one"
            .to_string(),
    });
    lines.push(format!("drive: {drive}"));
    let has_fault = matches!(drive, Condition::Fault | Condition::FaultReaction);
    if has_fault {
        let code = error_code.map_or("its code is not mapped".to_string(), |code| format!("code {code:#06x}"));
        lines.push(format!("THE DRIVE IS IN FAULT ({code}): find out why before you go on; arming clears it"));
    }
    lines.extend(sight.doubt.iter().map(|doubt| format!("WOULD BE STOPPED NOW: {doubt}")));
    lines.push(match plan.trials.len() {
        0 => format!(
            "`{}` at {position_rad:+.3} rad will move only while you ask for it, at {} rad/s at most, on {}",
            rig.joint.name,
            SPEED_RAD_S.min(limits.approach_rad_s),
            rig.bus.interface
        ),
        trials => format!(
            "`{}` will move by itself: first from {position_rad:+.3} rad by {TRIED_RAD} rad and back, slowly, to check signs; then \
             {trials} trials, {minutes:.0} min and the moves between them, on {}",
            rig.joint.name, rig.bus.interface
        ),
    });
    if let Some(first) = plan.trials.first() {
        let start_rad = first.trajectory.own.start_rad;
        lines.push(format!(
            "the first of them begins at {start_rad:+.3} rad, reached at {} rad/s",
            limits.approach_rad_s
        ));
    }
    lines.push(format!(
        "limits: {} to {} rad, {} rad/s, {} N m, as far as software can see to it",
        limits.low_rad, limits.high_rad, limits.speed_rad_s, limits.torque_nm
    ));
    lines.push(
        "Software does not replace the drive's safe torque off: hold the emergency stop in your hand, nobody in reach of the \
         joint, and the joint supported where it must not fall without torque."
            .to_string(),
    );
    lines.push("The word below gives the drive torque.".to_string());
    (lines, if has_fault { WORD_WITH_FAULT } else { WORD })
}
