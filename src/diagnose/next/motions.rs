//! Motions that could tell causes apart, within what a campaign has shown the joint to reach and moderately beyond.

use crate::effects::Extent;
use crate::trajectory::{Path, Segment, Trajectory};

/// A revolute joint may be asked to go so much beyond either end of the recorded range, rad: 45 deg, half of 0 to 90 deg.
const WIDER_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// It may be asked to move so many times as fast as recorded.
const FASTER: f64 = 2.0;
/// Slow motion is so many times as slow as fast motion at least, and no slower than this share of it: slower is always safe.
const SLOWER: f64 = 5.0;
const SLOWEST: f64 = 0.02;
/// Ramps reach their speed within this share of the way, so that sweeps are sweeps.
const RAMP_SHARE: f64 = 0.05;
/// No sweep takes longer, s.
const SWEEP_S: f64 = 30.0;
/// Reversals go back by so many clearances, and by this share of the range at least.
const BACK_CLEARANCES: f64 = 3.0;
const BACK_SHARE: f64 = 0.06;
/// Places at which small reversals are tried, as shares of the range.
const PLACES: [f64; 4] = [0.1, 0.4, 0.65, 0.9];
/// A pause in which a joint cools or a sensor drifts, s, and how many.
const DWELL_S: f64 = 120.0;
const DWELLS: usize = 2;
/// A rest at an end, s.
const REST_S: f64 = 2.0;
/// How far another joint swings about where it was recorded, rad, where it hardly moved; and its period, s.
const SWING_RAD: f64 = 0.35;
const SWING_S: f64 = 8.0;

/// What a motion asks beyond what was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beyond {
    Nothing,
    Speed,
    Range,
}

/// One motion that may be proposed.
#[derive(Debug, Clone)]
pub struct Motion {
    pub trajectory: Trajectory,
    /// For people: "slow sweeps".
    pub means: &'static str,
    pub beyond: Beyond,
}

/// What motions are made of.
pub struct Reach {
    low_rad: f64,
    high_rad: f64,
    slow_rad_s: f64,
    fast_rad_s: f64,
    back_rad: f64,
    /// Lowest and highest position of each other joint, rad.
    others_rad: Vec<(f64, f64)>,
}

impl Reach {
    /// What the campaign over `extent` reaches, other joints between `others_rad`; nothing where the joint hardly moved.
    pub fn of(extent: &Extent, others_rad: Vec<(f64, f64)>) -> Option<Self> {
        let (low_rad, high_rad) = extent.position_rad;
        let span = high_rad - low_rad;
        let (slow, fast) = extent.speed_rad_s;
        if !(span.is_finite() && span > 0.0 && fast.is_finite() && fast > 0.0) {
            return None;
        }
        let back_rad = (BACK_CLEARANCES * extent.backlash_m / extent.pulley_radius_m).max(BACK_SHARE * span);
        let slow_rad_s = slow.clamp(SLOWEST * fast, fast / SLOWER);
        Some(Self { low_rad, high_rad, slow_rad_s, fast_rad_s: fast, back_rad: back_rad.min(span / 2.0), others_rad })
    }

    fn span(&self) -> f64 {
        self.high_rad - self.low_rad
    }

    /// The same further at both ends, by no more than its own width.
    fn wider(&self) -> Self {
        let (low_rad, high_rad) = (self.low_rad - WIDER_RAD, self.high_rad + WIDER_RAD);
        Self { low_rad, high_rad, others_rad: self.others_rad.clone(), ..*self }
    }

    /// All motions, those within what was recorded first.
    pub fn motions(&self, turns: bool) -> Vec<Motion> {
        let mut all = self.within(Beyond::Nothing);
        all.extend(self.others_alone());
        let fast = FASTER * self.fast_rad_s;
        all.push(self.motion(
            "twice_as_fast",
            "sweeps at twice the recorded speed",
            Beyond::Speed,
            self.sweeps(fast, 8),
        ));
        all.push(self.motion(
            "fast_cosines",
            "cosines up to twice the recorded speed",
            Beyond::Speed,
            self.cosines(fast),
        ));
        if turns {
            all.extend(self.wider().within(Beyond::Range));
        }
        all
    }

    fn within(&self, beyond: Beyond) -> Vec<Motion> {
        let is_wide = beyond == Beyond::Range;
        let named = |narrow: &'static str, wide: &'static str| if is_wide { wide } else { narrow };
        let middle = (self.slow_rad_s * self.fast_rad_s).sqrt();
        let mut all = vec![
            self.motion(
                named("slow_sweeps", "wide_slow_sweeps"),
                "slow sweeps",
                beyond,
                self.sweeps(self.slow_rad_s, 2),
            ),
            self.motion(
                named("fast_sweeps", "wide_fast_sweeps"),
                "fast sweeps",
                beyond,
                self.sweeps(self.fast_rad_s, 8),
            ),
            self.motion(
                named("sweeps", "wide_sweeps"),
                "sweeps at three speeds",
                beyond,
                [self.sweeps(self.slow_rad_s, 1), self.sweeps(middle, 2), self.sweeps(self.fast_rad_s, 3)].concat(),
            ),
            self.motion(
                named("cosines", "wide_cosines"),
                "a cascade of cosines",
                beyond,
                self.cosines(self.fast_rad_s),
            ),
        ];
        if !is_wide {
            all.push(self.motion("small_reversals", "small reversals at several positions", beyond, self.reversals()));
            all.push(self.motion("rests_at_ends", "sweeps with rests at both ends", beyond, self.rests()));
            all.push(self.motion("long_dwells", "sweeps with minutes of rest between them", beyond, self.dwells()));
        }
        all
    }

    fn motion(&self, name: &str, means: &'static str, beyond: Beyond, segments: Vec<Segment>) -> Motion {
        let rest = |(low, high): &(f64, f64)| Path {
            start_rad: rounded((low + high) / 2.0),
            segments: vec![Segment::Rest { duration_s: REST_S }],
        };
        let own = Path { start_rad: rounded(self.low_rad), segments };
        let others = self.others_rad.iter().map(rest).collect();
        Motion { trajectory: Trajectory { name: name.to_string(), repeats: None, own, others }, means, beyond }
    }

    fn sweep(&self, to_rad: f64, speed_rad_s: f64) -> Segment {
        let speed_rad_s = speed_rad_s.max(self.span() / SWEEP_S);
        let acceleration_rad_s2 = speed_rad_s * speed_rad_s / (2.0 * RAMP_SHARE * self.span());
        Segment::Sweep {
            to_rad: rounded(to_rad),
            speed_rad_s: significant(speed_rad_s),
            acceleration_rad_s2: significant(acceleration_rad_s2),
        }
    }

    fn sweeps(&self, speed_rad_s: f64, times: usize) -> Vec<Segment> {
        let pair = || [self.sweep(self.high_rad, speed_rad_s), self.sweep(self.low_rad, speed_rad_s)];
        (0..times).flat_map(|_| pair()).collect()
    }

    /// Periods whose peak speed is the fastest, a half and an eighth of it.
    fn cosines(&self, fast_rad_s: f64) -> Vec<Segment> {
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
    fn reversals(&self) -> Vec<Segment> {
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

    fn rests(&self) -> Vec<Segment> {
        let rest = || Segment::Rest { duration_s: REST_S };
        let at = |speed: f64| [self.sweep(self.high_rad, speed), rest(), self.sweep(self.low_rad, speed), rest()];
        [self.fast_rad_s, self.fast_rad_s, (self.slow_rad_s * self.fast_rad_s).sqrt()]
            .into_iter()
            .flat_map(at)
            .collect()
    }

    fn dwells(&self) -> Vec<Segment> {
        let mut segments = self.sweeps(self.fast_rad_s, 3);
        for _ in 0..DWELLS {
            segments.push(Segment::Rest { duration_s: DWELL_S });
            segments.extend(self.sweeps(self.fast_rad_s, 3));
        }
        segments
    }

    /// Each other joint swinging while this one sweeps, then rests.
    fn others_alone(&self) -> Vec<Motion> {
        let swing = |at: usize| {
            let mut segments = self.sweeps(self.fast_rad_s, 1);
            let still_s = 3.0 * SWING_S;
            segments.push(Segment::Rest { duration_s: still_s });
            segments.extend(self.sweeps(self.fast_rad_s, 1));
            let mut motion = self.motion(
                &format!("other_{}_alone", at + 1),
                "another joint moving alone",
                Beyond::Nothing,
                segments,
            );
            let (low, high) = self.others_rad[at];
            let (middle, half) = ((low + high) / 2.0, ((high - low) / 2.0).max(SWING_RAD));
            let before_s: f64 = duration_s(&motion.trajectory.own) / 2.0 - still_s / 2.0;
            motion.trajectory.others[at] = Path {
                start_rad: rounded(middle - half),
                segments: vec![
                    Segment::Rest { duration_s: significant(before_s.max(REST_S)) },
                    Segment::Cosine {
                        low_rad: rounded(middle - half),
                        high_rad: rounded(middle + half),
                        period_s: SWING_S,
                        periods: 3,
                    },
                ],
            };
            motion
        };
        (0..self.others_rad.len()).map(swing).collect()
    }
}

/// How long a motion takes, s.
pub fn duration_s(path: &Path) -> f64 {
    let mut at_rad = path.start_rad;
    let step = |segment: &Segment| {
        let took_s = segment.duration_s(at_rad);
        at_rad = segment.end_rad(at_rad);
        took_s
    };
    path.segments.iter().map(step).sum()
}

/// To a tenth of a mrad (or of a mm): what a person can read in the file.
fn rounded(position: f64) -> f64 {
    (position * 1e4).round() / 1e4
}

/// To three digits.
fn significant(x: f64) -> f64 {
    if x <= 0.0 || !x.is_finite() {
        return x;
    }
    let unit = 10f64.powf(x.log10().floor() - 2.0);
    let scaled = (x / unit).round();
    // Dividing by a whole power leaves fewer digits than multiplying by its inverse.
    if unit < 1.0 { scaled / (1.0 / unit).round() } else { scaled * unit }
}
