//! Numbers of a rig's file put in place of others; everything else of it, comments included, stays as it is.

use crate::capture::rig::Rig;
use crate::problem::{Problem, Result};
use std::io::Write;
use std::path::Path;
use toml_edit::{DocumentMut, Item, Value};

/// Writes `numbers`, each a section, a key and what it is to be, into `file`, which holds `text`: all of them or none.
///
/// Errors: the file is no rig then, or cannot be written.
pub(super) fn rewrite(file: &Path, text: &str, numbers: &[(&str, &str, f64)]) -> Result<()> {
    let new = replaced(file, text, numbers)?;
    Rig::parse(file, &new)?;
    let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let written = tempfile::NamedTempFile::new_in(folder).and_then(|mut file_of_new| {
        file_of_new.write_all(new.as_bytes())?;
        if let Ok(old) = std::fs::metadata(file) {
            file_of_new.as_file().set_permissions(old.permissions())?;
        }
        file_of_new.as_file().sync_all()?;
        file_of_new.persist(file).map_err(|error| error.error)
    });
    match written {
        Ok(_) => Ok(()),
        Err(error) => Problem::unwritable(file, "cannot be written", &error).alone(),
    }
}

fn replaced(file: &Path, text: &str, numbers: &[(&str, &str, f64)]) -> Result<String> {
    let mut document: DocumentMut =
        text.parse().or_else(|error| Problem::error(file, format!("is no TOML: {error}"), "mend it first").alone())?;
    for (section, key, number) in numbers {
        let Some(table) = document.get_mut(section).and_then(Item::as_table_like_mut) else {
            let cure = format!("write `{key} = {number}` there");
            return Problem::error(file, format!("has no section [{section}]"), cure).alone();
        };
        // A whole number is written as one.
        let is_whole = number.fract() == 0.0 && number.abs() < 1e15;
        let mut value = if is_whole { Value::from(*number as i64) } else { Value::from(*number) };
        match table.get_mut(key).and_then(Item::as_value_mut) {
            Some(old) => {
                // What stands around it is the comment behind it.
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            None => {
                table.insert(key, Item::Value(value));
            }
        }
    }
    Ok(document.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::wire::RIG;

    #[test]
    fn all_but_the_numbers_stays_as_it_is() {
        let numbers = [("drive", "zero_counts", -4711.0), ("drive", "sign", -1.0), ("sensor", "nm_per_count", -1.5e-4)];
        let new = replaced(Path::new("rig.toml"), RIG, &numbers).unwrap();
        let changed: Vec<(&str, &str)> = RIG.lines().zip(new.lines()).filter(|(old, new)| old != new).collect();
        assert_eq!(RIG.lines().count(), new.lines().count());
        assert_eq!(
            changed.iter().map(|(_, new)| *new).collect::<Vec<_>>(),
            [
                "zero_counts = -4711                 # where the joint is at 0 rad",
                "sign = -1                        # -1 where counts grow as the joint goes down",
                "nm_per_count = -0.00015    # 10 V = 32,767 counts, 2 V for 1 N m",
            ]
        );
        let read = Rig::parse(Path::new("rig.toml"), &new).unwrap();
        assert_eq!((read.drive.zero_counts, read.drive.sign, read.sensor.nm_per_count), (-4711.0, -1.0, -1.5e-4));
        // The sensor's own zero is another line.
        assert_eq!(read.sensor.zero_counts, 0.0);
    }

    #[test]
    fn a_number_that_is_not_there_is_added_and_a_section_is_not() {
        let file = Path::new("rig.toml");
        let added = replaced(file, "[a]\nx = 1 # one\n\n[b]\ny = 2\n", &[("a", "z", 0.5)]).unwrap();
        assert_eq!(added, "[a]\nx = 1 # one\nz = 0.5\n\n[b]\ny = 2\n");
        assert!(replaced(file, "[b]\n", &[("a", "z", 0.5)]).unwrap_err().to_string().contains("[a]"));
        // Inline, dotted and with other line ends.
        let inline = replaced(file, "a = { x = 1 } # all\r\n", &[("a", "x", 2.0)]).unwrap();
        assert_eq!(inline.trim_end(), "a = { x = 2 } # all");
    }
}
