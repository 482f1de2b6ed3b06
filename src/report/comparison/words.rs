//! What changed, in a sentence.

use crate::compare::{Cause, CauseKind, Comparison, FunctionKind, Measure, Verdict};
use crate::model::{Direction, loss};
use crate::report::number::{counted, significant};
use crate::report::wording::{Units, moving};

/// The change of `cause` and its interval as shares of the value before; `None` where that is zero.
pub(super) fn relative(cause: &Cause) -> Option<[f64; 3]> {
    let ends = [cause.change, cause.low, cause.high];
    match cause.measure {
        Measure::Share | Measure::Load { .. } => Some(ends),
        Measure::Torque { before_nm } => (before_nm > 0.0).then(|| ends.map(|end| end / before_nm)),
        Measure::Angle => None,
    }
}

pub(super) fn in_torque(cause: &Cause) -> bool {
    matches!(cause.measure, Measure::Torque { .. })
}

fn of_what(kind: CauseKind, direction: Option<Direction>) -> String {
    let where_to = direction.map_or(String::new(), |direction| format!(" moving {}", direction.name()));
    format!("{}{where_to}", kind.words())
}

/// One cause with its size, in a technician's words.
pub fn told_cause(cause: &Cause, units: &Units) -> String {
    let percent = |ends: [f64; 3]| {
        let [change, low, high] = ends.map(|end| 100.0 * end);
        format!("{change:+.1} % [{low:.1}, {high:.1}]")
    };
    let speed = match cause.kind {
        CauseKind::Viscous => " at the fastest speed",
        CauseKind::Stribeck => " at the slowest speed",
        _ => "",
    };
    // Friction opposes the motion: moving down it is negative at the sensor.
    let sign = cause.direction.filter(|_| in_torque(cause)).map_or(1.0, Direction::sign);
    let size = match (cause.measure, relative(cause)) {
        (Measure::Angle, _) => {
            let [change, low, high] = [cause.change, cause.low, cause.high].map(f64::to_degrees);
            format!("{change:+.2} deg [{low:.2}, {high:.2}]")
        }
        (Measure::Share, Some(ends)) => percent(ends),
        (Measure::Load { mu_c }, Some(ends)) => {
            let [after, low, high] = ends.map(|share| significant(1.0 - loss(mu_c) / (1.0 + share), 3));
            format!(
                "{} of A and B(v), as from mu_c = {} to {after} [{low}, {high}]",
                percent(ends),
                significant(mu_c, 3)
            )
        }
        (_, ends) => {
            let share = ends.map_or(String::new(), |[change, low, high]| {
                let (low, high) = if sign < 0.0 { (-high, -low) } else { (low, high) };
                format!(", {} of the friction before", percent([sign * change, low, high]))
            });
            format!("{}{speed}{share}", units.torque(cause.change.abs()))
        }
    };
    let rivals: Vec<String> = cause.rivals.iter().map(|(kind, direction)| of_what(*kind, *direction)).collect();
    let or = match rivals.is_empty() {
        true => String::new(),
        false => format!(" (these data cannot tell it from {})", rivals.join(" or ")),
    };
    let changed = match (in_torque(cause), sign * cause.change > 0.0) {
        (false, _) => "changed",
        (true, true) => "rose",
        (true, false) => "fell",
    };
    format!("{} {changed} by {size}{or}", of_what(cause.kind, cause.direction))
}

/// What changed, decided on A and B(v) where both models have them.
fn told(found: &Comparison, units: &Units) -> String {
    let changed: Vec<&str> =
        found.changes.iter().filter(|c| c.verdict == Verdict::Changed).map(|c| c.name.as_str()).collect();
    let causes: Vec<String> = found.attribution.causes.iter().map(|cause| told_cause(cause, units)).collect();
    let parameters = match changed.len() {
        0 => "no single parameter changed beyond its interval".to_string(),
        n => format!(
            "{} changed beyond {}: {}",
            counted(n, "parameter", "parameters"),
            if n == 1 { "its interval" } else { "their intervals" },
            changed.join(", ")
        ),
    };
    match (found.attribution.is_known(), causes.is_empty(), open(found)) {
        (true, false, open) => {
            let open = open.map_or(String::new(), |open| format!("; {open}"));
            format!("{}{open}; {parameters}", causes.join("; "))
        }
        (true, true, _) if found.attribution.differs() => {
            format!("A and B(v) changed beyond their intervals, but no single cause explains how; {parameters}")
        }
        (true, true, Some(open)) => format!(
            "A and B(v) agree within their intervals where both models have them, but {open}, so whether the prediction's change is real is \
             not known; {parameters}"
        ),
        (true, true, None) if found.effect.rms_nm > found.effect.explained_nm => format!(
            "A and B(v) agree within their intervals at the speeds that both models cover, but the intervals account for only {} of the \
             prediction's change: the rest lies below those speeds or after reversals, and whether it is real is not known; {parameters}",
            units.torque(found.effect.explained_nm)
        ),
        (true, true, None) => format!(
            "A and B(v) agree within their intervals, which account for up to {} of the prediction's change; {parameters}",
            units.torque(found.effect.explained_nm)
        ),
        (false, ..) => {
            format!(
                "{parameters}; the models hold no intervals of A and B(v), so whether the prediction's change is real is not known"
            )
        }
    }
}

/// The functions that one of the models does not determine, in words; `None` where both determine all.
fn open(found: &Comparison) -> Option<String> {
    let name = |(kind, direction): &(FunctionKind, Direction)| format!("{} {}", kind.words(), moving(*direction));
    let names: Vec<String> = found.unknown.iter().map(name).collect();
    (!names.is_empty()).then(|| format!("one of the models does not determine {}", names.join(", ")))
}

pub(super) fn sentence(found: &Comparison, units: &Units) -> String {
    let mut told = told(found, units);
    let (a, b) = (found.before.combination.name(), found.after.combination.name());
    let curve = if a == b {
        String::new()
    } else {
        format!("; the form of the change-over curve differs, {a} before and {b} after")
    };
    let share = if found.load_is_missing() { " (friction alone: gravity and inertia are the chain's)" } else { "" };
    told[..1].make_ascii_uppercase();
    format!(
        "{told}{curve}. Along the paper's cosine cascade the prediction changes by {} RMS, {} at most{share}.",
        units.torque(found.effect.rms_nm),
        units.torque(found.effect.peak_nm)
    )
}
