//! What a drive remembers of its faults: the diagnosis history (0x10F3, ETG.1020), or the list of errors (0x1003, CiA 301).
//!
//! It is read by SDOs, so only where no data flow: before OP, and after it, when a capture has been stopped.

use super::line::Line;
use super::wire::Wire;
use ethercrab::{EtherCrabWireRead, EtherCrabWireSized, SubDevice, SubDeviceRef};
use ethercrab_wire::WireError;
use serde_json::{Value, json};
use std::ops::Deref;

/// Messages stand from this subindex of 0x10F3 on; before it, how many there are at most.
const FIRST_MESSAGE: u8 = 6;
const DIAGNOSIS: u16 = 0x10F3;
/// The list of errors, the newest first, 32 bits each.
const ERRORS: u16 = 0x1003;
/// At most this many are read: each takes a millisecond or more.
const MOST: u8 = 20;
/// How long all of it may take, ns.
const ANSWER_NS: u64 = 500_000_000;
/// The longest message that is read, bytes.
const MESSAGE_BYTES: usize = 128;

/// A message as it stands in the object.
#[derive(Debug, PartialEq, Eq)]
struct Message(Vec<u8>);

impl EtherCrabWireRead for Message {
    fn unpack_from_slice(bytes: &[u8]) -> Result<Self, WireError> {
        Ok(Self(bytes.to_vec()))
    }
}

impl EtherCrabWireSized for Message {
    const PACKED_LEN: usize = MESSAGE_BYTES;
    type Buffer = [u8; MESSAGE_BYTES];
    fn buffer() -> Self::Buffer {
        [0; MESSAGE_BYTES]
    }
}

impl Message {
    /// Its code, text and time stamp, which begin every message (ETG.1020, table 26), and what follows as bytes; nothing of an empty
    /// place.
    fn told(&self) -> Option<Value> {
        let whole = |from: usize, bytes: usize| {
            let part = self.0.get(from..from + bytes)?;
            Some(part.iter().rev().fold(0u64, |number, byte| number << 8 | u64::from(*byte)))
        };
        let (code, text, time_ns) = (whole(0, 4)?, whole(6, 2)?, whole(8, 8)?);
        let parameters: String = self.0[16..].iter().map(|byte| format!("{byte:02x}")).collect();
        let told = json!({
            "code": format!("{code:#010x}"), "text": format!("{text:#06x}"), "time_ns": time_ns, "parameters": parameters,
        });
        (code != 0).then_some(told)
    }
}

/// The faults that the device remembers; nothing where it has neither object, or does not answer within `ANSWER_NS`.
pub(super) fn read<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
) -> Option<Value> {
    let until_ns = line.wire.now_ns() + ANSWER_NS;
    if let Ok(most) = line.run_until(until_ns, device.sdo_read::<u8>(DIAGNOSIS, 1u8)) {
        let subs = FIRST_MESSAGE..FIRST_MESSAGE.saturating_add(most.min(MOST));
        let messages = subs.map_while(|sub| line.run_until(until_ns, device.sdo_read::<Message>(DIAGNOSIS, sub)).ok());
        let told: Vec<Value> = messages.filter_map(|message| message.told()).collect();
        return Some(json!({ "object": "0x10f3", "messages": told }));
    }
    let count = line.run_until(until_ns, device.sdo_read::<u8>(ERRORS, 0u8)).ok()?;
    let errors =
        (1..=count.min(MOST)).map_while(|sub| line.run_until(until_ns, device.sdo_read::<u32>(ERRORS, sub)).ok());
    let told: Vec<String> = errors.map(|error| format!("{error:#010x}")).collect();
    Some(json!({ "object": "0x1003", "messages": told }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_told_by_code_text_and_time() {
        let bytes = [&0x2310_E800u32.to_le_bytes()[..], &[2, 0], &[0x34, 0x12], &7u64.to_le_bytes(), &[0xAB]].concat();
        let told = Message(bytes).told().unwrap();
        assert_eq!(
            (&told["code"], &told["text"], &told["time_ns"], &told["parameters"]),
            (&json!("0x2310e800"), &json!("0x1234"), &json!(7), &json!("ab"))
        );
        assert_eq!((Message(vec![0; 16]).told(), Message(vec![1; 5]).told()), (None, None));
    }
}
