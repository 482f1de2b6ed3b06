//! The schemas against every bundled file, and against the keys that the readers ask for.

use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use tautline::schema::{
    Batch, Campaign, Check, Comparison, Diagnosis, Evaluation, FILES, Fleet, Interaction, Model, Repeatability, Rig,
    Trajectory,
};
use tautline::simulate::Plan;

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

/// What is wrong with `text` as a file of type `T`.
fn fault<T: DeserializeOwned>(path: &Path, text: &str) -> Option<String> {
    let told = match path.extension().is_some_and(|e| e == "toml") {
        true => toml::from_str::<T>(text).err().map(|error| error.to_string()),
        false => serde_json::from_str::<T>(text).err().map(|error| error.to_string()),
    };
    told.map(|error| format!("{}: {error}", path.display()))
}

#[test]
fn every_bundled_file_is_what_its_schema_says() {
    let mut all = Vec::new();
    files(Path::new("data"), &mut all);
    let (mut faults, mut seen) = (Vec::new(), 0);
    for path in all.iter().filter(|path| path.extension().is_some_and(|e| e == "toml" || e == "json")) {
        let text = fs::read_to_string(path).unwrap();
        let is = |format: &str| text.contains(&format!("{format}/1\""));
        let fault = match () {
            () if is("campaign") => fault::<Campaign>(path, &text),
            () if is("model") && !is("baseline") => fault::<Model>(path, &text),
            () if is("trajectory") => fault::<Trajectory>(path, &text),
            () if is("rig") => fault::<Rig>(path, &text),
            () if is("batch") => fault::<Batch>(path, &text),
            () => continue,
        };
        seen += 1;
        faults.extend(fault);
    }
    assert!(faults.is_empty() && seen >= 6, "{seen} files; {}", faults.join("\n"));
}

/// A rig with everything that it may have.
#[test]
fn a_rig_with_two_drives_and_a_brake_is_what_its_schema_says() {
    let brake = "[drive.brake]\nrelease_s = 0.1\nengage_s = 0.1\n[drive.brake.device]\nplace = 3\nname = \"outputs\"\nvendor = 1\n\
                 product = 2\n[drive.brake.device.outputs]\npdo = 0x1600\nentries = [{ as = \"brake\", index = 0x7000, sub = 1, \
                 type = \"bit\" }]\n\n[drive.inputs]";
    let rig = include_str!("../data/rigs/demo/rig.toml").replace("[drive.inputs]", brake);
    let text = format!("{rig}{}", include_str!("../data/rigs/demo/axes.toml"));
    let path = Path::new("rig.toml");
    assert_eq!(fault::<Rig>(path, &text), None);
    assert!(tautline::capture::rig::Rig::parse(path, &text).is_ok());
    assert!(fault::<Rig>(path, &text.replace("[axes.limits]", "unknown = 1\n[axes.limits]")).is_some());
}

#[test]
fn what_is_written_is_what_its_schema_says() {
    let out = tempfile::TempDir::new().unwrap();
    let to = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    let campaign =
        crate::campaigns::record(&crate::campaigns::truth(), &Plan { cosines: 1, ..crate::campaigns::plan() });
    let campaign = campaign.path().to_string_lossy().into_owned();
    let run = |arguments: &[&str]| assert!(crate::cli::tautline(arguments).status.success(), "{arguments:?}");
    run(&["identify", &campaign, "-o", &to("i"), "--quiet"]);
    run(&["evaluate", &campaign, "--model", &to("i"), "-o", &to("e"), "--quiet"]);
    run(&["diagnose", &campaign, "--model", &to("i"), "-o", &to("d"), "--quiet"]);
    let read = |name: &str| (out.path().join(name), fs::read_to_string(out.path().join(name)).unwrap());
    let ((model, a), (evaluation, b), (diagnosis, c)) =
        (read("i/model.json"), read("e/evaluation.json"), read("d/diagnosis.json"));
    let faults = [fault::<Model>(&model, &a), fault::<Evaluation>(&evaluation, &b), fault::<Diagnosis>(&diagnosis, &c)];
    assert!(faults.iter().all(Option::is_none), "{faults:#?}");
}

#[test]
fn what_is_printed_is_what_its_schema_says() {
    let out = tempfile::TempDir::new().unwrap();
    let to = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    let record = |seed: u64| {
        let plan = Plan { cosines: 1, seed, ..crate::campaigns::plan() };
        crate::campaigns::record(&crate::campaigns::truth(), &plan)
    };
    let campaigns = [record(1), record(2), record(3)];
    let paths = campaigns.each_ref().map(|campaign| campaign.path().to_string_lossy().into_owned());
    let list: String = std::iter::once("format = \"batch/1\"\n".to_string())
        .chain((0..3).map(|i| format!("[[campaigns]]\npath = \"{}\"\ndate = 2026-0{}-01\n", paths[i], i + 1)))
        .collect();
    fs::write(to("list.toml"), list).unwrap();
    let printed = |arguments: &[&str]| {
        let done = crate::cli::tautline(arguments);
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).unwrap()
    };
    for (path, name) in paths.iter().zip(["a", "b"]) {
        printed(&["identify", path, "-o", &to(name), "--quiet"]);
    }
    printed(&["check", &paths[0], "--baseline", &to("baseline.json"), "--update", "--quiet"]);
    let path = Path::new("printed.json");
    let faults = [
        fault::<Comparison>(path, &printed(&["compare", &to("a/model.json"), &to("b/model.json"), "--json"])),
        fault::<Check>(path, &printed(&["check", &paths[0], "--baseline", &to("baseline.json"), "--json"])),
        fault::<Fleet>(path, &printed(&["batch", &to("list.toml"), "-o", &to("fleet"), "--json"])),
        fault::<Repeatability>(path, &printed(&["repeatability", &to("list.toml"), "--json"])),
        fault::<Interaction>(
            path,
            &printed(&["interaction", "data/arm", "--model", "data/elbow/truth/model.json", "-o", &to("i"), "--json"]),
        ),
    ];
    assert!(faults.iter().all(Option::is_none), "{faults:#?}");
}

/// Keys that `files` ask for, by their source.
fn asked(files: &[&str]) -> Vec<String> {
    let sources = files.iter().map(|file| fs::read_to_string(format!("src/{file}")).unwrap());
    let mut keys = Vec::new();
    for source in sources {
        for ask in [".need(\"", ".may(\"", "count(\"", "percent(\"", "up_to(\"", "radius(\""] {
            keys.extend(source.split(ask).skip(1).map(|rest| rest.split('"').next().unwrap().to_string()));
        }
    }
    keys
}

#[test]
fn every_key_that_a_reader_asks_for_is_in_its_schema() {
    let readers: [(&str, &[&str]); 5] = [
        (
            "campaign",
            &[
                "core/log/campaign.rs",
                "core/log/files.rs",
                "core/log/entries.rs",
                "core/log/captured.rs",
                "core/log/uncertainty.rs",
                "core/log/arm.rs",
                "core/log/columns.rs",
                "core/model/joint.rs",
            ],
        ),
        ("model", &["core/model/file.rs", "core/model/functions.rs"]),
        ("trajectory", &["core/trajectory/file.rs"]),
        ("batch", &["batch/manifest.rs"]),
        (
            "rig",
            &[
                "capture/rig/read.rs",
                "capture/rig/read_drive.rs",
                "capture/rig/read_sensor.rs",
                "capture/rig/axes.rs",
                "capture/rig/setup.rs",
                "capture/rig/process_data.rs",
                "capture/limits.rs",
            ],
        ),
    ];
    // Of what an identification adds, and by quantity rather than by key.
    const OTHERS: [&str; 2] = ["parameter", "time"];
    for (name, readers) in readers {
        let schema = FILES.iter().find(|file| file.name == name).unwrap();
        let text = (schema.schema)().as_value().to_string();
        let missing: Vec<String> =
            asked(readers).into_iter().filter(|key| !text.contains(&format!("\"{key}\":"))).collect();
        let missing: Vec<&String> = missing.iter().filter(|key| !OTHERS.contains(&key.as_str())).collect();
        assert!(missing.is_empty(), "{name}: {missing:?}");
    }
}

/// The keys of `schema` as a table, sections below each other.
fn reference(name: &str, about: &str, schema: &serde_json::Value) -> String {
    let mut text = format!("## {name}\n\n{about}. `tautline schema {name}` prints the JSON Schema.\n");
    let definitions = schema["$defs"].as_object().into_iter().flatten();
    let parts = std::iter::once((String::new(), schema)).chain(definitions.map(|(key, part)| (key.clone(), part)));
    for (part, content) in parts {
        let variants = content["oneOf"].as_array().cloned().unwrap_or_default();
        let tables = std::iter::once(content.clone()).chain(variants);
        for table in tables {
            let Some(properties) = table["properties"].as_object() else { continue };
            let variant = properties.get("kind").and_then(|kind| kind["const"].as_str());
            let title = [part.as_str(), variant.unwrap_or_default()].join(" ");
            let described = table["description"].as_str().or(content["description"].as_str()).unwrap_or_default();
            let described = described.replace('\n', " ");
            text += &match title.trim() {
                "" => "\n| key | | |\n|---|---|---|\n".to_string(),
                title => format!("\n**{title}**: {described}\n\n| key | | |\n|---|---|---|\n"),
            };
            let needed: Vec<&str> =
                table["required"].as_array().into_iter().flatten().filter_map(|k| k.as_str()).collect();
            for (key, property) in properties {
                let means = property["description"].as_str().or(property["const"].as_str()).unwrap_or_default();
                let needs = if needed.contains(&key.as_str()) { "needed" } else { "" };
                text += &format!("| `{key}` | {needs} | {} |\n", means.replace('\n', " ").replace('|', "\\|"));
            }
        }
        for variant in content["oneOf"].as_array().into_iter().flatten().filter(|v| v["const"].is_string()) {
            let said = variant["description"].as_str().unwrap_or_default();
            text += &format!("\n- {part} `{}`: {said}", variant["const"].as_str().unwrap_or_default());
        }
        if text.ends_with(|c: char| c != '\n') {
            text.push('\n');
        }
    }
    text
}

#[test]
fn the_reference_in_the_guide_is_what_the_schemas_say() {
    let head = "# Reference: every key of every file\n\nMade from the types that `tautline schema` prints \
                (`TAUTLINE_GOLDEN=write cargo test --release reference` renews it). \
                Inputs refuse keys that are not here; results may hold more.\n";
    let parts: Vec<String> =
        FILES.iter().map(|file| reference(file.name, file.about, (file.schema)().as_value())).collect();
    let made = format!("{head}\n{}", parts.join("\n"));
    let path = Path::new("src/guide/files.md");
    if std::env::var("TAUTLINE_GOLDEN").is_ok_and(|v| v == "write") {
        fs::write(path, &made).unwrap();
    }
    assert!(fs::read_to_string(path).unwrap_or_default() == made, "src/guide/files.md is out of date");
}

#[test]
fn every_key_has_a_sentence() {
    fn walk(value: &serde_json::Value, path: &str, lacking: &mut Vec<String>) {
        if let Some(properties) = value.get("properties").and_then(|p| p.as_object()) {
            for (key, property) in properties {
                if property.get("description").is_none() && property.get("const").is_none() {
                    lacking.push(format!("{path}.{key}"));
                }
            }
        }
        match value {
            serde_json::Value::Object(object) => {
                object.iter().for_each(|(key, value)| walk(value, &format!("{path}.{key}"), lacking));
            }
            serde_json::Value::Array(list) => list.iter().for_each(|value| walk(value, path, lacking)),
            _ => {}
        }
    }
    for file in &FILES {
        let mut lacking = Vec::new();
        walk((file.schema)().as_value(), file.name, &mut lacking);
        assert!(lacking.is_empty(), "{lacking:?}");
    }
}
