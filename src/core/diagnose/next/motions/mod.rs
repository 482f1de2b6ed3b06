//! Motions that could tell causes apart, within what a campaign has shown the joint to reach and moderately beyond.

mod shapes;

use crate::effects::Extent;
use crate::trajectory::{Path, Protocol, Segment, Trajectory};
use shapes::{rounded, significant};

/// How far beyond either end of the recorded range a revolute joint may be asked to go, rad: 45 deg, half of 0 to 90 deg.
const WIDER_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// It may be asked to move at up to this multiple of the recorded speed.
const FASTER: f64 = 2.0;
/// Slow motion is slower than fast motion by at least this factor, and no slower than this share of it: slower is always safe.
const SLOWER: f64 = 5.0;
const SLOWEST: f64 = 0.02;
/// Reversals go back by this many clearances, and by at least this share of the range.
const BACK_CLEARANCES: f64 = 3.0;
const BACK_SHARE: f64 = 0.06;
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
        let (name, protocol) = (name.to_string(), Protocol::Free);
        Motion { trajectory: Trajectory { name, protocol, repeats: None, own, others }, means, beyond }
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
            let before_s: f64 = motion.trajectory.own.duration_s() / 2.0 - still_s / 2.0;
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
