//! Sweeps whose load is measured, or absent: where A comes from.

use crate::campaigns::{identified, plan, record, truth};
use std::path::Path;
use tautline::identify::{Identification, Route, Settings};
use tautline::model::{Direction, Model};
use tautline::simulate::{Plan, Sensors};

/// mu_c against the truth, on logs with noise of 10 mN m.
const MU_TOLERANCE: f64 = 2e-3;
/// B(v) of the model against the truth, N m.
const B_TOLERANCE_NM: f64 = 2e-3;

fn noisy(seed: u64) -> Plan {
    let sensors = Sensors { torque_noise_nm: 0.01, encoder_counts: 524_288.0 };
    Plan { repeats: 2, cosines: 1, sensors, seed, rate_hz: 100.0, ..plan() }
}

fn rewrite(file: &Path, change: impl Fn(String) -> String) {
    std::fs::write(file, change(std::fs::read_to_string(file).unwrap())).unwrap();
}

/// The campaign in `folder` with `share` of gravity's torque told as a measured load instead.
fn gravity_as_load(folder: &Path, model: &Model, share: f64) {
    let load_nm = share * model.dynamics.gravity_nm;
    let with_load = |(i, line): (usize, &str)| match (i, line.split(',').nth(1)) {
        (0, _) => format!("{line},load_nm"),
        (_, Some(degrees)) => format!("{line},{:.9}", load_nm * degrees.parse::<f64>().unwrap().to_radians().sin()),
        _ => line.to_string(),
    };
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|e| e == "csv") {
            rewrite(&file, |text| text.lines().enumerate().map(with_load).collect::<Vec<String>>().join("\n") + "\n");
        }
    }
    let left = format!("gravity_nm = {}", model.dynamics.gravity_nm - load_nm);
    let column = "[columns]\nload_torque = { name = \"load_nm\", unit = \"N m\" }";
    rewrite(&folder.join("campaign.toml"), |text| {
        text.replace("gravity_nm = 0.6916", &left).replace("[columns]", column)
    });
}

fn assert_recovered(found: &Identification, model: &Model) {
    for direction in Direction::BOTH {
        let (ours, theirs) = (found.model.friction.of(direction), model.friction.of(direction));
        assert!((ours.mu_c - theirs.mu_c).abs() < MU_TOLERANCE, "{direction:?}: {} for {}", ours.mu_c, theirs.mu_c);
    }
}

#[test]
fn a_measured_load_gives_a_with_gravity_or_without() {
    for (seed, share) in [(1, 1.0), (2, 1.0), (3, 0.4)] {
        let model = truth();
        let folder = record(&model, &noisy(seed));
        gravity_as_load(folder.path(), &model, share);
        let found = identified(folder.path(), Settings::default());
        assert_recovered(&found, &model);
        let rmse_nm = found.rmse_nm();
        assert!(rmse_nm < 8e-3, "{rmse_nm}");
        let Route::Sweeps(fits) = &found.route else { panic!("not by sweeps") };
        // Without gravity A is what the winch sees of 1 N m, with it of gravity's torque.
        let unit_nm = if share == 1.0 { 1.0 } else { 0.6916 * (1.0 - share) };
        let a_nm = model.joint.transmission() * unit_nm / (1.0 - model.friction.up.mu_c);
        assert!((fits.up.a.a_nm / a_nm - 1.0).abs() < 5e-3, "{} for {a_nm}", fits.up.a.a_nm);
        assert!(fits.up.covariance.as_ref().unwrap().parameters.contains(&tautline::model::Term::Load));
    }
}

#[test]
fn the_fitted_line_of_the_trace_follows_the_load() {
    let model = truth();
    let folder = record(&model, &noisy(4));
    gravity_as_load(folder.path(), &model, 1.0);
    let trace = identified(folder.path(), Settings::default()).trace.unwrap();
    assert!(trace.with_load);
    let mut compared = 0;
    for (time_s, y_nm) in trace.legs.iter().flat_map(|(_, line)| line) {
        let i = trace.time_s.partition_point(|t| t < time_s);
        // The low-passed noise of 10 mN m is 3 mN m; a line that knew no load would be off by 200.
        assert!((trace.filtered_nm[i] - y_nm).abs() < 0.02, "at {time_s} s: {y_nm} for {}", trace.filtered_nm[i]);
        compared += 1;
    }
    assert!(compared > 100);
}

#[test]
fn without_any_load_a_is_fixed_at_zero() {
    for (seed, noise_nm) in [(1, 0.01), (2, 0.01), (3, 0.0)] {
        let mut model = truth();
        model.dynamics.gravity_nm = 0.0;
        let mut plan = noisy(seed);
        plan.sensors.torque_noise_nm = noise_nm;
        let found = identified(record(&model, &plan).path(), Settings::default());
        let Route::Sweeps(fits) = &found.route else { panic!("not by sweeps") };
        for direction in Direction::BOTH {
            let fit = fits.of(direction);
            assert!(fit.a.fixed && fit.a.a_nm == 0.0 && fit.friction.mu_c == 0.0);
            let told = |w: &String| w.contains("A is fixed at 0") && w.contains(direction.name());
            assert!(found.warnings.iter().any(told), "{:?}", found.warnings);
            let (r1, r2) = (model.joint.winch_radius_m, model.joint.pulley_radius_m);
            for v in [0.06, 0.2, 0.35] {
                let theirs = model.friction.of(direction);
                let truth_nm = theirs.unloaded_nm(direction, v, r1, r2) / (1.0 - theirs.mu_c);
                let ours_nm = fit.friction.unloaded_nm(direction, v, r1, r2);
                assert!((ours_nm - truth_nm).abs() < B_TOLERANCE_NM, "B({v}): {ours_nm} for {truth_nm}");
            }
        }
    }
}

#[test]
fn a_load_that_does_not_change_is_refused_with_its_reason() {
    let model = truth();
    let folder = record(&model, &plan());
    gravity_as_load(folder.path(), &model, 1.0);
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|e| e == "csv") {
            let constant = |(i, line): (usize, &str)| match line.rsplit_once(',') {
                Some((rest, _)) if i > 0 => format!("{rest},0.5"),
                _ => line.to_string(),
            };
            rewrite(&file, |text| text.lines().enumerate().map(constant).collect::<Vec<String>>().join("\n") + "\n");
        }
    }
    let campaign = tautline::log::Campaign::read(folder.path()).unwrap();
    let problems = tautline::identify::run(&campaign, Settings::default(), &|| ()).map(|_| ()).unwrap_err().to_string();
    assert!(problems.contains("does not change along a leg"), "{problems}");
}
