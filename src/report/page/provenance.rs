//! Where a page comes from: date, command, version, commit, machine, and the files that went in with their digests.

use super::digest::sha256;
use crate::problem::visible;
use crate::report::output::Output;
use std::time::{SystemTime, UNIX_EPOCH};

/// The commit that the program was built from, where the build was told (`TAUTLINE_COMMIT`).
const COMMIT: Option<&str> = option_env!("TAUTLINE_COMMIT");
/// Hexadecimal digits of a digest that are shown: enough to tell files apart.
const DIGITS: usize = 16;
/// Seconds of a day.
const DAY_S: u64 = 86_400;

/// Name and value of each.
pub fn rows(output: &Output) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("date", date(now_s())),
        ("command", command()),
        ("tautline", env!("CARGO_PKG_VERSION").to_string()),
        ("commit", COMMIT.unwrap_or("not recorded by the build").to_string()),
        ("machine", machine()),
    ];
    rows.extend(output.sources().into_iter().map(|(name, path)| {
        let digest = std::fs::read(&path).map_or_else(
            |error| format!("cannot be read any more: {error}"),
            |bytes| format!("SHA-256 {}…", &sha256(&bytes).in_hex()[..DIGITS]),
        );
        (name, format!("{} ({digest})", visible(&path.to_string_lossy())))
    }));
    rows
}

/// Seconds since 1970, or what `SOURCE_DATE_EPOCH` says: then the same input gives the same bytes.
fn now_s() -> u64 {
    let said = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok());
    said.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()))
}

/// Year, month, day and time of `epoch_s` in UTC. After Howard Hinnant's civil-from-days: years that begin in March.
fn date(epoch_s: u64) -> String {
    let (days, rest_s) = (epoch_s / DAY_S + 719_468, epoch_s % DAY_S);
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let day_of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02} {:02}:{:02} UTC", rest_s / 3600, rest_s % 3600 / 60)
}

/// The command line as it was typed, its program by its name.
fn command() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| {
        let text = visible(&argument.to_string_lossy()).into_owned();
        if text.contains(char::is_whitespace) { format!("'{text}'") } else { text }
    });
    std::iter::once("tautline".to_string()).chain(arguments).collect::<Vec<_>>().join(" ")
}

fn machine() -> String {
    let name =
        ["/proc/sys/kernel/hostname", "/etc/hostname"].iter().find_map(|path| std::fs::read_to_string(path).ok());
    let name = name.or_else(|| std::env::var("COMPUTERNAME").ok()).unwrap_or_default();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{} {} {}, {threads} threads", visible(name.trim()), std::env::consts::OS, std::env::consts::ARCH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        // As `date -u -d @N` gives them.
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_827_696), "2000-02-29 12:34 UTC");
        assert_eq!(date(4_107_542_400), "2100-03-01 00:00 UTC");
    }
}
