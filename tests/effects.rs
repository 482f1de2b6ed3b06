//! Laws over the library: every effect in a file of its own, named in units, absent at 0, in proportion, dissipating or not,
//! read back from files, refused where it makes no sense.

use crate::campaigns::truth;
use std::collections::BTreeSet;
use tautline::dynamics::{Both, Motion};
use tautline::effects::{ActsOn, Added, Carried, Extent, Family, LIBRARY, Role, Sample, find};
use tautline::model::{Direction, Friction, Group, Model, Term};
use tautline::simulate::{Course, Sensors, record};

const RATE_HZ: f64 = 500.0;

/// The names of the format, in its order; files hold them, so they stay.
const IDS: [&str; 20] = [
    "reversal_transition",
    "stribeck",
    "load_dependent_friction",
    "friction_ripple",
    "torque_ripple",
    "cable_elasticity",
    "quadratic_viscous",
    "sensor_bias",
    "sensor_gain",
    "sensor_drift",
    "time_delay",
    "gravity_phase",
    "inertia",
    "warm_up",
    "joint_coupling",
    "contact",
    "elastic_spring",
    "saturation",
    "end_stop",
    "presliding",
];

/// One of each, of a size that shows.
pub fn examples() -> impl Iterator<Item = Added> {
    LIBRARY.into_iter().map(|effect| example(effect.about().id))
}

pub fn example(id: &str) -> Added {
    Added::parse(&format!("{id}:{}", find(id).unwrap().about().example)).unwrap()
}

fn with(effect: Added) -> Model {
    Model { effects: vec![effect], ..truth() }
}

/// Three strokes at growing speed, the other joint swinging, late in a campaign.
fn course() -> Course {
    let times = || (0..(20.0 * RATE_HZ) as usize).map(|i| i as f64 / RATE_HZ);
    Course {
        position_rad: times().map(|t| 0.6 - 0.5 * (0.1 * t + 0.03 * t * t).cos()).collect(),
        others_rad: vec![times().map(|t| 0.4 * (0.7 * t).sin()).collect()],
        contact_nm: Vec::new(),
        began_s: 3.0,
    }
}

/// What an ideal sensor reads along `course`, N m.
fn torque_nm(model: &Model, course: &Course) -> Vec<f64> {
    let exact = Sensors { torque_noise_nm: 0.0, encoder_counts: 0.0 };
    record(model, None, course, RATE_HZ, exact, 1).torque_nm
}

/// What `effect` adds along `course`, N m.
fn difference_nm(effect: Added, course: &Course) -> Vec<f64> {
    let (base, more) = (torque_nm(&truth(), course), torque_nm(&with(effect), course));
    more.iter().zip(&base).map(|(more, base)| more - base).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// `effect` with its strengths times `factor`.
fn scaled(effect: &Added, factor: f64) -> Added {
    let parameters = effect.named().map(|(p, x)| if p.role == Role::Strength { factor * x } else { x }).collect();
    Added { parameters, ..effect.clone() }
}

fn has_strength(effect: &Added) -> bool {
    effect.named().any(|(p, _)| p.role == Role::Strength)
}

#[test]
fn the_library_is_the_format_s_list_and_the_folder() {
    let ids = LIBRARY.map(|effect| effect.about().id);
    assert!(ids.starts_with(&IDS), "files hold these names, in this order: {IDS:?}");
    let shared = [
        "mod",
        "library",
        "ripple",
        "about",
        "clock",
        "parameter",
        "region",
        "sample",
        "transition",
        "effect",
        "along",
    ];
    let names =
        std::fs::read_dir("src/core/effects").unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let files: BTreeSet<String> = names.map(|name| name.trim_end_matches(".rs").to_string()).collect();
    assert_eq!(files, ids.iter().chain(&shared).map(|id| id.to_string()).collect());
    for id in ids {
        assert_eq!(find(id).unwrap().about().id, id);
        assert_eq!(example(id).id(), id);
    }
}

#[test]
fn parameters_name_their_units_and_have_room() {
    let units = [
        "_nm",
        "_m",
        "_s",
        "_rad",
        "_rad_s",
        "_nm_rad",
        "_nm_s_rad",
        "_nm_s2_rad2",
        "_kg_m2",
        "_rad_nm",
        "_nm_rad2",
        "_nm_rad3",
    ];
    // Shares, exponents, choices: without a dimension.
    let plain = [
        "p",
        "up",
        "down",
        "exponent",
        "error",
        "cold_share",
        "n",
        "with_friction",
        "of_tension",
        "first_order",
        "waves",
        "restarts",
        "side",
        "joint",
        "periods_per_rad",
        "sin_of_load",
        "cos_of_load",
        "sin_of_friction",
        "cos_of_friction",
        "stiffens",
        "by_speed",
        "long_tail",
        "parts",
        "hardens",
        "in_place",
        "at_joint",
        "terms",
    ];
    for effect in LIBRARY {
        let about = effect.about();
        let names: BTreeSet<&str> = about.parameters.iter().map(|p| p.name).collect();
        assert_eq!(names.len(), about.parameters.len(), "{}: a name twice", about.id);
        for p in about.parameters {
            let has_unit = units.iter().any(|unit| p.name.ends_with(unit));
            assert!(has_unit || plain.contains(&p.name), "{}: {} has no unit", about.id, p.name);
            let (low, high) = p.bounds;
            assert!(low < high && low.is_finite() && high.is_finite(), "{}: {} in {low} to {high}", about.id, p.name);
            let may_be_absent = p.role != Role::Strength || (p.allows(0.0) && low == -high);
            assert!(may_be_absent, "{}: {} cannot be 0", about.id, p.name);
        }
        for other in about.trades_with {
            assert!(is_cause(other), "{} trades with `{other}`", about.id);
        }
        for other in about.told_apart.iter().map(|(other, _)| other).chain(about.outnumbered_by) {
            assert!(is_cause(other), "{} names `{other}`", about.id);
        }
        assert_eq!(about.family == Family::Fault, about.acts_on == ActsOn::Sensor, "{}", about.id);
        assert!(about.remedy.is_some() == (about.family == Family::Fault), "{}: a fault has a remedy", about.id);
        assert!(!about.means.is_empty() && !about.formula.is_empty() && !about.source.is_empty(), "{}", about.id);
    }
}

/// Whether `name` is that of an effect or of a group of the model's own parameters.
fn is_cause(name: &str) -> bool {
    find(name).is_some() || Group::find(name).is_some()
}

#[test]
fn every_term_of_friction_goes_out_of_date_with_one_group() {
    for term in Term::ALL {
        let groups = Group::ALL.iter().filter(|group| group.terms.contains(&term)).count();
        assert_eq!(groups, 1, "{} is in {groups} groups", term.name());
        assert_eq!(Term::find(term.name()), Some(term));
    }
    for group in Group::ALL {
        assert_eq!(Group::find(group.name), Some(group));
        for (other, how) in group.told_apart {
            assert!(is_cause(other) && !how.is_empty(), "{} names `{other}`", group.name);
        }
    }
}

#[test]
fn an_effect_shows_and_without_strength_it_is_absent() {
    let course = course();
    for id in LIBRARY.map(|effect| effect.about().id) {
        let effect = example(id);
        let shown_nm = rms(&difference_nm(effect.clone(), &course));
        assert!(!effect.is_idle(), "{id}");
        assert!(shown_nm > 0.001 && shown_nm.is_finite(), "{id}: {shown_nm} N m");
        if has_strength(&effect) {
            let idle = scaled(&effect, 0.0);
            assert!(idle.is_idle(), "{id}");
            let left_nm = rms(&difference_nm(idle, &course));
            assert!(left_nm < 1e-12, "{id}: {left_nm} N m are left");
        }
    }
}

#[test]
fn twice_the_strength_is_twice_the_difference() {
    for effect in examples().collect::<Vec<_>>().iter().filter(|effect| has_strength(effect)) {
        // A lag is taken where gravity is then, a delay draws a curve's chord, a turned weight moves along an arc: in proportion
        // only to the first order.
        let tolerance = match effect.id() {
            "cable_elasticity" | "time_delay" | "gravity_phase" => 0.1,
            _ => 1e-9,
        };
        let (small, large) = (scaled(effect, 0.5), scaled(effect, 1.0));
        let (once, twice) = (difference_nm(small, &course()), difference_nm(large, &course()));
        let bent: Vec<f64> = once.iter().zip(&twice).map(|(a, b)| b - 2.0 * a).collect();
        assert!(rms(&bent) <= tolerance * rms(&twice), "{}: {} of {}", effect.id(), rms(&bent), rms(&twice));
    }
}

#[test]
fn friction_resists_in_both_directions_and_cogging_in_none() {
    let motion = |velocity| Motion { position: 0.7, velocity, acceleration: 0.0 };
    let carried = Carried { load_nm: 0.5, friction_nm: Both { up: 0.0, down: 0.0 } };
    for id in LIBRARY.map(|effect| effect.about().id) {
        let added = example(id);
        let friction_nm = |velocity| {
            let sample = Sample { time_s: 1.0, elapsed_s: 1.0, own: motion(velocity), others: &[] };
            added.effect.friction_nm(&added.parameters, &sample, carried)
        };
        let (up, down) = (friction_nm(0.2).up, friction_nm(-0.2).down);
        match id {
            "stribeck" | "load_dependent_friction" | "quadratic_viscous" => {
                assert!(up > 0.0 && down < 0.0, "{id}: {up} up, {down} down");
            }
            "friction_ripple" => assert!(up != 0.0 && up == -down, "{id}: {up} up, {down} down"),
            _ => assert!(up == 0.0 && down == 0.0, "{id}: {up} up, {down} down"),
        }
    }
}

/// Torques at both joints of a planar arm with a point mass at its end, by Lagrange's equations and central differences.
fn two_links_nm(q: [f64; 2], v: [f64; 2], a: [f64; 2], mass_kg: f64, lengths_m: [f64; 2]) -> [f64; 2] {
    const STEP: f64 = 1e-4;
    let energy_j = |q: [f64; 2], v: [f64; 2]| {
        let along =
            |of: fn(f64) -> f64| lengths_m[0] * v[0] * of(q[0]) + lengths_m[1] * (v[0] + v[1]) * of(q[0] + q[1]);
        0.5 * mass_kg * (along(f64::sin).powi(2) + along(f64::cos).powi(2))
    };
    let moved = |x: [f64; 2], at: usize, by: f64| {
        let mut x = x;
        x[at] += by;
        x
    };
    let slope = |of: &dyn Fn(f64) -> f64| (of(STEP) - of(-STEP)) / (2.0 * STEP);
    [0, 1].map(|at| {
        let momentum = |t: f64| {
            let now = |x: [f64; 2], v: [f64; 2]| [0, 1].map(|i| x[i] + v[i] * t);
            slope(&|by| energy_j(now(q, v), moved(now(v, a), at, by)))
        };
        slope(&momentum) - slope(&|by| energy_j(moved(q, at, by), v))
    })
}

#[test]
fn a_coupled_joint_is_a_rigid_link() {
    let (mass_kg, lengths_m) = (2.0_f64, [0.4_f64, 0.3]);
    let (q, v, a) = ([0.5, 0.9], [1.3, -0.8], [2.0, 1.1]);
    let [proximal, distal] = [0, 1].map(|at| Motion { position: q[at], velocity: v[at], acceleration: a[at] });
    let coupled_nm = |strengths: &str, own: Motion, other: Motion| {
        let added = Added::parse(&format!("joint_coupling:joint=1,{strengths}")).unwrap();
        let sample = Sample { time_s: 1.0, elapsed_s: 1.0, own, others: &[other] };
        added.effect.winch_torque_nm(&added.parameters, &sample, 0.0)
    };
    let (own_kg_m2, both_kg_m2) = (mass_kg * lengths_m[1].powi(2), mass_kg * lengths_m[0] * lengths_m[1]);
    let found = coupled_nm(&format!("inertia_kg_m2={own_kg_m2},inertia_cos_kg_m2={both_kg_m2}"), distal, proximal);
    let true_nm = two_links_nm(q, v, a, mass_kg, lengths_m)[1] - own_kg_m2 * a[1];
    assert!((found - true_nm).abs() < 1e-5, "{found} and {true_nm}");
    let found = coupled_nm(&format!("centrifugal_kg_m2={0},coriolis_kg_m2={0}", -both_kg_m2), proximal, distal);
    let true_nm = two_links_nm(q, v, [0.0; 2], mass_kg, lengths_m)[0];
    assert!((found - true_nm).abs() < 1e-5, "{found} and {true_nm}");
}

#[test]
fn friction_takes_energy_from_every_cycle_and_a_potential_none() {
    // Two whole periods between rests; the joint ends where it began.
    let n = 20_000;
    let position = |i: usize| 0.6 - 0.4 * (2.0 * std::f64::consts::TAU * i as f64 / n as f64).cos();
    let course = Course { position_rad: (0..=n).map(position).collect(), ..Course::default() };
    let work_of_nm = |effect: Added| {
        let added_nm = difference_nm(effect, &course);
        let x = &course.position_rad;
        (1..=n).map(|i| (x[i] - x[i - 1]) * (added_nm[i] + added_nm[i - 1]) / 2.0).sum::<f64>()
    };
    let work_nm = |id: &str| work_of_nm(example(id));
    for id in ["stribeck", "load_dependent_friction", "quadratic_viscous", "warm_up"] {
        assert!(work_nm(id) > 0.01, "{id} gives energy: {}", work_nm(id));
    }
    // A pulley that is not round scales friction, too, where it pulls: cogging is the potential.
    let cogging = || Added::parse("torque_ripple:periods_per_rad=5.1,sin_1_nm=0.06,cos_3_nm=0.02").unwrap();
    for effect in [cogging(), example("sensor_bias")] {
        let (id, work_nm) = (effect.effect.about().id, work_of_nm(effect));
        assert!(work_nm.abs() < 1e-6, "{id}: {work_nm} N m over whole cycles");
    }
    // Through the friction coefficients, which differ by direction, what acts at the joint costs a little.
    for id in ["gravity_phase", "elastic_spring", "end_stop", "inertia"] {
        assert!(work_nm(id).abs() < 0.02, "{id}: {} N m over whole cycles", work_nm(id));
    }
}

/// (17): what the joint is loaded with costs the cable's friction, too, more in one direction than in the other.
#[test]
fn a_ripple_at_the_joint_is_carried_by_the_cable() {
    let n = 20_000;
    let position = |i: usize| 0.6 - 0.4 * (std::f64::consts::TAU * i as f64 / n as f64).cos();
    let course = Course { position_rad: (0..=n).map(position).collect(), ..Course::default() };
    let of = |strengths: &str, place: &str| {
        difference_nm(Added::parse(&format!("torque_ripple:periods_per_rad=5,{strengths}{place}")).unwrap(), &course)
    };
    let truth = truth();
    let strengths = "sin_1_nm=0.1,cos_2_nm=0.05";
    let (at_winch_nm, at_joint_nm) = (of(strengths, ""), of(strengths, ",at_joint=1"));
    for (at, direction) in [(n / 5, Direction::Up), (3 * n / 5, Direction::Down)] {
        let expected = truth.joint.transmission() / truth.friction.of(direction).loss();
        let ratio = at_joint_nm[at] / at_winch_nm[at];
        assert!((ratio / expected - 1.0).abs() < 1e-9, "{direction:?}: {ratio} for {expected}");
    }
    // A share of the load is one of what is pulled there: at the winch of all of it, friction and all, at the joint of the load that the cable carries.
    let (at_winch_nm, at_joint_nm) = (of("sin_of_load=0.2", ""), of("sin_of_load=0.2", ",at_joint=1"));
    let frictionless = Model { friction: Both::make(|_| Friction::default()), ..truth.clone() };
    let (whole_nm, load_nm) = (torque_nm(&truth, &course), torque_nm(&frictionless, &course));
    for (at, direction) in [(n / 5, Direction::Up), (3 * n / 5, Direction::Down)] {
        let share = 0.2 * (std::f64::consts::TAU * 5.0 * course.position_rad[at]).sin();
        assert!((at_winch_nm[at] - share * whole_nm[at]).abs() < 1e-9, "{direction:?}");
        let carried_nm = load_nm[at] / truth.friction.of(direction).loss();
        assert!((at_joint_nm[at] - share * carried_nm).abs() < 1e-9, "{direction:?}");
        assert!((whole_nm[at] - carried_nm).abs() > 0.05, "the joint has friction");
    }
}

#[test]
fn a_stop_takes_what_it_loses() {
    let n = 20_000;
    let position = |i: usize| 0.6 - 0.4 * (2.0 * std::f64::consts::TAU * i as f64 / n as f64).cos();
    let course = Course { position_rad: (0..=n).map(position).collect(), ..Course::default() };
    let work_nm = |text: &str| {
        let added_nm = difference_nm(Added::parse(text).unwrap(), &course);
        let x = &course.position_rad;
        (1..=n).map(|i| (x[i] - x[i - 1]) * (added_nm[i] + added_nm[i - 1]) / 2.0).sum::<f64>()
    };
    let stop = |loss: &str| work_nm(&format!("end_stop:side=1,stiffness_nm=4,position_rad=0.7,exponent=1.5{loss}"));
    assert!(stop(",loss_nm=1") > stop("") + 0.01, "{} of {}", stop(",loss_nm=1"), stop(""));
}

fn extent() -> Extent {
    Extent {
        position_rad: (0.2, 1.1),
        resolution_rad: 1e-4,
        stroke_rad: 0.8,
        speed_rad_s: (0.02, 2.0),
        slowest_rad_s: 0.01,
        trial_s: 20.0,
        campaign_s: 40.0,
        one_recording: false,
        torque_nm: (-0.1, 1.0),
        others: 1,
        gravity_nm: 1.0,
        payload: None,
        payload_weighs: false,
        has_inertia: false,
        changes_gradually: false,
        backlash_m: 0.002,
        pulley_radius_m: 0.05,
        turns: true,
    }
}

/// A recording that was cut goes on: nothing starts anew with its pieces.
#[test]
fn no_law_of_time_restarts_within_one_recording() {
    let restarts = |extent: &Extent, id: &str| {
        let starts = find(id).unwrap().starts(extent);
        assert!(!starts.is_empty());
        starts.iter().filter(|start| start[0] > 0.5).count()
    };
    let long = Extent { trial_s: 120.0, campaign_s: 600.0, ..extent() };
    for id in ["sensor_drift", "warm_up"] {
        assert!(restarts(&long, id) > 0);
        assert_eq!(restarts(&Extent { one_recording: true, ..long.clone() }, id), 0, "{id}");
    }
    // In trials of 20 s nothing warms up that is cold again at the start of the next.
    assert_eq!(restarts(&extent(), "warm_up"), 0);
}

#[test]
fn a_clearance_that_comes_out_as_the_joint_s_own_is_confirmed() {
    let confirmed = |backlash_m: f64| {
        let added = Added::parse(&format!("reversal_transition:backlash_m={backlash_m},p=1,n=1")).unwrap();
        added.effect.confirmed(&added.parameters, &extent())
    };
    assert!(confirmed(0.0021) > 0);
    assert_eq!(confirmed(0.003), 0);
}

/// Bristles bend the most at first, a clearance that is taken up has a flat part there.
#[test]
fn a_transition_that_rises_at_first_suits_presliding_as_well() {
    let suits = |n: f64| {
        let added = Added::parse(&format!("reversal_transition:backlash_m=0.003,p=1,n={n}")).unwrap();
        added.effect.suits_its_like(&added.parameters)
    };
    assert!(suits(0.4) && !suits(0.8) && !suits(1.4));
    assert!(examples().all(|added| !added.effect.suits_its_like(&added.parameters)));
}

#[test]
fn numbers_that_contradict_the_name_are_told() {
    let extent = extent();
    let abrupt = Added::parse("presliding:travel_rad=0.01,exponent=0.65").unwrap();
    let is_presliding = |changes_gradually: bool| {
        abrupt.effect.is_itself(&abrupt.parameters, &Extent { changes_gradually, ..extent.clone() })
    };
    assert!(is_presliding(false) && !is_presliding(true));
    let is_itself = |text: &str| {
        let added = Added::parse(text).unwrap();
        added.effect.is_itself(&added.parameters, &extent)
    };
    for added in examples() {
        assert!(added.effect.is_itself(&added.parameters, &extent), "{}", added.id());
    }
    for text in [
        "saturation:low_nm=-0.05,high_nm=0.5",
        "end_stop:side=1,stiffness_nm=-4,position_rad=0.9,exponent=1.5",
        "end_stop:side=1,stiffness_nm=4,position_rad=0.9,exponent=1.5,loss_nm=5",
        "elastic_spring:stiffness_nm_rad=0.3,stiffens=1,cubic_nm_rad3=-0.2",
        "quadratic_viscous:up_nm_s2_rad2=-0.3",
        "presliding:travel_rad=3e-5,exponent=1",
        "elastic_spring:stiffness_nm_rad=0.01,preload_nm=-0.3",
        "stribeck:up_nm=-0.3,down_nm=0.3,speed_rad_s=0.1,exponent=1",
        "reversal_transition:backlash_m=4e-6,p=1,n=1",
        "cable_elasticity:with_friction=1,compliance_rad_nm=-0.01",
        "warm_up:restarts=0,cold_nm=0.1,time_constant_s=2000,exponent=0.3",
        "end_stop:side=1,stiffness_nm=4,position_rad=0.5,exponent=1.5",
        "end_stop:side=-1,stiffness_nm=4,position_rad=0.9,exponent=1.5",
        "load_dependent_friction:up=0.2,down=-0.15",
        "elastic_spring:stiffness_nm_rad=-0.3,stiffens=1,cubic_nm_rad3=-0.2",
        "warm_up:restarts=0,cold_share=-0.5,cold_nm=0.1,time_constant_s=15,exponent=1",
        "warm_up:restarts=0,cold_nm=-0.1,time_constant_s=15,exponent=1,parts=2",
        "warm_up:restarts=1,cold_nm=0.1,time_constant_s=15,exponent=1",
        "friction_ripple:periods_per_rad=1.2,sin_1_nm=0.08",
        "friction_ripple:periods_per_rad=1.3,sin_1_nm=0.08",
        "torque_ripple:periods_per_rad=0.9,cos_of_load=0.1",
        "sensor_drift:restarts=0,horizon_s=40,waves=0,settle_s=5,line_nm=0.01,offset_nm=0.2",
        "sensor_drift:restarts=1,horizon_s=20,waves=4,settle_s=5,line_nm=0.1,wave_2_nm=0.03",
        "sensor_drift:restarts=1,horizon_s=20,waves=0,settle_s=1,line_nm=0.1,settle_nm=0.1",
        "sensor_gain:error=2.5",
        "sensor_gain:error=-0.7",
        "stribeck:up_nm=0.3,down_nm=0.3,speed_rad_s=6,exponent=1",
    ] {
        assert!(!is_itself(text), "{text}");
    }
    assert!(
        is_itself("sensor_drift:restarts=1,horizon_s=20,waves=0,settle_s=5,settle_nm=0.1"),
        "creep, each trial tared"
    );
    assert!(is_itself("friction_ripple:periods_per_rad=1.4,sin_1_nm=0.08"), "1.26 periods within the range");
}

#[test]
fn what_may_be_left_out_is_what_the_plainest_form_has() {
    let plain = Added::parse("quadratic_viscous:up_nm_s2_rad2=0.3").unwrap();
    let spelled = "quadratic_viscous:up_nm_s2_rad2=0.3,down_nm_s2_rad2=0,exponent=2,by_speed=0";
    assert_eq!(plain, Added::parse(spelled).unwrap());
}

#[test]
fn a_range_that_ends_clips_noise_too() {
    let limits = example("saturation");
    let (low, high) = (limits.parameters[0], limits.parameters[1]);
    let model = Model { effects: vec![limits, example("sensor_bias")], ..truth() };
    let sensors = Sensors { torque_noise_nm: 0.02, encoder_counts: 0.0 };
    let read = record(&model, None, &course(), RATE_HZ, sensors, 3).torque_nm;
    assert!(read.iter().all(|y| (low..=high).contains(y)), "a reading beyond the range");
    for end in [low, high] {
        let held = read.iter().filter(|y| **y == end).count();
        assert!(held > 300, "{held} readings at {end}");
    }
}

#[test]
fn a_late_reading_is_the_same_curve_later() {
    let added = example("time_delay");
    let late = (added.parameters[0] * RATE_HZ) as usize;
    let (at_once, later) = (torque_nm(&truth(), &course()), torque_nm(&with(added), &course()));
    for i in late..later.len() {
        assert!((later[i] - at_once[i - late]).abs() < 1e-9, "sample {i}");
    }
}

#[test]
fn what_leaves_the_joint_behind_says_so() {
    for added in examples() {
        let lag_rad = added.hooks().position_lag_rad(&added.parameters, 1.0, 1.0);
        assert_eq!(lag_rad != 0.0, added.effect.lags(), "{}: {lag_rad}", added.id());
    }
}

/// Where it acts and which of its terms it has are forms of a coupling.
#[test]
fn a_coupling_acts_in_one_place_by_the_terms_that_it_uses() {
    let own = Motion { position: 0.4, velocity: 0.3, acceleration: 1.1 };
    let other = Motion { position: 0.7, velocity: -0.5, acceleration: 2.0 };
    let sample = Sample { time_s: 1.0, elapsed_s: 1.0, own, others: &[other] };
    let mut plain = Added::parse("joint_coupling:joint=1,offset_nm=1").unwrap();
    let names = plain.named().map(|(parameter, _)| parameter.name).collect::<Vec<_>>();
    let at = |name: &str| names.iter().position(|other| *other == name).unwrap();
    plain.parameters[at("offset_nm")] = 0.0;
    for (terms, at_joint) in [0.0, 1.0, 2.0, 3.0].into_iter().flat_map(|terms| [(terms, 0.0), (terms, 1.0)]) {
        for (strength, name) in names.iter().enumerate().filter(|(_, name)| name.contains('_') && **name != "at_joint")
        {
            let mut p = plain.parameters.clone();
            (p[at("terms")], p[at("at_joint")], p[strength]) = (terms, at_joint, 1.0);
            let [joint_nm, winch_nm] =
                [plain.hooks().joint_torque_nm(&p, &sample, 0.5), plain.hooks().winch_torque_nm(&p, &sample, 0.5)];
            let (acts_nm, idle_nm) = if at_joint > 0.5 { (joint_nm, winch_nm) } else { (winch_nm, joint_nm) };
            assert_eq!(acts_nm != 0.0, plain.effect.uses(&p, strength), "{name} with terms = {terms}");
            assert_eq!(idle_nm, 0.0, "{name} with at_joint = {at_joint}");
        }
    }
}

/// What an effect learns later is a form of it: models from before say nothing of it.
#[test]
fn a_form_that_a_model_does_not_know_is_the_default() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("model.json");
    for (id, later) in [
        ("cable_elasticity", &["hardens", "hardens_nm"][..]),
        ("warm_up", &["parts"]),
        ("torque_ripple", &["at_joint"]),
        ("joint_coupling", &["at_joint", "terms"]),
    ] {
        let model = with(example(id));
        let mut json = model.to_json();
        let parameters = json["effects"][0]["parameters"].as_object_mut().unwrap();
        later.iter().for_each(|name| assert!(parameters.remove(*name).is_some(), "{name}"));
        std::fs::write(&file, json.to_string()).unwrap();
        assert_eq!(Model::read(&file).unwrap(), model);
    }
}

#[test]
fn every_effect_reads_back_from_a_model() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    for model in examples().map(with).chain([Model { effects: examples().collect(), ..truth() }]) {
        std::fs::write(&file, model.to_json().to_string()).unwrap();
        assert_eq!(Model::read(&file).unwrap(), model);
    }
}

#[test]
fn an_impossible_effect_in_a_model_is_refused() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    let text = with(example("stribeck")).to_json().to_string();
    for (from, to, expected) in [
        ("\"stribeck\"", "\"stribek\"", "did you mean `stribeck`?"),
        ("\"exponent\":1.3", "\"exponent\":13.0", "expected 0.5 to 3"),
        ("\"exponent\":1.3,", "", "add `exponent`"),
        ("\"up_nm\":0.1", "\"up\":0.1", "unknown key `up`"),
        ("\"up_nm\":0.1", "\"up_nm\":\"much\"", "expected a number"),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let problems = Model::read(&file).unwrap_err().to_string();
        assert!(problems.contains(expected) && problems.contains("effects[0]"), "{from} -> {to}: {problems}");
    }
}

#[test]
fn an_effect_typed_wrongly_is_refused_with_what_there_is() {
    for (text, expected) in [
        ("stribek:up_nm=1", "did you mean `stribeck`?"),
        ("gremlins", "there are: reversal_transition, stribeck"),
        ("sensor_bias", "give one of bias_nm"),
        ("sensor_bias:", "give one of bias_nm"),
        ("sensor_bias:bias=0.1", "did you mean `bias_nm`?"),
        ("sensor_bias:bias_nm", "is no name=value"),
        ("sensor_bias:bias_nm=a", "expected a number"),
        ("sensor_bias:bias_nm=nan", "expected -1000000000 to 1000000000"),
        ("sensor_bias:bias_nm=1,bias_nm=2", "given twice"),
        ("stribeck:up_nm=0.1,speed_rad_s=0.1", "exponent is missing"),
        ("stribeck:up_nm=0.1,speed_rad_s=0.1,exponent=9", "expected 0.5 to 3"),
        ("presliding", "travel_rad is missing"),
    ] {
        let problems = Added::parse(text).unwrap_err().to_string();
        assert!(problems.contains(expected), "{text}: {problems}");
    }
    let given = Added::parse("stribeck: up_nm = 0.1, speed_rad_s = 2e-2, exponent = 1").unwrap();
    assert_eq!(given.parameters, [0.1, 0.0, 0.02, 1.0]);
}
