//! `tautline guide`.

use super::outcome::Talk;
use crate::guide::{PAGES, Page};
use crate::problem::Result;
use crate::report::terminal::wrapped;
use clap::builder::PossibleValuesParser;
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  tautline guide\n  tautline guide security | less")]
pub struct Arguments {
    /// The page to print [default: a list of them]
    #[arg(value_parser = PossibleValuesParser::new(PAGES.iter().map(|page| page.topic)))]
    topic: Option<String>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let wanted = |page: &&Page| arguments.topic.as_ref().is_none_or(|topic| topic == page.topic);
    let pages: Vec<&Page> = PAGES.iter().filter(wanted).collect();
    let as_json = |page: &&Page| match arguments.topic {
        Some(_) => json!({ "topic": page.topic, "about": page.about, "text": page.text }),
        None => json!({ "topic": page.topic, "about": page.about }),
    };
    // Not a result: the text may speak of what is no number.
    if talk.json {
        let told = json!({ "format": "guide/1", "pages": pages.iter().map(as_json).collect::<Vec<_>>() });
        super::outcome::say(|out| write!(out, "{}", crate::report::json_text(&told)))?;
    } else if !talk.quiet {
        super::outcome::say(|out| match arguments.topic {
            Some(_) => pages.iter().try_for_each(|page| write!(out, "{}", reflowed(page.text))),
            None => pages.iter().try_for_each(|page| writeln!(out, "{:<12} {}", page.topic, page.about)),
        })?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `text` with its paragraphs and list items as wide as the terminal; code, tables and headings as they are.
fn reflowed(text: &str) -> String {
    let (mut flowed, mut paragraph) = (String::new(), String::new());
    let mut in_code = false;
    for line in text.lines() {
        let is_code = line.starts_with("```");
        let stands = in_code || is_code || line.is_empty() || line.starts_with(['|', '#', '!']);
        let begins = line.starts_with("- ") || line.starts_with(|c: char| c.is_ascii_digit()) && line.contains(". ");
        if stands || begins {
            flow(&mut flowed, &mut paragraph);
        }
        match stands {
            true => flowed += &format!("{line}\n"),
            false => paragraph += &format!("{} ", line.trim()),
        }
        in_code ^= is_code;
    }
    flow(&mut flowed, &mut paragraph);
    flowed
}

/// Adds `paragraph` to `flowed` in lines and empties it.
fn flow(flowed: &mut String, paragraph: &mut String) {
    let indent = if paragraph.starts_with("- ") { 2 } else { 0 };
    if !paragraph.is_empty() {
        *flowed += &format!("{}\n", wrapped(paragraph, indent));
    }
    paragraph.clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_flow_and_code_stays() {
        let text = "# A\n\none\ntwo\n- item\n  more\n\n```sh\na  b\n```\n| x | y |\n";
        assert_eq!(reflowed(text), "# A\n\none two\n- item more\n\n```sh\na  b\n```\n| x | y |\n");
    }
}
