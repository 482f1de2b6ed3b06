//! Pages of reports: what browsers enforce and readers rely on. How they behave in a browser is tried by `scripts/pages.py`.

use crate::campaigns::{plan, record, truth};
use crate::cli::tautline;
use std::path::Path;
use std::sync::LazyLock;
use tautline::report::page::sha256;
use tautline::simulate::Plan;
use tempfile::TempDir;

/// An evaluation of six trials: its folder and its page.
static SIX: LazyLock<(TempDir, String)> = LazyLock::new(|| {
    let campaign = record(&truth(), &Plan { cosines: 6, ..plan() });
    let out = TempDir::new().unwrap();
    let (from, to) = (campaign.path().to_string_lossy().into_owned(), out.path().join("r"));
    let to_text = to.to_string_lossy().into_owned();
    let done = tautline(&["evaluate", &from, "--model", "data/elbow/truth/model.json", "-o", &to_text, "--quiet"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let page = std::fs::read_to_string(to.join("report.html")).unwrap();
    (out, page)
});

/// What stands between the last `open` and the `close` after it.
fn between<'a>(page: &'a str, open: &str, close: &str) -> &'a str {
    let from = page.rfind(open).unwrap() + open.len();
    &page[from..from + page[from..].find(close).unwrap()]
}

#[test]
fn the_policy_allows_just_the_script_and_the_style_of_the_page() {
    let policy = between(&SIX.1, "Content-Security-Policy\" content=\"", "\"");
    assert!(policy.starts_with("default-src 'none'; script-src 'sha256-"), "{policy}");
    for (part, open, close) in [("script-src", "<script>", "</script>"), ("style-src", "<style>", "</style>")] {
        let digest = sha256(between(&SIX.1, open, close).as_bytes()).in_base64();
        assert!(policy.contains(&format!("{part} 'sha256-{digest}'")), "{part}: {policy}");
    }
    assert!(!SIX.1.contains(" style=\"") && !SIX.1.contains(" onclick="), "the policy would block it");
}

#[test]
fn an_evaluation_of_six_trials_is_small_and_has_all_of_them() {
    assert!(SIX.1.len() < 1_500_000, "{} bytes", SIX.1.len());
    assert_eq!(SIX.1.matches("data-option=").count(), 6);
    assert_eq!(SIX.1.matches("<noscript>").count(), 1 + 6 * 3);
}

#[test]
fn a_page_tells_where_it_comes_from() {
    let told = between(&SIX.1, "<dl class=\"provenance\">", "</dl>");
    for name in ["date", "command", "tautline", "commit", "machine", "campaign file", "model file"] {
        assert!(told.contains(&format!("<dt>{name}</dt>")), "{name}: {told}");
    }
    let model = sha256(&std::fs::read(Path::new("data/elbow/truth/model.json")).unwrap()).in_hex();
    assert!(told.contains(&model[..16]), "{told}");
}

#[test]
fn every_link_leads_somewhere() {
    for link in SIX.1.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(SIX.1.contains(&format!("id=\"{link}\"")), "{link}");
    }
}

#[test]
fn the_script_is_small() {
    assert!(between(&SIX.1, "<script>", "</script>").len() < 60_000);
}
