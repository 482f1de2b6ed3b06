//! The mailbox (ETG.1000.4, 6.7; ETG.1000.6, 5.6): CoE in, CoE out, emergencies in between.

use super::dictionary::Dictionary;
use super::information;
use super::sdo::Server;
use crate::bus::memory::Memory;
use std::collections::VecDeque;

/// How long a device takes to answer, ns.
const ANSWERS_AFTER_NS: u64 = 400_000;
/// Sync managers of the mailbox: from the master, and to it.
pub const OUT: usize = 0;
/// To the master.
pub const IN: usize = 1;

/// The CoE service of SDO information.
const INFORMATION: u8 = 8;
/// Where a sync manager's activation and the device's own control stand.
const ACTIVATION: u16 = 6;
const OWN_CONTROL: u16 = 7;
/// The repeat bit in both.
const REPEAT: u8 = 2;

/// An emergency message: CiA 301 error code and error register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Emergency {
    /// What is wrong.
    pub code: u16,
    /// 0x1001.
    pub register: u8,
}

/// A device's mailbox.
#[derive(Debug, Clone, Default)]
pub struct Mailbox {
    server: Server,
    /// What came, and when it will be answered.
    asked: Option<(u64, Vec<u8>)>,
    waiting: VecDeque<Vec<u8>>,
    /// The last that went out, should it get lost.
    last: Vec<u8>,
    counter: u8,
    /// Counter of the last request; 0 before there was one.
    asked_counter: u8,
}

impl Mailbox {
    /// Forgets everything, as on a return to INIT.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The master filled its mailbox at `now_ns`.
    pub fn take(&mut self, memory: &mut Memory, now_ns: u64) {
        let manager = memory.sync_manager(OUT);
        let bytes = memory.bytes(manager.start, usize::from(manager.length)).to_vec();
        // Bits 4 to 6 of the fifth byte count requests from 1 to 7; one that comes again was executed (ETG.1000.4, 5.6).
        let counter = bytes.get(5).map_or(0, |byte| byte >> 4 & 7);
        if counter != 0 && counter == self.asked_counter {
            memory.set_full(OUT, false);
            return;
        }
        self.asked_counter = counter;
        self.asked = Some((now_ns + ANSWERS_AFTER_NS, bytes));
    }

    /// Something went wrong that the master should hear of.
    pub fn warn(&mut self, emergency: Emergency) {
        let code = emergency.code.to_le_bytes();
        let message = [code[0], code[1], emergency.register, 0, 0, 0, 0, 0];
        self.waiting.push_back(coe(1, &message));
    }

    /// When there is something to do.
    pub fn due_ns(&self) -> Option<u64> {
        self.asked.as_ref().map(|(due_ns, _)| *due_ns)
    }

    /// Answers what is due, and puts what waits into the mailbox to the master if that is empty.
    pub fn work(&mut self, memory: &mut Memory, dictionary: &mut Dictionary, in_pre_op: bool, now_ns: u64) {
        if let Some((_, request)) = self.asked.take_if(|(due_ns, _)| *due_ns <= now_ns) {
            memory.set_full(OUT, false);
            let room = usize::from(memory.sync_manager(IN).length);
            let answers = self.answers(&request, dictionary, in_pre_op, room);
            self.waiting.extend(answers.unwrap_or_default());
        }
        let manager = memory.sync_manager(IN);
        if manager.active
            && !memory.is_full(IN)
            && let Some(message) = self.waiting.pop_front()
        {
            self.post(memory, message);
        }
    }

    /// The master requests the last message again by toggling its repeat bit.
    pub fn repeat_if_asked(&mut self, memory: &mut Memory) {
        let at = crate::bus::registers::SYNC_MANAGER + 8 * IN as u16;
        let asked = memory.u8(at + ACTIVATION) & REPEAT;
        let done = memory.u8(at + OWN_CONTROL);
        if asked != done & REPEAT {
            memory.put(at + OWN_CONTROL, &[done & !REPEAT | asked]);
            let manager = memory.sync_manager(IN);
            if manager.active && !self.last.is_empty() && !memory.is_full(IN) {
                memory.put(manager.start, &self.last);
                memory.set_full(IN, true);
            }
        }
    }

    fn post(&mut self, memory: &mut Memory, mut message: Vec<u8>) {
        self.counter = self.counter % 7 + 1;
        message[5] |= self.counter << 4;
        let manager = memory.sync_manager(IN);
        message.resize(usize::from(manager.length).max(message.len()), 0);
        message.truncate(usize::from(manager.length));
        memory.put(manager.start, &message);
        memory.set_full(IN, true);
        self.last = message;
    }

    /// What goes back; none where the request is no message, or ends a transfer.
    fn answers(
        &mut self,
        request: &[u8],
        dictionary: &mut Dictionary,
        in_pre_op: bool,
        room: usize,
    ) -> Option<Vec<Vec<u8>>> {
        let length = usize::from(u16::from_le_bytes([*request.first()?, *request.get(1)?]));
        let kind = request.get(5)? & 0x0F;
        let Some(body) = request.get(6..6 + length) else { return Some(vec![error(5)]) };
        if kind != 3 {
            return Some(vec![error(2)]);
        }
        match body.get(1)? >> 4 {
            2 => {
                let answer = self.server.answer(&body[2..], dictionary, in_pre_op, room)?;
                // An abort is a request of its own, all else a response.
                Some(vec![coe(if answer[0] == 0x80 { 2 } else { 3 }, &answer)])
            }
            INFORMATION => {
                let answers = information::answers(&body[2..], dictionary, room);
                Some(answers.iter().map(|answer| coe(INFORMATION, answer)).collect())
            }
            _ => Some(vec![error(4)]),
        }
    }
}

/// A CoE message behind its mailbox header.
fn coe(service: u8, data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u16 + 2).to_le_bytes();
    let mut bytes = vec![length[0], length[1], 0, 0, 0, 3, 0, service << 4];
    bytes.extend(data);
    bytes
}

/// A mailbox error (ETG.1000.4, table 30): 2 no such protocol, 4 no such service, 5 a header that makes no sense.
fn error(code: u8) -> Vec<u8> {
    vec![4, 0, 0, 0, 0, 0, 1, 0, code, 0]
}
