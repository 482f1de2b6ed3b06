//! The joint behind the drive: its torque is the model's for the motion that it really makes, as its sensor reads it.

use super::master::*;
use tautline::bus::Bus;
use tautline::effects::Added;
use tautline::model::Model;
use tautline::simulate::torque_nm;

/// Half a swing of a cosine up and down again, 0.1 to 0.9 rad in 2 s, after going to its start: position, rad, and sensor, N m.
fn swing(model: Model, noise_nm: f64) -> (Vec<f64>, Vec<f64>) {
    let mut master = Master::at(Bus::demo(model, noise_nm, 5));
    master.reach_enabled();
    let begin = rad(master.wanted.position);
    let mut all = Vec::new();
    for i in 0..3000 {
        let t = f64::from(i) * 1e-3;
        let start = begin + (0.1 - begin) * t.min(1.0);
        let wave = 0.4 * (1.0 - (std::f64::consts::TAU * (t - 1.0).max(0.0) / 2.0).cos());
        master.wanted.position = counts(start + wave);
        let told = master.cycle();
        all.push((rad(told.position), f64::from(told.sensor) / 32767.0 * 5.0));
    }
    all.into_iter().unzip()
}

/// Running mean over 41 samples: targets in whole counts shake the joint, and differences of its positions shake more.
fn smooth(values: &[f64]) -> Vec<f64> {
    values.windows(41).map(|window| window.iter().sum::<f64>() / 41.0).collect()
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_sensor_reads_what_the_model_predicts_of_the_motion() {
    let (position_rad, sensor_nm) = swing(truth(), 0.0);
    let predicted_nm = torque_nm(&truth(), &position_rad, 1000.0);
    // From where the clearance has been gone through once.
    let (a, b) = (smooth(&sensor_nm[500..]), smooth(&predicted_nm[500..]));
    let range_nm = b.iter().cloned().fold(0.0, f64::max) - b.iter().cloned().fold(0.0, f64::min);
    assert!(range_nm > 1.0, "{range_nm} N m");
    assert!(farthest(&a, &b) < 0.01, "{} N m apart", farthest(&a, &b));
}

#[test]
fn effects_of_the_model_act_and_its_sensor_may_be_late() {
    let late = Model { effects: vec![Added::parse("time_delay:delay_s=0.05").unwrap()], ..truth() };
    let (position_rad, sensor_nm) = swing(truth(), 0.0);
    let (position_late_rad, late_nm) = swing(late, 0.0);
    assert_eq!(position_rad, position_late_rad, "only the reading is late");
    assert!(farthest(&late_nm[1050..], &sensor_nm[1000..2950]) < 2e-3);

    let biased = Model { effects: vec![Added::parse("sensor_bias:bias_nm=0.25").unwrap()], ..truth() };
    let (_, biased_nm) = swing(biased, 0.0);
    assert!((biased_nm[2000] - sensor_nm[2000] - 0.25).abs() < 1e-3);
}

#[test]
fn noise_is_as_large_as_asked() {
    let (_, clean_nm) = swing(truth(), 0.0);
    let (_, noisy_nm) = swing(truth(), 0.02);
    let squares: f64 = clean_nm.iter().zip(&noisy_nm).map(|(a, b)| (a - b).powi(2)).sum();
    let spread_nm = (squares / clean_nm.len() as f64).sqrt();
    assert!((0.019..0.021).contains(&spread_nm), "{spread_nm} N m");
}
