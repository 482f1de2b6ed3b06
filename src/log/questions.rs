//! `# ?` in `campaign.toml`: values that a draft holds the place of, for what no data can tell.

use crate::problem::Problem;
use std::path::Path;

/// The mark of a value that is still to be given.
pub const MARK: &str = "# ?";

/// A problem for each value of `file` that is still a question.
pub(super) fn open(file: &Path) -> Vec<Problem> {
    // A file that cannot be read was reported.
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let asked = text.lines().enumerate().filter_map(|(row, line)| Some((row, line, question(line)?)));
    asked
        .map(|(row, line, question)| {
            let key = line.split('=').next().unwrap_or_default().trim();
            let (what, cure) = match key.starts_with('#') || key.is_empty() {
                true => ("a question is open".to_string(), format!("answer it and delete this line: {question}")),
                false => (
                    "is still a question: the value only holds its place".to_string(),
                    format!("write the value and delete `{MARK}`: {question}"),
                ),
            };
            let problem = Problem::error(file, what, cure.trim_end_matches([':', ' '])).at_row(row as u64 + 1);
            if key.starts_with('#') || key.is_empty() { problem } else { problem.in_column(key) }
        })
        .collect()
}

/// What stands behind the mark in a line of TOML, if it has one outside of texts.
fn question(line: &str) -> Option<&str> {
    let mut quote = None;
    let mut is_escaped = false;
    for (at, sign) in line.char_indices() {
        match (quote, sign) {
            (Some('"'), '\\') if !is_escaped => {
                is_escaped = true;
                continue;
            }
            (Some(open), sign) if sign == open && !is_escaped => quote = None,
            (None, '"' | '\'') => quote = Some(sign),
            (None, '#') => {
                let comment = line[at..].trim_start_matches('#').trim_start();
                return comment.strip_prefix('?').map(str::trim);
            }
            _ => {}
        }
        is_escaped = false;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::question;

    #[test]
    fn the_mark_counts_outside_of_texts_alone() {
        assert_eq!(question("gravity_nm = 0.0 # ? torque at 90 deg"), Some("torque at 90 deg"));
        assert_eq!(question("gravity_nm = 0.0 #?"), Some(""));
        assert_eq!(question("name = \"# ? a \\\" # ?\""), None);
        assert_eq!(question("name = '# ?' # plain"), None);
        assert_eq!(question("gravity_nm = 0.0"), None);
    }
}
