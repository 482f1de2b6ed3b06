//! The effect library for readers: as JSON, on the terminal.

use super::terminal::{BOLD, DIM};
use crate::effects::{Effect, Family, HARMONICS, LIBRARY, Parameter, Role};
use serde_json::{Value, json};
use std::io::{self, Write};

/// All of them, as a list.
pub fn as_json() -> Value {
    LIBRARY.iter().map(|effect| one(*effect)).collect()
}

fn one(effect: &dyn Effect) -> Value {
    let about = effect.about();
    let parameter = |p: &Parameter| {
        let (low, high) = p.bounds;
        json!({ "name": p.name, "role": role(p.role), "low": low, "high": high })
    };
    json!({
        "id": about.id,
        "family": family(about.family),
        "means": about.means,
        "formula": about.formula,
        "source": about.source,
        "signature": about.signature.name(),
        "trades_with": about.trades_with,
        "acts_on": about.acts_on.name(),
        "of_time": about.of_time,
        "needs": about.needs.iter().map(|excitation| excitation.name()).collect::<Vec<_>>(),
        "by_hand": about.by_hand,
        "remedy": about.remedy,
        "example": format!("{}:{}", about.id, about.example),
        "parameters": about.parameters.iter().map(parameter).collect::<Vec<Value>>(),
    })
}

/// Writes each effect's name, meaning, formula and parameters to `out`.
pub fn write_list<W: Write>(out: &mut W) -> io::Result<()> {
    for effect in LIBRARY {
        let about = effect.about();
        writeln!(out, "{BOLD}{}{BOLD:#}  {DIM}{}{DIM:#}  {}", about.id, family(about.family), about.means)?;
        writeln!(out, "  {}", about.formula)?;
        writeln!(out, "  {}", about.parameters.iter().map(described).collect::<Vec<_>>().join(", "))?;
    }
    writeln!(
        out,
        "\nStrengths may be 0, and forms are where they are left out; h runs from 1 to {HARMONICS} in a ripple. q position, v speed, a acceleration of the joint, y at the winch."
    )
}

/// Its name, and what may be left out or between which values it must lie.
fn described(p: &Parameter) -> String {
    let (low, high) = p.bounds;
    match p.role {
        Role::Strength | Role::Form => p.name.to_string(),
        _ => match p.default {
            Some(default) => format!("{} ({low} to {high}, else {default})", p.name),
            None => format!("{} ({low} to {high})", p.name),
        },
    }
}

fn family(family: Family) -> &'static str {
    match family {
        Family::Physics => "of the joint",
        Family::Fault => "of the measurement",
        Family::Outside => "from outside",
    }
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Strength => "strength",
        Role::Shape => "shape",
        Role::Position => "position",
        Role::Level => "level",
        Role::Choice => "choice",
        Role::Form => "form",
    }
}
