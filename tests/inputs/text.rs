//! Texts: lines without end, NUL bytes, nesting, names by the million, files elsewhere.

use super::written;
use crate::cli::tautline;
use crate::import::HEAD;
use std::io::{self, Read};
use std::path::Path;
use tautline::document::Document;
use tautline::dynamics::Chain;
use tautline::log::{Campaign, Log, Samples, Survey, examine_trial, read_trial};
use tempfile::TempDir;

const COLUMNS: &str = r#"[columns]
time = { name = "t", unit = "s" }
position = { name = "pos", unit = "deg" }
torque = { name = "trq", unit = "N m" }
"#;

/// A campaign of one log of these bytes.
fn campaign(log: &[u8]) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("a.csv"), log).unwrap();
    let trials = "[[trials]]\nfile = \"a.csv\"\nprotocol = \"free\"\n";
    std::fs::write(folder.path().join("campaign.toml"), format!("{HEAD}{COLUMNS}{trials}")).unwrap();
    folder
}

/// Why a campaign with a log of these bytes is refused: in few words.
fn refusal(log: &[u8]) -> String {
    let folder = campaign(log);
    let read = Campaign::read(folder.path()).and_then(|of| read_trial(&of, 0));
    let said = read.unwrap_err().to_string();
    assert!(said.len() < 5000, "{} bytes", said.len());
    said
}

fn rows(count: usize) -> String {
    let row = |i: usize| format!("{:.3},{:.4},{:.4}\n", i as f64 * 0.001, 20.0 + i as f64 * 0.01, (i as f64).sin());
    format!("t,pos,trq\n{}", (0..count).map(row).collect::<String>())
}

#[test]
fn a_first_line_without_end_is_refused() {
    let said = refusal(&vec![b'x'; 50_000_000]);
    assert!(said.contains("a.csv, row 1: the row is longer than 1 MB"), "{said}");
    let said = refusal(format!("{}\"{}", rows(100), "1,2,3\n".repeat(500_000)).as_bytes());
    assert!(said.contains("close every quote"), "{said}");
}

#[test]
fn nul_bytes_of_a_power_cut_are_named() {
    let said = refusal(&vec![0; 50_000_000]);
    assert!(said.contains("row 1: NUL bytes begin here") && said.contains("power cut"), "{said}");
    let said = refusal(&[rows(500).as_bytes(), &[0; 4096]].concat());
    assert!(said.contains("row 502: NUL bytes begin here"), "{said}");
    let wide: Vec<u8> = rows(10).encode_utf16().flat_map(u16::to_le_bytes).collect();
    // Read as what it is, not taken for damage: too short is all that is wrong with it.
    assert!(refusal(&wide).contains("has 10 samples"), "{}", refusal(&wide));
}

#[test]
fn a_log_with_holes_is_looked_at_only_where_time_rises() {
    let log = format!("{}00\n0.005,20,0.1\n{}", rows(60), rows(60).replace("t,pos,trq\n", "00\n"));
    let folder = campaign(log.as_bytes());
    let (log, problems) = examine_trial(&Campaign::read(folder.path()).unwrap(), 0);
    assert!(!problems.is_empty());
    let is_finite = |log: &Log| log.time_s.iter().chain(&log.torque_nm).all(|value| value.is_finite());
    assert!(log.is_none_or(|log| is_finite(&log)));
}

#[test]
fn names_without_end_are_shown_once_and_short() {
    let long = "torque_".repeat(100_000);
    let said = refusal(format!("t,pos,{long}\n0,1,2\n").as_bytes());
    assert!(said.contains("torque_torque_") && said.len() < 1000, "{said}");
    let many: String = (0..1_000_000).map(|at| format!("c{at},")).collect();
    assert!(refusal(format!("{many}\n").as_bytes()).contains("longer than 1 MB"));
    let many: String = (0..100_000).map(|at| format!("c{at},")).collect();
    assert!(refusal(format!("{many}\n").as_bytes()).contains("columns, more than the 10000"));
}

#[test]
fn a_million_unknown_keys_are_counted() {
    let many: String = (0..1_000_000).map(|at| format!("c{at}=1\n")).collect();
    let file = Path::new("a.toml");
    let mass = Document::from_toml(file, &many).and_then(|text| text.read(|root| root.need("mass").number()));
    let said = mass.unwrap_err();
    assert!(said.0.len() == 22 && said.to_string().contains("and 999980 more unknown keys"), "{}", said.0.len());
}

#[test]
fn nesting_without_end_is_refused() {
    for depth in [200, 100_000] {
        let urdf =
            format!("<robot name=\"a\">{}{}</robot>", "<link name=\"b\">".repeat(depth), "</link>".repeat(depth));
        let (_folder, file) = written("a.urdf", urdf.as_bytes());
        let said = Chain::read(&file, "elbow").unwrap_err().to_string();
        assert!(said.contains("a.urdf, row 1: nests more than 64"), "{said}");
        let (open, close) = ("[".repeat(depth), "]".repeat(depth));
        assert!(Document::from_json(Path::new("a.json"), &format!("{{\"a\":{open}{close}}}")).is_err());
        assert!(Document::from_toml(Path::new("a.toml"), &format!("a = {open}{close}")).is_err());
        assert!(Document::from_toml(Path::new("a.toml"), &format!("{}b = 1", "a.".repeat(depth))).is_err());
        assert!(Document::from_toml(Path::new("a.toml"), &format!("[{}b]", "a.".repeat(depth))).is_err());
    }
}

#[test]
fn a_urdf_of_more_than_any_robot_is_refused() {
    let refused = |text: &str, expected: &str| {
        let (_folder, file) = written("a.urdf", text.as_bytes());
        let said = Chain::read(&file, "elbow").unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    };
    let mesh = "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual>\n";
    refused(
        &format!("<robot name=\"a\"><link name=\"b\">{}</link></robot>", mesh.repeat(50_000)),
        "more than 30000 elements",
    );
    refused("<!DOCTYPE a [<!ENTITY b \"cc\">]>\n<robot name=\"&b;\"/>", "declares a document type");
    refused(&"<!-- more -->".repeat(1_000_000), "larger than 8 MB");
}

/// A stream that never ends its line.
struct Endless(usize);

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0 += buffer.len();
        assert!(self.0 < 20_000_000, "it is read without end");
        buffer.fill(b'7');
        Ok(buffer.len())
    }
}

#[test]
fn a_stream_without_line_ends_is_refused() {
    let folder = campaign(rows(100).as_bytes());
    let campaign = Campaign::read(folder.path()).unwrap();
    let said = Samples::new(&campaign, Endless(0)).err().unwrap().to_string();
    assert!(said.contains("standard input, row 1: the row is longer than 1 MB"), "{said}");
    let begun = io::Cursor::new(rows(20)).chain(Endless(0));
    let last = Samples::new(&campaign, begun).unwrap().last().unwrap().unwrap_err().to_string();
    assert!(last.contains("row 22: the row is longer"), "{last}");
    let cut = io::Cursor::new([rows(20).as_bytes(), &[0; 100]].concat());
    let last = Samples::new(&campaign, cut).unwrap().last().unwrap().unwrap_err().to_string();
    assert!(last.contains("row 22: NUL bytes"), "{last}");
}

#[test]
fn files_elsewhere_are_refused_and_links_told() {
    let folder = campaign(rows(100).as_bytes());
    let file = folder.path().join("campaign.toml");
    let whole = std::fs::read_to_string(&file).unwrap();
    let chain = "urdf = \"../../../etc/arm.urdf\"\njoint = \"elbow\"\n";
    let dynamics = "gravity_nm = 0.6916\ninertia_kg_m2 = 0.012\n";
    std::fs::write(&file, whole.replace(dynamics, chain)).unwrap();
    let said = Campaign::read(folder.path()).unwrap_err().to_string();
    assert!(said.contains("`../../../etc/arm.urdf` lies outside the campaign; copy the URDF"), "{said}");
    std::fs::write(&file, &whole).unwrap();

    let elsewhere = TempDir::new().unwrap();
    let log = folder.path().join("a.csv");
    std::fs::rename(&log, elsewhere.path().join("b.csv")).unwrap();
    std::os::unix::fs::symlink(elsewhere.path().join("b.csv"), &log).unwrap();
    let warnings = Campaign::read(folder.path()).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].what.contains("is a link to"), "{warnings:?}");
    std::fs::remove_file(elsewhere.path().join("b.csv")).unwrap();
    let said = Campaign::read(folder.path()).unwrap_err().to_string();
    assert!(said.contains("`a.csv` is a link to what is not there"), "{said}");
    std::fs::remove_file(&log).unwrap();
    std::fs::create_dir(&log).unwrap();
    let said = Campaign::read(folder.path()).unwrap_err().to_string();
    assert!(said.contains("`a.csv` is a folder") && !said.contains("did you mean"), "{said}");
}

#[test]
fn faults_in_many_files_are_listed_in_few_lines() {
    let folder = TempDir::new().unwrap();
    let mut text = format!("{HEAD}{COLUMNS}");
    for trial in 0..300 {
        let name = format!("{trial}.csv");
        let faulty: String = (0..100).map(|at| format!("{at},x{trial}_{at},1\n")).collect();
        std::fs::write(folder.path().join(&name), format!("t,pos,trq\n{faulty}")).unwrap();
        text += &format!("[[trials]]\nfile = \"{name}\"\nprotocol = \"free\"\n");
    }
    std::fs::write(folder.path().join("campaign.toml"), text).unwrap();
    let done = tautline(&["validate", &folder.path().to_string_lossy(), "--json"]);
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(said.lines().count() == 201 && said.contains("more problems"), "{} lines", said.lines().count());
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(json["problems"].as_array().unwrap().len() > 6000);
    assert!(!Survey::read(folder.path()).unwrap().readable.is_empty());
}
