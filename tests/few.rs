//! Little data: few speeds, few strokes. No form runs away, and nothing counts as known that is not.

use crate::campaigns::{identified, plan, record, truth};
use nalgebra::{DMatrix, DVector};
use tautline::identify::{Form, FrictionFit, Identification, Route, Settings};
use tautline::model::{Both, Status};
use tautline::numerics::cluster;
use tautline::simulate::{Plan, Sensors};

fn campaign(speeds: usize, repeats: u32, seed: u64) -> tempfile::TempDir {
    let sensors = Sensors { torque_noise_nm: 0.02, encoder_counts: 524_288.0 };
    let plan = Plan { speeds, repeats, seed, sensors, slowest_rad_s: 0.02, cosines: 1, rate_hz: 50.0, ..plan() };
    record(&truth(), &plan)
}

fn fits(found: &Identification) -> &Both<FrictionFit> {
    match &found.route {
        Route::Sweeps(fits) => fits,
        Route::Free(_) => panic!("not by sweeps"),
    }
}

fn statuses(found: &Identification, names: &[&str]) -> Vec<Status> {
    let of = |direction: &str| {
        names
            .iter()
            .map(|name| found.model.confidence[&format!("friction.{direction}.{name}")].status)
            .collect::<Vec<Status>>()
    };
    ["up", "down"].map(of).concat()
}

/// With six speeds two exponentials left up to 79 mN m where one leaves 9; with twelve, 25.
#[test]
fn the_default_form_does_not_run_away() {
    for (speeds, repeats) in [(4, 1), (6, 1), (6, 2), (8, 1), (12, 1)] {
        for seed in [5, 13] {
            let folder = campaign(speeds, repeats, seed);
            let rmse_nm = |form| identified(folder.path(), Settings { form, ..Settings::default() }).rmse_nm();
            let (default, one) = (rmse_nm(Form::Two), rmse_nm(Form::One));
            assert!(default <= 1.02 * one, "{speeds} x {repeats}, seed {seed}: {default} where one leaves {one}");
        }
    }
}

#[test]
fn the_full_protocol_takes_the_papers_seven_parameters() {
    for seed in 1..3 {
        let found = identified(campaign(20, 3, seed).path(), Settings::default());
        let fits = fits(&found);
        assert_eq!([fits.up.taken.rates.len(), fits.down.taken.rates.len()], [2, 2], "seed {seed}");
        assert!(fits.up.cut.is_none() && fits.down.cut.is_none());
    }
}

/// A sweep of which only the top is left, where the load hardly changes: it says nothing of A, and the others are enough.
#[test]
fn a_leg_that_says_nothing_of_a_is_left_out() {
    let folder = campaign(8, 1, 3);
    let whole = identified(folder.path(), Settings::default());
    let file = folder.path().join(&whole.legs[0].file);
    let log = std::fs::read_to_string(&file).unwrap();
    let (head, rows) = log.split_once('\n').unwrap();
    let at_top = |row: &&str| row.split(',').nth(1).unwrap().parse::<f64>().unwrap() > 80.0;
    let top: Vec<&str> = std::iter::once(head).chain(rows.lines().filter(at_top)).collect();
    std::fs::write(&file, top.join("\n") + "\n").unwrap();
    let found = identified(folder.path(), Settings::default());
    assert_eq!(found.legs.len(), whole.legs.len() - 2);
    assert!(found.warnings.iter().any(|told| told.contains("left out 2 legs")), "{:?}", found.warnings);
}

#[test]
fn a_form_cut_for_want_of_speeds_says_so_and_pins_nothing_but_mu_c() {
    let found = identified(campaign(6, 1, 1).path(), Settings::default());
    let fit = &fits(&found).up;
    // Six points are too few for Akaike's criterion of one exponential, yet they show it beyond doubt.
    assert_eq!((fit.taken.rates.len(), fit.supported), (1, 1), "{}", fit.why);
    assert!(fit.why.contains("F test p = 0.00") && fit.why.contains("exactly determined"), "{}", fit.why);
    assert!(found.warnings.iter().any(|w| w.contains("6 speeds are too few")), "{:?}", found.warnings);
    let known = statuses(&found, &["a_j", "b_j", "c_j", "d"]);
    assert!(known.iter().all(|status| *status != Status::Pinned), "{known:?}");
    assert!(statuses(&found, &["mu_c"]).iter().all(|status| *status == Status::Pinned));
}

#[test]
fn an_exactly_determined_form_knows_nothing_of_its_errors() {
    for (speeds, names) in [(2, ["a_j", "d"].as_slice()), (4, &["a_j", "b_j", "c_j", "d"])] {
        let found = identified(campaign(speeds, 1, 3).path(), Settings::default());
        for fit in [&fits(&found).up, &fits(&found).down] {
            assert_eq!(fit.taken.freedom(), 0.0);
            assert!(fit.r_squared.is_nan() && fit.profile.is_none() && fit.covariance.is_err());
            assert!(fit.why.contains("exactly determined"), "{}", fit.why);
        }
        assert!(found.warnings.iter().any(|w| w.contains("determine it exactly")), "{:?}", found.warnings);
        let known = statuses(&found, names);
        assert!(known.iter().all(|status| *status == Status::Flat), "{speeds} speeds: {known:?}");
    }
}

#[test]
fn viscous_friction_that_helps_the_motion_is_told() {
    let mut helped = truth();
    helped.friction.up = tautline::model::Friction { d: -4.0, b_c: 0.0, ..helped.friction.up };
    let found = identified(record(&helped, &Plan { speeds: 12, ..plan() }).path(), Settings::default());
    assert!(found.model.friction.up.d < 0.0 && found.model.friction.down.d > 0.0);
    let told = |direction: &str| found.warnings.iter().any(|w| w.contains("helps") && w.contains(direction));
    assert!(told("moving up") && !told("moving down"), "{:?}", found.warnings);
}

#[test]
fn few_clusters_tell_nothing_of_the_errors() {
    let bread = DMatrix::from_element(1, 1, 0.5);
    let scores =
        |n: usize| (0..n).map(|i| DVector::from_element(1, if i % 2 == 0 { 1.0 } else { -1.0 })).collect::<Vec<_>>();
    assert!(cluster::covariance(&bread, &scores(4))[(0, 0)].is_infinite());
    // Bread 0.5, meat 6 scores of 1, 6 / (6 - 1) for the small sample.
    assert!((cluster::covariance(&bread, &scores(6))[(0, 0)] - 0.25 * 6.0 * 1.2).abs() < 1e-12);
    assert_eq!([cluster::freedom(4, 1), cluster::freedom(5, 5), cluster::freedom(9, 3)], [0.0, 0.0, 6.0]);
}

/// Two sweeps back and forth, marked as free motion: four strokes.
#[test]
fn few_strokes_pin_nothing() {
    let folder = campaign(2, 1, 1);
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let keep =
        text.split("[[trials]]").filter(|part| !part.contains("cosine")).collect::<Vec<&str>>().join("[[trials]]");
    let lines = keep.lines().filter(|line| !line.starts_with("speed_rad_s"));
    let free: Vec<String> = lines.map(|line| line.replace("\"uniform\"", "\"free\"")).collect();
    std::fs::write(&file, free.join("\n")).unwrap();
    let found = identified(folder.path(), Settings::default());
    assert!(matches!(found.route, Route::Free(_)));
    let identified: Vec<Status> =
        found.model.confidence.iter().filter(|(name, _)| name.starts_with("friction")).map(|(_, c)| c.status).collect();
    assert!(identified.iter().all(|s| matches!(s, Status::Flat | Status::AtBound)), "{:?}", found.model.confidence);
}
