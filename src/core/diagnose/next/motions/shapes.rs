//! The pieces that motions are made of.

use super::{REST_S, Reach};
use crate::trajectory::Segment;

/// Ramps reach their speed within this share of the way, so that sweeps are sweeps.
const RAMP_SHARE: f64 = 0.05;
/// No sweep takes longer, s, where the joint was seen to be fast enough.
const SWEEP_S: f64 = 30.0;
/// Places at which small reversals are tried, as shares of the range.
const PLACES: [f64; 4] = [0.1, 0.4, 0.65, 0.9];
/// A pause in which a joint cools or a sensor drifts, s, and how many.
const DWELL_S: f64 = 120.0;
const DWELLS: usize = 2;

impl Reach {
    pub(super) fn sweep(&self, to_rad: f64, speed_rad_s: f64) -> Segment {
        let speed_rad_s = speed_rad_s.max((self.span() / SWEEP_S).min(self.fast_rad_s));
        let acceleration_rad_s2 = speed_rad_s * speed_rad_s / (2.0 * RAMP_SHARE * self.span());
        Segment::Sweep {
            to_rad: rounded(to_rad),
            speed_rad_s: significant(speed_rad_s),
            acceleration_rad_s2: significant(acceleration_rad_s2),
        }
    }

    pub(super) fn sweeps(&self, speed_rad_s: f64, times: usize) -> Vec<Segment> {
        let pair = || [self.sweep(self.high_rad, speed_rad_s), self.sweep(self.low_rad, speed_rad_s)];
        (0..times).flat_map(|_| pair()).collect()
    }

    /// Periods whose peak speed is the fastest, a half and an eighth of it.
    pub(super) fn cosines(&self, fast_rad_s: f64) -> Vec<Segment> {
        let fastest_s = std::f64::consts::PI * self.span() / fast_rad_s;
        let period = |(slower, periods): (f64, u32)| Segment::Cosine {
            low_rad: rounded(self.low_rad),
            high_rad: rounded(self.high_rad),
            period_s: significant(slower * fastest_s),
            periods,
        };
        [(8.0, 1), (2.0, 2), (1.0, 4)].into_iter().map(period).collect()
    }

    /// Back and forth at some places: by less than the clearance, by as much, by several times as much.
    pub(super) fn reversals(&self) -> Vec<Segment> {
        let mut segments = Vec::new();
        let speed = (self.slow_rad_s * self.fast_rad_s).sqrt().min(self.back_rad);
        let all = PLACES.into_iter().chain(PLACES.into_iter().rev());
        for place in all {
            let at = self.low_rad + place * self.span();
            segments.push(self.sweep(at, self.fast_rad_s));
            for share in [0.15, 0.4, 1.0] {
                let away = if place > 0.5 { at - share * self.back_rad } else { at + share * self.back_rad };
                segments.extend([self.slow(away, speed), self.slow(at, speed)]);
            }
        }
        segments.push(self.sweep(self.low_rad, self.fast_rad_s));
        segments
    }

    /// A short sweep, as slow as it is short.
    fn slow(&self, to_rad: f64, speed_rad_s: f64) -> Segment {
        let acceleration_rad_s2 = speed_rad_s * speed_rad_s / (0.1 * self.back_rad);
        Segment::Sweep {
            to_rad: rounded(to_rad),
            speed_rad_s: significant(speed_rad_s),
            acceleration_rad_s2: significant(acceleration_rad_s2),
        }
    }

    pub(super) fn rests(&self) -> Vec<Segment> {
        let rest = || Segment::Rest { duration_s: REST_S };
        let at = |speed: f64| [self.sweep(self.high_rad, speed), rest(), self.sweep(self.low_rad, speed), rest()];
        [self.fast_rad_s, self.fast_rad_s, (self.slow_rad_s * self.fast_rad_s).sqrt()]
            .into_iter()
            .flat_map(at)
            .collect()
    }

    pub(super) fn dwells(&self) -> Vec<Segment> {
        let mut segments = self.sweeps(self.fast_rad_s, 3);
        for _ in 0..DWELLS {
            segments.push(Segment::Rest { duration_s: DWELL_S });
            segments.extend(self.sweeps(self.fast_rad_s, 3));
        }
        segments
    }
}

/// To a tenth of a mrad (or of a mm): what a person can read in the file.
pub(super) fn rounded(position: f64) -> f64 {
    (position * 1e4).round() / 1e4
}

/// To three digits.
pub(super) fn significant(x: f64) -> f64 {
    if x <= 0.0 || !x.is_finite() {
        return x;
    }
    let unit = 10f64.powf(x.log10().floor() - 2.0);
    let scaled = (x / unit).round();
    // Dividing by a whole power leaves fewer digits than multiplying by its inverse.
    if unit < 1.0 { scaled / (1.0 / unit).round() } else { scaled * unit }
}
