//! A jog, with what the operator saw of it -> the rig's numbers: sign and scale of drive and sensor, the joint's zero.
//!
//! **Drive**: the counts between the ends of the jog by the angle that was seen between them are `counts_per_rad`; `sign` is wrong where
//! the joint went down while up was asked for. What was there before stays where it agrees as well as an angle can be read. **Zero**: from
//! a pose that the operator tells. **Sensor**: friction acts against every motion, so the torque going up is above that going down (see
//! `tried`): where it is not, `nm_per_count` has the wrong sign. The mean of both ways is free of friction: under a known load it gives the
//! scale. Without one, the drive's own torque shows what the sensor should have read; this is reported but not written to the rig, because
//! friction ahead of the sensor reduces it.

use super::rig::Rig;
use super::tried::{self, Fit};
use std::f64::consts::FRAC_PI_2;

/// A pose is an angle about which a joint's zero lies, and no more than some turns, rad (m of a prismatic joint).
const FARTHEST: f64 = 8.0 * FRAC_PI_2;
/// Significant digits of a scale: an angle read to a thousandth is a good one.
const DIGITS: i32 = 6;
/// Share of the limit of torque that a known load must be at least, to give a scale.
const HEAVY: f64 = 0.05;

/// The torque at one moment of a steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// rad.
    pub position_rad: f64,
    /// At the sensor, N m.
    pub torque_nm: f64,
    /// The drive's own, N m at the winch.
    pub drive_nm: f64,
}

/// What a jog has shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Jogged {
    /// The lowest and the highest position, rad as the rig counts.
    pub ends_rad: (f64, f64),
    /// Where it ended, rad as the rig counts.
    pub end_rad: f64,
    /// On the steady ways up ...
    pub up: Vec<Sample>,
    /// ... and down.
    pub down: Vec<Sample>,
}

/// What the operator saw and knows; for a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// The way between the ends of the jog, rad, negative where the joint went down while up was asked for.
    pub moved_rad: Option<f64>,
    /// How well that is read, rad.
    pub read_to_rad: f64,
    /// Where the joint is at the end, rad.
    pub at_rad: Option<f64>,
    /// The torque at the winch that holds the joint where it was jogged, N m: a known weight.
    pub load_nm: Option<f64>,
}

/// A number of the rig's file that should be another.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// The section of the file.
    pub section: &'static str,
    /// The key in it.
    pub key: &'static str,
    /// What the rig says.
    pub before: f64,
    /// What it should say.
    pub after: f64,
    /// Why, in words.
    pub why: String,
}

/// Numbers that should be others, and what else was seen, in words.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// In the order of the file.
    pub proposals: Vec<Proposal>,
    /// Lines of a report.
    pub lines: Vec<String>,
}

/// What follows for `rig` from a jog and from what the operator told of it.
///
/// Errors: something told that cannot be so, in words.
pub fn findings(rig: &Rig, jogged: &Jogged, told: &Told) -> Result<Findings, String> {
    let mut found = Findings::default();
    let drive = &rig.drive;
    let (mut sign, mut counts_per_rad) = (drive.sign, drive.counts_per_rad);
    if let Some(moved_rad) = told.moved_rad {
        (sign, counts_per_rad) = found.drive(rig, jogged, moved_rad, told.read_to_rad)?;
    }
    if let Some(at_rad) = told.at_rad {
        if !at_rad.is_finite() || at_rad.abs() > FARTHEST {
            return Err(format!("{at_rad} rad is not a pose of the joint"));
        }
        let counts = drive.counts(jogged.end_rad);
        // Adding 0 takes the sign off a zero.
        let zero_counts = (counts - sign * at_rad * counts_per_rad).round() + 0.0;
        let why = format!("{counts:.0} counts at {at_rad} rad");
        found.propose("drive", "zero_counts", drive.zero_counts, zero_counts, why);
    } else if (sign, counts_per_rad) != (drive.sign, drive.counts_per_rad) {
        found.lines.push(
            "zero_counts stays: set it from a pose that you know, by `tautline rig zero` or --at-rad here".to_string(),
        );
    }
    found.sensor(rig, jogged, sign == drive.sign, told.load_nm)?;
    Ok(found)
}

impl Findings {
    fn propose(&mut self, section: &'static str, key: &'static str, before: f64, after: f64, why: String) {
        if before != after {
            self.proposals.push(Proposal { section, key, before, after, why });
        }
    }

    /// Sign and scale of the drive.
    fn drive(&mut self, rig: &Rig, jogged: &Jogged, moved_rad: f64, read_to_rad: f64) -> Result<(f64, f64), String> {
        let drive = &rig.drive;
        let counts = (drive.counts(jogged.ends_rad.1) - drive.counts(jogged.ends_rad.0)).abs();
        if !(read_to_rad > 0.0 && moved_rad.abs() > read_to_rad) {
            return Err(format!("a way of {moved_rad} rad cannot be read to {read_to_rad} rad"));
        }
        if moved_rad.abs() > FARTHEST || counts < 1.0 {
            return Err(format!("{counts:.0} counts do not make {moved_rad} rad"));
        }
        let error = read_to_rad / moved_rad.abs();
        let seen = counts / moved_rad.abs();
        let fits = (seen / drive.counts_per_rad - 1.0).abs() <= error;
        let counts_per_rad = if fits { drive.counts_per_rad } else { rounded(seen) };
        let read = format!("{counts:.0} counts for {:.4} rad, known to {:.0} %", moved_rad.abs(), 100.0 * error);
        if fits {
            self.lines.push(format!("counts_per_rad fits what was seen ({read}): go farther to know it better"));
        }
        self.propose("drive", "counts_per_rad", drive.counts_per_rad, counts_per_rad, read);
        let sign = drive.sign * moved_rad.signum();
        self.propose("drive", "sign", drive.sign, sign, "the joint went down while up was asked for".to_string());
        Ok((sign, counts_per_rad))
    }

    /// Sign and scale of the sensor, the drive's sign being right, or turned.
    fn sensor(&mut self, rig: &Rig, jogged: &Jogged, is_up: bool, load_nm: Option<f64>) -> Result<(), String> {
        let (up, down) = common(&jogged.up, &jogged.down);
        let (up, down) = if is_up { (up, down) } else { (down, up) };
        let [up_nm, down_nm] = [&up, &down].map(|side| side.iter().map(|at| at.torque_nm).collect::<Vec<_>>());
        if up_nm.is_empty() || down_nm.is_empty() {
            self.lines.push("the sensor's sign takes a jog up and back down the same way".to_string());
            return load_nm
                .map_or(Ok(()), |_| Err("a known load needs the mean torque of both directions".to_string()));
        }
        let (fit, words) = tried::signs(rig, &up_nm, &down_nm);
        let mut nm_per_count = rig.sensor.nm_per_count;
        let mut why = words;
        let is_opposed = matches!(fit, Fit::Opposed(_));
        if is_opposed {
            nm_per_count = -nm_per_count;
        } else {
            self.lines.push(format!("sensor: {why}"));
        }
        if let Some(load_nm) = load_nm {
            let seen_nm = rig.signal.torque_sign * (mean(&up_nm) + mean(&down_nm)) / 2.0;
            let scale = load_nm / seen_nm;
            if !scale.is_finite() || seen_nm.abs().min(load_nm.abs()) < HEAVY * rig.limits.torque_nm {
                return Err(format!("the sensor's {seen_nm:+.4} N m and a load of {load_nm} N m give no scale"));
            }
            if fit != Fit::Unknown && (scale < 0.0) != is_opposed {
                return Err(format!("a load of {load_nm} N m has the wrong sign, by the friction of both ways"));
            }
            nm_per_count = rounded(scale * rig.sensor.nm_per_count);
            why = format!("{seen_nm:+.4} N m where the load makes {load_nm:+.4}; {why}");
        } else if let Some(share) = share(&up, &down) {
            self.lines.push(format!(
                "sensor: it saw {:.0} % of the change that the drive's own torque saw between up and down; friction before the \
                 sensor makes that less than 100 %, and a scale is wrong where it is far from it",
                100.0 * share
            ));
        }
        self.propose("sensor", "nm_per_count", rig.sensor.nm_per_count, nm_per_count, why);
        Ok(())
    }
}

/// The samples of each way over the positions that both have passed.
fn common(up: &[Sample], down: &[Sample]) -> (Vec<Sample>, Vec<Sample>) {
    let ends = |side: &[Sample]| {
        side.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at.position_rad), high.max(at.position_rad)))
    };
    let ((up_low, up_high), (down_low, down_high)) = (ends(up), ends(down));
    let both = up_low.max(down_low)..=up_high.min(down_high);
    let within = |side: &[Sample]| side.iter().copied().filter(|at| both.contains(&at.position_rad)).collect();
    (within(up), within(down))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The sensor's share of the drive's change of torque between the two directions; `None` where the drive's torque hardly changed.
fn share(up: &[Sample], down: &[Sample]) -> Option<f64> {
    let change = |torque: fn(&Sample) -> f64| {
        let [up, down] = [up, down].map(|side| mean(&side.iter().map(torque).collect::<Vec<_>>()));
        up - down
    };
    let share = (change(|at| at.torque_nm) / change(|at| at.drive_nm)).abs();
    share.is_finite().then_some(share)
}

/// `value` to as many digits as a scale has.
fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS as usize - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: Told = Told { moved_rad: None, read_to_rad: 0.009, at_rad: None, load_nm: None };

    fn rig() -> Rig {
        Rig::parse("rig.toml".as_ref(), include_str!("../../data/rigs/demo/rig.toml")).unwrap()
    }

    /// Two degrees each way, at a torque of `up_nm` and `down_nm` at the sensor.
    fn jog(up_nm: f64, down_nm: f64) -> Jogged {
        let at = |i: i32| f64::from(i) * 35e-6;
        let side = |torque_nm: f64| {
            let noise = |i: i32| 1e-4 * f64::from(i * 7919 % 13 - 6);
            let sample =
                move |i| Sample { position_rad: at(i), torque_nm: torque_nm + noise(i), drive_nm: 1.2 * torque_nm };
            (0..1000).map(sample).collect::<Vec<_>>()
        };
        Jogged { ends_rad: (0.0, 0.035), end_rad: 0.0, up: side(up_nm), down: side(down_nm) }
    }

    fn keys(found: &Result<Findings, String>) -> Vec<(&'static str, f64)> {
        found.as_ref().unwrap().proposals.iter().map(|new| (new.key, new.after)).collect()
    }

    #[test]
    fn what_fits_stays() {
        let rig = rig();
        let found = findings(&rig, &jog(0.3, 0.2), &Told { moved_rad: Some(0.03), ..NOTHING });
        assert_eq!(keys(&found), []);
        let lines = found.unwrap().lines.join("\n");
        assert!(lines.contains("fits what was seen") && lines.contains("83 % of the change"), "{lines}");
    }

    #[test]
    fn signs_follow_from_friction_and_from_what_was_seen() {
        let (rig, scale) = (rig(), rig().sensor.nm_per_count);
        assert_eq!(keys(&findings(&rig, &jog(0.2, 0.3), &NOTHING)), [("nm_per_count", -scale)]);
        // The joint went down while up was asked for: what was called up is down.
        let down = Told { moved_rad: Some(-0.035), ..NOTHING };
        assert_eq!(keys(&findings(&rig, &jog(0.2, 0.3), &down)), [("sign", -1.0)]);
        assert_eq!(keys(&findings(&rig, &jog(0.3, 0.2), &down)), [("sign", -1.0), ("nm_per_count", -scale)]);
        // Of torques that do not differ nothing follows.
        assert_eq!(keys(&findings(&rig, &jog(0.3, 0.3), &NOTHING)), []);
    }

    #[test]
    fn scales_follow_from_an_angle_and_from_a_load() {
        let rig = rig();
        let seen = Told { moved_rad: Some(0.07), at_rad: Some(0.1), load_nm: Some(0.5), ..NOTHING };
        let found = keys(&findings(&rig, &jog(0.3, 0.2), &seen));
        let half = rig.drive.counts_per_rad / 2.0;
        assert_eq!((found[0].0, found[1].0, found[2].0), ("counts_per_rad", "zero_counts", "nm_per_count"));
        assert!((found[0].1 / half - 1.0).abs() < 1e-5 && (found[1].1 + 0.1 * half).abs() < 1.0, "{found:?}");
        assert!((found[2].1 / (2.0 * rig.sensor.nm_per_count) - 1.0).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn what_cannot_be_so_is_refused() {
        let (rig, jog) = (rig(), jog(0.3, 0.2));
        for wrong in [
            Told { moved_rad: Some(0.0), ..NOTHING },
            Told { moved_rad: Some(f64::NAN), ..NOTHING },
            Told { moved_rad: Some(400.0), ..NOTHING },
            Told { read_to_rad: 0.0, moved_rad: Some(0.03), ..NOTHING },
            Told { at_rad: Some(f64::INFINITY), ..NOTHING },
            Told { load_nm: Some(0.0), ..NOTHING },
            Told { load_nm: Some(-0.5), ..NOTHING },
        ] {
            assert!(findings(&rig, &jog, &wrong).is_err(), "{wrong:?}");
        }
        let one_way = Jogged { down: Vec::new(), ..jog };
        assert!(findings(&rig, &one_way, &Told { load_nm: Some(0.5), ..NOTHING }).is_err());
        assert_eq!(keys(&findings(&rig, &one_way, &NOTHING)), []);
    }
}
