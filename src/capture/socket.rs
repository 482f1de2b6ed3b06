//! A network interface in real time: a raw packet socket, which takes `CAP_NET_RAW` and nothing else.

use super::lock::Lock;
use super::wire::Wire;
use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::time::{Duration, Instant};

/// EtherCAT's EtherType, in the order in which the network has bytes.
const ETHERCAT: u16 = 0x88A4_u16.to_be();
/// The last stretch before a moment is waited for awake: a sleep ends late by about that, ns.
const AWAKE_NS: u64 = 60_000;

/// A raw socket that sees EtherCAT frames only.
#[derive(Debug)]
pub struct RawSocket {
    socket: OwnedFd,
    began: Instant,
    _lock: Lock,
}

impl RawSocket {
    /// Opens `interface`.
    ///
    /// Errors: there is no such interface, another process works on it, or this one may not.
    pub fn open(interface: &str) -> io::Result<Self> {
        let name = std::ffi::CString::new(interface).map_err(io::Error::other)?;
        // SAFETY: `name` ends in a zero and lives through the call.
        let index = unsafe { libc::if_nametoindex(name.as_ptr()) };
        if index == 0 {
            return Err(io::Error::last_os_error());
        }
        let lock = Lock::take(index)?;
        let kind = libc::SOCK_RAW | libc::SOCK_NONBLOCK | libc::SOCK_CLOEXEC;
        // SAFETY: no pointer is passed; what comes back is checked.
        let socket = unsafe { libc::socket(libc::AF_PACKET, kind, i32::from(ETHERCAT)) };
        if socket < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: the descriptor was just opened, and nobody else owns it.
        let socket = unsafe { OwnedFd::from_raw_fd(socket) };
        // SAFETY: a plain structure of integers, for which zeros are valid.
        let mut address: libc::sockaddr_ll = unsafe { std::mem::zeroed() };
        address.sll_family = libc::AF_PACKET as u16;
        address.sll_protocol = ETHERCAT;
        address.sll_ifindex = index as i32;
        let length = size_of::<libc::sockaddr_ll>() as libc::socklen_t;
        // SAFETY: the address is of the type and length that its family has.
        let bound = unsafe { libc::bind(socket.as_raw_fd(), (&raw const address).cast(), length) };
        if bound < 0 {
            Err(io::Error::last_os_error())
        } else {
            Ok(Self { socket, began: Instant::now(), _lock: lock })
        }
    }

    /// Waits until a frame can be read, for `patience` at most.
    fn wait(&self, patience: Duration) {
        let mut poll = libc::pollfd { fd: self.socket.as_raw_fd(), events: libc::POLLIN, revents: 0 };
        let patience =
            libc::timespec { tv_sec: patience.as_secs() as libc::time_t, tv_nsec: patience.subsec_nanos().into() };
        // SAFETY: one descriptor, and both structures live through the call.
        unsafe { libc::ppoll(&raw mut poll, 1, &raw const patience, std::ptr::null()) };
    }
}

impl Wire for RawSocket {
    fn now_ns(&self) -> u64 {
        self.began.elapsed().as_nanos() as u64
    }

    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        // SAFETY: pointer and length are those of one slice.
        let sent = unsafe { libc::send(self.socket.as_raw_fd(), frame.as_ptr().cast(), frame.len(), 0) };
        if sent < 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
    }

    fn receive(&mut self, buffer: &mut [u8], until_ns: u64) -> io::Result<Option<usize>> {
        loop {
            // SAFETY: pointer and length are those of one slice.
            let read = unsafe { libc::recv(self.socket.as_raw_fd(), buffer.as_mut_ptr().cast(), buffer.len(), 0) };
            if read >= 0 {
                return Ok(Some(read as usize));
            }
            let error = io::Error::last_os_error();
            if !matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) {
                return Err(error);
            }
            let now_ns = self.now_ns();
            if now_ns >= until_ns {
                return Ok(None);
            }
            self.wait(Duration::from_nanos(until_ns - now_ns));
        }
    }

    fn sleep(&mut self, until_ns: u64) {
        let now_ns = self.now_ns();
        if until_ns > now_ns + AWAKE_NS {
            std::thread::sleep(Duration::from_nanos(until_ns - now_ns - AWAKE_NS));
        }
        while self.now_ns() < until_ns {
            std::hint::spin_loop();
        }
    }

    fn is_real_time(&self) -> bool {
        true
    }
}
