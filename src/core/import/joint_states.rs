//! ROS 2 recordings in MCAP: messages of type `sensor_msgs/msg/JointState`, as DDS serialises them (CDR, OMG DDS-RTPS 2.2, 10.2).
//!
//! Columns are `time` (the header's stamp, s, from the first message on), `JOINT.position`, `JOINT.velocity`, `JOINT.effort`;
//! where several topics carry joint states, each with its topic before: `/arm/joint_states:elbow.position`. A joint that is not
//! in every message (a gripper that reports for itself) has the times of its own messages.
//!
//! The CRCs of the data section, of each chunk and of the summary are verified, where the recorder wrote them.

use super::Series;
use crate::limits::{Budget, MCAP_RECORD_BYTES, MESSAGE_JOINTS, PASSED_OVER_PER_KEPT, listed, shown};
use crate::problem::{Problem, Result};
use mcap::parse_record;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// The message's type; older recordings name it without `msg`.
const TYPES: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];
/// Bytes that one joint of one message is kept in: its message's number and three readings.
const KEPT_BYTES: u64 = 28;
/// Bytes that a joint itself is kept in, besides its name.
const JOINT_BYTES: u64 = 256;

/// One message.
struct State {
    stamp_s: f64,
    names: Vec<String>,
    /// Position, velocity, effort, each as long as the names or empty.
    values: [Vec<f64>; 3],
}

pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Vec<Series>> {
    let mut found = Found::default();
    found.read(bytes, &mut Budget::of_file(bytes.len() as u64)).or_else(|error| {
        let cure = "copy it again from where it was recorded, mend it with `mcap recover`, or record again";
        Problem::error(file, format!("is damaged as MCAP: {error}"), cure).alone()
    })?;
    let Found { topics, channels, .. } = found;
    if topics.is_empty() {
        let held: BTreeSet<String> =
            channels.values().map(|of| format!("{}: {} ({})", of.topic, of.kind, of.encoding)).collect();
        let cure = match held.is_empty() {
            true => "nothing was recorded".to_string(),
            false => format!("it holds {}", listed(held.iter().map(String::as_str))),
        };
        return Problem::error(file, format!("holds no {} as cdr", TYPES[0]), cure).alone();
    }
    let several = topics.len() > 1;
    let mut all = Vec::new();
    for (name, topic) in topics {
        topic.columns(if several { format!("{name}:") } else { String::new() }, &mut all);
    }
    Ok(all)
}

/// What a recording holds, as far as it was read.
#[derive(Default)]
struct Found {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// By name.
    topics: BTreeMap<String, Topic>,
}

struct Channel {
    topic: String,
    kind: String,
    encoding: String,
}

/// The joint states of one topic.
#[derive(Default)]
struct Topic {
    stamps_s: Vec<f64>,
    joints: Vec<Joint>,
    /// Places in `joints`, by name.
    places: HashMap<String, usize>,
}

/// A joint's name with its three signals.
type Signals = (String, [Vec<f64>; 3]);

/// What the messages say of one joint.
struct Joint {
    name: String,
    /// The messages that it is in.
    messages: Vec<u32>,
    /// Position, velocity, effort, message by message; empty where none has it.
    values: [Vec<f64>; 3],
}

impl Found {
    /// Reads record after record; what is wrong with them, where something is.
    fn read(&mut self, bytes: &[u8], budget: &mut Budget) -> std::result::Result<(), String> {
        let options = LinearReaderOptions::default()
            .with_record_length_limit(MCAP_RECORD_BYTES)
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
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
                    budget.take(data.len() as u64 / PASSED_OVER_PER_KEPT)?;
                    self.take(parse_record(opcode, data).map_err(|error| error.to_string())?, budget)?;
                }
            }
        }
        Ok(())
    }

    fn take(&mut self, record: Record<'_>, budget: &mut Budget) -> std::result::Result<(), String> {
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
                let topic = self.topics.entry(channel.topic.clone()).or_default();
                let number = topic.stamps_s.len() + 1;
                let mut state = State::parse(&data)
                    .ok_or_else(|| format!("message {number} of {} is no JointState", channel.topic))?;
                if state.stamp_s == 0.0 {
                    // Some drivers leave the stamp out.
                    state.stamp_s = header.log_time as f64 * 1e-9;
                }
                topic.take(state, budget).map_err(|what| format!("message {number} of {}: {what}", channel.topic))?;
            }
            _ => {}
        }
        Ok(())
    }
}

impl Topic {
    fn take(&mut self, state: State, budget: &mut Budget) -> std::result::Result<(), String> {
        let message = u32::try_from(self.stamps_s.len()).map_err(|_| "it is one of too many")?;
        self.stamps_s.push(state.stamp_s);
        budget.take(8 + KEPT_BYTES * state.names.len() as u64)?;
        for (at, name) in state.names.into_iter().enumerate() {
            let place = match self.places.get(&name) {
                Some(place) => *place,
                None => {
                    budget.take(JOINT_BYTES + 2 * name.len() as u64)?;
                    self.places.insert(name.clone(), self.joints.len());
                    self.joints.push(Joint { name, messages: Vec::new(), values: Default::default() });
                    self.joints.len() - 1
                }
            };
            let joint = &mut self.joints[place];
            if joint.messages.last() == Some(&message) {
                return Err(format!("it names joint `{}` twice", shown(&joint.name)));
            }
            for (known, told) in joint.values.iter_mut().zip(&state.values).filter(|(_, told)| !told.is_empty()) {
                known.resize(joint.messages.len(), f64::NAN);
                known.push(told[at]);
            }
            joint.messages.push(message);
        }
        Ok(())
    }

    /// The columns, each called so and `before`: joints in the same messages share a clock.
    fn columns(self, before: String, all: &mut Vec<Series>) {
        let start_s = self.stamps_s.iter().copied().fold(f64::INFINITY, f64::min);
        let mut clocks: HashMap<Vec<u32>, Vec<Signals>> = HashMap::new();
        let mut order: Vec<Vec<u32>> = Vec::new();
        for Joint { name, messages, values } in self.joints {
            let joints = clocks.entry(messages.clone()).or_default();
            if joints.is_empty() {
                order.push(messages);
            }
            joints.push((name, values));
        }
        for messages in order {
            let clock = all.last().map_or(0, |last| last.clock + 1);
            let mut put = |name: String, values| all.push(Series { name, values, clock, first_row: 1 });
            let time = messages.iter().map(|message| self.stamps_s[*message as usize] - start_s).collect();
            put(format!("{before}time"), time);
            for (joint, values) in clocks.remove(&messages).unwrap_or_default() {
                let told = ["position", "velocity", "effort"].into_iter().zip(values);
                for (quantity, mut values) in told.filter(|(_, values)| !values.is_empty()) {
                    values.resize(messages.len(), f64::NAN);
                    put(format!("{before}{joint}.{quantity}"), values);
                }
            }
        }
    }
}

impl State {
    /// Reads a message; `None` where the bytes are not one.
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
        (count <= MESSAGE_JOINTS).then_some(count)
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
