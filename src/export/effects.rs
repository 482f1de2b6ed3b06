//! Each effect's hooks as code. A test holds every effect of the library, as C and as Rust, against what the model foretells.

use super::code::{Code, number};
use crate::effects::{Added, HARMONICS, RESTING_RAD_S};
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

/// The parameters of `added` by name, as numbers of the code.
struct Named<'a>(&'a Added);

impl Named<'_> {
    fn value(&self, name: &str) -> f64 {
        self.0.named().find(|(parameter, _)| parameter.name == name).map_or(0.0, |(_, value)| value)
    }

    fn text(&self, name: &str) -> String {
        number(self.value(name))
    }

    /// Time on the clock that the effect goes by.
    fn clock(&self) -> &'static str {
        if self.value("restarts") > 0.5 { "t" } else { "elapsed" }
    }
}

/// The hooks of `added` that act without memory; lines that they need go to `code`.
pub fn hooks(added: &Added, code: &mut Code) -> Hooks {
    let named = Named(added);
    let of = |name: &str| named.text(name);
    let none = Hooks::default();
    let both = |up: &str, down: &str| Some(borne_by_both(&named, up, down));
    match added.id() {
        "stribeck" => {
            let fall = format!("exp(-pow(fabs(v) / {}, {}))", of("speed_rad_s"), of("exponent"));
            let decay = code.keep("decay", &fall);
            Hooks { friction_nm: both(&decay, &decay), ..none }
        }
        "load_dependent_friction" => {
            let [up, down] = ["own_up", "own_down"].map(|own| borne(&named, own));
            Hooks { friction_nm: both(&up, &down), ..none }
        }
        "quadratic_viscous" => drag(&named, code),
        "friction_ripple" => {
            let (always, share) = ripple(added, code);
            let side = |sign: &str, own: &str| format!("{sign}{always} + {share} * {own}");
            Hooks { friction_nm: Some([side("", "own_up"), side("-", "own_down")]), ..none }
        }
        "torque_ripple" => {
            let (always, by_load) = ripple(added, code);
            Hooks { winch_nm: Some(format!("{always} + {by_load} * load")), ..none }
        }
        "cable_elasticity" => {
            let load = if named.value("with_friction") > 0.5 { "pull" } else { "joint_nm" };
            Hooks { lag_rad: Some(format!("{} * {load}", of("compliance_rad_nm"))), ..none }
        }
        "sensor_bias" => Hooks { reading_nm: Some(format!("y + {}", of("bias_nm"))), ..none },
        "sensor_gain" => Hooks { reading_nm: Some(format!("(1.0 + {}) * y", of("error"))), ..none },
        "saturation" => {
            Hooks { reading_nm: Some(format!("fmax(fmin(y, {}), {})", of("high_nm"), of("low_nm"))), ..none }
        }
        "sensor_drift" => Hooks { reading_nm: Some(drift(&named, code)), ..none },
        "gravity_phase" => {
            let (cos_nm, of_nm) = (named.value("cos_nm"), named.value("of_nm"));
            let less = number((of_nm * of_nm - cos_nm * cos_nm).max(0.0).sqrt() - of_nm);
            Hooks { joint_nm: Some(format!("{} * cos(q) + {less} * sin(q)", number(cos_nm))), ..none }
        }
        "inertia" => Hooks { joint_nm: Some(format!("{} * a", of("inertia_kg_m2"))), ..none },
        "elastic_spring" => {
            let beyond = code.keep("beyond", &format!("q - {}", of("centre_rad")));
            let cube = format!("{} * {beyond} * {beyond} * {beyond}", of("cubic_nm_rad3"));
            Hooks { joint_nm: Some(format!("{} * q + {} + {cube}", of("stiffness_nm_rad"), of("preload_nm"))), ..none }
        }
        "end_stop" => stop(&named, code),
        "warm_up" => warmth(&named, code),
        "contact" => touch(&named, code),
        "joint_coupling" => Hooks { winch_nm: Some(coupling(&named, code)), ..none },
        // The change-over after reversals, presliding and the delay have memory: the controller's own.
        _ => none,
    }
}

/// Drag beyond linear: on the branches, or by speed alone.
fn drag(named: &Named<'_>, code: &mut Code) -> Hooks {
    let of = |name: &str| named.text(name);
    let power = code.keep("power", &format!("pow(fabs(v), {})", of("exponent")));
    match named.value("by_speed") > 0.5 {
        true => {
            let [up, down] = [of_up(named), of_down(named)].map(|size| format!("{size} * {power}"));
            Hooks { winch_nm: Some(code.choice("v > 0.0", &up, &format!("-{down}"))), ..Hooks::default() }
        }
        false => Hooks { friction_nm: Some(borne_by_both(named, &power, &power)), ..Hooks::default() },
    }
}

/// A stop, which gives back less than it took.
fn stop(named: &Named<'_>, code: &mut Code) -> Hooks {
    let of = |name: &str| named.text(name);
    let side = of("side");
    let depth = code.keep("depth", &format!("fmax({side} * (q - {}), 0.0)", of("position_rad")));
    let stiffness =
        format!("({side} * {} + tanh(v / {}) * {})", of("stiffness_nm"), number(RESTING_RAD_S), of("loss_nm"));
    let pushed = format!("{stiffness} * pow({depth}, {})", of("exponent"));
    Hooks { joint_nm: Some(code.choice(&format!("{depth} > 0.0"), &pushed, "0.0")), ..Hooks::default() }
}

/// Friction that falls as the joint warms up.
fn warmth(named: &Named<'_>, code: &mut Code) -> Hooks {
    let of = |name: &str| named.text(name);
    let share = format!("fmax({}, 0.0) / {}", named.clock(), of("time_constant_s"));
    let cold = match named.value("long_tail") > 0.5 {
        true => format!("pow(1.0 + {share}, -{})", of("exponent")),
        false => format!("exp(-pow({share}, {}))", of("exponent")),
    };
    let cold = code.keep("cold", &cold);
    let more = code.keep("more", &format!("({} + {} * fabs(v)) * {cold}", of("cold_nm"), of("cold_nm_s_rad")));
    Hooks {
        factor: Some(format!("1.0 + {} * {cold}", of("cold_share"))),
        friction_nm: Some([more.clone(), format!("-{more}")]),
        ..Hooks::default()
    }
}

/// A burst from outside.
fn touch(named: &Named<'_>, code: &mut Code) -> Hooks {
    let of = |name: &str| named.text(name);
    let share = code.keep("share", &format!("(elapsed - {}) / {}", of("start_s"), of("length_s")));
    let sine = code.keep("sine", &format!("sin({} * {share})", number(PI)));
    let burst = format!("{} * {sine} * {sine}", of("peak_nm"));
    let within = format!("{share} >= 0.0 && {share} <= 1.0");
    Hooks { winch_nm: Some(code.choice(&within, &burst, "0.0")), ..Hooks::default() }
}

/// The strengths of both branches on what each bears.
fn borne_by_both(named: &Named<'_>, up: &str, down: &str) -> [String; 2] {
    [format!("{} * {up}", of_up(named)), format!("-{} * {down}", of_down(named))]
}

/// The strength of a branch, however its unit is written.
fn of_up(named: &Named<'_>) -> String {
    number(["up", "up_nm", "up_nm_s2_rad2"].iter().map(|name| named.value(name)).sum())
}

fn of_down(named: &Named<'_>) -> String {
    number(["down", "down_nm", "down_nm_s2_rad2"].iter().map(|name| named.value(name)).sum())
}

/// What a branch of `load_dependent_friction` bears, its own friction kept as `own`.
fn borne(named: &Named<'_>, own: &str) -> String {
    let (of_tension, before) = (named.text("of_tension"), named.text("pretension_nm"));
    let tension = format!("hypot(load + {of_tension} * {own}, {before})");
    match named.value("levels_off_nm") {
        level if level > 0.0 => format!("({tension} / (1.0 + {tension} / {}))", number(level)),
        _ => tension,
    }
}

/// Whether `added` is one that the controller carries out by itself, with memory.
pub fn has_memory(added: &Added) -> bool {
    matches!(added.id(), "reversal_transition" | "presliding" | "time_delay")
}

/// The sum of harmonics, each angle the one before turned on by the fundamental; and what there is of the fundamental in each N m
/// that the cable carries.
fn ripple(added: &Added, code: &mut Code) -> (String, String) {
    let (strengths, by_load) = added.parameters[1..].split_at(2 * HARMONICS);
    let harmonics = strengths.chunks_exact(2).rposition(|pair| pair != [0.0, 0.0]).map_or(0, |last| last + 1);
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
    let of_load = code.keep("of_load", &format!("{} * {sine} + {} * {cosine}", number(by_load[0]), number(by_load[1])));
    (sum, of_load)
}

fn drift(named: &Named<'_>, code: &mut Code) -> String {
    let clock = named.clock();
    let share = code.keep("share", &format!("{clock} / {}", named.text("horizon_s")));
    let first = code.keep("wave", &format!("cos({} * {share})", number(PI)));
    let (mut before, mut now, mut sum) = (number(1.0), first.clone(), number(0.0));
    for (at, wave) in ["wave_1_nm", "wave_2_nm", "wave_3_nm", "wave_4_nm"].into_iter().enumerate() {
        if at > 0 {
            let next = code.keep("wave", &format!("2.0 * {first} * {now} - {before}"));
            (before, now) = (now, next);
        }
        sum = code.keep("drift", &format!("{sum} + {} * {now}", named.text(wave)));
    }
    let settles = format!("{} * exp(-{clock} / {})", named.text("settle_nm"), named.text("settle_s"));
    format!("y + {settles} + {} * {share} + {sum}", named.text("line_nm"))
}

fn coupling(named: &Named<'_>, code: &mut Code) -> String {
    let of = |name: &str| named.text(name);
    let other = (named.value("joint") as usize).saturating_sub(1);
    let field = |code: &Code, name: &str| code.of_sample(&format!("others[{other}].{name}"));
    let [q2, v2, a2] =
        ["position_rad", "velocity_rad_s", "acceleration_rad_s2"].map(|name| code.keep("other", &field(code, name)));
    let rest = number(RESTING_RAD_S);
    let parts = [
        format!("{} * {q2}", of("stiffness_nm_rad")),
        format!("{} * {v2}", of("viscous_nm_s_rad")),
        format!("{} * tanh({v2} / {rest})", of("coulomb_nm")),
        format!("{} * {a2}", of("inertia_kg_m2")),
        format!("{} * (sin(q + {q2}) - sin(q))", of("weight_nm")),
        format!("{} * cos(q) * {a2}", of("inertia_cos_kg_m2")),
        format!("{} * {q2} * {q2}", of("bending_nm_rad2")),
        of("offset_nm"),
    ];
    code.keep("coupled", &parts.join(" + "))
}
