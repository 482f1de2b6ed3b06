//! The model as code for a controller: a C99 header, a Rust module without the standard library.
//!
//! One call a sample, without allocation, in bounded time: the recursion of K_f, both branches, every effect. What it gives is
//! what `predict` gives for the same position, speed and acceleration.

pub use super::code::Language;
use super::code::{inline, lines, number};
use super::plain_name;
use crate::dynamics::{AT_REST_RAD_S, JointKind, Motion, Payload};
use crate::effects::{Added, Presliding, Sample};
use crate::model::{Asked, Combination, Model, moved, on_the_way};
use crate::numerics::causal::Lag;
use crate::numerics::expression::{Expression, Tape};
use crate::numerics::scalar::Scalar;
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
    passage: Passage,
    /// K~ follows the sign of the speed alone, from this speed on, rad/s.
    jumps: Option<String>,
    late: Option<Late>,
    follows: Option<Follows>,
    effects: Vec<String>,
    body: String,
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
#[template(path = "model.h", escape = "none", config = "src/askama.toml")]
struct Header {
    p: Parts,
}

#[derive(Template)]
#[template(path = "model.rs.txt", escape = "none", config = "src/askama.toml")]
struct Module {
    p: Parts,
}

/// The code of `model` in `language`.
///
/// Errors: a torque recorded early, which no controller can predict; a delay too long to keep.
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
    let others = model.effects.iter().map(of_other).max().unwrap_or(0);
    let needs_slope = model.chain.is_some() && stretches(model);
    Ok(Parts {
        upper: name.to_ascii_uppercase(),
        joint: commented(&model.joint.name),
        source: commented(&settings.source),
        version: env!("CARGO_PKG_VERSION"),
        rate_hz: number(settings.rate_hz),
        prismatic: model.joint.kind == JointKind::Prismatic,
        chain: model.chain.as_ref().map(|chain| {
            let payload = match model.dynamics.payload {
                none if none.is_none() => String::new(),
                Payload { mass_kg, moment_kg_m: [x, y, z], inertia_kg_m2 } => format!(
                    ", whose last link carries {mass_kg:.6} kg with a first moment of {x:.6}, {y:.6}, {z:.6} kg m and an inertia of \
                     {inertia_kg_m2:.6} kg m^2 more"
                ),
            };
            commented(&format!("{} of {}{payload}", chain.joint, chain.urdf))
        }),
        needs_slope,
        others,
        passage: passage(model, language),
        jumps: (model.added_curve().is_none() && model.combination == Combination::Sign).then(|| number(AT_REST_RAD_S)),
        late: late(model, settings)?,
        follows: follows(model, settings),
        effects: model.effects.iter().map(|e| format!("{}: {}", e.id(), e.effect.about().means)).collect(),
        body: body(model, language, others),
        name,
    })
}

/// Whether any effect takes the joint away from where its encoder is.
fn stretches(model: &Model) -> bool {
    model.effects.iter().any(|e| e.effect.lags())
}

/// What stands in a comment: nothing that would end it or begin another, on one line, in the order in which it is read.
fn commented(text: &str) -> String {
    visible(text).replace("*/", "* /").replace("/*", "/ *")
}

/// Where friction stands between its branches, step by step: the formulas of `model::combination` and of presliding as expressions
/// over the variables of the templates.
struct Passage {
    /// K_f after `travel` towards `end`.
    moved: String,
    /// K~ at `u`, the share of the transition.
    k_tilde: String,
    /// What is left of `behind` after `moved`, where friction builds up elastically.
    left: Option<String>,
}

fn passage(model: &Model, language: Language) -> Passage {
    let tape = Tape::default();
    let of_state = |name: &str| tape.input(language.member("s", name));
    let over = model.over::<Expression<'_>>();
    let (u, end, travel) = (tape.input("u"), tape.input("end"), tape.input("travel"));
    let backlash_rad = over.backlash_m() / over.joint.pulley_radius_m;
    let done = over.added_curve().map_or_else(|| over.combination.share(u), |curve| curve.share(u));
    let left = model.presliding().map(|Presliding { travel_rad, exponent }| {
        // Where the exponent is as good as 1 the formula is the exponential itself.
        let exponent = if (exponent - 1.0).abs() < 1e-6 { 1.0 } else { exponent };
        let bristles = Presliding { travel_rad: Expression::from(travel_rad), exponent: Expression::from(exponent) };
        inline(&tape, bristles.left(tape.input("behind").abs(), tape.input("moved")), language)
    });
    Passage {
        moved: inline(&tape, moved(of_state("k_f"), travel, backlash_rad, end), language),
        k_tilde: inline(&tape, on_the_way(of_state("start_k_tilde"), done, end), language),
        left,
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
    let [reading, now, before] = Lag::new(samples).weights().map(number);
    Some(Follows { reading, now, before })
}

/// y of one sample, friction standing at `k`: the model's own formula over expressions, then the sensor's errors.
fn body(model: &Model, language: Language, others: usize) -> String {
    let tape = Tape::default();
    let of_sample = |name: &str| tape.input(language.member("x", name));
    let motion = |at: usize| {
        let of = |name: &str| of_sample(&format!("others[{at}].{name}"));
        Motion { position: of("position_rad"), velocity: of("velocity_rad_s"), acceleration: of("acceleration_rad_s2") }
    };
    let others: Vec<Motion<Expression<'_>>> = (0..others).map(motion).collect();
    let own = Motion { position: tape.input("q"), velocity: tape.input("v"), acceleration: tape.input("a") };
    let sample = Sample { time_s: tape.input("t"), elapsed_s: tape.input("elapsed"), own, others: &others };
    let over = model.over();
    let load_nm = of_sample("load_nm");
    let asked = match model.chain {
        // Its dynamics are the caller's to add.
        Some(_) => Asked { torque_nm: load_nm, slope_nm_rad: of_sample("slope_nm_rad") },
        None => over.asked_alone(own, load_nm),
    };
    let mut y = over.driven_nm(&sample, asked, tape.input("k")).torque_nm;
    let mut through = |function: &str| {
        let function = format!("{}_{function}", plain_name(model));
        y = tape.call(&function, &[tape.input("s"), y]).named("read_nm");
    };
    if model.delay_s() != 0.0 {
        through("late_nm");
    }
    if model.lag_s() > 0.0 {
        through("following_nm");
    }
    lines(&tape, over.reading_nm(&sample, y), "y", language)
}
