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

#[cfg(test)]
mod tests {
    use super::day;

    #[test]
    fn days_are_counted_over_leap_years_and_centuries() {
        assert_eq!(day("1970-01-01"), Some(0.0));
        assert_eq!(day("2000-03-01T12:00:00"), Some(11_017.0));
        assert_eq!(day("2024-03-01").zip(day("2024-02-28")).map(|(b, a)| b - a), Some(2.0));
        assert_eq!(day("2100-03-01").zip(day("2100-02-28")).map(|(b, a)| b - a), Some(1.0));
        assert_eq!(day("spring"), None);
    }
}
