//! Devices as they are: several PDOs, a drive alone, objects to be written first, clocks of their own; and a joint moved by hand.

use super::{RIG, SWEEP, demo, plan, rig, run, traced, truth};
use crate::cli::tautline;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, drive};
use tautline::capture::commission::{Told, findings};
use tautline::capture::drive::Condition;
use tautline::capture::found::scan;
use tautline::capture::in_process::InProcess;
use tautline::capture::line::with_line;
use tautline::capture::operator::Agrees;
use tautline::capture::plan::Plan;
use tautline::capture::rig::{Rig, starting_rig};
use tautline::capture::run::jog::{Jog, Jogger};
use tautline::capture::session::{Outcome, Task, Torque, jog};

/// The demo's rig with other text in place of some.
fn rig_with(changes: &[(&str, &str)]) -> Rig {
    let text = changes.iter().fold(RIG.to_string(), |text, (before, after)| {
        assert!(text.contains(before), "{before}");
        text.replace(before, after)
    });
    Rig::parse(Path::new("rig.toml"), &text).unwrap_or_else(|why| panic!("{why}\n{text}"))
}

/// The text of the demo's rig with another section in place of its own from `[name]` to the next blank line.
fn with_section(text: &str, name: &str, section: &str) -> String {
    let at = text.find(&format!("[{name}]")).unwrap();
    let end = text[at..].find("\n\n").unwrap() + at;
    format!("{}{section}{}", &text[..at], &text[end..])
}

const OUTPUTS: &str = "[drive.outputs]
pdos = [
    { pdo = 0x1600, entries = [{ as = \"mode\", index = 0x6060, type = \"i8\" }, { as = \"target_torque\", index = 0x6071, type = \"i16\" }] },
    { pdo = 0x1601, entries = [
        { as = \"control_word\", index = 0x6040, type = \"u16\" },
        { as = \"target_position\", index = 0x607A, type = \"i32\" },
    ] },
]
";
const INPUTS: &str = "[drive.inputs]
pdos = [
    { pdo = 0x1A01, entries = [
        { as = \"status_word\", index = 0x6041, type = \"u16\" },
        { as = \"position\", index = 0x6064, type = \"i32\" },
    ] },
    { pdo = 0x1A00, entries = [
        { as = \"velocity\", index = 0x606C, type = \"i32\" },
        { as = \"torque\", index = 0x6077, type = \"i16\" },
        { as = \"mode\", index = 0x6061, type = \"i8\" },
    ] },
]
";

/// D3: several PDOs each way, one of them as the maker has fixed it.
#[test]
fn several_pdos_are_mapped_and_read() {
    let text = with_section(&with_section(RIG, "drive.outputs", OUTPUTS), "drive.inputs", INPUTS);
    let several = Rig::parse(Path::new("rig.toml"), &text).unwrap();
    let watched = run(demo(), &several, &plan(SWEEP), None);
    assert_eq!((watched.outcome.cause, watched.outcome.complete), (None, 2));
    // What a device has fixed otherwise is refused, with what it has.
    let wrong = text.replace("index = 0x6041, type = \"u16\"", "index = 0x6041, type = \"u32\"");
    assert_ne!(wrong, text);
    let wrong = Rig::parse(Path::new("rig.toml"), &wrong).unwrap();
    let refused = std::panic::catch_unwind(|| run(demo(), &wrong, &plan(SWEEP), None).outcome);
    assert!(refused.is_err());
}

/// D4: a drive alone: the torque is its own.
#[test]
fn a_drive_alone_serves() {
    let alone = || Bus::new(vec![drive(0)]).with_joint(Joint::new(truth(), 0.0, 0.005, 1));
    let at = RIG.find("[sensor]").unwrap();
    let end = RIG.find("[limits]").unwrap();
    let text = format!("{}[sensor]\nfrom = \"drive_torque\"\n\n{}", &RIG[..at], &RIG[end..]);
    let rig = Rig::parse(Path::new("rig.toml"), &text).unwrap();
    assert_eq!(rig.sensor.nm_per_count, 0.002);
    let outcome = traced(alone(), &rig, &plan(SWEEP), &Agrees, &mut |_, _| ());
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    // And a scan writes a rig for it, in which what no device can tell is missing.
    let mut bus = alone();
    let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    });
    let found = with_line(wire, scan).unwrap();
    let text = starting_rig("eth1", &found).unwrap();
    let filled: Vec<&str> =
        text.lines().map(|line| line.strip_prefix("# ").filter(|l| l.contains(" = ")).unwrap_or(line)).collect();
    let read = Rig::parse("rig.toml".as_ref(), &filled.join("\n")).unwrap_or_else(|why| panic!("{why}\n{text}"));
    assert!(read.sensor.is_in_drive && read.sensor.inputs.place("torque").is_some(), "{text}");
}

/// Objects are written in PRE-OP and read back; what is not taken is refused by name.
#[test]
fn startup_objects_are_written_and_read_back() {
    let startup = |value: &str| {
        let line = format!("mode = \"csp\"\nstartup = [{{ index = 0x6085, type = \"u32\", value = {value} }}]");
        rig_with(&[("mode = \"csp\"", line.as_str())])
    };
    let mut ramp = 0;
    let outcome = traced(demo(), &startup("5000000"), &plan(SWEEP), &Agrees, &mut |_, bus| {
        ramp = u32::from_le_bytes(bus.devices()[0].object(0x6085, 0).unwrap().try_into().unwrap());
    });
    assert_eq!((outcome.complete, ramp), (2, 5_000_000));
    assert!(
        outcome.report.iter().any(|line| line.contains("0x6085:00 set to 5000000, read back")),
        "{:?}",
        outcome.report
    );
    let refused = Rig::parse(
        Path::new("rig.toml"),
        &RIG.replace("mode = \"csp\"", "mode = \"csp\"\nstartup = [{ index = 0x6085, type = \"u16\", value = 70000 }]"),
    );
    assert!(refused.unwrap_err().to_string().contains("which the type cannot hold"));
}

/// Clocks of devices that want their pulses later, or none.
#[test]
fn clocks_pulse_as_each_device_wants() {
    for clock in ["{ sync0_shift_us = 100 }", "{ assign_activate = 0x0700, sync1_us = 250 }", "{ assign_activate = 0 }"]
    {
        let line = format!("name = \"torque terminal\"\nclock = {clock}");
        let rig = rig_with(&[("name = \"torque terminal\"", line.as_str())]);
        let outcome = traced(demo(), &rig, &plan(SWEEP), &Agrees, &mut |_, _| ());
        assert_eq!((outcome.cause, outcome.complete), (None, 2), "{clock}");
        assert!(
            outcome.report.iter().any(|line| line.contains("`torque terminal`") && line.contains("clock")),
            "{clock}"
        );
    }
}

/// The first AL status of the drive that is not OP, and its code, after `faults` at cycle 5000; and what became of the capture.
fn left_op(rig: &Rig, faults: &[Fault]) -> (u16, u16, Outcome) {
    let mut bus = demo();
    faults.iter().for_each(|fault| bus.inject(*fault, When::Cycle(5000)));
    let (mut state, mut code) = (0, 0);
    let outcome = traced(bus, rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
        if state == 0 && bus.cycles() > 5000 && bus.devices()[0].al_status() != 8 {
            (state, code) = (bus.devices()[0].al_status(), bus.devices()[0].al_code());
        }
    });
    (state, code, outcome)
}

/// D7: a drive that works by its clock gives up when outputs stay away: as it is told, so that it stands in for its watchdog and bridges
/// the gaps that the rig lets pass.
#[test]
fn a_clocked_drive_gives_up_in_a_long_gap() {
    let (state, code, outcome) = left_op(&rig(), &[Fault::WatchdogOff { device: 0 }, Fault::Unsent { frames: 70 }]);
    assert_eq!((state, code), (0x14, 0x1A));
    let told = "`winch drive`: gives up after 11 pulses of its clock without outputs (0x10f1:02 = 33, read back)";
    assert!(outcome.report.iter().any(|line| line == told), "{:?}", outcome.report);
    let patient = rig_with(&[
        ("missed_cycles_max = 1 ", "watchdog_ms = 200\nmissed_cycles_max = 90 "),
        ("lowpass_hz = 5.0", "lowpass_hz = 1.0"),
        ("stale_cycles = 3", "stale_cycles = 100"),
        ("torque_step_nm = 0.3", "torque_step_nm = 5.0"),
    ]);
    let (_, code, outcome) = left_op(&patient, &[Fault::Unsent { frames: 70 }]);
    assert_eq!((code, outcome.cause, outcome.complete), (0, None, 2));
}

/// Up for a while, then down, then the end.
#[derive(Debug)]
struct UpAndDown;

impl Jogger for UpAndDown {
    fn wanted(&self, time_s: f64) -> Jog {
        match time_s {
            t if t < 2.0 => Jog::Up,
            t if t < 2.5 => Jog::Rest,
            t if t < 4.0 => Jog::Down,
            _ => Jog::End,
        }
    }
}

#[test]
fn a_jog_is_slow_and_small_and_ends_without_torque() {
    let (rig, interrupted, mut bus) = (rig(), AtomicBool::new(false), demo());
    let plan = Plan { trials: Vec::new(), rest_s: 0.0 };
    let (mut fastest, mut highest, mut last) = (0.0f64, f64::MIN, Condition::Unknown);
    let wire = InProcess::new(|now_ns: u64, frame: &[u8]| {
        let replies = bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect();
        let truth = bus.truth();
        (fastest, highest) = (fastest.max(truth.velocity_rad_s.abs()), highest.max(truth.position_rad));
        last = Condition::of(bus.drive_status().unwrap_or(0));
        replies
    });
    let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let outcome = jog(wire, &task, &UpAndDown, &Arc::default()).unwrap();
    assert_eq!((outcome.cause, outcome.torque), (None, Torque::Off));
    assert!(!last.has_torque() && fastest < 0.2 && (0.05..0.1).contains(&highest), "{fastest} rad/s, {highest} rad");
    assert!(outcome.report.iter().any(|line| line.starts_with("moved between")), "{:?}", outcome.report);
    let (jogged, nothing) =
        (outcome.jogged.unwrap(), Told { moved_rad: None, read_to_rad: 0.009, at_rad: None, load_nm: None });
    let found = findings(&rig, &jogged, &nothing).unwrap();
    assert!(found.proposals.is_empty(), "{found:?}");
    assert!(found.lines.iter().any(|line| line.contains("signs of drive and sensor fit")), "{found:?}");
}

/// Jogs the demo's joint by the rig in `file`; what came of it.
fn jogged(file: &str, more: &[&str]) -> serde_json::Value {
    let script = ["rig", "jog", "--rig", file, "--json", "--script", "up 1.5, down 3, up 1.5"];
    let done = tautline(&[&script, more].concat());
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    serde_json::from_slice(&done.stdout).unwrap()
}

/// A rig whose drive counts the other way and half as far, and whose sensor has the wrong sign: a jog, with what was seen of it, sets it
/// right; the file keeps all else.
#[test]
fn a_jog_sets_signs_scale_and_zero_right() {
    let out = tempfile::TempDir::new().unwrap();
    let file = out.path().join("rig.toml").to_string_lossy().into_owned();
    let wrong = [
        ("counts_per_rad = 166886.05 ", "counts_per_rad = 83443 "),
        ("sign = 1  ", "sign = -1  "),
        ("nm_per_count = 0.00015259255", "nm_per_count = -0.00015259255"),
    ];
    let text = wrong.iter().fold(RIG.to_string(), |text, (before, after)| {
        assert!(text.contains(before), "{before}");
        text.replacen(before, after, 1)
    });
    std::fs::write(&file, &text).unwrap();
    // Nothing told, nothing written; of the sensor alone the signs seem to fit, since both are wrong.
    let told = jogged(&file, &[]);
    assert_eq!((&told["proposed"]["numbers"], &told["proposed"]["written"]), (&serde_json::json!([]), &false.into()));
    let moved = told["report"].as_array().unwrap().iter().find_map(|line| {
        let (_, rest) = line.as_str().unwrap().split_once(" rad, ").filter(|(way, _)| way.starts_with("moved"))?;
        rest.split_once(" counts")?.0.parse::<f64>().ok()
    });
    let moved_rad = format!("{:.6}", -moved.unwrap() / 166_886.05);
    let seen = ["--moved-rad", &moved_rad, "--read-to-rad", "0.001", "--at-rad", "0.1"];
    let told = jogged(&file, &seen);
    assert_eq!(
        (told["proposed"]["numbers"].as_array().unwrap().len(), &told["proposed"]["written"]),
        (4, &false.into())
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    let told = jogged(&file, &[&seen[..], &["--write"]].concat());
    assert_eq!(told["proposed"]["written"], true, "{told}");
    let new = std::fs::read_to_string(&file).unwrap();
    let read = Rig::parse(Path::new("rig.toml"), &new).unwrap();
    assert!((read.drive.counts_per_rad / 166_886.05 - 1.0).abs() < 1e-3 && read.drive.sign == 1.0, "{new}");
    assert_eq!(read.sensor.nm_per_count, 0.000_152_592_55);
    assert!((read.drive.position_rad(0.0) - 0.1).abs() < 0.03, "{}", read.drive.zero_counts);
    assert_eq!(new.matches('#').count(), text.matches('#').count());
    // By the new numbers nothing more is proposed but the zero, where another pose is told.
    let told = jogged(&file, &["--at-rad", "0"]);
    let numbers = told["proposed"]["numbers"].as_array().unwrap();
    assert!(numbers.len() == 1 && numbers[0]["key"] == "zero_counts", "{numbers:?}");
    // What cannot be so is refused, and nothing is written.
    let refused = tautline(&["rig", "jog", "--rig", &file, "--script", "up 1", "--moved-rad", "400", "--write"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), new);
}

/// D7: seventeen devices were "not enough capacity, check cables".
#[test]
fn a_long_bus_is_scanned_and_one_that_is_too_long_says_so() {
    let scanned = |terminals: usize| {
        let devices = std::iter::once(drive(0)).chain((0..terminals).map(|_| Terminal::default().device(0))).collect();
        let mut bus = Bus::new(devices);
        let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
        });
        with_line(wire, scan)
    };
    assert_eq!(scanned(17).map(|found| found.len()), Ok(18));
    let failure = scanned(64).unwrap_err();
    assert!(failure.is_capacity() && failure.to_string().contains("64 devices"), "{failure}");
}

/// A rig from the maker's own description, before the device is there.
#[test]
fn an_esi_file_becomes_a_rig() {
    let out = tempfile::TempDir::new().unwrap();
    let path = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    let esi = "<EtherCATInfo><Vendor><Id>#xAB</Id></Vendor><Descriptions><Devices>\
        <Device><Type ProductCode=\"#x402\" RevisionNo=\"#x1\">Old</Type>\
        <RxPdo Sm=\"2\"><Index>#x1600</Index><Entry><Index>#x6040</Index><SubIndex>0</SubIndex><BitLen>16</BitLen></Entry></RxPdo></Device>\
        <Device><Type ProductCode=\"#x402\" RevisionNo=\"#x2\">New</Type>\
        <RxPdo Sm=\"2\"><Index>#x1600</Index><Entry><Index>#x6040</Index><SubIndex>0</SubIndex><BitLen>16</BitLen></Entry>\
        <Entry><Index>#x607A</Index><SubIndex>0</SubIndex><BitLen>32</BitLen></Entry></RxPdo>\
        <TxPdo Sm=\"3\"><Index>#x1A00</Index><Entry><Index>#x6041</Index><SubIndex>0</SubIndex><BitLen>16</BitLen></Entry></TxPdo></Device>\
        </Devices></Descriptions></EtherCATInfo>";
    std::fs::write(path("drive.xml"), esi).unwrap();
    let scan = |more: &[&str]| {
        let file = path("drive.xml");
        tautline(&[&["rig", "scan", "--interface", "eth1", "--esi", &file], more].concat())
    };
    let done = scan(&["--product", "0x402", "-o", &path("rig.toml"), "--json"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&told["devices"][0]["name"], told["devices"].as_array().unwrap().len()), (&"New".into(), 1));
    let rig = std::fs::read_to_string(path("rig.toml")).unwrap();
    assert!(rig.contains("interface = \"eth1\"") && rig.contains("0x607a"), "{rig}");
    let refused = scan(&["--product", "7"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
}
