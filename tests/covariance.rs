//! The covariance of the friction parameters: what repeated campaigns scatter by.

use crate::campaigns::truth;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::path::Path;
use tautline::identify::friction::{Data, FrictionFit, fit_friction};
use tautline::identify::legs::{amplitudes, fix_a};
use tautline::identify::stribeck::Points;
use tautline::identify::{Form, LegFit, LegZero};
use tautline::log::Uncertainty;
use tautline::model::{Both, Direction, Friction, Term};

/// Scatter over 250 draws is known to 5 %, and the linearisation adds to it.
const SD_TOLERANCE: f64 = 0.15;
/// Correlations over as many draws are known to 0.06 or better.
const CORRELATION_TOLERANCE: f64 = 0.15;
const DRAWS: usize = 250;

/// Legs at 12 speeds, three each, of a joint with one exponential; A of each leg and its mean torque with noise.
fn legs(random: &mut ChaCha8Rng, load_nm: f64) -> Vec<LegFit> {
    let joint = truth().joint;
    let noise = |sd: f64, random: &mut ChaCha8Rng| Normal::new(0.0, sd).unwrap().sample(random);
    let mut legs = Vec::new();
    for direction in Direction::BOTH {
        let s = direction.sign();
        let friction =
            Friction { mu_c: 0.4, a_j: 30.0 * s, b_j: 8.0 * s, c_j: 12.0 * s, d: 6.0, ..Friction::default() };
        let a_nm = joint.transmission() * load_nm / (1.0 - friction.mu_c);
        for i in 0..36 {
            let speed_rad_s = 0.02 * 20f64.powf(f64::from(i / 3) / 11.0);
            let unloaded = friction.unloaded_nm(direction, speed_rad_s, joint.winch_radius_m, joint.pulley_radius_m);
            legs.push(LegFit {
                file: String::new(),
                repeat: 1,
                direction,
                speed_rad_s,
                samples: 1000,
                a_nm: a_nm + noise(6e-3, random),
                a_se_nm: 6e-3,
                b_nm: 0.0,
                b_se_nm: 1e-3,
                r_squared: 1.0,
                rmse_nm: 0.0,
                raw_rmse_nm: 0.0,
                mean_sine: 0.7,
                mean_torque_nm: a_nm * 0.7 + unloaded / (1.0 - friction.mu_c) + noise(1e-3, random),
                zero: LegZero::default(),
            });
        }
    }
    legs
}

fn fit(random: &mut ChaCha8Rng) -> Both<FrictionFit> {
    let (joint, load_nm) = (truth().joint, 0.6916);
    let mut legs = legs(random, load_nm);
    let a = amplitudes(&legs, load_nm, Path::new("test")).unwrap();
    fix_a(&mut legs, &a);
    let uncertainty = Uncertainty::default();
    let data =
        Data { legs: &legs, a: &a, joint: &joint, uncertainty: &uncertainty, load_nm, campaign: Path::new("test") };
    fit_friction(&data, Form::One, None).unwrap()
}

#[test]
fn the_covariance_is_the_scatter_of_repeated_campaigns() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let draws: Vec<Both<FrictionFit>> = (0..DRAWS).map(|_| fit(&mut random)).collect();
    for direction in Direction::BOTH {
        let told: Vec<_> = draws.iter().map(|d| d.of(direction).covariance.as_ref().unwrap()).collect();
        let names = &told[0].parameters;
        assert_eq!(names, &[Term::Load, Term::Coulomb, Term::JointStribeck, Term::JointDecay, Term::Viscous]);
        let values: Vec<Vec<f64>> =
            draws.iter().map(|d| names.iter().map(|term| d.of(direction).friction[*term]).collect()).collect();
        let mean = |i: usize| values.iter().map(|v| v[i]).sum::<f64>() / DRAWS as f64;
        let scatter = |i: usize, j: usize| {
            values.iter().map(|v| (v[i] - mean(i)) * (v[j] - mean(j))).sum::<f64>() / (DRAWS as f64 - 1.0)
        };
        let told_mean = |i: usize, j: usize| told.iter().map(|c| c.matrix[(i, j)]).sum::<f64>() / DRAWS as f64;
        for i in 0..names.len() {
            let ratio = (told_mean(i, i) / scatter(i, i)).sqrt();
            assert!(
                (ratio - 1.0).abs() < SD_TOLERANCE,
                "{direction:?} {}: told {ratio} of its scatter",
                names[i].name()
            );
            for j in 0..i {
                let told = told_mean(i, j) / (told_mean(i, i) * told_mean(j, j)).sqrt();
                let seen = scatter(i, j) / (scatter(i, i) * scatter(j, j)).sqrt();
                let off = (told - seen).abs();
                assert!(
                    off < CORRELATION_TOLERANCE,
                    "{direction:?} {} {}: {told} for {seen}",
                    names[i].name(),
                    names[j].name()
                );
            }
        }
    }
}

#[test]
fn correlations_are_symmetric_and_the_strongest_come_first() {
    let fit = fit(&mut ChaCha8Rng::seed_from_u64(1)).up;
    let covariance = fit.covariance.unwrap();
    for i in 0..covariance.parameters.len() {
        assert!((covariance.correlation(i, i) - 1.0).abs() < 1e-12);
        for j in 0..i {
            assert_eq!(covariance.matrix[(i, j)], covariance.matrix[(j, i)]);
        }
    }
    let strongest = covariance.strongest(3);
    assert_eq!(strongest.len(), 3);
    assert!(strongest.windows(2).all(|pair| pair[0].2.abs() >= pair[1].2.abs()));
}

#[test]
fn a_covariance_that_cannot_be_is_told() {
    let line = |n: i32| Points::new((1..=n).map(|i| (0.05 * f64::from(i), 0.5 + 0.1 * f64::from(i), 1.0)).collect());
    let two = line(2);
    assert!(two.covariance(&two.fit(0).unwrap()).unwrap_err().contains("exactly determined"));
    // An exponential without amplitude: its rate changes nothing.
    let many = line(8);
    let mut flat = many.with_rates(&[5.0]).unwrap();
    flat.coefficients[2] = 0.0;
    assert!(many.covariance(&flat).unwrap_err().contains("singular"));
}
