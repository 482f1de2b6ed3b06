//! A report in one file: the verdict, the figure that shows it, what to do next; below, collapsible, everything else. No link to
//! anything outside; the script draws the figures (`chart`) and needs no network.

mod digest;
mod provenance;
mod terms;

use super::chart::{Columns, FOR_FILES, FOR_PAGES, Figure, svg};
use super::output::Output;
use super::{png, unmade};
use crate::problem::Result;
use askama::Template;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use rayon::prelude::*;
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::io::Write;

pub use digest::sha256;

const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = include_str!("page.css");
/// Of a selection of trials this many stand as files, and in the page for readers without its script.
const STATIC: usize = 6;
/// A column with a longer cell holds words, which wrap and begin at its left end.
const SENTENCE: usize = 24;

/// A report's page.
#[derive(Debug, Default)]
pub struct Page {
    /// The line above the title.
    pub kicker: String,
    /// What it is about: the joint.
    pub title: String,
    /// What it tells of it, for the window's title.
    pub subject: String,
    /// The verdict.
    pub short: String,
    /// The figures that show it.
    pub lead: Vec<Figure>,
    /// What to do next, a sentence each.
    pub next: Vec<String>,
    /// Numbers to see first.
    pub cards: Vec<Card>,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// Everything else.
    pub sections: Vec<Section>,
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

/// A warning.
#[derive(Debug)]
pub struct Warning {
    /// What it says.
    pub text: String,
    /// The figure that shows why, by its name.
    pub figure: Option<String>,
}

impl From<&String> for Warning {
    fn from(text: &String) -> Self {
        Self { text: text.clone(), figure: None }
    }
}

/// A part of the page that can be folded away.
#[derive(Debug)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Whether it is unfolded at first.
    pub open: bool,
    /// What it holds.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Sentences.
    List(Vec<String>),
    /// Terms with what they mean.
    Terms(Vec<(Cell, String)>),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Figure),
    /// What is chosen from ("trial"), and the choices by name, one of which is shown, each with its figures.
    Choice(&'static str, Vec<(String, Vec<Figure>)>),
}

/// A table; its first column names the rows.
#[derive(Debug)]
pub struct Table {
    /// Its heading; may be empty.
    pub title: String,
    /// How to read it.
    pub intro: String,
    /// Heads of the columns.
    pub heads: Vec<String>,
    /// Cells by row.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Debug, Clone, Default)]
pub struct Cell {
    /// What stands in it.
    pub text: String,
    /// What that means, told on hovering; may be empty.
    pub meaning: String,
    /// The style of a label; empty where it is plain text.
    pub chip: &'static str,
    /// The figure or section that shows it, by its name; empty without.
    pub link: String,
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, ..Self::default() }
    }
}

/// `texts` as cells.
pub fn cells(texts: Vec<String>) -> Vec<Cell> {
    texts.into_iter().map(Cell::from).collect()
}

impl Section {
    /// A section of `blocks`, unfolded.
    pub fn open(title: &str, blocks: Vec<Block>) -> Self {
        Self { title: title.to_string(), open: true, blocks }
    }

    /// A section of `blocks`, folded away at first.
    pub fn folded(title: &str, blocks: Vec<Block>) -> Self {
        Self { open: false, ..Self::open(title, blocks) }
    }

    /// Its address in the page.
    fn id(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        format!("s-{}", self.title.chars().map(plain).collect::<String>())
    }

    fn figures(&self) -> impl Iterator<Item = (bool, &Figure)> {
        self.blocks.iter().flat_map(|block| match block {
            Block::Figure(figure) => vec![(true, figure)],
            Block::Choice(_, options) => {
                let step = options.len().div_ceil(STATIC).max(1);
                let all = options.iter().enumerate();
                all.flat_map(|(at, (_, figures))| figures.iter().map(move |f| (at.is_multiple_of(step), f))).collect()
            }
            _ => Vec::new(),
        })
    }
}

impl Table {
    /// A table of texts.
    pub fn new(title: &str, intro: &str, heads: &[&str], rows: Vec<Vec<String>>) -> Self {
        Self {
            title: title.to_string(),
            intro: intro.to_string(),
            heads: heads.iter().map(|head| (*head).to_string()).collect(),
            rows: rows.into_iter().map(cells).collect(),
        }
    }

    /// Its rows as texts.
    pub fn texts(&self) -> Vec<Vec<String>> {
        self.rows.iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect()
    }

    /// The style of column `at`: numbers stand at its right end, names and words at its left, and long texts wrap.
    fn style(&self, at: &usize) -> &'static str {
        let texts = || self.rows.iter().filter_map(|row| row.get(*at)).map(|cell| cell.text.trim());
        let is_number = |text: &str| {
            text.chars().next().is_none_or(|c| c.is_ascii_digit() || "-\u{2212}\u{2013}+±<>[∞".contains(c))
        };
        match texts().any(|text| text.chars().count() > SENTENCE) {
            true => "words",
            false if texts().all(is_number) => "number",
            false => "name",
        }
    }
}

/// The page with its figures drawn.
#[derive(Template)]
#[template(path = "page.html", config = "src/askama.toml")]
struct Rendered<'p> {
    page: &'p Page,
    /// Those of the page, and the glossary's terms that they use.
    sections: Vec<&'p Section>,
    provenance: Vec<(&'static str, String)>,
    /// Drawings of the figures that stand in the page for readers without its script, by name.
    drawings: HashMap<&'p str, String>,
    data: String,
    style: &'static str,
    script: &'static str,
    style_digest: String,
    script_digest: String,
}

impl Rendered<'_> {
    fn svg(&self, figure: &Figure) -> Option<&String> {
        self.drawings.get(&figure.name[..])
    }
}

impl Page {
    /// All figures, each with whether it stands as a file too.
    fn figures(&self) -> Vec<(bool, &Figure)> {
        self.lead.iter().map(|figure| (true, figure)).chain(self.sections.iter().flat_map(Section::figures)).collect()
    }

    /// Writes `report.html` and `plots/` to `output`; `pictures` asks for PNG beside the drawings.
    ///
    /// Errors: a file that cannot be written.
    pub fn write(&self, output: &Output, pictures: bool) -> Result<()> {
        let figures = self.figures();
        let lasting: Vec<&Figure> = figures.iter().filter(|(is_static, _)| *is_static).map(|(_, f)| *f).collect();
        let one = |figure: &&Figure| {
            write_figure(figure, "plots/", output, pictures)?;
            drawn(figure, FOR_PAGES, output)
        };
        let (drawings, data) =
            rayon::join(|| lasting.par_iter().map(one).collect::<Result<Vec<String>>>(), || packed(&figures));
        let names = lasting.iter().map(|figure| &figure.name[..]);
        let of_csp = |text: &str| format!("sha256-{}", sha256(text.as_bytes()).in_base64());
        let terms = terms::section(self);
        let rendered = Rendered {
            page: self,
            sections: self.sections.iter().chain(&terms).collect(),
            provenance: provenance::rows(output).into_iter().chain(self.provenance.iter().cloned()).collect(),
            drawings: names.zip(drawings?).collect(),
            data: data.or_else(|error| unmade(output, "report.html", error))?,
            style: STYLE,
            script: SCRIPT,
            style_digest: of_csp(STYLE),
            script_digest: of_csp(SCRIPT),
        };
        let text = rendered.render().or_else(|error| unmade(output, "report.html", error))?;
        output.write("report.html", text)
    }
}

/// Writes `figure` as SVG, and as PNG with `pictures`, to `folder` of `output`.
///
/// Errors: a file that cannot be written.
pub fn write_figure(figure: &Figure, folder: &str, output: &Output, pictures: bool) -> Result<()> {
    let svg = drawn(figure, FOR_FILES, output)?;
    if pictures {
        let name = format!("{folder}{}.png", figure.name);
        output.write(&name, png::render(&svg).or_else(|error| unmade(output, &name, error))?)?;
    }
    output.write(&format!("{folder}{}.svg", figure.name), svg)
}

fn drawn(figure: &Figure, buckets: usize, output: &Output) -> Result<String> {
    svg(figure, buckets).or_else(|error| unmade(output, &figure.name, error))
}

/// The data of `figures` for the page's script: JSON, deflated, in letters.
fn packed(figures: &[(bool, &Figure)]) -> std::io::Result<String> {
    let mut columns = Columns::of(figures.len());
    let mut named = Map::new();
    for (_, figure) in figures {
        named.insert(figure.name.clone(), figure.to_json(&mut columns));
    }
    let data = format!("{{\"figures\":{},\"columns\":{}}}", Value::Object(named), columns.into_json());
    let mut packer = DeflateEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(data.as_bytes())?;
    Ok(URL_SAFE_NO_PAD.encode(packer.finish()?))
}
