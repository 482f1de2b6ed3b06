//! Text from a file, made harmless: what acts on a terminal or a page instead of being shown is written as its code.
//!
//! Names, paths and quoted values come from files that somebody else may have written. A control character in them can clear a
//! terminal or set its title, and makes XML ill-formed; a bidirectional override shows a text in another order than it has.

use std::borrow::Cow;

/// Whether `c` is not shown but acts: control characters, line and paragraph separators, marks of width zero, bidirectional
/// marks and overrides, tags, and the code points that are no characters in XML.
pub fn acts(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{fffe}' | '\u{ffff}' | '\u{e0000}'..='\u{e007f}')
}

/// `text` on one line, with every character that acts written as `\u{1b}`.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, acts)
}

/// The same for a `text` of several lines: line ends and tabs stay.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| acts(c) && !matches!(c, '\n' | '\t'))
}

/// Whether no character of `text` acts. Tables and pages are megabytes of ASCII: only what is not ASCII is decoded.
fn is_harmless(text: &str, acts: impl Fn(char) -> bool) -> bool {
    let plain: [bool; 256] = std::array::from_fn(|byte| byte < 128 && !acts(char::from(byte as u8)));
    let mut rest = text;
    while let Some(at) = rest.bytes().position(|byte| !plain[usize::from(byte)]) {
        // Only ASCII lies before it: a character begins there.
        let mut others = rest[at..].chars();
        if others.next().is_some_and(&acts) {
            return false;
        }
        rest = others.as_str();
    }
    true
}

fn escaped(text: &str, acts: impl Fn(char) -> bool) -> Cow<'_, str> {
    if is_harmless(text, &acts) {
        return Cow::Borrowed(text);
    }
    let one = |c: char| if acts(c) { c.escape_unicode().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(one).collect())
}

/// `text` of a terminal: the same as [`visible_lines`], but colours and weights (`ESC [ 1 m`) stay.
pub fn visible_styled(text: &str) -> Cow<'_, str> {
    if !text.contains('\u{1b}') {
        return visible_lines(text);
    }
    let mut parts = text.split('\u{1b}');
    let mut shown = visible_lines(parts.next().unwrap_or_default()).into_owned();
    for part in parts {
        let style = style_length(part);
        if style > 0 {
            shown.push('\u{1b}');
        } else {
            shown += "\\u{1b}";
        }
        shown += &part[..style];
        shown += &visible_lines(&part[style..]);
    }
    Cow::Owned(shown)
}

/// Length of the style that `text`, which follows an escape, begins with; 0 without one.
fn style_length(text: &str) -> usize {
    /// The longest that this program writes: bold and a colour.
    const LONGEST: usize = 8;
    let Some(rest) = text.strip_prefix('[') else { return 0 };
    let digits = rest.bytes().take_while(|b| b.is_ascii_digit() || *b == b';').count();
    if digits <= LONGEST && rest[digits..].starts_with('m') { digits + 2 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn sequences_are_shown_and_styles_stay() {
        assert_eq!(visible("a\u{1b}]0;title\u{7}b"), "a\\u{1b}]0;title\\u{7}b");
        assert_eq!(visible("right\u{202e}left\n"), "right\\u{202e}left\\u{a}");
        assert_eq!(visible_styled("\u{1b}[1m\u{1b}[33mbold\u{1b}[0m\n"), "\u{1b}[1m\u{1b}[33mbold\u{1b}[0m\n");
        assert_eq!(visible_styled("\u{1b}[2J\u{1b}c"), "\\u{1b}[2J\\u{1b}c");
        assert_eq!(visible("Größe 3 µN·m ✓ علم"), "Größe 3 µN·m ✓ علم");
    }

    proptest! {
        #[test]
        fn nothing_that_acts_is_left(text in any::<String>()) {
            prop_assert!(!visible(&text).contains(acts));
            prop_assert!(!visible_lines(&text).contains(|c| acts(c) && c != '\n' && c != '\t'));
            let styled = visible_styled(&text).into_owned();
            prop_assert_eq!(visible_styled(&styled), &*styled, "stable");
        }
    }
}
