//! Samples to the disk as they come, in a thread of their own: nothing of the cycle waits for the disk.
//!
//! A trial's log is a CSV to which whole rows are added; what has come is written every 20 ms and forced to the disk every 50 ms.
//! While it is being written `campaign.toml` lists it as incomplete, and is replaced as one when it ends: whatever happens in
//! between, the folder opens as a campaign with all that was written.

use super::folder::Folder;
use crate::log::{Captured, TrialEntry};
use std::fs::File;
use std::io::{self, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Rows that may wait for the disk: 8 s at 1 kHz, longer than a disk is ever away. They are made room for beforehand.
const WAITING: usize = 8192;
/// How long a row may wait before it is written ...
const WRITE: Duration = Duration::from_millis(20);
/// ... and forced to the disk, where a power cut leaves it.
const SYNC: Duration = Duration::from_millis(50);
/// Header of a log, as `Sample::write` fills it.
pub const HEADER: &str = "time_s,cycle,state,working_counter,position_rad,torque_nm,command_rad,bus_time_s,status_word,sensor_status,sensor_counts,drive_torque_nm";

/// One cycle as recorded. For a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When its frame was sent, by this machine's own steady clock, s since the trial began.
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
    /// The devices' common clock, s since the trial began; 0 without clocks.
    pub bus_time_s: f64,
    /// The drive's status word.
    pub status_word: u16,
    /// The terminal's status word.
    pub sensor_status: u16,
    /// The terminal's value as it came.
    pub sensor_counts: f64,
    /// The drive's own torque, N m at the winch; 0 where it is not mapped.
    pub drive_torque_nm: f64,
}

impl Sample {
    /// Adds its row to `out`.
    fn write(&self, out: &mut Vec<u8>) -> io::Result<()> {
        let Self { time_s, cycle, state, working_counter, position_rad, torque_nm, command_rad, bus_time_s, .. } = self;
        let Self { status_word, sensor_status, sensor_counts, drive_torque_nm, .. } = self;
        writeln!(
            out,
            "{time_s:.6},{cycle},{state},{working_counter},{position_rad:.8},{torque_nm:.6},{command_rad:.8},\
             {bus_time_s:.6},{status_word},{sensor_status},{sensor_counts},{drive_torque_nm:.4}"
        )
    }
}

/// What the thread is told.
enum Message {
    Begin(TrialEntry),
    Row(Sample),
    End(Captured),
    Note(String),
}

/// The other end of the thread.
pub struct Recorder {
    sender: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<()>>,
    failed: Arc<Mutex<Option<String>>>,
    /// Whether to wait for the disk rather than to fail: in virtual time.
    waits: bool,
}

impl Recorder {
    /// Records into `folder`. With `waits` a full queue is waited for, else it is a failure.
    pub fn new(folder: Folder, waits: bool) -> Self {
        let (sender, receiver) = sync_channel(WAITING);
        let failed = Arc::new(Mutex::new(None));
        let told = Arc::clone(&failed);
        let thread = std::thread::spawn(move || {
            let mut writer = Writer { folder, log: None, buffer: Vec::new(), synced: Instant::now(), failed: told };
            writer.run(&receiver);
        });
        Self { sender: Some(sender), thread: Some(thread), failed, waits }
    }

    /// Records nothing.
    pub fn none() -> Self {
        Self { sender: None, thread: None, failed: Arc::default(), waits: true }
    }

    /// A trial begins: it is in the campaign from now on, as incomplete.
    pub fn begin(&mut self, entry: TrialEntry) {
        self.tell(Message::Begin(entry));
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

    /// Why nothing more can be recorded, if that is so.
    pub fn failed(&self) -> Option<String> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits until everything is on the disk.
    pub fn finish(mut self) -> Option<String> {
        self.close();
        self.failed()
    }

    fn close(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }

    fn tell(&mut self, message: Message) {
        let Some(sender) = &self.sender else { return };
        let is_row = matches!(message, Message::Row(_));
        // Only rows come in numbers; what is between them is waited for, between motions.
        let told = if self.waits || !is_row {
            sender.send(message).map_err(|_| "its thread has ended")
        } else {
            sender.try_send(message).map_err(|error| match error {
                TrySendError::Full(_) => "the disk is too slow",
                TrySendError::Disconnected(_) => "its thread has ended",
            })
        };
        if let Err(why) = told {
            fail(&self.failed, why.to_string());
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.close();
    }
}

/// The first failure is the one that is told.
fn fail(failed: &Mutex<Option<String>>, why: String) {
    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
}

/// The thread's side.
struct Writer {
    folder: Folder,
    log: Option<File>,
    buffer: Vec<u8>,
    synced: Instant,
    failed: Arc<Mutex<Option<String>>>,
}

impl Writer {
    fn run(&mut self, receiver: &Receiver<Message>) {
        let mut written = Instant::now();
        loop {
            let done = match receiver.recv_timeout(WRITE.saturating_sub(written.elapsed())) {
                Ok(message) => self.take(message),
                Err(RecvTimeoutError::Timeout) => Ok(()),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let done = done.and_then(|()| {
                if written.elapsed() < WRITE {
                    return Ok(());
                }
                written = Instant::now();
                self.flush(false)
            });
            if let Err(error) = done {
                fail(&self.failed, error.to_string());
            }
        }
        if let Err(error) = self.flush(true) {
            fail(&self.failed, error.to_string());
        }
    }

    fn take(&mut self, message: Message) -> io::Result<()> {
        match message {
            Message::Row(sample) => sample.write(&mut self.buffer),
            Message::Begin(entry) => {
                let mut log = File::create(self.folder.path.join(&entry.file))?;
                writeln!(log, "{HEADER}")?;
                log.sync_data()?;
                self.folder.begin(entry)?;
                self.log = Some(log);
                Ok(())
            }
            // Of a trial that could not begin there is nothing to end.
            Message::End(_) if self.log.is_none() => Ok(()),
            Message::End(captured) => {
                let flushed = self.flush(true);
                self.log = None;
                // A log that is not whole on the disk stays listed as incomplete.
                flushed.and_then(|()| self.folder.end(captured))
            }
            Message::Note(line) => self.folder.note(&line),
        }
    }

    /// Writes what has come; forces it to the disk when it is time, or `now`.
    fn flush(&mut self, now: bool) -> io::Result<()> {
        let Some(log) = &mut self.log else { return Ok(()) };
        // What could not be written is not tried again: whole rows after part of one would be no rows.
        let rows = std::mem::take(&mut self.buffer);
        log.write_all(&rows)?;
        self.buffer = rows;
        self.buffer.clear();
        if now || self.synced.elapsed() >= SYNC {
            log.sync_data()?;
            self.synced = Instant::now();
        }
        Ok(())
    }
}
