//! `trajectory/1`: a motion as a TOML file.

use super::protocol::ACCELERATION_RAD_S2;
use super::{Path, Protocol, Segment, Trajectory, Wave};
use crate::document::{Document, Section, write_pairs};
use crate::problem::Result;
use std::path::Path as FilePath;
use toml::Value;

/// The format's name and version.
const FORMAT: &str = "trajectory/1";
/// The longest motion, s: ten hours; a longer one is a slip in a unit or a digit.
const LONGEST_S: f64 = 36_000.0;
/// The most repeats, periods or waves: more would be a slip too.
const MANY: i64 = 1000;
/// Where a cosine may begin beside its ends, rad: what is lost in writing a position with six digits.
const BESIDE_RAD: f64 = 1e-5;

impl Trajectory {
    /// Reads a trajectory; without a `name` it is called like its file.
    ///
    /// Errors: the file, an unknown key or kind, a number that makes no sense, a cosine that begins where the joint is not.
    pub fn read(file: &FilePath) -> Result<Self> {
        let stem = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Document::open(file)?.read(|root| {
            root.need("format").choice(&[(FORMAT, ())]);
            let name = root.may("name").text().unwrap_or(stem);
            if !is_plain(&name) {
                root.reject(
                    "name",
                    format!("is `{name}`"),
                    "logs are called by it: use letters, digits, `_`, `-`, `.`",
                );
            }
            let repeats = root.may("repeats").whole(1, MANY).and_then(|n| u32::try_from(n).ok());
            let own = read_path(root);
            let others = root.may("others").sections(read_path).unwrap_or_default();
            let protocol = read_protocol(root, own.as_ref());
            Some(Self { name, protocol: protocol?, repeats, own: own?, others })
        })
    }

    /// The text of its file.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        let mut pairs = vec![("format", FORMAT.into()), ("name", self.name.as_str().into())];
        if self.protocol != Protocol::Free {
            pairs.push(("protocol", self.protocol.name().into()));
        }
        pairs.extend(self.repeats.map(|repeats| ("repeats", i64::from(repeats).into())));
        pairs.push(("start_rad", self.own.start_rad.into()));
        write_pairs(&mut text, "", &pairs);
        write_segments(&mut text, "segments", &self.own);
        for other in &self.others {
            write_pairs(&mut text, "\n[[others]]\n", &[("start_rad", other.start_rad.into())]);
            write_segments(&mut text, "others.segments", other);
        }
        text
    }
}

/// Whether files can be called so everywhere.
fn is_plain(name: &str) -> bool {
    let begins = name.chars().next().is_some_and(|c| c.is_alphanumeric());
    begins && name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c))
}

/// What the motion `own` is for, free motion where it does not say; the speed of a uniform one is that of its sweeps.
fn read_protocol(root: &Section<'_>, own: Option<&Path>) -> Option<Protocol> {
    let sweep = Protocol::Uniform { speed_rad_s: f64::NAN };
    let all = [sweep, Protocol::Cosine, Protocol::Interaction, Protocol::Free];
    let protocol = root.may("protocol").choice(&all.map(|protocol| (protocol.name(), protocol)));
    let Protocol::Uniform { .. } = protocol.unwrap_or(Protocol::Free) else { return protocol.or(Some(Protocol::Free)) };
    let speeds: Vec<f64> = own?.segments.iter().filter_map(Segment::sweep_speed_rad_s).collect();
    match speeds.first() {
        Some(first) if speeds.iter().all(|speed| speed == first) => Some(Protocol::Uniform { speed_rad_s: *first }),
        Some(_) => {
            root.reject("protocol", "is `uniform`, and its sweeps differ in speed", "one file for each speed");
            None
        }
        None => {
            root.reject("protocol", "is `uniform`, and no segment is a sweep", "delete it, or add sweeps");
            None
        }
    }
}

fn read_path(section: &Section<'_>) -> Option<Path> {
    let start_rad = section.need("start_rad").such_as("0.0", "where the joint starts, rad").number();
    // Where the joint is, and since when, as far as that is known.
    let (mut at_rad, mut whole_s) = (start_rad.unwrap_or(f64::NAN), 0.0);
    let list = section.need("segments").such_as("[[segments]]", "one for each piece of the motion, with its kind");
    let segments = list.sections(|s| {
        let segment = read_segment(s, at_rad);
        whole_s += segment.as_ref().map_or(0.0, |segment| segment.duration_s(at_rad));
        at_rad = segment.as_ref().map_or(f64::NAN, |segment| segment.end_rad(at_rad));
        segment
    })?;
    if segments.is_empty() {
        section.reject("segments", "holds none", "add `[[segments]]` with its kind");
    }
    if whole_s > LONGEST_S {
        let what = format!("take {whole_s:.0} s together");
        section.reject("segments", what, format!("expected {LONGEST_S} s at most: check speeds and durations"));
    }
    Some(Path { start_rad: start_rad?, segments })
}

/// One segment, which begins at `at_rad`.
fn read_segment(s: &Section<'_>, at_rad: f64) -> Option<Segment> {
    let kind = s.need("kind").choice(&["rest", "sweep", "cosine", "multisine"].map(|kind| (kind, kind)));
    match kind.unwrap_or_default() {
        "" => {
            // Which of its keys would be right depends on the kind.
            s.keys().for_each(|key| s.may(key).ignore());
            None
        }
        "rest" => Some(Segment::Rest { duration_s: s.need("duration_s").positive()? }),
        "sweep" => {
            let (to_rad, speed_rad_s) = (s.need("to_rad").number(), s.need("speed_rad_s").positive());
            let acceleration_rad_s2 = s.may("acceleration_rad_s2").positive().unwrap_or(ACCELERATION_RAD_S2);
            Some(Segment::Sweep { to_rad: to_rad?, speed_rad_s: speed_rad_s?, acceleration_rad_s2 })
        }
        "cosine" => read_cosine(s, at_rad),
        _ => read_multisine(s),
    }
}

fn read_cosine(s: &Section<'_>, at_rad: f64) -> Option<Segment> {
    let (low_rad, high_rad) = (s.need("low_rad").number(), s.need("high_rad").number());
    let (period_s, periods) = (s.need("period_s").positive(), s.may("periods").whole(1, MANY).unwrap_or(1));
    let (low_rad, high_rad) = (low_rad?, high_rad?);
    if low_rad >= high_rad {
        s.reject("high_rad", format!("is {high_rad}, low_rad {low_rad}"), "high_rad must be above low_rad");
    } else if [low_rad, high_rad].iter().all(|end| (end - at_rad).abs() > BESIDE_RAD) {
        let what = format!("a cosine begins at {low_rad} or {high_rad} rad, and the joint is at {at_rad} there");
        s.reject("low_rad", what, "put a sweep before it, or correct start_rad");
    }
    Some(Segment::Cosine { low_rad, high_rad, period_s: period_s?, periods: u32::try_from(periods).ok()? })
}

fn read_multisine(s: &Section<'_>) -> Option<Segment> {
    let (duration_s, fade_s) = (s.need("duration_s").positive(), s.need("fade_s").positive());
    let list = s.need("waves").such_as("[[segments.waves]]", "one for each sine");
    let waves = list.sections(|s| {
        let (amplitude_rad, frequency_hz) = (s.need("amplitude_rad").number(), s.need("frequency_hz").positive());
        let phase_rad = s.may("phase_rad").number().unwrap_or(0.0);
        Some(Wave { amplitude_rad: amplitude_rad?, frequency_hz: frequency_hz?, phase_rad })
    });
    let (duration_s, fade_s) = (duration_s?, fade_s?);
    if fade_s > duration_s / 2.0 {
        let what = format!("is {fade_s}, of {duration_s} s in all");
        s.reject("fade_s", what, "fading in and out takes the whole segment at most: halve duration_s");
    }
    Some(Segment::Multisine { duration_s, fade_s, waves: waves? })
}

fn write_segments(text: &mut String, table: &str, path: &Path) {
    for segment in &path.segments {
        write_pairs(text, &format!("\n[[{table}]]\n"), &pairs(segment));
    }
}

fn pairs(segment: &Segment) -> Vec<(&'static str, Value)> {
    match segment {
        Segment::Rest { duration_s } => vec![("kind", "rest".into()), ("duration_s", (*duration_s).into())],
        Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2 } => vec![
            ("kind", "sweep".into()),
            ("to_rad", (*to_rad).into()),
            ("speed_rad_s", (*speed_rad_s).into()),
            ("acceleration_rad_s2", (*acceleration_rad_s2).into()),
        ],
        Segment::Cosine { low_rad, high_rad, period_s, periods } => vec![
            ("kind", "cosine".into()),
            ("low_rad", (*low_rad).into()),
            ("high_rad", (*high_rad).into()),
            ("period_s", (*period_s).into()),
            ("periods", i64::from(*periods).into()),
        ],
        Segment::Multisine { duration_s, fade_s, waves } => vec![
            ("kind", "multisine".into()),
            ("duration_s", (*duration_s).into()),
            ("fade_s", (*fade_s).into()),
            ("waves", waves.iter().map(wave).collect::<Vec<Value>>().into()),
        ],
    }
}

fn wave(wave: &Wave) -> Value {
    let pairs =
        [("amplitude_rad", wave.amplitude_rad), ("frequency_hz", wave.frequency_hz), ("phase_rad", wave.phase_rad)];
    pairs.into_iter().map(|(name, x)| (name.to_string(), x.into())).collect::<toml::Table>().into()
}
