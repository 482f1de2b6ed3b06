//! `# ?` in `campaign.toml`: placeholder values of a draft, for what no data can determine.

use crate::problem::Problem;
use std::path::Path;
use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// The mark of a value that is still to be given.
pub const MARK: &str = "# ?";

/// A problem for each value of `file` that is still a question.
pub(super) fn open(file: &Path) -> Vec<Problem> {
    // A file that cannot be read was reported.
    let text = std::fs::read_to_string(file).unwrap_or_default();
    questions(&text)
        .into_iter()
        .map(|(row, key, question)| {
            let (what, cure) = match key {
                None => ("a question is open".to_string(), format!("answer it and delete this line: {question}")),
                Some(_) => (
                    "is still a question: the value only holds its place".to_string(),
                    format!("write the value and delete `{MARK}`: {question}"),
                ),
            };
            let problem = Problem::error(file, what, cure.trim_end_matches([':', ' '])).at_row(row);
            match key {
                Some(key) => problem.in_column(key),
                None => problem,
            }
        })
        .collect()
}

/// The comments of a TOML text that start with the mark: row from 1, key of the value before it if there is one, question.
fn questions(text: &str) -> Vec<(u64, Option<&str>, &str)> {
    let source = Source::new(text);
    let comments = source.lex().filter(|token| token.kind() == TokenKind::Comment).map(|token| token.span());
    comments
        .filter_map(|span| {
            let comment = text[span.start()..span.end()].trim_start_matches('#').trim_start();
            let question = comment.strip_prefix('?')?.trim();
            let before = &text[..span.start()];
            let line = before.rsplit('\n').next().unwrap_or_default();
            let key = line.split('=').next().unwrap_or_default().trim();
            let row = before.matches('\n').count() as u64 + 1;
            Some((row, Some(key).filter(|key| !key.is_empty()), question))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::questions;

    #[test]
    fn the_mark_counts_outside_of_texts_alone() {
        let asked = |line| questions(line).first().map(|&(_, key, question)| (key, question));
        assert_eq!(asked("gravity_nm = 0.0 # ? torque at 90 deg"), Some((Some("gravity_nm"), "torque at 90 deg")));
        assert_eq!(asked("gravity_nm = 0.0 #?"), Some((Some("gravity_nm"), "")));
        assert_eq!(asked("## ? which way is up"), Some((None, "which way is up")));
        assert_eq!(asked("name = \"# ? a \\\" # ?\""), None);
        assert_eq!(asked("name = '# ?' # plain"), None);
        assert_eq!(asked("name = '''\\'#?'''"), None);
        assert_eq!(asked("text = \"\"\"\nnot over # ?\n\"\"\""), None);
        assert_eq!(asked("gravity_nm = 0.0"), None);
    }

    #[test]
    fn a_question_stands_in_its_row() {
        let text = "a = 1\n\nb = 2 # ? how much\n";
        assert_eq!(questions(text), [(3, Some("b"), "how much")]);
    }
}
