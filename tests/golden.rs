//! The report's wording and shape against a stored copy. `TAUTLINE_GOLDEN=write cargo test --release golden` renews it.

use crate::campaigns::{plan, record, truth};
use std::path::Path;
use tautline::identify::{Settings, run};
use tautline::log::Campaign;
use tautline::report::{Output, write_identification};
use tautline::simulate::Plan;

/// The page without its drawings, styles and numbers, one tag or text a line: what a change of wording or order shows in.
fn skeleton(page: &str) -> String {
    let mut text = page.to_string();
    let parts = [
        ("<svg", "</svg>"),
        ("<style", "</style>"),
        ("<script", "</script>"),
        ("<meta http", ">"),
        ("<dl class=\"prov", "</dl>"),
    ];
    for (open, close) in parts {
        while let Some(start) = text.find(open) {
            let end = text[start..].find(close).map_or(text.len(), |at| start + at + close.len());
            text.replace_range(start..end, "");
        }
    }
    let mut out = String::new();
    let mut number = false;
    for c in text.chars() {
        match c {
            '0'..='9' => number = true,
            '.' | '-' | '−' | 'e' if number => {}
            _ => {
                if std::mem::take(&mut number) {
                    out.push('#');
                }
                out.push(c);
                if c == '>' {
                    out.push('\n');
                }
            }
        }
    }
    let lines: Vec<&str> = out.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines.join("\n") + "\n"
}

#[test]
fn the_report_reads_as_it_did() {
    let folder = record(&truth(), &Plan { cosines: 1, ..plan() });
    let campaign = Campaign::read(folder.path()).unwrap();
    let found = run(&campaign, Settings::default(), &|| ()).unwrap();
    let out = tempfile::TempDir::new().unwrap();
    let output = Output::begin(&out.path().join("r"), false, "identify").unwrap();
    write_identification(&found, "elbow", &output, false).unwrap();
    output.finish().unwrap();
    let page = skeleton(&std::fs::read_to_string(out.path().join("r/report.html")).unwrap());
    let golden = Path::new("tests/golden/report.txt");
    if std::env::var("TAUTLINE_GOLDEN").is_ok_and(|v| v == "write") {
        std::fs::create_dir_all("tests/golden").unwrap();
        std::fs::write(golden, &page).unwrap();
    }
    let stored = std::fs::read_to_string(golden).unwrap_or_default();
    let at = page.lines().zip(stored.lines()).position(|(a, b)| a != b);
    let show =
        |text: &str| text.lines().nth(at.unwrap_or(text.lines().count().saturating_sub(1))).unwrap_or("").to_string();
    assert!(page == stored, "the report changed at line {at:?}:\n  now    {}\n  stored {}", show(&page), show(&stored));
}
