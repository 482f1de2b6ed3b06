//! The recorder's thread, and the one behind it that waits for the disk.

use super::{HEADER, Message, Shared};
use crate::capture::folder::Folder;
use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// How long a row may wait before it is written: from then on a killed process loses it no more ...
const WRITE: Duration = Duration::from_millis(20);
/// ... and before it is forced to the disk, where a power cut leaves it.
const SYNC: Duration = Duration::from_millis(50);

/// What is being written.
pub(super) struct Writer {
    folder: Folder,
    log: Option<File>,
    rows: Vec<u8>,
    synced: Instant,
    /// Logs to be forced to the disk, one at a time: where the last is still on its way, this one waits for its next turn.
    syncs: SyncSender<File>,
    shared: Arc<Shared>,
}

impl Writer {
    pub fn new(folder: Folder, shared: Arc<Shared>) -> Self {
        let (syncs, logs) = sync_channel::<File>(0);
        let told = Arc::clone(&shared);
        // It ends with the writer, its only sender; nothing waits for it.
        std::thread::spawn(move || {
            for log in logs {
                log.sync_data().unwrap_or_else(|error| told.fail(error.to_string()));
            }
        });
        Self { folder, log: None, rows: Vec::new(), synced: Instant::now(), syncs, shared }
    }

    /// Writes what comes, until nobody sends any more.
    pub fn run(&mut self, messages: &Receiver<Message>) {
        let mut written = Instant::now();
        loop {
            let done = match messages.recv_timeout(WRITE.saturating_sub(written.elapsed())) {
                Ok(message) => self.take(message),
                Err(RecvTimeoutError::Timeout) => Ok(()),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let done = done.and_then(|()| {
                if written.elapsed() < WRITE {
                    return Ok(());
                }
                written = Instant::now();
                self.write()
            });
            done.unwrap_or_else(|error| self.shared.fail(error.to_string()));
        }
        self.close().unwrap_or_else(|error| self.shared.fail(error.to_string()));
    }

    fn take(&mut self, message: Message) -> io::Result<()> {
        match message {
            Message::Row(sample) => sample.write(&mut self.rows),
            Message::Note(line) => self.folder.note(&line),
            Message::Evidence(line) => self.folder.evidence(&line),
            Message::DriveFaults(line) => self.folder.drive_faults(&line),
            Message::Begin(entry) => {
                let begun = self.open(&entry.file).and_then(|log| self.folder.begin(entry).map(|()| log));
                // Rows may come; else `run` says that they cannot.
                begun.map(|log| {
                    self.log = Some(log);
                    self.shared.ready.store(true, Ordering::Release);
                })
            }
            // Of a trial that could not begin there is nothing to end.
            Message::End(_) if self.log.is_none() => Ok(()),
            // A log that is not whole on the disk stays listed as incomplete.
            Message::End(captured) => self.close().and_then(|()| self.folder.end(captured)),
        }
    }

    fn open(&self, file: &str) -> io::Result<File> {
        let mut log = File::create(self.folder.path.join(file))?;
        let extras: String = self.folder.extras().map(|column| format!(",{column}")).collect();
        writeln!(log, "{HEADER}{extras}")?;
        log.sync_data()?;
        Ok(log)
    }

    /// Writes what has come, and has it forced to the disk when it is time.
    fn write(&mut self) -> io::Result<()> {
        let Some(log) = &mut self.log else { return Ok(()) };
        // What could not be written is not tried again: whole rows after part of one would be no rows.
        let mut rows = std::mem::take(&mut self.rows);
        log.write_all(&rows)?;
        rows.clear();
        self.rows = rows;
        if self.synced.elapsed() >= SYNC && self.syncs.try_send(log.try_clone()?).is_ok() {
            self.synced = Instant::now();
        }
        Ok(())
    }

    /// Writes what has come, and waits until it is on the disk.
    fn close(&mut self) -> io::Result<()> {
        let written = self.write();
        let log = self.log.take();
        written.and_then(|()| log.map_or(Ok(()), |log| log.sync_data()))
    }
}
