//! ROS 2 recordings in MCAP: messages of type `sensor_msgs/msg/JointState`, as DDS serialises them (CDR, OMG DDS-RTPS 2.2, 10.2).
//!
//! Columns are `time` (the header's stamp, s, from the first message on), `JOINT.position`, `JOINT.velocity`, `JOINT.effort`;
//! where several topics carry joint states, each with its topic before: `/arm/joint_states:elbow.position`.

use super::Series;
use crate::problem::{Problem, Result};
use mcap::parse_record;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The message's type; older recordings name it without `msg`.
const TYPES: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];
/// More joints in a message are damage.
const JOINTS_MAX: usize = 4096;

/// One message.
struct State {
    stamp_s: f64,
    names: Vec<String>,
    /// Position, velocity, effort, each as long as the names or empty.
    values: [Vec<f64>; 3],
}

/// No record of joint states is longer, bytes; a length beyond is damage, and must not be allocated.
const RECORD_MAX: usize = 256 << 20;

pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Vec<Series>> {
    let mut found = Found::default();
    found.read(bytes).map_err(|error| {
        let cure = "mend it with `mcap recover`, or record again";
        Problem::error(file, format!("is damaged as MCAP: {error}"), cure)
    })?;
    let Found { states, channels, .. } = found;
    if states.is_empty() {
        let listed: BTreeSet<String> =
            channels.values().map(|of| format!("{}: {} ({})", of.topic, of.kind, of.encoding)).collect();
        let listed: Vec<String> = listed.into_iter().collect();
        let cure = if listed.is_empty() {
            "nothing was recorded".to_string()
        } else {
            format!("it holds {}", listed.join(", "))
        };
        return Problem::error(file, format!("holds no {} as cdr", TYPES[0]), cure).alone();
    }
    let several = states.len() > 1;
    let columns = |(clock, (topic, states)): (usize, (String, Vec<State>))| {
        columns(&states, clock, &if several { format!("{topic}:") } else { String::new() })
    };
    Ok(states.into_iter().enumerate().flat_map(columns).collect())
}

/// What a recording holds, as far as it was read.
#[derive(Default)]
struct Found {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// By topic.
    states: BTreeMap<String, Vec<State>>,
}

struct Channel {
    topic: String,
    kind: String,
    encoding: String,
}

impl Found {
    /// Reads record after record; what is wrong with them, where something is.
    fn read(&mut self, bytes: &[u8]) -> std::result::Result<(), String> {
        let options = LinearReaderOptions::default().with_record_length_limit(RECORD_MAX);
        let mut reader = LinearReader::new_with_options(options);
        let mut rest = bytes;
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| error.to_string())? {
                LinearReadEvent::ReadRequest(most) => {
                    let (now, later) = rest.split_at(most.min(rest.len()));
                    reader.insert(now.len())[..now.len()].copy_from_slice(now);
                    reader.notify_read(now.len());
                    rest = later;
                }
                LinearReadEvent::Record { data, opcode } => {
                    self.take(parse_record(opcode, data).map_err(|error| error.to_string())?)?;
                }
            }
        }
        Ok(())
    }

    fn take(&mut self, record: Record<'_>) -> std::result::Result<(), String> {
        match record {
            Record::Schema { header, .. } => drop(self.schemas.insert(header.id, header.name)),
            Record::Channel(of) => {
                let kind = self.schemas.get(&of.schema_id).cloned().unwrap_or_default();
                let channel = Channel { topic: of.topic, kind, encoding: of.message_encoding };
                self.channels.insert(of.id, channel);
            }
            Record::Message { header, data } => {
                let is_ours = |of: &&Channel| TYPES.contains(&of.kind.as_str()) && of.encoding == "cdr";
                let Some(channel) = self.channels.get(&header.channel_id).filter(is_ours) else { return Ok(()) };
                let seen = self.states.entry(channel.topic.clone()).or_default();
                let mut state = State::parse(&data)
                    .ok_or_else(|| format!("message {} of {} is no JointState", seen.len() + 1, channel.topic))?;
                if state.stamp_s == 0.0 {
                    // Some drivers leave the stamp out.
                    state.stamp_s = header.log_time as f64 * 1e-9;
                }
                seen.push(state);
            }
            _ => {}
        }
        Ok(())
    }
}

/// A column for each joint's position, velocity and effort, as far as any message has them.
fn columns(states: &[State], clock: usize, before: &str) -> Vec<Series> {
    let start_s = states.iter().map(|state| state.stamp_s).fold(f64::INFINITY, f64::min);
    let time = states.iter().map(|state| state.stamp_s - start_s).collect();
    let mut all = vec![Series { name: format!("{before}time"), values: time, clock }];
    let mut at: BTreeMap<(String, usize), usize> = BTreeMap::new();
    for (row, state) in states.iter().enumerate() {
        for (quantity, values) in state.values.iter().enumerate() {
            for (name, value) in state.names.iter().zip(values) {
                let column = *at.entry((name.clone(), quantity)).or_insert_with(|| {
                    let name = format!("{before}{name}.{}", ["position", "velocity", "effort"][quantity]);
                    all.push(Series { name, values: vec![f64::NAN; states.len()], clock });
                    all.len() - 1
                });
                all[column].values[row] = *value;
            }
        }
    }
    all
}

impl State {
    /// Reads a message; nothing where it is none.
    fn parse(bytes: &[u8]) -> Option<Self> {
        // The first four bytes say how the rest is written: the second is 1 for little end first.
        let little = match bytes.get(..2)? {
            [0, 1] => true,
            [0, 0] => false,
            _ => return None,
        };
        let mut cdr = Cdr { body: bytes.get(4..)?, at: 0, little };
        let (seconds, nanoseconds) = (cdr.word()? as i32, cdr.word()?);
        cdr.text()?;
        let names = (0..cdr.count()?).map(|_| cdr.text()).collect::<Option<Vec<String>>>()?;
        let values = [cdr.numbers()?, cdr.numbers()?, cdr.numbers()?];
        let fits = values.iter().all(|of| of.is_empty() || of.len() == names.len());
        fits.then_some(Self { stamp_s: f64::from(seconds) + 1e-9 * f64::from(nanoseconds), names, values })
    }
}

/// A message being read: every number stands at a multiple of its size.
struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl Cdr<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let from = self.at.next_multiple_of(N);
        let taken: [u8; N] = self.body.get(from..from.checked_add(N)?)?.try_into().ok()?;
        self.at = from + N;
        Some(taken)
    }

    fn word(&mut self) -> Option<u32> {
        let word = self.take::<4>()?;
        Some(if self.little { u32::from_le_bytes(word) } else { u32::from_be_bytes(word) })
    }

    fn count(&mut self) -> Option<usize> {
        let count = self.word()? as usize;
        (count <= JOINTS_MAX).then_some(count)
    }

    /// A text with its closing zero.
    fn text(&mut self) -> Option<String> {
        let length = self.word()? as usize;
        let bytes = self.body.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Some(String::from_utf8_lossy(text).into_owned())
    }

    fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = self.count()?;
        let number = |cdr: &mut Self| {
            let bytes = cdr.take::<8>()?;
            Some(if cdr.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
        };
        (0..count).map(|_| number(self)).collect()
    }
}
