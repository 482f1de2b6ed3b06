//! The model as code for a controller: a C99 header, a Rust module without the standard library.
//!
//! One call a sample, without allocation, in bounded time: the recursion of K_f, both branches, every effect. What it gives is
//! what `predict` gives for the same position, speed and acceleration.

pub use super::code::Language;
use super::code::{Code, number};
use super::effects::{Hooks, has_memory, hooks};
use super::plain_name;
use crate::dynamics::{Dynamics, JointKind};
use crate::effects::Added;
use crate::model::{AT_REST_RAD_S, Combination, Direction, Friction, Model};
use crate::problem::{Problem, Result, visible};
use askama::Template;

/// The longest delay that is kept, samples: 160 kB of a controller's memory.
const LATE_MAX: f64 = 20_000.0;

/// What the code is made for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Calls a second, Hz: what a delay is counted in.
    pub rate_hz: f64,
    /// What the code says it comes from.
    pub source: String,
}

/// What both templates are filled with.
struct Parts {
    name: String,
    upper: String,
    joint: String,
    source: String,
    version: &'static str,
    rate_hz: String,
    prismatic: bool,
    /// The chain whose dynamics the caller adds, and whether its slope is asked for.
    chain: Option<String>,
    needs_slope: bool,
    others: usize,
    backlash_rad: String,
    share: String,
    /// K~ follows the sign of the speed alone, from this speed on, rad/s.
    jumps: Option<String>,
    presliding: Option<Bristles>,
    late: Option<Late>,
    follows: Option<Follows>,
    effects: Vec<String>,
    body: String,
}

struct Bristles {
    travel_rad: String,
    exponential: bool,
    power: String,
}

/// A delay: samples in all, the whole of it and what is left over.
struct Late {
    kept: usize,
    whole: usize,
    share: String,
}

/// A sensor that follows with a lag: the weights of its last reading, of what it is given now, and of what it was given before
/// (`numerics::causal::Lag`).
struct Follows {
    reading: String,
    now: String,
    before: String,
}

#[derive(Template)]
#[template(path = "model.h", escape = "none")]
struct Header {
    p: Parts,
}

#[derive(Template)]
#[template(path = "model.rs.txt", escape = "none")]
struct Module {
    p: Parts,
}

/// The code of `model` in `language`.
///
/// Errors: a torque recorded early, which no controller can foretell; a delay too long to keep.
pub fn controller(model: &Model, language: Language, settings: &Settings) -> Result<String> {
    let p = parts(model, language, settings)?;
    let made = match language {
        Language::C => Header { p }.render(),
        Language::Rust => Module { p }.render(),
    };
    // The template engine drops the last line's end.
    made.map(|text| text + "\n")
        .or_else(|error| Problem::error("export", format!("could not be made: {error}"), "report this").alone())
}

fn parts(model: &Model, language: Language, settings: &Settings) -> Result<Parts> {
    let name = plain_name(model);
    let of_other = |e: &Added| e.effect.other_joint(&e.parameters).map_or(0, |joint| joint + 1);
    let presliding = model.presliding().map(|bristles| Bristles {
        travel_rad: number(bristles.travel_rad),
        exponential: (bristles.exponent - 1.0).abs() < 1e-6,
        power: number(1.0 - bristles.exponent),
    });
    let needs_slope = model.chain.is_some() && stretches(model);
    Ok(Parts {
        upper: name.to_ascii_uppercase(),
        joint: commented(&model.joint.name),
        source: commented(&settings.source),
        version: env!("CARGO_PKG_VERSION"),
        rate_hz: number(settings.rate_hz),
        prismatic: model.joint.kind == JointKind::Prismatic,
        chain: model.chain.as_ref().map(|chain| commented(&format!("{} of {}", chain.joint, chain.urdf))),
        needs_slope,
        others: model.effects.iter().map(of_other).max().unwrap_or(0),
        backlash_rad: number(model.backlash_m() / model.joint.pulley_radius_m),
        share: share(model),
        jumps: (model.added_curve().is_none() && model.combination == Combination::Sign).then(|| number(AT_REST_RAD_S)),
        presliding,
        late: late(model, settings)?,
        follows: follows(model, settings),
        effects: model.effects.iter().map(|e| format!("{}: {}", e.id(), e.effect.about().means)).collect(),
        body: body(model, language, needs_slope),
        name,
    })
}

/// Whether any effect takes the joint away from where its encoder is.
fn stretches(model: &Model) -> bool {
    model.effects.iter().any(|e| e.effect.position_lag_rad(&e.parameters, 1.0, 1.0) != 0.0)
}

/// What stands in a comment: nothing that would end it or begin another, on one line, in the order in which it is read.
fn commented(text: &str) -> String {
    visible(text).replace("*/", "* /").replace("/*", "/ *")
}

/// g(u)/g(1), as `Combination::share` has it.
fn share(model: &Model) -> String {
    if let Some(curve) = model.added_curve() {
        let p = number(curve.p);
        return format!("pow(atan(2.0 * {p} * u) / atan(2.0 * {p}), {})", number(curve.n));
    }
    match model.combination {
        Combination::Sign => number(1.0),
        Combination::Linear => "u".to_string(),
        Combination::Arctan { p, .. } => format!("atan(2.0 * {0} * u) / atan(2.0 * {0})", number(p)),
        Combination::Power { n } => format!("pow(u, {})", number(n)),
    }
}

fn late(model: &Model, settings: &Settings) -> Result<Option<Late>> {
    let samples = model.delay_s() * settings.rate_hz;
    if samples == 0.0 {
        return Ok(None);
    }
    let refuse = |what: String, cure: &str| Problem::error("effect `time_delay`", what, cure).alone();
    if samples < 0.0 {
        let what = format!("the torque is recorded {} s early, which takes the motion to come", -model.delay_s());
        return refuse(what, "a controller has no such motion: delete the effect from a copy of the model");
    }
    if !samples.is_finite() || samples > LATE_MAX {
        let what = format!("the torque is recorded {} s late: {samples:.0} samples to keep", model.delay_s());
        return refuse(what, "lower --rate-hz, or delete the effect from a copy of the model");
    }
    let whole = samples.floor();
    Ok(Some(Late { kept: whole as usize + 2, whole: whole as usize, share: number(samples - whole) }))
}

fn follows(model: &Model, settings: &Settings) -> Option<Follows> {
    let samples = Some(model.lag_s() * settings.rate_hz).filter(|samples| *samples > 0.0)?;
    let kept = (-1.0 / samples).exp();
    let share = samples * (1.0 - kept);
    Some(Follows { reading: number(kept), now: number(1.0 - share), before: number(share - kept) })
}

/// y of one sample, friction standing at `k`: the formula of `predict`, line by line.
fn body(model: &Model, language: Language, needs_slope: bool) -> String {
    let mut code = Code::new(language);
    let transmission = number(model.joint.transmission());
    let made: Vec<(&Added, Hooks)> = model.effects.iter().map(|e| (e, hooks_named(e, &mut code))).collect();
    rigid(model, needs_slope, &mut code);
    code.variable("joint_nm", "asked_nm");
    made.iter().filter_map(|(_, h)| h.joint_nm.as_ref()).for_each(|more| code.change("joint_nm", "+=", more));
    code.constant("load", &format!("{transmission} * joint_nm"));
    branches(model, &mut code);
    let friction = || made.iter().filter_map(|(_, h)| h.friction_nm.as_ref());
    if friction().flatten().any(|more| more.contains("own_")) {
        code.constant("own_up", "up");
        code.constant("own_down", "down");
    }
    for more in friction() {
        code.change("up", "+=", &more[0]);
        code.change("down", "+=", &more[1]);
    }
    code.variable("factor", "1.0");
    made.iter().filter_map(|(_, h)| h.factor.as_ref()).for_each(|more| code.change("factor", "*=", more));
    code.variable("winch_nm", "0.0");
    made.iter().filter_map(|(_, h)| h.winch_nm.as_ref()).for_each(|more| code.change("winch_nm", "+=", more));
    let (mu_up, mu_down) = (number(model.friction.up.mu_c), number(model.friction.down.mu_c));
    code.constant("friction_nm", "factor * (down + k * (up - down))");
    code.constant("loss", &format!("1.0 - {mu_down} - k * ({mu_up} - {mu_down})"));
    code.variable("y", "(load + friction_nm) / loss + winch_nm");
    let lags: Vec<&String> = made.iter().filter_map(|(_, h)| h.lag_rad.as_ref()).collect();
    if !lags.is_empty() {
        stretch(&lags, &transmission, &mut code);
    }
    // What the sensor makes of it: late, off scale, off zero, clipped last.
    if model.delay_s() != 0.0 {
        code.change("y", "=", &format!("{}_late_nm(s, y)", plain_name(model)));
    }
    if model.lag_s() > 0.0 {
        code.change("y", "=", &format!("{}_following_nm(s, y)", plain_name(model)));
    }
    for clips in [false, true] {
        let of = made.iter().filter(|(e, _)| e.effect.clips() == clips).filter_map(|(_, h)| h.reading_nm.as_ref());
        of.for_each(|reading| code.change("y", "=", reading));
    }
    code.lines()
}

fn hooks_named(added: &Added, code: &mut Code) -> Hooks {
    if !has_memory(added) {
        code.remark(added.id());
    }
    hooks(added, code)
}

/// What mass and load ask of the joint, and how gravity changes along it.
fn rigid(model: &Model, needs_slope: bool, code: &mut Code) {
    // A chain's are the caller's to add.
    let own = if model.chain.is_some() { Dynamics::default() } else { model.dynamics };
    let (gravity, inertia) = (number(own.gravity_nm), number(own.inertia_kg_m2));
    let load = code.of_sample("load_nm");
    let turns = model.joint.kind == JointKind::Revolute;
    let angle = match own.position_zero_rad {
        0.0 => "q".to_string(),
        zero_rad => format!("q + {}", number(zero_rad)),
    };
    let weight = if turns { format!("{gravity} * sin({angle})") } else { gravity.clone() };
    code.constant("asked_nm", &format!("({inertia} * a + {weight}) + {load}"));
    if stretches(model) {
        let slope = match (needs_slope, turns) {
            (true, _) => code.of_sample("slope_nm_rad"),
            (false, true) => format!("{gravity} * cos({angle})"),
            (false, false) => number(0.0),
        };
        code.constant("slope", &slope);
    }
}

/// The unloaded friction of both branches, each at its own sign of speed.
fn branches(model: &Model, code: &mut Code) {
    for direction in Direction::BOTH {
        let branch = model.friction.of(direction);
        let speed = if direction == Direction::Up { "fabs(v)" } else { "(-fabs(v))" };
        let (r1, r2) = (number(model.joint.winch_radius_m), model.joint.pulley_radius_m);
        let Friction { a_j, b_c, c_c, b_j, c_j, d, .. } = *branch;
        let stribeck = |b_n: f64, c_s_rad: f64| match b_n {
            0.0 => number(0.0),
            _ => format!("{} * exp(-{} * {speed})", number(b_n), number(c_s_rad)),
        };
        let both = format!("({} + {})", stribeck(b_c, c_c * r2), stribeck(b_j, c_j));
        code.variable(direction.name(), &format!("{r1} * ({} + {both} + {} * {speed})", number(a_j), number(d)));
    }
}

/// The lag of a stretched cable and the torque that stretches it, settled in three steps.
fn stretch(lags: &[&String], transmission: &str, code: &mut Code) {
    let lag = lags.iter().map(|lag| format!("({lag})")).collect::<Vec<_>>().join(" + ");
    for _ in 0..3 {
        let mut behind = lag.clone();
        if lag.contains("pull") {
            behind = lag.replace("pull", &code.keep("pull", &format!("y / {transmission}")));
        }
        code.change(
            "y",
            "=",
            &format!("({transmission} * (joint_nm - slope * ({behind})) + friction_nm) / loss + winch_nm"),
        );
    }
}
