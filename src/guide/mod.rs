//! The guide: a page for each topic, text in Markdown, the same here and on the terminal.

#[doc = include_str!("campaign.md")]
pub mod campaign {}
#[doc = include_str!("capture.md")]
pub mod capture {}
#[doc = include_str!("changes.md")]
pub mod changes {}
#[doc = include_str!("developers.md")]
pub mod developers {}
#[doc = include_str!("diagnose.md")]
pub mod diagnose {}
#[doc = include_str!("evaluate.md")]
pub mod evaluate {}
#[doc = include_str!("faq.md")]
pub mod faq {}
#[doc = include_str!("files.md")]
pub mod files {}
#[doc = include_str!("gallery.md")]
pub mod gallery {}
#[doc = include_str!("glossary.md")]
pub mod glossary {}
#[doc = include_str!("identify.md")]
pub mod identify {}
#[doc = include_str!("logs.md")]
pub mod logs {}
#[doc = include_str!("measured.md")]
pub mod measured {}
#[doc = include_str!("model.md")]
pub mod model {}
#[doc = include_str!("security.md")]
pub mod security {}
#[doc = include_str!("simulate.md")]
pub mod simulate {}
#[doc = include_str!("simulators.md")]
pub mod simulators {}
#[doc = include_str!("start.md")]
pub mod start {}
#[doc = include_str!("theory.md")]
pub mod theory {}

/// One page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its name on the command line.
    pub topic: &'static str,
    /// What it is about, in one line.
    pub about: &'static str,
    /// Its text, Markdown.
    pub text: &'static str,
}

/// The page on `$topic`.
macro_rules! page {
    ($topic:literal, $about:literal) => {
        Page { topic: $topic, about: $about, text: include_str!(concat!($topic, ".md")) }
    };
}

/// All pages, in the order in which they are read.
pub const PAGES: &[Page] = &[
    page!("theory", "winch, cables, clearance and joint: what the sensor reads, and the paper"),
    page!("start", "ten minutes: a lab's logs, their campaign, a model, a verdict, as a terminal shows it"),
    page!("logs", "from a lab's own files to a first model: init, units, current, position alone, gears, doubts"),
    page!("identify", "identify a joint from sweeps or free motion; statuses, options, how it works"),
    page!("campaign", "campaign.toml, units, signal checks, import of other formats"),
    page!("evaluate", "other motions, interaction torque, a whole arm"),
    page!("diagnose", "verdicts on the gap between model and recordings, and how often they are right"),
    page!("gallery", "what the first figure of a diagnosis looks like, by verdict"),
    page!("changes", "compare two models, repeatability, regression gate, fleets"),
    page!("simulate", "excitation trajectories and simulated campaigns"),
    page!("simulators", "a MuJoCo joint improved from recordings: model, record, diagnose, export"),
    page!("capture", "record a joint over EtherCAT: rigs, plans, safety"),
    page!("model", "the formula, model.json, export to controllers and simulators"),
    page!("files", "reference: every key of campaign.toml, model.json and the other files"),
    page!("faq", "frequently asked questions: recording, results, verdicts, programs"),
    page!("measured", "speed, memory and accuracy, beside SciPy and beside the paper"),
    page!("security", "what is trusted, what is read and written, limits and integrity checks"),
    page!("glossary", "the terms of reports and messages"),
    page!("developers", "the house, the scripts, CI"),
];
