//! Numbers as a reader wants them: few digits, and no more than are known.

/// `value` with `digits` significant digits; tiny and huge ones with an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return unknown(value);
    }
    if value == 0.0 {
        return "0".to_string();
    }
    // Rounded first: 9.996 with three digits is 10.0, not 10.00.
    let rounded: f64 = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    let power = rounded.abs().log10().floor() as i32;
    if !(-4..6).contains(&power) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    format!("{rounded:.*}", (digits as i32 - 1 - power).max(0) as usize)
}

/// `value` with as many decimals as an uncertainty of `spread` leaves meaning: two digits of the spread.
pub fn as_precise_as(value: f64, spread: f64) -> String {
    let usable = value.is_finite() && spread.is_finite() && spread != 0.0;
    if !usable {
        return significant(value, 4);
    }
    let power = spread.abs().log10().floor() as i32;
    if power < -6 || value.abs() >= 1e6 {
        return significant(value, 6);
    }
    let text = format!("{value:.*}", (1 - power).max(0) as usize);
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_string(),
        _ => text,
    }
}

/// "value ± spread", both to the spread's two digits; the value alone where the spread is not known.
pub fn with_spread(value: f64, spread: f64) -> String {
    match spread.is_finite() {
        true => format!("{} ± {}", as_precise_as(value, spread), as_precise_as(spread, spread)),
        false => significant(value, 4),
    }
}

/// An end of an interval this many values away says no more than its size.
const FAR: f64 = 20.0;

/// "low to high" about `value`, to two digits of the nearer end's distance; a word for an end that the data leave open.
pub fn interval(value: f64, low: f64, high: f64) -> String {
    if low.is_finite() && high.is_finite() && low.abs().max(high.abs()) > FAR * value.abs() {
        return format!("{} to {}", significant(low, 2), significant(high, 2));
    }
    let (below, above) = ((value - low).abs(), (high - value).abs());
    // An end that is much nearer, or at the value itself, does not determine the digits of the other.
    let digits_of = below.min(above).max(0.03 * below.max(above));
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("{} to {}", as_precise_as(low, digits_of), as_precise_as(high, digits_of)),
        (true, false) => format!("above {}", significant(low, 3)),
        (false, true) => format!("below {}", significant(high, 3)),
        (false, false) => "open".to_string(),
    }
}

/// A share as percent.
pub fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", significant(100.0 * share, 2)) } else { "unknown".to_string() }
}

/// R² with the digits that tell a good fit from a very good one.
pub fn r_squared(value: f64) -> String {
    if value.is_finite() { format!("{value:.4}") } else { "unknown".to_string() }
}

/// `text` with a true minus sign for a leading hyphen: for drawings, which nobody copies numbers from.
pub fn with_minus(text: &str) -> String {
    text.strip_prefix('-').map_or_else(|| text.to_string(), |rest| format!("\u{2212}{rest}"))
}

/// A whole number in groups of three.
pub fn count(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// "1 trial", "3 trials".
pub fn counted(number: usize, one: &str, many: &str) -> String {
    format!("{} {}", count(number), if number == 1 { one } else { many })
}

fn unknown(value: f64) -> String {
    match value {
        v if v.is_nan() => "unknown".to_string(),
        v if v > 0.0 => "∞".to_string(),
        _ => "-∞".to_string(),
    }
}
