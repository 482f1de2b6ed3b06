//! The glossary's terms that a page uses, with what they mean: folded away at its end, and told on hovering where each first stands.

use super::{Block, Cell, Page, Section, Table};
use crate::report::chart::Figure;
use std::collections::HashSet;

/// The guide's glossary: a table of terms and meanings.
const GLOSSARY: &str = include_str!("../../guide/glossary.md");
/// A term of fewer letters is a symbol, which any word could be; formulas explain those.
const LETTERS_MIN: usize = 3;

/// Terms of the glossary in `page`, each with its meaning, in the glossary's order.
pub fn of(page: &Page) -> Vec<(&'static str, &'static str)> {
    let mut text = String::new();
    for part in texts(page) {
        text.extend([&part.to_lowercase(), " "]);
    }
    // A word within a term of several is not a term by itself.
    let several = entries().filter(|(term, _)| term.contains(' '));
    let alone = several.fold(text.clone(), |text, (term, _)| text.replace(&term.to_lowercase(), " "));
    let words: HashSet<&str> = alone.split(|c: char| !is_word(c)).collect();
    let occurs = |term: &str| match term.contains(' ') {
        true => text.contains(&term.to_lowercase()),
        false => ["", "s"].iter().any(|plural| words.contains(format!("{}{plural}", term.to_lowercase()).as_str())),
    };
    entries().filter(|(term, _)| occurs(term)).collect()
}

/// Every term with its meaning; a row of several terms is one each.
fn entries() -> impl Iterator<Item = (&'static str, &'static str)> {
    let rows = GLOSSARY.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | "));
    let terms = rows.skip(1).flat_map(|(terms, meaning)| terms.split(", ").map(move |term| (term, meaning)));
    terms.filter(|(term, _)| term.chars().count() >= LETTERS_MIN && !term.contains('`'))
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '-' | '_')
}

/// The texts on `page`, except those from the recordings.
fn texts(page: &Page) -> Vec<&str> {
    let mut all: Vec<&str> = vec![&page.short];
    all.extend(page.lead.iter().flat_map(of_figure));
    all.extend(page.next.iter().map(String::as_str));
    all.extend(page.cards.iter().flat_map(|card| [card.name.as_str(), card.note.as_str()]));
    all.extend(page.warnings.iter().map(|warning| warning.text.as_str()));
    for section in &page.sections {
        all.push(&section.title);
        for block in &section.blocks {
            match block {
                Block::Text(text) => all.push(text),
                Block::List(items) => all.extend(items.iter().map(String::as_str)),
                Block::Terms(terms) => all.extend(terms.iter().map(|(_, meaning)| meaning.as_str())),
                Block::Table(table) => all.extend(of_table(table)),
                Block::Figure(figure) => all.extend(of_figure(figure)),
                Block::Choice(_, options) => {
                    all.extend(options.first().into_iter().flat_map(|(_, figures)| figures).flat_map(of_figure));
                }
            }
        }
    }
    all
}

fn of_figure(figure: &Figure) -> [&str; 2] {
    [&figure.title, &figure.caption]
}

fn of_table(table: &Table) -> impl Iterator<Item = &str> {
    let cells = table.rows.iter().flatten().map(|cell| cell.text.as_str());
    [table.title.as_str(), table.intro.as_str()].into_iter().chain(table.heads.iter().map(String::as_str)).chain(cells)
}

/// The section that tells them; `None` where the page uses none.
pub fn section(page: &Page) -> Option<Section> {
    let terms: Vec<(Cell, String)> =
        of(page).into_iter().map(|(term, meaning)| (term.to_string().into(), meaning.to_string())).collect();
    (!terms.is_empty()).then(|| Section::folded(TITLE, vec![Block::Terms(terms)]))
}

/// Its heading; the page's script finds the terms by it.
const TITLE: &str = "Terms";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_explains_the_terms_that_it_uses_and_no_others() {
        let page = Page { short: "A gap from 120 legs, above the noise floor".to_string(), ..Page::default() };
        let terms: Vec<&str> = of(&page).into_iter().map(|(term, _)| term).collect();
        assert_eq!(terms, ["gap", "leg", "noise floor"]);
    }

    #[test]
    fn every_row_of_the_glossary_is_read() {
        let rows = GLOSSARY.lines().filter(|line| line.starts_with("| ")).count() - 1;
        let meanings: HashSet<&str> = entries().map(|(_, meaning)| meaning).collect();
        // A, B(v) apart: a symbol alone.
        assert_eq!(meanings.len(), rows - 1, "{meanings:?}");
    }
}
