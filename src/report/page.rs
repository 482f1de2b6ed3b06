//! A report in one file: a verdict, numbers to see first, tables, figures, provenance; no link to anything outside.

use super::output::Output;
use super::{png, unmade};
use crate::problem::Result;
use askama::Template;
use rayon::prelude::*;

/// A report's page; everything is text, and the template escapes all but the drawings.
#[derive(Debug, Default, Template)]
#[template(path = "page.html")]
pub struct Page {
    /// The line above the title.
    pub kicker: String,
    /// What it is about: the joint.
    pub title: String,
    /// What it tells of it, for the window's title.
    pub subject: String,
    /// The verdict.
    pub short: String,
    /// Its grounds, a sentence each.
    pub steps: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Numbers to see first.
    pub cards: Vec<Card>,
    /// What to do next, a sentence each.
    pub next: Vec<String>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Figures.
    pub drawings: Vec<Drawing>,
    /// How many of the figures stand before the tables.
    pub leading: usize,
    /// Name and value of what went in.
    pub provenance: Vec<(&'static str, String)>,
}

/// A number to see first.
#[derive(Debug)]
pub struct Card {
    /// What it is.
    pub name: String,
    /// It, with its unit.
    pub value: String,
    /// How to read it.
    pub note: String,
}

/// A table; its first column names the rows.
#[derive(Debug)]
pub struct Table {
    /// Its heading.
    pub title: String,
    /// How to read it.
    pub intro: String,
    /// Heads of the columns.
    pub heads: Vec<String>,
    /// Cells by row.
    pub rows: Vec<Vec<String>>,
}

/// A figure, drawn.
#[derive(Debug)]
pub struct Drawing {
    /// Name of its file, without extension.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What it shows, and what to look for.
    pub caption: String,
    /// The drawing.
    pub svg: String,
}

/// A column with a longer cell holds words, which wrap and begin at its left end.
const SENTENCE: usize = 24;

impl Table {
    /// The style of column `at`: words, or numbers and the like.
    fn style(&self, at: &usize) -> &'static str {
        let is_long = |row: &Vec<String>| row.get(*at).is_some_and(|cell| cell.chars().count() > SENTENCE);
        if self.rows.iter().any(is_long) { "words" } else { "number" }
    }
}

impl Page {
    /// The figures before the tables, and those after them.
    fn parted(&self) -> (&[Drawing], &[Drawing]) {
        self.drawings.split_at(self.leading.min(self.drawings.len()))
    }

    /// Writes `report.html` and `plots/` to `output`; `pictures` asks for PNG beside the drawings.
    pub fn write(&self, output: &Output, pictures: bool) -> Result<()> {
        for drawing in &self.drawings {
            output.write(&format!("plots/{}.svg", drawing.name), &drawing.svg)?;
        }
        if pictures {
            self.drawings.par_iter().try_for_each(|drawing| {
                let name = format!("plots/{}.png", drawing.name);
                let picture = png::render(&drawing.svg).or_else(|error| unmade(output, &name, error))?;
                output.write(&name, picture)
            })?;
        }
        let page = self.render().or_else(|error| unmade(output, "report.html", error))?;
        output.write("report.html", page)
    }
}
