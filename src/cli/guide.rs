//! `tautline guide`.

use super::outcome::Talk;
use crate::guide::{PAGES, Page};
use crate::problem::Result;
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
            Some(_) => pages.iter().try_for_each(|page| write!(out, "{}", page.text)),
            None => pages.iter().try_for_each(|page| writeln!(out, "{:<12} {}", page.topic, page.about)),
        })?;
    }
    Ok(ExitCode::SUCCESS)
}
