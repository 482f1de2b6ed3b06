//! Our own loop between the EtherCAT stack and the wire, in place of the stack's, which one late frame ends for good.
//!
//! A future of the stack is polled, what it wants to send is sent, what comes in is handed over, and so on until it is done or its time is
//! up. Errors of the stack from a frame that comes late, twice or damaged are ignored: the answer is then missing, which the caller sees. A
//! panic of the stack ends only what was being asked; what is known to make it panic, an emergency message during a transfer of objects, is
//! kept from it (see `unasked`).

use super::clock;
use super::unasked::Unasked;
use super::wire::{FRAME_BYTES, Wire};
use ethercrab::error::Error;
use ethercrab::{MainDevice, MainDeviceConfig, PduRx, PduStorage, PduTx, RetryBehaviour, Timeouts};
use std::future::Future;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

/// Devices on a bus, a power of two as the stack wants it.
pub const DEVICES: usize = 64;
/// Bytes of process data of all devices together.
pub const BYTES: usize = 1024;

/// Frames in flight at once.
const FRAMES: usize = 16;
/// Bytes of process data that fit in one frame.
const FRAME_DATA: usize = PduStorage::element_size(1100);
/// Time that a frame may be away while the bus is set up, where no cycle waits.
const ANSWER: Duration = Duration::from_millis(30);
/// Time that a device may take from one state to the next: what ETG.1020 gives to those that name no time of their own.
const STATE: Duration = Duration::from_secs(10);
/// Time that a device may take to fetch a word of its EEPROM, or a message out of its mailbox.
const PATIENCE: Duration = Duration::from_millis(300);
/// Time that it may take to answer for an object: some drives store it first.
const OBJECT: Duration = Duration::from_secs(3);
/// How often a frame of the set-up is sent again when no answer comes.
const RETRIES: usize = 3;
/// Frames by which the clocks are brought together before they drift along.
const CLOCK_FRAMES: u32 = 2000;
/// The longest wait for a frame before timers are looked at again, ns.
const LOOK_NS: u64 = 1_000_000;

/// The wire with the stack's two ends of it.
pub struct Line<'s, W> {
    /// The wire itself.
    pub wire: W,
    tx: PduTx<'s>,
    rx: PduRx<'s>,
    buffer: Box<[u8; FRAME_BYTES]>,
    unasked: Unasked,
}

/// Why something asked of the bus was not done.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The stack says so.
    Stack(Error),
    /// The stack panicked, with these words.
    Panic(String),
    /// No answer came until the given moment.
    TimedOut,
}

impl Failure {
    /// Whether there is more on the bus than this program has room for.
    pub fn is_capacity(&self) -> bool {
        matches!(self, Self::Stack(Error::Capacity(_)))
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stack(Error::Capacity(_)) => {
                write!(f, "there is more on the bus than this program drives: {DEVICES} devices and {BYTES} bytes")
            }
            Self::Stack(error) => write!(f, "{error}"),
            Self::Panic(words) => write!(f, "something panicked: {words}"),
            Self::TimedOut => write!(f, "no answer in time"),
        }
    }
}

/// Sets up a stack on `wire` and hands both to `act`.
///
/// # Panics
///
/// Never: a storage that was just made can be split.
pub fn with_line<W: Wire, R>(wire: W, act: impl FnOnce(&mut Line<'_, W>, &MainDevice<'_>) -> R) -> R {
    let storage: PduStorage<FRAMES, FRAME_DATA> = PduStorage::new();
    let (tx, rx, pdu_loop) = storage.try_split().expect("is split once");
    let timeouts = Timeouts {
        pdu: ANSWER,
        // Not at once: a bus in virtual time would stand still, a real one be flooded.
        wait_loop_delay: Duration::from_micros(200),
        state_transition: STATE,
        // A computer that stalls for a moment must not take a device for dead that has answered meanwhile.
        eeprom: PATIENCE,
        mailbox_echo: PATIENCE,
        mailbox_response: OBJECT,
    };
    let config =
        MainDeviceConfig { dc_static_sync_iterations: CLOCK_FRAMES, retry_behaviour: RetryBehaviour::Count(RETRIES) };
    let main = MainDevice::new(pdu_loop, timeouts, config);
    let mut line = Line { wire, tx, rx, buffer: Box::new([0; FRAME_BYTES]), unasked: Unasked::default() };
    act(&mut line, &main)
}

impl<W: Wire> Line<'_, W> {
    /// Runs `future` to its end.
    ///
    /// Errors: what the stack says, or that it panicked.
    pub fn run<T>(&mut self, future: impl Future<Output = Result<T, Error>>) -> Result<T, Failure> {
        self.run_until(u64::MAX, future)
    }

    /// Runs `future`, until `until_ns` at most; what it still had under way is then dropped.
    ///
    /// Errors: as `run`, and that the time was up.
    pub fn run_until<T>(
        &mut self,
        until_ns: u64,
        future: impl Future<Output = Result<T, Error>>,
    ) -> Result<T, Failure> {
        let run = AssertUnwindSafe(|| self.drive(until_ns, future));
        catch_unwind(run).unwrap_or_else(|panic| Err(Failure::Panic(words(&*panic))))
    }

    fn drive<T>(&mut self, until_ns: u64, future: impl Future<Output = Result<T, Error>>) -> Result<T, Failure> {
        let mut future = pin!(future);
        let mut context = Context::from_waker(Waker::noop());
        self.unasked.forget();
        loop {
            clock::set_ns(self.wire.now_ns());
            if let Poll::Ready(done) = future.as_mut().poll(&mut context) {
                return done.map_err(Failure::Stack);
            }
            self.send();
            let now_ns = self.wire.now_ns();
            if now_ns >= until_ns {
                return Err(Failure::TimedOut);
            }
            // An alarm that is due is looked at right away, after what has come in meanwhile.
            self.receive(clock::alarm_ns().clamp(now_ns, now_ns + LOOK_NS).min(until_ns));
        }
    }

    fn send(&mut self) {
        while let Some(frame) = self.tx.next_sendable_frame() {
            let Self { wire, unasked, .. } = self;
            // What cannot be sent is not answered: the caller sees it missing.
            let _ = frame.send_blocking(|bytes| {
                unasked.sends(bytes);
                let _ = wire.send(bytes);
                Ok(bytes.len())
            });
        }
    }

    /// Hands over what comes in: the first frame until `until_ns`, and what is there besides.
    fn receive(&mut self, until_ns: u64) {
        let mut until_ns = until_ns;
        while let Ok(Some(bytes)) = self.wire.receive(&mut self.buffer[..], until_ns) {
            let frame = &self.buffer[..bytes.min(FRAME_BYTES)];
            if !self.unasked.withholds(frame) {
                // Late, doubled and damaged frames are errors here, and of no matter.
                let _ = self.rx.receive_frame(frame);
            }
            until_ns = 0;
        }
    }

    /// Emergency messages that came while objects were asked for, since this was last called: station address and code.
    pub fn heard(&mut self) -> Vec<(u16, u16)> {
        std::mem::take(&mut self.unasked.heard)
    }

    /// The end, past the stack: each device at `stations` is told to leave OP, on which a drive must stop by itself. Three times, as
    /// frames may be lost. Devices that are not named stay as they are.
    pub fn drop_out(&mut self, stations: impl IntoIterator<Item = u16>) {
        for station in stations {
            let mut frame = DROP_OUT;
            frame[ADDRESS_AT..ADDRESS_AT + 2].copy_from_slice(&station.to_le_bytes());
            (0..3).for_each(|_| drop(self.wire.send(&frame)));
        }
    }
}

/// Where the datagram's station address stands in `DROP_OUT`.
const ADDRESS_AT: usize = 18;

/// A write of SAFE-OP (0x04, 0x10: whatever error is acknowledged) to AL control (register 0x0120) of one station, padded to the
/// shortest Ethernet frame: destination, source, EtherType 0x88A4, EtherCAT header (length 14, type 1), datagram (command 5 FPWR,
/// index, address, register, length 2, interrupt), data, working counter.
const DROP_OUT: [u8; 60] = {
    let mut frame = [0; 60];
    let start: [u8; 30] = [
        0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x88, 0xA4, //
        0x0E, 0x10, //
        0x05, 0xFF, 0x00, 0x00, 0x20, 0x01, 0x02, 0x00, 0x00, 0x00, //
        0x14, 0x00, 0x00, 0x00,
    ];
    let mut i = 0;
    while i < start.len() {
        frame[i] = start[i];
        i += 1;
    }
    frame
};

/// What was caught of a panic, in its own words.
pub(super) fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| text.to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no words".to_string())
}
