//! Samples to the disk as they come, in a thread of their own: nothing of the cycle waits for the disk.
//!
//! A trial's log is a CSV to which whole rows are added; what has come is written every 20 ms, and forced to the disk every 50 ms
//! by a third thread, as a disk may take its time.
//! While it is being written `campaign.toml` lists it as incomplete, and is replaced as one when it ends: whatever happens in
//! between, the folder opens as a campaign with all that was written.

mod writer;

use super::folder::Folder;
use super::line::words;
use crate::log::{Captured, TrialEntry};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use writer::Writer;

/// Rows that may wait for the disk: 8 s at 1 kHz, longer than a disk is ever away. They are made room for beforehand.
const WAITING: usize = 8192;
/// Header of a log, as `Sample::write` fills it; behind it come those of `EXTRAS` that the rig maps.
pub const HEADER: &str = "time_s,cycle,state,working_counter,position_rad,torque_nm,command_rad,bus_time_s,status_word,sensor_status,sensor_counts,drive_torque_nm";

/// What the drive may tell besides: the role of its input, and the column.
pub const EXTRAS: [(&str, &str); 2] = [("velocity", "drive_velocity_rad_s"), ("current", "drive_current_per_mille")];

/// One cycle as recorded. For a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When its frame was sent, by this machine's own steady clock, s since the capture began.
    pub time_s: f64,
    /// Number of its period since the bus began to cycle: one that is missing was missed.
    pub cycle: u64,
    /// Where the safety machine was.
    pub state: &'static str,
    /// As it came back.
    pub working_counter: u16,
    /// rad.
    pub position_rad: f64,
    /// At the sensor, N m.
    pub torque_nm: f64,
    /// What the drive was told with the same frame, rad.
    pub command_rad: f64,
    /// The devices' common clock, s since this run's first cycle; 0 without clocks.
    pub bus_time_s: f64,
    /// The drive's status word.
    pub status_word: u16,
    /// The terminal's status word.
    pub sensor_status: u16,
    /// The terminal's value as it came.
    pub sensor_counts: f64,
    /// The drive's own torque, N m at the winch; 0 where it is not mapped.
    pub drive_torque_nm: f64,
    /// What it tells besides, as `EXTRAS` lists it; no column where it is not mapped.
    pub extras: [Option<f64>; EXTRAS.len()],
}

impl Sample {
    /// Adds its row to `out`.
    fn write(&self, out: &mut Vec<u8>) -> io::Result<()> {
        let Self { time_s, cycle, state, working_counter, position_rad, torque_nm, command_rad, bus_time_s, .. } = self;
        let Self { status_word, sensor_status, sensor_counts, drive_torque_nm, .. } = self;
        write!(
            out,
            "{time_s:.6},{cycle},{state},{working_counter},{position_rad:.8},{torque_nm:.6},{command_rad:.8},\
             {bus_time_s:.6},{status_word},{sensor_status},{sensor_counts},{drive_torque_nm:.4}"
        )?;
        self.extras.iter().flatten().try_for_each(|extra| write!(out, ",{extra:.6}"))?;
        writeln!(out)
    }
}

/// What the thread is told.
enum Message {
    Begin(TrialEntry),
    Row(Sample),
    End(Captured),
    Note(String),
    Evidence(String),
    DriveFaults(String),
}

/// What the threads tell each other.
#[derive(Debug, Default)]
struct Shared {
    /// The first failure.
    failed: Mutex<Option<String>>,
    /// Whether the log of the trial that was begun last is on the disk.
    ready: AtomicBool,
}

impl Shared {
    /// Nobody waits for a log any more that cannot come.
    fn fail(&self, why: String) {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
        self.ready.store(true, Ordering::Release);
    }
}

/// The other end of the thread.
pub struct Recorder {
    sender: Option<SyncSender<Message>>,
    /// What waits for room on the way there, in order: nothing passes it by.
    late: VecDeque<Message>,
    thread: Option<JoinHandle<()>>,
    shared: Arc<Shared>,
    /// Whether to wait for the disk rather than to fail: in virtual time.
    waits: bool,
}

/// Why nothing can be handed over any more.
const ENDED: &str = "its thread has ended";
/// How often the disk is looked at where it is waited for.
const LOOKED: Duration = Duration::from_micros(200);

impl Recorder {
    /// Records into `folder`. With `waits` the disk is waited for, else a full queue is a failure.
    pub fn new(folder: Folder, waits: bool) -> Self {
        let (sender, receiver) = sync_channel(WAITING);
        let shared = Arc::new(Shared::default());
        let mut writer = Writer::new(folder, Arc::clone(&shared));
        let told = Arc::clone(&shared);
        let thread = std::thread::spawn(move || {
            let panicked = catch_unwind(AssertUnwindSafe(|| writer.run(&receiver))).err();
            panicked.into_iter().for_each(|panic| told.fail(format!("its thread panicked: {}", words(&*panic))));
        });
        Self { sender: Some(sender), late: VecDeque::new(), thread: Some(thread), shared, waits }
    }

    /// Records nothing.
    pub fn none() -> Self {
        Self { sender: None, late: VecDeque::new(), thread: None, shared: Arc::default(), waits: true }
    }

    /// A trial begins: it is in the campaign from now on, as incomplete.
    pub fn begin(&mut self, entry: TrialEntry) {
        self.shared.ready.store(self.sender.is_none(), Ordering::Release);
        self.tell(Message::Begin(entry));
    }

    /// Whether its log is on the disk, and rows can come; in virtual time it will be.
    pub fn is_ready(&mut self) -> bool {
        self.hand_over();
        while self.waits && !self.shared.ready.load(Ordering::Acquire) {
            std::thread::sleep(LOOKED);
        }
        self.shared.ready.load(Ordering::Acquire)
    }

    /// One more cycle of it.
    pub fn record(&mut self, sample: Sample) {
        self.tell(Message::Row(sample));
    }

    /// It ends, as `captured` says.
    pub fn end(&mut self, captured: Captured) {
        self.tell(Message::End(captured));
    }

    /// A line for the campaign's own log.
    pub fn note(&mut self, line: String) {
        self.tell(Message::Note(line));
    }

    /// A line of JSON for the campaign's evidence.
    pub fn evidence(&mut self, line: String) {
        self.tell(Message::Evidence(line));
    }

    /// What the drives remember of their faults, by name, before the trials or after a stop.
    pub fn remembered(&mut self, when: &str, histories: Vec<(String, Value)>) {
        for (drive, history) in histories {
            let line = json!({ "drive": drive, "when": when, "fault_history": history });
            self.tell(Message::DriveFaults(line.to_string()));
        }
    }

    /// Why nothing more can be recorded, if that is so.
    pub fn failed(&self) -> Option<String> {
        self.shared.failed.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits until everything is on the disk.
    pub fn finish(mut self) -> Option<String> {
        self.close();
        self.failed()
    }

    fn close(&mut self) {
        if let Some(sender) = self.sender.take() {
            self.late.drain(..).for_each(|message| sender.send(message).unwrap_or(()));
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }

    /// In real time nothing here ever waits: while the disk is away the drive must still be told to stop. A row for which there is
    /// no room is a failure; all else is kept until there is.
    fn tell(&mut self, message: Message) {
        let Some(sender) = &self.sender else { return };
        if self.waits {
            sender.send(message).unwrap_or_else(|_| self.shared.fail(ENDED.to_string()));
            return;
        }
        let is_row = matches!(message, Message::Row(_));
        self.late.push_back(message);
        self.hand_over();
        if is_row && self.late.pop_back().is_some() {
            self.shared.fail("the disk is too slow".to_string());
        }
    }

    /// Hands over what waits, as far as there is room.
    fn hand_over(&mut self) {
        let Some(sender) = &self.sender else { return };
        while let Some(message) = self.late.pop_front() {
            match sender.try_send(message) {
                Ok(()) => {}
                Err(TrySendError::Full(message)) => return self.late.push_front(message),
                Err(TrySendError::Disconnected(_)) => self.shared.fail(ENDED.to_string()),
            }
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.close();
    }
}
