//! What a bus is reached through: frames out, frames in, and the time.

use std::io;

/// The longest Ethernet frame with its header, without the checksum.
pub const FRAME_BYTES: usize = 1514;

/// A network interface in real time, or a bus of our own in virtual time. Times are ns of one monotonic clock.
pub trait Wire {
    /// The time now.
    fn now_ns(&self) -> u64;

    /// Sends a whole Ethernet frame.
    fn send(&mut self, frame: &[u8]) -> io::Result<()>;

    /// The next frame that comes in, as its length in `buffer`; nothing if none does before `until_ns`.
    fn receive(&mut self, buffer: &mut [u8], until_ns: u64) -> io::Result<Option<usize>>;

    /// Waits for the moment `until_ns`; frames that come in meanwhile are kept.
    fn sleep(&mut self, until_ns: u64);

    /// Whether time passes by itself: then nothing may be waited for beside the wire.
    fn is_real_time(&self) -> bool;
}

impl<W: Wire + ?Sized> Wire for Box<W> {
    fn now_ns(&self) -> u64 {
        (**self).now_ns()
    }

    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        (**self).send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], until_ns: u64) -> io::Result<Option<usize>> {
        (**self).receive(buffer, until_ns)
    }

    fn sleep(&mut self, until_ns: u64) {
        (**self).sleep(until_ns);
    }

    fn is_real_time(&self) -> bool {
        (**self).is_real_time()
    }
}
