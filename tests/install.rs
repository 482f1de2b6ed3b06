//! What a newcomer meets first: the demo, manual pages, the Python module.

use crate::cli::tautline;
use serde_json::Value;
use std::process::Command;
use tempfile::TempDir;

#[test]
fn the_demo_finds_what_it_withheld() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("demo");
    let to = out.to_string_lossy().into_owned();
    let done = tautline(&["demo", "-o", &to, "--json"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let told: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(told["steps"].as_array().unwrap().len(), 6);
    let found: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("diagnosed/diagnosis.json")).unwrap()).unwrap();
    assert_eq!(found["verdict"]["effects"][0], "elastic_spring", "{}", found["verdict"]);
    assert!(out.join("exported/elbow_model.h").is_file());
    let again = tautline(&["demo", "-o", &to]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
}

#[test]
fn every_command_has_its_manual_page() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("man1");
    let done = tautline(&["man", "-o", &out.to_string_lossy(), "--json"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    for name in ["tautline", "tautline-identify", "tautline-fit-trials", "tautline-excite-uniform"] {
        let page = std::fs::read_to_string(out.join(format!("{name}.1"))).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(&name.replace('-', "\\-")), "{name}: {page}");
    }
}

/// Without Python there is nothing to test: CI has it.
#[test]
fn the_python_module_gives_dicts() {
    let script = "
import sys, tautline
effects = tautline.run('effects')
assert effects[0]['id'] == 'reversal_transition', effects[0]
try:
    tautline.run('identify', 'no-such-folder', output=sys.argv[1], form='two')
except tautline.Refused as refused:
    assert refused.status == 2 and 'no-such-folder' in str(refused)
else:
    raise SystemExit('nothing was refused')
made = tautline.run('excite', 'cosine', output=sys.argv[1], periods_s=[16, 8], limit_speed_rad_s=2.0, repeats=None)
assert made['motions'][0]['duration_s'] == 24.0, made
tautline.run('export', 'data/elbow/truth', output=sys.argv[1] + '2', only='csv')
rows = tautline.table(sys.argv[1] + '2/parameters.csv')
campaign = tautline.Campaign('data/davinci_l4')
assert campaign.validate()['errors'] == 0
trial = {'time_s': [0.01 * i for i in range(2000)], 'position_rad': [1.0 if i % 400 < 200 else 0.5 for i in range(2000)]}
trial['torque_nm'] = [0.1 * (i % 7) for i in range(2000)]
made = tautline.Campaign.from_arrays([trial], joint={'drive': 'direct'}, dynamics={'gravity_nm': 0.5}, torque_sign=-1)
assert made.validate()['trials'] == 1
frame = {**trial, 'run': [1] * 2000}
class Frame(dict):
    columns = list(frame)
same = tautline.Campaign.from_dataframe(Frame(frame), by='run', joint={'drive': 'direct'}, dynamics={'gravity_nm': 0.5}, torque_sign=-1)
assert (same.folder / 'trial_1.csv').read_text() == (made.folder / 'trial_1.csv').read_text()
try:
    tautline.Campaign.from_arrays([{**trial, 'position_rad': [0.0]}], joint={}, dynamics={}, torque_sign=1)
except ValueError as refused:
    assert 'differ in length' in str(refused), refused
else:
    raise SystemExit('arrays of different lengths were taken')
class Number:
    def item(self):
        return 1
tautline.Campaign.from_arrays([{**trial, 'repeat': Number()}], joint={'drive': 'direct'}, dynamics={}, torque_sign=1)
def refused(words, make):
    try:
        make()
    except (TypeError, ValueError) as found:
        assert words in str(found), found
    else:
        raise SystemExit('taken: ' + words)
declared = dict(joint={'drive': 'direct'}, dynamics={}, torque_sign=1)
refused('into a list', lambda: tautline.Campaign.from_arrays(trial, **declared))
refused('two dimensions', lambda: tautline.Campaign.from_arrays([{**trial, 'torque_nm': [[0.0]] * 2000}], **declared))
refused('SI and radians', lambda: tautline.Campaign.from_arrays([{'position_deg': [0.0]}], **declared))
refused('position_rad', lambda: tautline.Campaign.from_dataframe(Frame({'time_s': [0.0]}), columns={'time_s': 'time_s'}, **declared))
import warnings
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter('always')
    found = tautline.Campaign('data/elbow').identify()
assert any(issubclass(warning.category, tautline.Doubt) for warning in told) == bool(found['warnings']), told
assert rows['value'][0] == 0.012 and rows['low'][0] is None and rows['name'][0] == 'joint.winch_radius_m', rows
";
    let folder = TempDir::new().unwrap();
    let run = Command::new("python3")
        .args(["-c", script, &folder.path().join("out").to_string_lossy()])
        .env("PYTHONPATH", "src/python")
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("TAUTLINE", env!("CARGO_BIN_EXE_tautline"))
        .output();
    let Ok(done) = run else { return };
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
