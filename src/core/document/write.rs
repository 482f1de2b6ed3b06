//! TOML in an order of keys that reads well.

use std::fmt::Write;
use toml::Value;

/// Adds a `heading` (empty, or `\n[table]\n`) and a line for each pair to `text`. Every value goes through the `toml` crate, so
/// that names are escaped and numbers survive.
pub fn write_pairs(text: &mut String, heading: &str, pairs: &[(&str, Value)]) {
    text.push_str(heading);
    for (key, value) in pairs {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    }
}
