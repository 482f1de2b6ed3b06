//! Derivatives of the prediction agree with central differences, for every term of friction and every parameter of every effect.

use crate::campaigns::truth;
use crate::effects::example;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline::dynamics::Motion;
use tautline::effects::{Added, Evaluated, LIBRARY, Role, Sample};
use tautline::model::{Combination, Direction, Model, Passage, Term};
use tautline::numerics::dual::Dual;

const RATE_HZ: f64 = 100.0;
const SAMPLES: usize = 600;
/// Of the largest derivative along the motion: a difference quotient of this step has some 1e-9 of it by itself.
const WITHIN: f64 = 1e-6;
/// Relative step of the difference quotient.
const STEP: f64 = 1e-6;

/// One number of a model.
type Slot<S> = fn(&mut Model<S>) -> &mut S;

/// A motion with reversals at random points, another joint beside it.
fn motions(random: &mut ChaCha8Rng) -> Vec<[Motion; 2]> {
    let mut wave = |size: f64, hz: (f64, f64)| {
        let (size, rate) =
            (size * random.random_range(0.7..1.3), std::f64::consts::TAU * random.random_range(hz.0..hz.1));
        let phase = random.random_range(0.0..1.0);
        move |t: f64| {
            let (sin, cos) = (rate * t + phase).sin_cos();
            Motion { position: size * sin, velocity: size * rate * cos, acceleration: -size * rate * rate * sin }
        }
    };
    let (slow, quick, other) = (wave(0.5, (0.2, 0.3)), wave(0.05, (0.9, 1.3)), wave(0.4, (0.1, 0.2)));
    let at = |i: usize| {
        let t = i as f64 / RATE_HZ;
        let (a, b) = (slow(t), quick(t));
        let own = Motion {
            position: 0.6 + a.position + b.position,
            velocity: a.velocity + b.velocity,
            acceleration: a.acceleration + b.acceleration,
        };
        [own, other(t)]
    };
    (0..SAMPLES).map(at).collect()
}

/// What the sensor reads along `motions`: passage, torque, delay and reading, as prediction and simulation have them.
fn readings_nm<S: Evaluated<Given = f64>>(model: &Model<S>, motions: &[[Motion; 2]]) -> Vec<S> {
    let mut passage = Passage::after(model, Direction::Up, motions[0][0].position, 0.0);
    let sample = |i: usize| {
        let time_s = i as f64 / RATE_HZ;
        Sample { time_s, elapsed_s: 3.0 + time_s, own: motions[i][0], others: &motions[i][1..] }
    };
    let driven = |i: usize| {
        let k_tilde = passage.step(motions[i][0].position, Direction::of(motions[i][0].velocity));
        let sample = sample(i);
        model.driven_nm(&sample, model.asked_alone(sample.own, S::from(0.1)), k_tilde).torque_nm
    };
    let late_nm = model.late_nm((0..motions.len()).map(driven).collect(), RATE_HZ);
    late_nm.iter().enumerate().map(|(i, y)| model.reading_nm(&sample(i), *y)).collect()
}

/// Compares the derivatives by one number of `model` with its central difference along `motions`.
fn compare(
    name: &str,
    model: &Model,
    motions: &[[Motion; 2]],
    of_f64: impl Fn(&mut Model) -> &mut f64,
    of_dual: impl Fn(&mut Model<Dual>) -> &mut Dual,
) {
    let mut moved = model.clone();
    let value = *of_f64(&mut moved);
    let step = STEP * value.abs().max(1e-3);
    let mut along = |x: f64| {
        *of_f64(&mut moved) = x;
        readings_nm(&moved, motions)
    };
    let (less, more) = (along(value - step), along(value + step));
    let mut moving = model.over::<Dual>();
    *of_dual(&mut moving) = Dual::variable(value, 2);
    let exact = readings_nm(&moving, motions);
    let plain = readings_nm(model, motions);
    let largest = exact.iter().map(|y| y.slopes[2].abs()).fold(0.0, f64::max);
    assert!(largest > 0.0 && largest.is_finite(), "{name}: no derivative");
    for (i, y) in exact.iter().enumerate() {
        let quotient = (more[i] - less[i]) / (2.0 * step);
        // Of values near 1 N m a difference keeps 1e-16 / step.
        let rounding = 4.0 * f64::EPSILON * plain[i].abs().max(1.0) / step;
        let off = (y.slopes[2] - quotient).abs();
        assert!(off <= WITHIN * largest + rounding, "{name}, sample {i}: {} for {quotient} of {largest}", y.slopes[2]);
        assert!((y.value - plain[i]).abs() <= 1e-12, "{name}, sample {i}: value {} for {}", y.value, plain[i]);
        assert_eq!(y.slopes[0], 0.0, "{name}: a slope by nothing");
    }
}

/// The bundled model with every term, scattered, its friction changing over along `combination`.
fn scattered(combination: Combination, random: &mut ChaCha8Rng) -> Model {
    let mut model = Model { combination, ..truth() };
    model.joint.backlash_m = 0.003 * random.random_range(0.8..1.2);
    model.dynamics.position_zero_rad = 0.02;
    for direction in Direction::BOTH {
        let sign = direction.sign();
        let values = [0.15, 20.0 * sign, 6.0 * sign, 900.0 * sign, 4.0 * sign, 12.0 * sign, 9.0];
        for (term, value) in Term::ALL.into_iter().zip(values) {
            model.friction.of_mut(direction)[term] = value * random.random_range(0.8..1.2);
        }
    }
    model
}

#[test]
fn by_the_model_s_own_parameters() {
    for seed in 0..4 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let motions = motions(&mut random);
        for combination in [Combination::Linear, Combination::arctan(1.3), Combination::Power { n: 1.4 }] {
            let model = scattered(combination, &mut random);
            for (direction, term) in Direction::BOTH.into_iter().flat_map(|d| Term::ALL.map(|term| (d, term))) {
                let name = term.dotted(direction);
                compare(
                    &name,
                    &model,
                    &motions,
                    |m| &mut m.friction.of_mut(direction)[term],
                    |m| &mut m.friction.of_mut(direction)[term],
                );
            }
            let own: [(&str, Slot<f64>, Slot<Dual>); 4] = [
                ("gravity", |m| &mut m.dynamics.gravity_nm, |m| &mut m.dynamics.gravity_nm),
                ("inertia", |m| &mut m.dynamics.inertia_kg_m2, |m| &mut m.dynamics.inertia_kg_m2),
                ("zero", |m| &mut m.dynamics.position_zero_rad, |m| &mut m.dynamics.position_zero_rad),
                ("backlash", |m| &mut m.joint.backlash_m, |m| &mut m.joint.backlash_m),
            ];
            for (name, of_f64, of_dual) in own {
                compare(name, &model, &motions, of_f64, of_dual);
            }
            if !matches!(combination, Combination::Linear) {
                compare("curve", &model, &motions, parameter_of_curve, parameter_of_curve);
            }
        }
    }
}

fn parameter_of_curve<S>(model: &mut Model<S>) -> &mut S {
    match &mut model.combination {
        Combination::Arctan { p, .. } => p,
        Combination::Power { n } => n,
        _ => unreachable!("a curve without a parameter"),
    }
}

#[test]
fn by_every_parameter_of_every_effect() {
    for seed in 0..3 {
        for effect in LIBRARY {
            let about = effect.about();
            let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
            let motions = motions(&mut random);
            let mut added = example(about.id);
            for (parameter, value) in about.parameters.iter().zip(&mut added.parameters) {
                match parameter.role {
                    Role::Strength if *value == 0.0 => *value = 0.02,
                    Role::Strength | Role::Shape => *value *= random.random_range(0.95..1.05),
                    Role::Position | Role::Level | Role::Choice | Role::Form => {}
                }
            }
            let mut model = scattered(Combination::Power { n: 1.4 }, &mut random);
            // Levels lie within what the sensor reads.
            let plain_nm = readings_nm(&model, &motions);
            let (low, high) = plain_nm.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
            let levels = about.parameters.iter().zip(&mut added.parameters).filter(|(p, _)| p.role == Role::Level);
            levels.zip([0.2, 0.8]).for_each(|((_, level), share)| *level = low + share * (high - low));
            model.effects.push(added);
            for (at, parameter) in about.parameters.iter().enumerate() {
                if matches!(parameter.role, Role::Choice | Role::Form) || !effect.uses(&model.effects[0].parameters, at)
                {
                    continue;
                }
                let name = format!("{} {}", about.id, parameter.name);
                compare(
                    &name,
                    &model,
                    &motions,
                    |m| &mut m.effects[0].parameters[at],
                    |m| &mut m.effects[0].parameters[at],
                );
            }
        }
    }
}

#[test]
fn bristles_that_are_exponential_have_a_derivative_by_their_exponent() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let motions = motions(&mut random);
    let added = Added::parse("presliding:travel_rad=0.01,exponent=1").unwrap();
    let model = Model { effects: vec![added], ..scattered(Combination::Linear, &mut random) };
    // Beside the exponent of 1 the quotient is of the general form; the derivative at 1 is that of the expansion.
    let mut moving = model.over::<Dual>();
    moving.effects[0].parameters[1] = Dual::variable(1.0, 0);
    let exact = readings_nm(&moving, &motions);
    let beside = |exponent: f64| {
        let mut moved = model.clone();
        moved.effects[0].parameters[1] = exponent;
        readings_nm(&moved, &motions)
    };
    let (less, more) = (beside(1.0 - 1e-4), beside(1.0 + 1e-4));
    let largest = exact.iter().map(|y| y.slopes[0].abs()).fold(0.0, f64::max);
    assert!(largest > 1e-4, "{largest}");
    for (i, y) in exact.iter().enumerate() {
        let quotient = (more[i] - less[i]) / 2e-4;
        assert!((y.slopes[0] - quotient).abs() < 1e-5 * largest + 1e-9, "sample {i}: {} for {quotient}", y.slopes[0]);
    }
}
