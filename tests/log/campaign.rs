//! `campaign.toml`: every fault by row and key, with its cure; what is written reads back.

use super::{CAMPAIGN, folder, sweep};
use proptest::prelude::*;
use std::path::Path;
use tautline::dynamics::{Dynamics, JointKind};
use tautline::log::{
    Campaign, Column, Columns, Files, OtherColumn, Protocol, ReferenceColumn, Signal, TrialEntry, Uncertainty,
};
use tautline::model::{Drive, Joint};
use tautline::problem::Problem;
use tautline::units::Unit;

/// The faults of CAMPAIGN after `old` became `new`.
fn faults(old: &str, new: &str) -> Vec<Problem> {
    assert!(CAMPAIGN.contains(old), "{old}");
    let folder = folder(&CAMPAIGN.replace(old, new), sweep());
    Campaign::read(folder.path()).err().map_or(Vec::new(), |problems| problems.0)
}

#[test]
fn reads_a_folder_and_the_file_alike() {
    let folder = folder(CAMPAIGN, sweep());
    let campaign = Campaign::read(folder.path()).expect("reads");
    assert_eq!(campaign, Campaign::read(&folder.path().join("campaign.toml")).expect("reads"));
    assert_eq!(campaign.trials[0].protocol, Protocol::Uniform { speed_rad_s: 0.5 });
    assert_eq!(campaign.joint.kind, JointKind::Revolute);
}

/// (what stands there, what is put instead, row, key, words of the message)
const FAULTS: [(&str, &str, u64, &str, &str); 42] = [
    ("campaign/1", "campaign/2", 1, "format", "campaign/1"),
    ("kind = \"revolute\"", "kind = \"revolut\"", 5, "joint.kind", "did you mean `revolute`?"),
    ("kind = \"revolute\"", "kind = \"prismatic\"", 6, "joint.winch_radius_m", "set it to 1.0"),
    ("winch_radius_m = 0.012", "winch_radius = 0.012", 6, "joint.winch_radius", "did you mean `winch_radius_m`?"),
    ("winch_radius_m = 0.012", "winch_radius = 0.012", 3, "joint.winch_radius_m", "write `winch_radius_m = 0.012`"),
    ("torque_sign = -1\n", "", 14, "signal.torque_sign", "write `torque_sign = -1`: 1 or -1, so that y ="),
    ("lowpass_hz = 5.0\n", "", 14, "signal.lowpass_hz", "write `lowpass_hz = 5.0`: cut-off"),
    (
        "torque = { name = \"trq\", unit = \"N m\" }\n",
        "",
        19,
        "columns.torque",
        "{ name = \"torque\", unit = \"N m\" }`",
    ),
    (", unit = \"N m\"", "", 22, "columns.torque.unit", "write `unit = \"N m\"`"),
    ("protocol = \"uniform\"\n", "", 24, "trials[0].protocol", "write `protocol = \"uniform\"`, or one of cosine"),
    ("speed_rad_s = 0.5\n", "", 24, "trials[0].speed_rad_s", "write `speed_rad_s = 0.1`: the sweep's speed"),
    ("unit = \"N m\"", "unit = \"MNm\"", 22, "columns.torque.unit", "expected one of `N m`, `mN m`"),
    ("unit = \"deg\"", "unit = \"Nm\"", 21, "columns.position.unit", "no unit of position on a revolute joint"),
    ("kind = \"revolute\"", "kind = \"prismatic\"", 26, "trials[0].protocol", "write `free` and delete speed_rad_s"),
    ("winch_radius_m = 0.012", "winch_radius_m = 0", 6, "joint.winch_radius_m", "a number above 0"),
    ("winch_radius_m = 0.012", "winch_radius_m = -0.01", 6, "joint.winch_radius_m", "a number above 0"),
    ("winch_radius_m = 0.012", "winch_radius_m = \"0.012\"", 6, "joint.winch_radius_m", "the text `0.012`"),
    ("winch_radius_m = 0.012", "winch_radius_m = inf", 6, "joint.winch_radius_m", "a number above 0"),
    ("backlash_m = 0.0008", "backlash_m = -0.0008", 8, "joint.backlash_m", "0 or above"),
    ("gravity_nm = 0.6916", "gravity_nm = nan", 11, "dynamics.gravity_nm", "expected a number"),
    ("gravity_nm = 0.6916", "urdf = \"exo.urdf\"", 10, "dynamics.joint", "add `joint`"),
    ("torque_sign = -1", "torque_sign = -2", 15, "signal.torque_sign", "1 or -1"),
    ("lowpass_hz = 5.0", "lowpass_hz = 0", 16, "signal.lowpass_hz", "above 0"),
    ("lowpass_order = 4", "lowpass_order = 0", 17, "signal.lowpass_order", "from 1 to 12"),
    ("lowpass_order = 4", "lowpass_order = 13", 17, "signal.lowpass_order", "from 1 to 12"),
    ("lowpass_order = 4", "lowpass_order = 4.5", 17, "signal.lowpass_order", "from 1 to 12"),
    ("unit = \"s\"", "unit = \"min\"", 20, "columns.time.unit", "expected one of `s`, `ms`, `us`"),
    ("unit = \"N m\"", "unit = \"nm\"", 22, "columns.torque.unit", "did you mean `N m`?"),
    ("unit = \"deg\"", "unit = \"mm\"", 21, "columns.position.unit", "no unit of position on a revolute joint"),
    ("name = \"trq\"", "name = \"pos\"", 22, "columns.torque", "as `position` does"),
    ("torque = {", "troque = {", 22, "columns.troque", "did you mean `torque`?"),
    (
        "\n[[trials]]",
        "reference_torque = { name = \"f\", unit = \"N\" }\n[[trials]]",
        23,
        "columns.reference_torque.unit",
        "arm_m",
    ),
    (
        "\n[[trials]]",
        "current = { name = \"i\", unit = \"A\", arm_m = 1 }\n[[trials]]",
        23,
        "columns.current.arm_m",
        "unknown key",
    ),
    (
        "\n[[trials]]",
        "other_position_3 = { name = \"o\", unit = \"rad\" }\n[[trials]]",
        23,
        "columns.other_position_3",
        "did you mean `other_position`?",
    ),
    ("a.csv", "b.csv", 25, "trials[0].file", "did you mean `a.csv`?"),
    ("a.csv", "../a.csv", 25, "trials[0].file", "outside the campaign"),
    ("a.csv", "/etc/a.csv", 25, "trials[0].file", "outside the campaign"),
    ("\"uniform\"", "\"unifrom\"", 26, "trials[0].protocol", "did you mean `uniform`?"),
    ("\"uniform\"", "\"cosine\"", 27, "trials[0].speed_rad_s", "only a uniform trial has one speed"),
    ("speed_rad_s", "speed_rads", 27, "trials[0].speed_rads", "did you mean `speed_rad_s`?"),
    ("repeat = 1", "repeat = 0", 28, "trials[0].repeat", "whole number from 1"),
    (
        "repeat = 1",
        "repeat = 1\n[[trials]]\nfile = \"./a.csv\"\nprotocol = \"free\"",
        30,
        "trials[1].file",
        "listed already in row 24",
    ),
];

#[test]
fn each_fault_is_named_with_row_key_and_cure() {
    for (old, new, row, key, words) in FAULTS {
        let found = faults(old, new);
        let meant = |problem: &&Problem| problem.column.as_deref() == Some(key) && problem.row == Some(row);
        let Some(problem) = found.iter().find(meant) else { panic!("{new}: {found:#?}") };
        assert!(problem.to_string().contains(words), "{new}: {problem}");
        assert!(!problem.cure.is_empty(), "{problem}");
    }
}

#[test]
fn what_is_missing_outermost_is_written_out() {
    let found = |old: &str| faults(old, "").into_iter().map(|problem| problem.to_string()).collect::<String>();
    assert!(found("format = \"campaign/1\"\n").contains("missing; write `format = \"campaign/1\"`"));
    let signal = "[signal]\ntorque_sign = -1\nlowpass_hz = 5.0\nlowpass_order = 4\n";
    assert!(found(signal).contains("missing; write `[signal]`: a section with torque_sign"));
}

/// The warnings of CAMPAIGN after `old` became `new`.
fn doubts(old: &str, new: &str) -> Vec<Problem> {
    assert!(CAMPAIGN.contains(old), "{old}");
    let folder = folder(&CAMPAIGN.replace(old, new), sweep());
    std::fs::write(folder.path().join("b.csv"), sweep()).expect("writes");
    Campaign::read(folder.path()).expect("reads").warnings
}

#[test]
fn radii_in_millimetres_are_doubted() {
    for (new, count) in [("12", 1), ("0.00001", 1), ("0.5", 0), ("0.012", 0)] {
        let found = doubts("winch_radius_m = 0.012", &format!("winch_radius_m = {new}"));
        assert_eq!(found.len(), count, "{found:?}");
        assert!(found.iter().all(|p| p.row == Some(6) && p.cure.contains("metres") && p.to_string().contains(new)));
    }
}

#[test]
fn repeats_with_one_number_are_doubted() {
    let second = |trial: &str| doubts("repeat = 1", &format!("repeat = 1\n[[trials]]\nfile = \"b.csv\"\n{trial}"));
    let sweep = "protocol = \"uniform\"\nspeed_rad_s = 0.5";
    let found = second(sweep);
    assert!(found.len() == 1 && found[0].row == Some(30), "{found:?}");
    assert!(found[0].to_string().contains("trial in row 24"), "{}", found[0]);
    for fine in ["\nrepeat = 2", "\ntrajectory = \"wide\""] {
        assert_eq!(second(&format!("{sweep}{fine}")), []);
    }
    assert_eq!(second("protocol = \"free\""), []);
}

#[test]
fn all_faults_of_a_file_come_at_once_by_row() {
    let broken = CAMPAIGN.replace("0.012\npulley", "0\npulley").replace("4\n", "40\n").replace("uniform", "free");
    let rows: Vec<_> = Campaign::read(folder(&broken, sweep()).path()).expect_err("faults").0;
    assert_eq!(rows.iter().map(|problem| problem.row).collect::<Vec<_>>(), [Some(6), Some(17), Some(27)]);
}

#[test]
fn syntax_faults_and_absent_files_are_told() {
    let found = faults("lowpass_hz = 5.0", "lowpass_hz = ");
    assert_eq!((found.len(), found[0].row), (1, Some(16)));
    let twice = faults("lowpass_hz = 5.0", "lowpass_hz = 5.0\nlowpass_hz = 5.0");
    assert_eq!(twice[0].row, Some(17));
    let found = Campaign::read(Path::new("no/such/folder")).expect_err("absent");
    assert!(found.to_string().contains("no such file"), "{found}");
    let empty = CAMPAIGN.split("[[trials]]").next().expect("a part").replacen("\n", "\ntrials = []\n", 1);
    let found = Campaign::read(folder(&empty, "").path()).expect_err("empty").to_string();
    assert!(found.contains("lists no trial"), "{found}");
}

fn column(unit: Unit) -> impl Strategy<Value = Column> {
    "[^\\p{C}\\p{Zl}\\p{Zp}]{1,12}".prop_map(move |name| Column::new(name.trim(), unit))
}

prop_compose! {
    /// Any columns with names of their own.
    fn columns()(
        mut named in prop::collection::vec(column(Unit::Degree), 9),
        given in any::<[bool; 5]>(),
        arm_m in prop::option::of(1e-3..10.0),
    ) -> Columns {
        named.iter_mut().enumerate().for_each(|(index, column)| column.name.push_str(&index.to_string()));
        let mut take = |unit| Column { unit, ..named.pop().expect("nine") };
        let reference_unit = if arm_m.is_some() { Unit::Newton } else { Unit::MillinewtonMetre };
        Columns {
            time: take(Unit::Microsecond),
            position: take(Unit::Degree),
            torque: take(Unit::NewtonMetre),
            rate_hz: None,
            torque_from: None,
            command: None,
            velocity: given[0].then(|| take(Unit::Rpm)),
            current: given[1].then(|| take(Unit::Ampere)),
            temperature: given[2].then(|| take(Unit::Celsius)),
            load_torque: given[3].then(|| take(Unit::MillinewtonMetre)),
            reference_torque: given[4].then(|| ReferenceColumn { column: take(reference_unit), arm_m }),
            other_position: vec![OtherColumn { column: take(Unit::Millimetre), joint: None }],
        }
    }
}

prop_compose! {
    fn campaign()(
        columns in columns(),
        name in "[^\\p{C}\\p{Zl}\\p{Zp}]*",
        trajectory in prop::option::of("[^\\p{C}\\p{Zl}\\p{Zp}]*"),
        speed_rad_s in 1e-6..1e6,
        gravity_nm in -1e9..1e9,
        backlash_m in 0.0..1.0,
        position_zero_rad in 0.0..1.5,
        is_uniform in any::<bool>(),
        repeat in 1..u32::MAX,
    ) -> Campaign {
        let joint = Joint { name, kind: JointKind::Revolute, drive: Drive::Cable, winch_radius_m: 0.012, pulley_radius_m: 0.04, backlash_m };
        let protocol = if is_uniform { Protocol::Uniform { speed_rad_s } } else { Protocol::Interaction };
        Campaign {
            folder: "".into(),
            file: "".into(),
            joint,
            dynamics: Dynamics { gravity_nm, inertia_kg_m2: 0.012, ..Dynamics::default() },
            arm: None,
            uncertainty: Uncertainty { position_zero_rad, ..Uncertainty::default() },
            signal: Signal { torque_sign: -1.0, lowpass_hz: 5.0, lowpass_order: 4 },
            files: Files::default(),
            columns,
            trials: vec![TrialEntry { file: "a.csv".into(), part: None, protocol, repeat, trajectory, capture: None, controller: None }],
            warnings: Vec::new(),
            clock_s: Vec::new(),
        }
    }
}

proptest! {
    #[test]
    fn what_is_written_reads_back(mut campaign in campaign()) {
        let folder = folder(&campaign.to_toml(), "");
        campaign.folder = folder.path().to_path_buf();
        campaign.file = folder.path().join("campaign.toml");
        let back = Campaign::read(folder.path());
        prop_assert_eq!(back, Ok(campaign));
    }
}
