//! Fitted parameters as a reader wants them: their units read off their names, before and after, ripples by their amplitudes.

use crate::diagnose::{Candidate, Cause, Diagnosis, Fitted};
use crate::dynamics::{JointKind, Payload};
use crate::model::{Combination, Direction, Model, Term};
use crate::report::number::{as_precise_as, interval, significant};
use crate::report::wording::Units;

/// Endings of names and the units that they stand for, longer ones first.
const ENDINGS: [(&str, &str); 16] = [
    ("_nm_s2_rad2", "N m s²/rad²"),
    ("_nm_s_rad", "N m s/rad"),
    ("_nm_rad2", "N m/rad²"),
    ("_nm_rad", "N m/rad"),
    ("_rad_nm", "rad/(N m)"),
    ("_kg_m2", "kg m²"),
    ("_kg_m", "kg m"),
    ("_kg", "kg"),
    ("_per_rad", "1/rad"),
    ("_rad_s", "rad/s"),
    ("_nm", "N m"),
    ("_rad", "rad"),
    ("_hz", "Hz"),
    ("_deg", "deg"),
    ("_m", "m"),
    ("_s", "s"),
];

/// One parameter to be shown, in the unit that suits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Its name, without the unit.
    pub name: String,
    /// The unit of the numbers; empty without.
    pub unit: String,
    /// Its value in the model as delivered; `None` where that has none.
    pub before: Option<String>,
    /// Fitted.
    pub value: String,
    /// The 95 % interval, "low, high"; empty where none is known.
    pub interval: String,
    /// Warnings.
    pub doubt: Option<&'static str>,
}

impl Shown {
    /// "backlash 0.81 mm [0.79, 0.84]", "friction.up.a_j 37.5 -> 42.1 N [41, 43], at its bound".
    pub fn sentence(&self) -> String {
        let before = self.before.as_ref().map_or(String::new(), |x| format!("{x} -> "));
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let range = if self.interval.is_empty() { String::new() } else { format!(" [{}]", self.interval) };
        let doubt = self.doubt.map_or(String::new(), |doubt| format!(", {doubt}"));
        format!("{} {before}{}{unit}{range}{doubt}", self.name, self.value)
    }
}

/// The parameters of `candidate`: a ripple's by its period and the amplitudes of harmonics that differ significantly from zero; without
/// parameters that are zero before and after.
pub fn shown(candidate: &Candidate, found: &Diagnosis) -> Vec<Shown> {
    let units = Units::of(&found.before.joint);
    let stale = matches!(candidate.cause, Cause::Stale(_));
    let before = |name: &str| if stale { of_model(&found.before, name) } else { None };
    let harmonics = amplitudes(&candidate.parameters);
    let is_own = |p: &&Fitted| harmonics.is_empty() || !(p.name.starts_with("sin_") || p.name.starts_with("cos_"));
    let is_nothing = |p: &Fitted| p.value == 0.0 && before(&p.name) == Some(0.0);
    let own = candidate.parameters.iter().filter(is_own).filter(|p| !is_nothing(p)).map(|p| match &p.name[..] {
        "periods_per_rad" => one(&period(p), None, &units),
        name => one(p, before(name), &units),
    });
    own.chain(harmonics.iter().map(|p| one(p, None, &units))).collect()
}

fn one(fitted: &Fitted, before: Option<f64>, units: &Units) -> Shown {
    let (name, unit) = split(&fitted.name);
    let size = fitted.value.abs().max(before.unwrap_or(0.0).abs());
    let (unit, factor) = suited(unit, size, units);
    let value = factor * fitted.value;
    let ends = fitted.interval.map(|(low, high)| (factor * low, factor * high));
    let half = ends.map_or(f64::NAN, |(low, high)| (high - low) / 2.0);
    let precise = |value: f64| match ends {
        // A choice among whole numbers.
        None if value.fract() == 0.0 => format!("{value:.0}"),
        Some(_) if half > 0.0 && half < value.abs() => as_precise_as(value, half),
        _ => significant(value, 3),
    };
    Shown {
        name: name.to_string(),
        unit,
        before: before.map(|x| precise(factor * x)),
        value: precise(value),
        interval: ends.map_or(String::new(), |(low, high)| interval(value, low, high).replace(" to ", ", ")),
        doubt: fitted.doubt,
    }
}

/// The unit that a parameter's name tells; empty where it has none.
pub fn unit_of(name: &str) -> &'static str {
    split(name).1
}

/// A name without its unit, and the unit.
fn split(name: &str) -> (&str, &'static str) {
    let ending = ENDINGS.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit)));
    ending.filter(|(rest, _)| !rest.is_empty()).unwrap_or((name, friction_unit(name)))
}

/// The unit of a parameter of friction, which its name does not tell.
fn friction_unit(name: &str) -> &'static str {
    let last = name.strip_prefix("friction.").and_then(|rest| rest.split_once('.'));
    last.and_then(|(_, last)| Term::find(last)).map_or("", |term| term.unit(JointKind::Revolute))
}

/// The unit in which a value of this `size` reads well, and the factor to it.
fn suited(unit: &'static str, size: f64, units: &Units) -> (String, f64) {
    let slides = units.torque == "N";
    let (unit, factor) = match unit {
        "N m" => units.torque_scale(size),
        "rad" => (units.position, units.position_factor),
        "m" => ("mm", 1e3),
        "s" if size < 0.1 => ("ms", 1e3),
        unit => (unit, 1.0),
    };
    // The `_nm` and `_rad` of a joint that slides hold N and m.
    (if slides && factor == 1.0 { unit.replace("N m", "N").replace("rad", "m") } else { unit.to_string() }, factor)
}

/// A wave number as the period that people measure.
fn period(periods_per_rad: &Fitted) -> Fitted {
    let of = |periods: f64| 1.0 / periods.max(f64::MIN_POSITIVE);
    Fitted {
        name: "period_rad".to_string(),
        value: of(periods_per_rad.value),
        interval: periods_per_rad.interval.map(|(low, high)| (of(high), of(low))),
        doubt: periods_per_rad.doubt,
    }
}

/// Amplitudes of `sin_h`, `cos_h` pairs, their intervals by the pair's own as if independent; the first, and others above zero.
fn amplitudes(parameters: &[Fitted]) -> Vec<Fitted> {
    let named = |name: String| parameters.iter().find(|p| p.name == name);
    let pairs = (1..).map_while(|h| Some((h, named(format!("sin_{h}_nm"))?, named(format!("cos_{h}_nm"))?)));
    let amplitude = |(h, sin, cos): (i32, &Fitted, &Fitted)| {
        let value = sin.value.hypot(cos.value);
        let half = |p: &Fitted| p.interval.map_or(0.0, |(low, high)| (high - low) / 2.0);
        let spread = (sin.value * half(sin)).hypot(cos.value * half(cos)) / value.max(f64::MIN_POSITIVE);
        Fitted {
            name: format!("harmonic {h}_nm"),
            value,
            interval: (spread > 0.0).then_some(((value - spread).max(0.0), value + spread)),
            doubt: sin.doubt.or(cos.doubt),
        }
    };
    let told = |(at, p): &(usize, Fitted)| *at == 0 || p.interval.is_none_or(|(low, _)| low > 0.0);
    pairs.map(amplitude).enumerate().filter(told).map(|(_, p)| p).collect()
}

/// The value with a dotted name in `model`.
pub fn of_model(model: &Model, name: &str) -> Option<f64> {
    match name {
        "dynamics.gravity_nm" => Some(model.dynamics.gravity_nm),
        "dynamics.inertia_kg_m2" => Some(model.dynamics.inertia_kg_m2),
        "joint.backlash_m" => Some(model.joint.backlash_m),
        "combination.p" | "combination.n" => match model.combination {
            Combination::Arctan { p, .. } => Some(p),
            Combination::Power { n } => Some(n),
            Combination::Sign | Combination::Linear => None,
        },
        _ => {
            if let Some(name) = name.strip_prefix("dynamics.payload.") {
                let at = Payload::<f64>::NAMES.iter().position(|known| *known == name)?;
                return Some(model.dynamics.payload.numbers()[at]);
            }
            let (direction, last) = name.strip_prefix("friction.")?.split_once('.')?;
            let direction = Direction::BOTH.into_iter().find(|d| d.name() == direction)?;
            Some(model.friction.of(direction)[Term::find(last)?])
        }
    }
}
