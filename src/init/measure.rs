//! What a reading of 1 stands for: `deg`, `0.0879 deg`, `1/4096 turn`.

use crate::units::Unit;
use std::fmt;

/// A unit, and how many of it a reading of 1 is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Times a reading this is the value in `unit`.
    pub scale: f64,
    /// The unit.
    pub unit: Unit,
}

impl Measure {
    /// The measure that `text` names; `None` where it names none.
    pub fn written(text: &str) -> Option<Self> {
        let text = text.trim();
        if let Some(unit) = Unit::written(text) {
            return Some(unit.into());
        }
        let end = text.find(|sign: char| !(sign.is_ascii_digit() || ".,/eE+-".contains(sign)))?;
        let number = |text: &str| text.trim().replace(',', ".").parse::<f64>().ok();
        let scale = match text[..end].split_once('/') {
            Some((over, under)) => number(over)? / number(under)?,
            None => number(&text[..end])?,
        };
        let unit = Unit::written(text[end..].trim())?;
        (scale.is_finite() && scale != 0.0).then_some(Self { scale, unit })
    }

    /// A reading times this is the value in SI.
    pub fn factor(self) -> f64 {
        self.scale * self.unit.factor()
    }
}

impl From<Unit> for Measure {
    fn from(unit: Unit) -> Self {
        Self { scale: 1.0, unit }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.scale != 1.0 {
            write!(f, "{} ", self.scale)?;
        }
        f.write_str(self.unit.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_is_a_unit_or_a_number_of_them() {
        for (text, scale, unit) in [
            ("deg", 1.0, Unit::Degree),
            ("0,0879 deg", 0.0879, Unit::Degree),
            ("1/4096 turn", 1.0 / 4096.0, Unit::Turn),
            ("-1 rad", -1.0, Unit::Radian),
            ("1/min", 1.0, Unit::Rpm),
            ("2e-3Nm", 2e-3, Unit::NewtonMetre),
        ] {
            assert_eq!(Measure::written(text), Some(Measure { scale, unit }), "{text}");
        }
        for text in ["", "4096", "counts", "1/0 deg", "0 deg", "1/2/3 deg"] {
            assert_eq!(Measure::written(text), None, "{text}");
        }
    }
}
