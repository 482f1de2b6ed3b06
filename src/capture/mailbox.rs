//! The drive's mailbox, looked into beside the process data: what comes unasked is an emergency message (CiA 301; ETG.1000.6).
//!
//! It is read by registers and not through the stack, which does not survive such a message where it expects an answer. Nothing is
//! requested from the drive during the exchange of process data, so no answer to a request can be removed by mistake.

use super::line::Line;
use super::unasked::{HEAD, emergency};
use super::wire::Wire;
use ethercrab::{SubDevice, SubDeviceRef};
use std::ops::Deref;

/// Sync manager 1, the mailbox that a device writes: start and length, 16 bits each.
const WHERE: u16 = 0x0808;
/// Its status; bit 3 is set while it is full.
const STATUS: u16 = 0x080D;
const FULL: u8 = 1 << 3;

/// Takes a message out of the mailbox of `device`, if there is one, until `until_ns` at most: the code of an emergency; the inner `None` is
/// another message. One that only reports the end of an error (code 0) does not count.
pub(super) fn fetch<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
    until_ns: u64,
) -> Option<Option<u16>> {
    let status = line.run_until(until_ns, device.register_read::<u8>(STATUS)).ok()?;
    if status & FULL == 0 {
        return None;
    }
    let place = line.run_until(until_ns, device.register_read::<u32>(WHERE)).ok()?;
    let (start, length) = (place as u16, (place >> 16) as u16);
    let head = line.run_until(until_ns, device.register_read::<[u8; HEAD]>(start)).ok();
    // It is empty, and takes the next message, once its last byte is read.
    let last = start.wrapping_add(length).wrapping_sub(1);
    let _ = line.run_until(until_ns, device.register_read::<u8>(last));
    let code = head.as_ref().and_then(emergency);
    (code != Some(0)).then_some(code)
}
