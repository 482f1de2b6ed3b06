//! Each effect's hooks as code. A test holds every effect of the library, as C and as Rust, against what the model foretells.

use super::code::{Code, number};
use crate::effects::Added;
use std::f64::consts::{PI, TAU};

/// What an effect adds, as expressions over `q`, `v`, `a` (position, speed, acceleration), `t` and `elapsed` (since the trial
/// and the campaign began), `load` at the winch and `y`.
#[derive(Debug, Default)]
pub struct Hooks {
    /// At the joint, N m.
    pub joint_nm: Option<String>,
    /// To each branch of friction, N m at the winch.
    pub friction_nm: Option<[String; 2]>,
    /// Multiplies friction.
    pub factor: Option<String>,
    /// To y, N m.
    pub winch_nm: Option<String>,
    /// How far the joint is behind, rad, under `joint_nm` and `pull` at the joint.
    pub lag_rad: Option<String>,
    /// What the sensor makes of `y`.
    pub reading_nm: Option<String>,
}

/// The hooks of `added` that act before friction is known; lines that they need go to `code`.
pub fn hooks(added: &Added, code: &mut Code) -> Hooks {
    let p: Vec<String> = added.parameters.iter().map(|x| number(*x)).collect();
    let at = |index: usize| p.get(index).cloned().unwrap_or_else(|| number(0.0));
    let (p0, p1, p2, p3) = (at(0), at(1), at(2), at(3));
    let value = |index: usize| added.parameters.get(index).copied().unwrap_or(0.0);
    let none = Hooks::default();
    let sides = |name: &str| Some([name.to_string(), format!("-{name}")]);
    match added.id() {
        "stribeck" => {
            let decay = code.keep("decay", &format!("exp(-pow(fabs(v) / {p2}, {p3}))"));
            Hooks { friction_nm: Some([format!("{p0} * {decay}"), format!("-{p1} * {decay}")]), ..none }
        }
        "load_dependent_friction" => {
            Hooks { friction_nm: Some([format!("{p0} * fabs(load)"), format!("-{p1} * fabs(load)")]), ..none }
        }
        "quadratic_viscous" => Hooks { friction_nm: Some([format!("{p0} * v * v"), format!("-{p1} * v * v")]), ..none },
        "friction_ripple" => Hooks { friction_nm: sides(&ripple(added, code)), ..none },
        "torque_ripple" => Hooks { winch_nm: Some(ripple(added, code)), ..none },
        "cable_elasticity" => {
            let load = if value(0) > 0.5 { "pull" } else { "joint_nm" };
            Hooks { lag_rad: Some(format!("{p1} * {load}")), ..none }
        }
        "sensor_bias" => Hooks { reading_nm: Some(format!("y + {p0}")), ..none },
        "sensor_gain" => Hooks { reading_nm: Some(format!("(1.0 + {p0}) * y")), ..none },
        "saturation" => Hooks { reading_nm: Some(format!("fmax(fmin(y, {p1}), {p0})")), ..none },
        "sensor_drift" => Hooks { reading_nm: Some(drift(added, code)), ..none },
        "gravity_phase" => Hooks { joint_nm: Some(format!("{p0} * cos(q)")), ..none },
        "inertia" => Hooks { joint_nm: Some(format!("{p0} * a")), ..none },
        "elastic_spring" => Hooks { joint_nm: Some(format!("{p0} * q + {p1}")), ..none },
        "end_stop" => {
            let depth = code.keep("depth", &format!("fmax({p0} * (q - {p2}), 0.0)"));
            let pushed = format!("{p0} * {p1} * pow({depth}, {p3})");
            Hooks { joint_nm: Some(code.choice(&format!("{depth} > 0.0"), &pushed, "0.0")), ..none }
        }
        "warm_up" => {
            let clock = clock(value(0));
            let cold = code.keep("cold", &format!("exp(-pow(fmax({clock}, 0.0) / {}, {}))", at(4), at(5)));
            let more = code.keep("more", &format!("({p2} + {p3} * fabs(v)) * {cold}"));
            Hooks { factor: Some(format!("1.0 + {p1} * {cold}")), friction_nm: sides(&more), ..none }
        }
        "contact" => {
            let share = code.keep("share", &format!("(elapsed - {p1}) / {p2}"));
            let sine = code.keep("sine", &format!("sin({} * {share})", number(PI)));
            let burst = format!("{p0} * {sine} * {sine}");
            let within = format!("{share} >= 0.0 && {share} <= 1.0");
            Hooks { winch_nm: Some(code.choice(&within, &burst, "0.0")), ..none }
        }
        "joint_coupling" => Hooks { winch_nm: Some(coupling(added, code)), ..none },
        // The change-over after reversals, presliding and the delay have memory: the controller's own.
        _ => none,
    }
}

/// Whether `added` is one that the controller carries out by itself, with memory.
pub fn has_memory(added: &Added) -> bool {
    matches!(added.id(), "reversal_transition" | "presliding" | "time_delay")
}

fn clock(restarts: f64) -> &'static str {
    if restarts > 0.5 { "t" } else { "elapsed" }
}

/// The sum of harmonics, each angle the one before turned on by the fundamental.
fn ripple(added: &Added, code: &mut Code) -> String {
    let strengths = &added.parameters[1..];
    let harmonics = strengths.chunks_exact(2).rposition(|pair| pair != [0.0, 0.0]).map_or(0, |last| last + 1);
    if harmonics == 0 {
        return number(0.0);
    }
    let angle = code.keep("angle", &format!("{} * {} * q", number(TAU), number(added.parameters[0])));
    let (sine, cosine) = (code.keep("sine", &format!("sin({angle})")), code.keep("cosine", &format!("cos({angle})")));
    let (mut s, mut c) = (sine.clone(), cosine.clone());
    let mut sum = number(0.0);
    for (at, pair) in strengths.chunks_exact(2).take(harmonics).enumerate() {
        sum = code.keep("ripple", &format!("{sum} + ({} * {s} + {} * {c})", number(pair[0]), number(pair[1])));
        if at + 1 < harmonics {
            let turned = [format!("{s} * {cosine} + {c} * {sine}"), format!("{c} * {cosine} - {s} * {sine}")];
            [s, c] = turned.map(|turned| code.keep("turned", &turned));
        }
    }
    sum
}

fn drift(added: &Added, code: &mut Code) -> String {
    let p = &added.parameters;
    let clock = clock(p[0]);
    let share = code.keep("share", &format!("{clock} / {}", number(p[1])));
    let first = code.keep("wave", &format!("cos({} * {share})", number(PI)));
    let (mut before, mut now, mut sum) = (number(1.0), first.clone(), number(0.0));
    for (at, wave_nm) in p[5..].iter().enumerate() {
        if at > 0 {
            let next = code.keep("wave", &format!("2.0 * {first} * {now} - {before}"));
            (before, now) = (now, next);
        }
        sum = code.keep("drift", &format!("{sum} + {} * {now}", number(*wave_nm)));
    }
    let settles = format!("{} * exp(-{clock} / {})", number(p[3]), number(p[2]));
    format!("y + {settles} + {} * {share} + {sum}", number(p[4]))
}

fn coupling(added: &Added, code: &mut Code) -> String {
    /// Below this the other joint rests, rad/s: as in the effect itself.
    const RESTING_RAD_S: f64 = 0.01;
    let p: Vec<String> = added.parameters.iter().map(|x| number(*x)).collect();
    let other = (added.parameters[0] as usize).saturating_sub(1);
    let field = |code: &Code, name: &str| code.of_sample(&format!("others[{other}].{name}"));
    let [q2, v2, a2] =
        ["position_rad", "velocity_rad_s", "acceleration_rad_s2"].map(|name| code.keep("other", &field(code, name)));
    let rest = number(RESTING_RAD_S);
    let rigid = format!(
        "{} * {q2} + {} * {v2} + {} * tanh({v2} / {rest}) + {} * {a2} + {} * (sin(q + {q2}) - sin(q))",
        p[1], p[2], p[3], p[4], p[5]
    );
    code.keep("coupled", &format!("{rigid} + {} * cos(q) * {a2} + {} * {q2} * {q2} + {}", p[6], p[7], p[8]))
}
