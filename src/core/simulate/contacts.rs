//! A person's touches: bursts of torque of random size, direction and length.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Nobody touches the joint before, s.
const LEAD_S: f64 = 3.0;
/// Smallest and largest torque, N m.
const SIZE_NM: (f64, f64) = (0.3, 1.5);
/// Shortest and longest rise and fall, s.
const RISE_S: (f64, f64) = (0.2, 0.6);
/// Shortest and longest hold, s.
const HOLD_S: (f64, f64) = (0.3, 2.0);
/// Shortest and longest pause, s.
const PAUSE_S: (f64, f64) = (1.5, 4.0);

/// The torque that a person adds in each of `samples`, N m: smooth pulses with pauses between.
pub fn contacts_nm(samples: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut torque_nm = vec![0.0; samples];
    let end_s = samples as f64 / rate_hz - LEAD_S;
    let mut start_s = LEAD_S;
    loop {
        let (rise_s, hold_s) = (between(&mut random, RISE_S), between(&mut random, HOLD_S));
        let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
        let size_nm = sign * between(&mut random, SIZE_NM);
        let length_s = 2.0 * rise_s + hold_s;
        if start_s + length_s > end_s {
            return torque_nm;
        }
        let (from, to) = ((start_s * rate_hz) as usize, ((start_s + length_s) * rate_hz) as usize);
        for (i, slot) in torque_nm.iter_mut().enumerate().take(to).skip(from) {
            let t = i as f64 / rate_hz - start_s;
            let share = (t.min(length_s - t) / rise_s).clamp(0.0, 1.0);
            *slot = size_nm * (1.0 - (PI * share).cos()) / 2.0;
        }
        start_s += length_s + between(&mut random, PAUSE_S);
    }
}

fn between(random: &mut impl Rng, (low, high): (f64, f64)) -> f64 {
    random.random_range(low..high)
}
