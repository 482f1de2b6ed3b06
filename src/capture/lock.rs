//! One program at a time on an interface: a second one would reset the devices under a moving joint.
//!
//! A socket with an abstract name is the lock. The kernel takes it back when the process ends, however that happens, and keeps it
//! within a network namespace, as it does interfaces. It locks out this program only: other masters do not know of it.

use std::io;
use std::os::fd::AsRawFd;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener, UnixStream};

/// An interface taken, until this is dropped.
#[derive(Debug)]
pub struct Lock {
    _listener: UnixListener,
}

impl Lock {
    /// Takes the interface of this index.
    ///
    /// Errors: another process has it, which is named.
    pub fn take(interface: u32) -> io::Result<Self> {
        let address = SocketAddr::from_abstract_name(format!("tautline/ethercat/{interface}"))?;
        match UnixListener::bind_addr(&address) {
            Ok(listener) => Ok(Self { _listener: listener }),
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
                let holder = UnixStream::connect_addr(&address).ok().and_then(|stream| process_of(&stream));
                let holder = holder.map_or("another process".to_string(), |pid| format!("process {pid}"));
                Err(io::Error::new(error.kind(), format!("{holder} is working on it")))
            }
            Err(error) => Err(error),
        }
    }
}

/// The process at the other end.
fn process_of(stream: &UnixStream) -> Option<i32> {
    let mut found = libc::ucred { pid: 0, uid: 0, gid: 0 };
    let mut length = size_of::<libc::ucred>() as libc::socklen_t;
    // SAFETY: the buffer is of the type and length that this option has, and lives through the call.
    let failed = unsafe {
        libc::getsockopt(
            stream.as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_PEERCRED,
            (&raw mut found).cast(),
            &raw mut length,
        )
    };
    (failed == 0 && found.pid > 0).then_some(found.pid)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interface_is_taken_once_and_given_back() {
        // No interface has this index.
        let index = u32::MAX - std::process::id();
        let first = Lock::take(index).unwrap();
        let refused = Lock::take(index).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AddrInUse);
        assert_eq!(refused.to_string(), format!("process {} is working on it", std::process::id()));
        drop(first);
        Lock::take(index).unwrap();
    }
}
