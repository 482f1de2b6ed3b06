//! The guide: a page for each topic, text in Markdown, the same here and on the terminal.

#[doc = include_str!("security.md")]
pub mod security {}

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

/// All pages.
pub const PAGES: &[Page] = &[Page {
    topic: "security",
    about: "what is trusted, what is read and written, limits and integrity checks",
    text: include_str!("security.md"),
}];
