//! Dates as numbers of days.

/// Days from 1970-01-01 to the day that `date` (ISO 8601, whatever follows the day) names, in the Gregorian calendar.
pub fn day(date: &str) -> Option<f64> {
    let mut parts = date.get(..10)?.split('-').map(str::parse::<i64>);
    let (year, month, of_month) = (parts.next()?.ok()?, parts.next()?.ok()?, parts.next()?.ok()?);
    // Years begin in March, so that the leap day is their last; then months before the m-th have (153 m + 2) / 5 days.
    let (year, m) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leaps = year / 4 - year / 100 + year / 400;
    // 719,468 days from 0000-03-01 to 1970-01-01.
    Some((365 * year + leaps + (153 * m + 2) / 5 + of_month - 1 - 719_468) as f64)
}

/// The date, ISO 8601, of the day `day` days after 1970-01-01.
pub fn date_of(day: f64) -> String {
    // Day of the 400 years (146,097 days) that began on a 1st of March, as in `day`.
    let days = day.floor() as i64 + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    // The last day of 4, 100 and 400 years is the leap day, or would be.
    let of_cycle = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * of_cycle + of_cycle / 4 - of_cycle / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let (year, month) =
        if month < 10 { (400 * era + of_cycle, month + 3) } else { (400 * era + of_cycle + 1, month - 9) };
    format!("{year:04}-{month:02}-{of_month:02}")
}

#[cfg(test)]
mod tests {
    use super::{date_of, day};

    #[test]
    fn dates_come_back() {
        for i in -200_000..200_000_i32 {
            let text = date_of(f64::from(i));
            assert_eq!(day(&text), Some(f64::from(i)), "{text}");
        }
    }

    #[test]
    fn days_are_counted_over_leap_years_and_centuries() {
        assert_eq!(day("1970-01-01"), Some(0.0));
        assert_eq!(day("2000-03-01T12:00:00"), Some(11_017.0));
        assert_eq!(day("2024-03-01").zip(day("2024-02-28")).map(|(b, a)| b - a), Some(2.0));
        assert_eq!(day("2100-03-01").zip(day("2100-02-28")).map(|(b, a)| b - a), Some(1.0));
        assert_eq!(day("spring"), None);
    }
}
