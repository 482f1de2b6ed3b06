//! Which faults are played, in which mode, alone and two at once.

use crate::bus::Fault;

/// Modes, each with the lines of the rig that choose it, and its limit of speed, rad/s: not far above the plan, and above what the
/// joint does by itself in torque mode where it falls through its backlash.
pub(super) const MODES: [(&str, &str, f64); 4] = [
    ("csp", "mode = \"csp\"", 0.5),
    ("csv", "mode = \"csv\"\ngains = { position_per_s = 20.0 }", 0.5),
    ("cst", "mode = \"cst\"\ngains = { stiffness_nm_rad = 60.0, damping_nm_s_rad = 1.5 }", 0.8),
    ("two drives", "mode = \"csp\"", 0.5),
];
/// The first of them have one drive; in the last there is a second one, which holds a tension.
pub(super) const TWO: usize = 3;

/// What strikes the first or the second of two drives.
const OF_TWO: [(bool, Fault); 8] = [
    (true, Fault::Drive { code: 0x2310 }),
    (true, Fault::FrozenInputs { device: 2 }),
    (true, Fault::Inhibit),
    (true, Fault::IgnoredControl),
    (true, Fault::EncoderJump { by_rad: 0.03 }),
    (true, Fault::Gone { device: 2 }),
    (false, Fault::FrozenEncoder),
    (false, Fault::Drive { code: 0x2310 }),
];

/// One case: what strikes, in which mode, and whether the joint is held or moves then.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub mode: usize,
    pub holding: bool,
    /// Whether the second of two drives is struck.
    pub second: bool,
    pub faults: Vec<Fault>,
}

/// Every fault alone.
const SINGLE: [Fault; 29] = [
    Fault::Late { frames: 10, by_ns: 3_000_000 },
    Fault::Lost { frames: 10 },
    Fault::Unsent { frames: 10 },
    Fault::Corrupted { frames: 10 },
    Fault::WorkingCounterShort { device: 0, frames: 1 },
    Fault::WorkingCounterShort { device: 1, frames: 5 },
    Fault::SafeOp { device: 0, code: 0x1A },
    Fault::SafeOp { device: 1, code: 0x1A },
    Fault::Gone { device: 1 },
    Fault::Gone { device: 0 },
    Fault::SecondMaster,
    Fault::Emergency { device: 0, code: 0x8611 },
    Fault::Watchdog { device: 0 },
    Fault::Drive { code: 0x2310 },
    Fault::QuickStop,
    Fault::Inhibit,
    Fault::InternalLimit,
    Fault::Blocked,
    Fault::CableBreak,
    Fault::EncoderJump { by_rad: 0.03 },
    Fault::EncoderJump { by_rad: -0.03 },
    Fault::EncoderJump { by_rad: 0.002 },
    Fault::EncoderJump { by_rad: 0.0006 },
    Fault::StaleSensor,
    Fault::SaturatedSensor,
    Fault::NotANumber,
    Fault::FrozenInputs { device: 0 },
    Fault::FrozenEncoder,
    Fault::IgnoredControl,
];

/// The ten worst, of which every two strike at once: what takes away sight, obedience, the wire, the load.
const WORST: [Fault; 10] = [
    Fault::FrozenEncoder,
    Fault::FrozenInputs { device: 0 },
    Fault::IgnoredControl,
    Fault::IgnoredQuickStop,
    Fault::Gone { device: 0 },
    Fault::Gone { device: 1 },
    Fault::EncoderJump { by_rad: 0.03 },
    Fault::CableBreak,
    Fault::Blocked,
    Fault::StaleSensor,
];

/// All cases: every fault in position mode, those that differ by the mode in the others, every pair of the worst in each.
pub(super) fn cases() -> Vec<Case> {
    let differs_by_mode = |fault: &&Fault| {
        !matches!(fault, Fault::Late { .. } | Fault::Corrupted { .. } | Fault::WorkingCounterShort { .. })
    };
    let case = |mode, holding, faults| Case { mode, holding, second: false, faults };
    let mut all: Vec<Case> = SINGLE.iter().map(|fault| case(0, false, vec![*fault])).collect();
    for mode in 0..TWO {
        let others = SINGLE.iter().filter(differs_by_mode).filter(|_| mode > 0);
        all.extend(others.map(|fault| case(mode, false, vec![*fault])));
        for (i, first) in WORST.iter().enumerate() {
            all.extend(WORST[i + 1..].iter().map(|second| case(mode, false, vec![*first, *second])));
        }
        all.push(case(mode, false, vec![Fault::WatchdogOff { device: 0 }, Fault::Gone { device: 0 }]));
        all.push(case(mode, true, vec![Fault::FrozenInputs { device: 0 }]));
        all.push(case(mode, true, vec![Fault::Gone { device: 0 }]));
        all.push(case(mode, true, vec![Fault::IgnoredControl, Fault::StaleSensor]));
    }
    // Speeds other than commanded are a fault of speed mode.
    all.push(case(1, false, vec![Fault::Runaway { factor: 4.0 }]));
    all.push(case(1, false, vec![Fault::Runaway { factor: 4.0 }, Fault::IgnoredQuickStop]));
    all.push(case(1, false, vec![Fault::Runaway { factor: -1.0 }]));
    all.extend(OF_TWO.map(|(second, fault)| Case { second, ..case(TWO, false, vec![fault]) }));
    all
}

impl Case {
    pub fn name(&self) -> String {
        let faults: Vec<String> =
            self.faults.iter().map(|fault| format!("{fault:?}").replace(" {", "").replace(" }", "")).collect();
        let when = if self.holding { " while held" } else { "" };
        let which = if self.second { ", the second:" } else { "" };
        format!("{}{which} {}{when}", MODES[self.mode].0, faults.join(" + "))
    }
}
