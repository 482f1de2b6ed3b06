//! The start-up code on frames that no emulator of ours made: recordings of real devices, which the EtherCAT stack publishes with its
//! own tests (crate `ethercrab`, MIT or Apache-2.0). They are read where cargo has put that crate.
//!
//! A frame that is sent is answered as the same request was in the recording, in turn; what was not asked there is not answered, as if
//! the device were silent. Recorded are the way to PRE-OP and some objects.

use std::collections::HashMap;
use std::path::PathBuf;
use std::process::Command;
use tautline::capture::found::{Found, scan};
use tautline::capture::in_process::InProcess;
use tautline::capture::line::with_line;

/// Where an EtherCAT frame's header begins, and its first datagram.
const HEADER: usize = 14;
const FIRST: usize = 16;
/// Header and working counter of a datagram.
const AROUND: usize = 12;
/// Commands that only write: the answer carries what was written.
const WRITES: [u8; 4] = [2, 5, 8, 11];
/// The source address of a frame that was sent, and of its answer, whose second bit the first device has set.
const SENT: u8 = 0x10;
const ANSWER: u8 = 0x12;

/// The folder of the stack's recordings.
fn recordings() -> PathBuf {
    // Of other platforms nothing need ever have been downloaded.
    let compiler = Command::new("rustc").arg("-vV").output().unwrap().stdout;
    let compiler = String::from_utf8(compiler).unwrap();
    let host = compiler.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let asked = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--offline", "--filter-platform", host])
        .output();
    let told: serde_json::Value = serde_json::from_slice(&asked.unwrap().stdout).unwrap();
    let packages = told["packages"].as_array().unwrap();
    let stack = packages.iter().find(|package| package["name"] == "ethercrab").unwrap();
    PathBuf::from(stack["manifest_path"].as_str().unwrap()).parent().unwrap().join("tests")
}

/// The frames of a pcapng file (draft-ietf-opsawg-pcapng): of its blocks those with a packet.
fn frames(bytes: &[u8]) -> Vec<&[u8]> {
    const PACKET: u32 = 6;
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let (mut at, mut found) = (0, Vec::new());
    while at + 12 <= bytes.len() {
        let length = word(at + 4) as usize;
        if word(at) == PACKET {
            found.push(&bytes[at + 28..at + 28 + word(at + 20) as usize]);
        }
        at += length.max(12);
    }
    found
}

/// The datagrams of a frame: where each begins, and how many bytes of data it has.
fn datagrams(frame: &[u8]) -> Vec<(usize, usize)> {
    let (mut at, mut found) = (FIRST, Vec::new());
    while at + AROUND <= frame.len() {
        let length = u16::from_le_bytes([frame[at + 6], frame[at + 7]]);
        found.push((at, usize::from(length & 0x7FF)));
        if length >> 15 == 0 {
            break;
        }
        at += AROUND + usize::from(length & 0x7FF);
    }
    found
}

/// What a frame asks for: of each datagram command, address and length, and where `exactly`, what is written. Not its number.
fn request(frame: &[u8], exactly: bool) -> Vec<u8> {
    let one = |(at, length): (usize, usize)| {
        let head = [&frame[at..=at], &frame[at + 2..at + 6], &[length as u8, (length >> 8) as u8]].concat();
        let data = if exactly { &frame[at + 10..at + 10 + length] } else { &[] };
        [&head[..], data].concat()
    };
    datagrams(frame).into_iter().flat_map(one).collect()
}

/// Answers by request, in the order in which they came.
struct Recording {
    exact: HashMap<Vec<u8>, Vec<Vec<u8>>>,
    alike: HashMap<Vec<u8>, Vec<Vec<u8>>>,
    asked: HashMap<Vec<u8>, usize>,
}

impl Recording {
    fn of(bytes: &[u8]) -> Self {
        let (mut exact, mut alike) = (HashMap::new(), HashMap::new());
        let all: Vec<&[u8]> = frames(bytes).into_iter().filter(|frame| frame.len() > FIRST + AROUND).collect();
        for (i, sent) in all.iter().enumerate().filter(|(_, frame)| frame[6] == SENT) {
            let is_its = |frame: &&&[u8]| frame[6] == ANSWER && frame[FIRST + 1] == sent[FIRST + 1];
            let Some(answer) = all[i + 1..].iter().find(is_its) else { continue };
            exact.entry(request(sent, true)).or_insert_with(Vec::new).push(answer.to_vec());
            alike.entry(request(sent, false)).or_insert_with(Vec::new).push(answer.to_vec());
        }
        Self { exact, alike, asked: HashMap::new() }
    }

    /// The next answer to what `frame` asks; the last one again where there are no more.
    fn answer(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let exactly = request(frame, true);
        let answers = self.exact.get(&exactly).or_else(|| self.alike.get(&request(frame, false)))?;
        let turn = self.asked.entry(exactly).or_insert(0);
        let mut answer = answers[(*turn).min(answers.len() - 1)].clone();
        *turn += 1;
        for (at, length) in datagrams(frame) {
            answer[at + 1] = frame[at + 1];
            if WRITES.contains(&frame[at]) {
                answer[at + 10..at + 10 + length].copy_from_slice(&frame[at + 10..at + 10 + length]);
            }
        }
        Some(answer)
    }
}

/// What a scan finds in the recording called `name`.
fn scanned(name: &str) -> Vec<Found> {
    let bytes = std::fs::read(recordings().join(name)).unwrap();
    let mut recording = Recording::of(&bytes);
    assert!(recording.exact.len() > 50, "{name}: {} requests", recording.exact.len());
    const AWAY_NS: u64 = 50_000;
    let wire = InProcess::new(move |now_ns, frame: &[u8]| {
        assert_eq!(frame[HEADER - 2..HEADER], [0x88, 0xA4]);
        recording.answer(frame).map(|answer| (now_ns + AWAY_NS, answer)).into_iter().collect()
    });
    with_line(wire, scan).unwrap_or_else(|failure| panic!("{name}: {failure}"))
}

/// Vendor number of Beckhoff, whose terminals were recorded.
const BECKHOFF: u32 = 2;

#[test]
fn real_devices_are_found_as_recorded() {
    for (name, devices) in [
        ("replay-ek1914-el3004-mailbox.pcapng", &["EK1914", "EL3004"][..]),
        ("replay-ek1914-el3004-configure.pcapng", &["EK1914", "EL3004"][..]),
        ("replay-ek1100-el2828-el2889.pcapng", &["EK1100", "EL2828", "EL2889"][..]),
    ] {
        let found = scanned(name);
        let names: Vec<&str> = found.iter().map(|device| device.name.as_str()).collect();
        assert_eq!(names, devices, "{name}");
        assert!(found.iter().all(|device| device.vendor == BECKHOFF && device.product != 0), "{name}: {found:?}");
    }
}
