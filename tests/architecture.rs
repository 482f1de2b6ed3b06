//! The house: `core/lib.rs` and then `lib.rs` list the rooms upstream first, and no room imports from one below it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Both lists of rooms, upstream first.
fn lists() -> String {
    ["src/core/lib.rs", "src/lib.rs"].map(|list| fs::read_to_string(list).unwrap()).concat()
}

fn rooms() -> Vec<String> {
    lists().lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';').map(str::to_string)).collect()
}

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Every `crate::room` named in a file, with the room the file stands in.
fn imports() -> Vec<(PathBuf, String, String)> {
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    let mut found = Vec::new();
    for file in files {
        let within = file.strip_prefix("src/core").or_else(|_| file.strip_prefix("src")).unwrap();
        let room = within.iter().next().unwrap().to_string_lossy().trim_end_matches(".rs").to_string();
        for part in fs::read_to_string(&file).unwrap().split("crate::").skip(1) {
            let name: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            found.push((file.clone(), room.clone(), name));
        }
    }
    found
}

#[test]
fn imports_run_one_way() {
    let order: BTreeMap<String, usize> = rooms().into_iter().enumerate().map(|(i, room)| (room, i)).collect();
    assert!(order.len() > 20, "lib.rs was not understood: {order:?}");
    let mut checked = 0;
    for (file, room, imported) in imports() {
        let (Some(at), Some(from)) = (order.get(&room), order.get(&imported)) else { continue };
        assert!(from <= at, "{} imports `{imported}`, which stands below `{room}` in lib.rs", file.display());
        checked += 1;
    }
    assert!(checked > 50, "only {checked} imports were seen");
}

/// Files that stand directly in a room, named in another of them, tests left out; folders within are not looked into.
fn neighbours(folder: &str) -> BTreeMap<String, Vec<String>> {
    let name = |path: &Path| path.file_stem().unwrap().to_string_lossy().to_string();
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "rs")).collect();
    let all: Vec<String> = files.iter().map(|path| name(path)).filter(|file| file != "mod").collect();
    let of = |path: &PathBuf| {
        let source = fs::read_to_string(path).unwrap();
        let source = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        let named = |file: &&String| {
            let direct = ["super::X::", "use super::X;"].iter().any(|way| source.contains(&way.replace('X', file)));
            let lists = source.split("use super::{").skip(1).filter_map(|list| list.split('}').next());
            direct || lists.flat_map(|list| list.split([',', ':'])).any(|item| item.trim() == file.as_str())
        };
        (name(path), all.iter().filter(|file| **file != name(path)).filter(named).cloned().collect())
    };
    files.iter().filter(|path| name(path) != "mod").map(of).collect()
}

#[test]
fn files_of_a_room_import_one_way() {
    for folder in ["src/core/diagnose", "src/core/simulate", "src/capture"] {
        let mut left = neighbours(folder);
        assert!(left.values().map(Vec::len).sum::<usize>() > 5, "{folder} was not understood: {left:?}");
        // What imports nothing that is left is on no circle.
        while let Some(file) = left.iter().find(|(_, of)| of.is_empty()).map(|(file, _)| file.clone()) {
            left.remove(&file);
            left.values_mut().for_each(|of| of.retain(|other| *other != file));
        }
        assert!(left.is_empty(), "circles in {folder}, or what stands above them: {left:?}");
    }
}

#[test]
fn data_frames_stay_in_the_log_room() {
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    for file in files.iter().filter(|f| !f.starts_with("src/core/log")) {
        assert!(!fs::read_to_string(file).unwrap().contains("polars::"), "{} names polars", file.display());
    }
}

#[test]
fn only_the_command_line_and_reports_print() {
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    for file in files.iter().filter(|f| !f.starts_with("src/cli") && !f.starts_with("src/report")) {
        let text = fs::read_to_string(file).unwrap();
        for word in ["println!", "eprintln!", "print!(", "stdout()", "stderr()"] {
            assert!(!text.contains(word), "{} holds {word}", file.display());
        }
    }
}

#[test]
fn every_room_has_its_line_in_the_drawing() {
    let lists = lists();
    let lines: Vec<&str> = lists.lines().collect();
    for (i, line) in lines.iter().enumerate().filter(|(_, l)| l.starts_with("pub mod ")) {
        assert!(lines[i - 1].starts_with("/// "), "`{line}` lacks its line in the drawing");
    }
}

/// Where `word` stands as a text of its own in `source`, comments left out: line numbers.
fn literals(source: &str, word: &str) -> Vec<usize> {
    let is_code = |line: &&str| !line.trim_start().starts_with("//");
    let lines = source.lines().enumerate().filter(|(_, line)| is_code(line));
    lines.filter(|(_, line)| line.contains(&format!("\"{word}\""))).map(|(i, _)| i + 1).collect()
}

#[test]
fn what_is_known_of_an_effect_stands_in_its_own_file() {
    // As words of plain English they name columns, keys and lines of figures, too.
    const PLAIN: [(&str, &[&str]); 3] = [
        (
            "contact",
            &["cli/follow.rs", "report/interaction.rs", "report/plots/interaction.rs", "report/plots/diagnosis"],
        ),
        ("inertia", &["report/plots/evaluation/series.rs", "export/table.rs", "core/model/groups.rs"]),
        ("gravity", &["report/plots/evaluation/series.rs", "core/identify/implausible", "core/robots/mjcf.rs"]),
    ];
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    let ids = tautline::effects::LIBRARY.map(|effect| effect.about().id);
    let groups = tautline::model::Group::ALL.map(|group| group.name);
    for file in files.iter().filter(|f| !f.starts_with("src/core/effects")) {
        let source = fs::read_to_string(file).unwrap();
        let code = source.split("#[cfg(test)]").next().unwrap();
        let is_group_file = file.starts_with("src/core/model/groups.rs");
        for name in ids.into_iter().chain(groups.into_iter().filter(|_| !is_group_file)) {
            let allowed = PLAIN.iter().filter(|(word, _)| *word == name).flat_map(|(_, places)| *places);
            if allowed.into_iter().any(|place| file.starts_with(Path::new("src").join(place))) {
                continue;
            }
            // What tells two groups apart names both.
            let found = literals(code, name);
            assert!(found.is_empty() || is_group_file, "{} names `{name}` in lines {found:?}", file.display());
        }
    }
}

/// Lines of code, comments and tests left out, with their numbers.
fn code(source: &str) -> impl Iterator<Item = (usize, &str)> {
    let code = source.split("#[cfg(test)]").next().unwrap_or_default();
    code.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, line)| !line.trim_start().starts_with("//"))
}

#[test]
fn each_formula_of_the_model_stands_in_one_place() {
    // What gives a second copy away, and the rooms that hold the only one.
    const FORMULAS: [(&str, &[&str]); 5] = [
        ("the loss by friction under load, 1 - mu", &["1.0 - mu", "1.0 - friction", "1.0 - down", "mu_up", "mu_down"]),
        ("the balance solved for y", &["friction_nm) / ", "change) / (1"]),
        ("a Stribeck term", &["rate * speed", "rate * u", "rates[i] * u", "c_c * pulley", "c_j * v"]),
        ("K_f and the curve", &["2.0 * travel", ".atan()"]),
        ("the two branches combined", &["k_tilde * (", "k_tilde[i] * (up"]),
    ];
    // An effect's own change-over after reversals.
    let has_its_own = |file: &Path| file.starts_with("src/core/effects/transition.rs");
    let mut files = Vec::new();
    sources(Path::new("src"), &mut files);
    for file in files.iter().filter(|f| !f.starts_with("src/core/model") && !f.starts_with("src/core/numerics")) {
        let source = fs::read_to_string(file).unwrap();
        for (what, marks) in FORMULAS {
            let found: Vec<(usize, &str)> =
                code(&source).filter(|(_, line)| marks.iter().any(|mark| line.contains(mark))).collect();
            assert!(found.is_empty() || has_its_own(file), "{} holds {what} again: {found:?}", file.display());
        }
    }
}
