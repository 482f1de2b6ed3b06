//! The words of messages, help, reports and documents: none that a reader must decode. The glossary (`tautline guide glossary`)
//! has the terms to use instead.

use std::fs;
use std::path::{Path, PathBuf};

/// What must not stand in user-facing text, and what stands there instead.
const INSTEAD: [(&str, &str); 26] = [
    ("to be had", "cannot be identified, can be extracted"),
    ("foretell", "predict"),
    ("foretold", "predicted"),
    ("distrust", "warnings"),
    ("meet it to", "fit RMSE"),
    ("met to", "fit RMSE"),
    ("for want of", "because there is no"),
    ("is said to", "is reported"),
    ("tautline says", "tautline reports"),
    ("says so", "reports it"),
    ("what rings", "an oscillating residual"),
    ("makes up for", "compensates for"),
    ("made up for", "compensated"),
    ("no fit saw", "held-out data"),
    ("never saw", "held-out data"),
    ("did not see", "held-out data"),
    ("not seen", "held-out data"),
    ("known only together", "correlated with other parameters"),
    ("known only with", "correlated with other parameters"),
    ("causes tried", "candidate causes, ranked"),
    ("what takes minutes", "slow effects"),
    ("kind of log known", "unsupported log format"),
    ("behind its back", "a change it was not told about"),
    ("lays hands on", "accesses"),
    ("judged on", "validated on, scored on"),
    ("in all: what takes", "only so much data: slow effects cannot be detected"),
];

fn files(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_wanted = path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending));
        match path.is_dir() {
            true => files(&path, endings, found),
            false if is_wanted => found.push(path),
            false => {}
        }
    }
}

/// The text of a source file that users read: what stands between quotes, and the documentation of arguments, which is their help.
fn shown(path: &Path, text: &str) -> String {
    if path.extension().is_none_or(|e| e != "rs") {
        return text.to_string();
    }
    let is_help = path.starts_with("src/cli");
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| {
        let line = line.trim_start();
        !line.starts_with("//") || is_help && line.starts_with("///")
    });
    lines.map(|line| line.trim().trim_end_matches('\\').trim_end()).collect::<Vec<_>>().join(" ")
}

#[test]
fn no_word_that_must_be_decoded_stands_in_user_facing_text() {
    let mut all = vec![PathBuf::from("README.md"), PathBuf::from("CHANGELOG.md")];
    files(Path::new("src"), &["rs", "md", "html", "js", "py", "svg"], &mut all);
    files(Path::new("data"), &["md"], &mut all);
    files(Path::new("scripts"), &["md"], &mut all);
    let mut found = Vec::new();
    for path in &all {
        let text = shown(path, &fs::read_to_string(path).unwrap()).to_lowercase();
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for (word, instead) in INSTEAD {
            for (at, _) in words.match_indices(word) {
                let from = words[..at].char_indices().rev().nth(40).map_or(0, |(i, _)| i);
                found.push(format!("{}: `{}`: say: {instead}", path.display(), &words[from..at + word.len()]));
            }
        }
    }
    assert!(found.is_empty(), "{} places:\n{}", found.len(), found.join("\n"));
}

#[test]
fn the_test_finds_what_it_looks_for() {
    let source = "/// never saw\nlet a = \"data that it \\\n    never saw\";\n";
    assert!(
        shown(Path::new("src/report/a.rs"), source)
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("never saw")
    );
    assert!(shown(Path::new("src/cli/a.rs"), "/// never saw\nx: u8").contains("never saw"));
    assert!(!shown(Path::new("src/report/a.rs"), "/// never saw\nx: u8").contains("never saw"));
}

/// The targets of the links and pictures of a Markdown text.
fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect()
}

#[test]
fn every_link_of_the_guide_leads_somewhere() {
    let mut pages = vec![PathBuf::from("README.md")];
    files(Path::new("src/guide"), &["md"], &mut pages);
    files(Path::new("data"), &["md"], &mut pages);
    files(Path::new("scripts"), &["md"], &mut pages);
    let mut broken = Vec::new();
    for page in pages {
        let text = fs::read_to_string(&page).unwrap();
        for link in links(&text).into_iter().filter(|link| !link.starts_with("http") && !link.starts_with('#')) {
            let target = page.parent().unwrap().join(link.split('#').next().unwrap());
            if !target.exists() {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
        for topic in text.split("`tautline guide ").skip(1).filter_map(|rest| rest.split('`').next()) {
            let is_known = tautline::guide::PAGES.iter().any(|page| page.topic == topic) || topic == "TOPIC";
            if !is_known {
                broken.push(format!("{}: tautline guide {topic}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn every_page_of_the_guide_is_listed() {
    let mut files_found = Vec::new();
    files(Path::new("src/guide"), &["md"], &mut files_found);
    let readme = fs::read_to_string("README.md").unwrap();
    for file in files_found {
        let topic = file.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(tautline::guide::PAGES.iter().any(|page| page.topic == topic), "{topic} is not in PAGES");
        assert!(readme.contains(&format!("src/guide/{topic}.md")), "README lacks {topic}");
    }
}
