//! What CI systems read: JUnit XML, and GitHub's workflow commands.

use super::{Names, told};
use crate::check::{Checked, Finding, Outcome};
use crate::problem::visible;
use askama::Template;

/// Annotations of one kind that GitHub shows for a step.
const SHOWN: usize = 10;

#[derive(Template)]
#[template(path = "junit.xml", config = "src/askama.toml")]
struct Junit<'a> {
    name: &'a str,
    tests: usize,
    failures: usize,
    cases: Vec<Case>,
}

struct Case {
    part: &'static str,
    name: String,
    failed: bool,
    told: String,
}

/// JUnit XML, a test case for each thing compared.
///
/// Errors: the template cannot be rendered, a fault of this program.
pub fn to_junit(checked: &Checked, names: &Names) -> Result<String, askama::Error> {
    let case = |finding: &Finding| Case {
        part: finding.part.name(),
        name: plain(&finding.name),
        failed: finding.outcome == Outcome::Regressed,
        told: plain(&told(finding)),
    };
    let failures = checked.with(Outcome::Regressed).count();
    let (name, cases) = (&*plain(names.campaign), checked.findings.iter().map(case).collect::<Vec<_>>());
    Junit { name, tests: cases.len(), failures, cases }.render()
}

/// Without the characters that XML cannot hold.
fn plain(text: &str) -> String {
    visible(text).into_owned()
}

/// Workflow commands: an error for each regression, the gravest first, a notice for what else moved.
pub fn to_github(checked: &Checked, names: &Names) -> String {
    let file = property(names.campaign_file);
    let command = |kind: &str, title: &str, message: &str| {
        format!("::{kind} file={file},title={}::{}\n", property(title), escaped(message))
    };
    let regressed = super::terminal::gravest(checked);
    let mut text = String::new();
    for finding in regressed.iter().take(SHOWN - 1) {
        text += &command("error", &format!("{} {} regressed", finding.part.name(), finding.name), &told(finding));
    }
    if regressed.len() >= SHOWN {
        let rest: Vec<&str> = regressed.iter().skip(SHOWN - 1).map(|finding| finding.name.as_str()).collect();
        text += &command("error", &format!("and {} more regressed", rest.len()), &rest.join("\n"));
    }
    for outcome in [Outcome::Changed, Outcome::Better] {
        let found: Vec<String> = checked.with(outcome).map(|f| format!("{}: {}", f.name, told(f))).collect();
        if !found.is_empty() {
            text += &command("notice", &format!("{} {}", found.len(), outcome.name()), &found.join("\n"));
        }
    }
    if regressed.is_empty() {
        let message =
            format!("{} figures and settings are within tolerance of {}", checked.findings.len(), names.baseline);
        text += &command("notice", &format!("{} checked", names.campaign), &message);
    }
    text
}

/// As the message of a workflow command.
fn escaped(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// As a property of a workflow command.
fn property(text: &str) -> String {
    escaped(&visible(text)).replace(':', "%3A").replace(',', "%2C")
}
