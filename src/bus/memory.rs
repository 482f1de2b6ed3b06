//! A device's memory behind its sync managers: who may read and write what, and what that sets off.

use super::registers::{self as at, PROCESS_MEMORY};

/// Process memory, bytes.
pub const RAM: usize = 0x2000;
/// The whole.
const SIZE: usize = PROCESS_MEMORY as usize + RAM;

/// 12 KiB with sync managers before the upper 8.
#[derive(Clone)]
pub struct Memory {
    bytes: Vec<u8>,
    sync_managers: usize,
    fmmus: usize,
    /// Sync managers that the device itself keeps shut, one bit each.
    shut: u8,
}

impl std::fmt::Debug for Memory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Memory").field("sync_managers", &self.sync_managers).field("fmmus", &self.fmmus).finish()
    }
}

/// A sync manager as the master set it up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SyncManager {
    /// First address.
    pub start: u16,
    /// Bytes.
    pub length: u16,
    /// Bits 0-1 are 2 for a mailbox, bits 2-3 are 1 where the master writes, bit 6 feeds the watchdog.
    pub control: u8,
    /// Whether the master activated it.
    pub active: bool,
}

impl SyncManager {
    /// Whether the master writes there.
    pub fn is_written(self) -> bool {
        self.control >> 2 & 3 == 1
    }

    /// Whether it is a mailbox rather than a buffer.
    pub fn is_mailbox(self) -> bool {
        self.control & 3 == 2
    }

    /// Whether writing to it feeds the watchdog.
    pub fn feeds_watchdog(self) -> bool {
        self.control & 0x40 != 0
    }

    fn end(self) -> usize {
        usize::from(self.start) + usize::from(self.length)
    }
}

/// What touching the process memory did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Touched {
    /// Sync managers read to their end, one bit each.
    pub read: u8,
    /// Sync managers written to their end, one bit each.
    pub written: u8,
}

impl Memory {
    /// Zeros, with the given number of sync managers and FMMUs.
    pub fn new(sync_managers: usize, fmmus: usize) -> Self {
        Self { bytes: vec![0; SIZE], sync_managers, fmmus, shut: 0 }
    }

    /// How many FMMUs there are.
    pub fn fmmus(&self) -> usize {
        self.fmmus
    }

    /// Bytes, by the device itself.
    pub fn bytes(&self, address: u16, length: usize) -> &[u8] {
        let from = usize::from(address).min(SIZE);
        &self.bytes[from..(from + length).min(SIZE)]
    }

    /// The same to be written by the device itself.
    pub fn bytes_mut(&mut self, address: u16, length: usize) -> &mut [u8] {
        let from = usize::from(address).min(SIZE);
        &mut self.bytes[from..(from + length).min(SIZE)]
    }

    /// One byte.
    pub fn u8(&self, address: u16) -> u8 {
        self.bytes.get(usize::from(address)).copied().unwrap_or(0)
    }

    /// Two bytes.
    pub fn u16(&self, address: u16) -> u16 {
        u16::from_le_bytes([self.u8(address), self.u8(address.wrapping_add(1))])
    }

    /// Four.
    pub fn u32(&self, address: u16) -> u32 {
        u32::from(self.u16(address)) | u32::from(self.u16(address + 2)) << 16
    }

    /// Eight.
    pub fn u64(&self, address: u16) -> u64 {
        u64::from(self.u32(address)) | u64::from(self.u32(address + 4)) << 32
    }

    /// Writes bytes, by the device itself; what lies beyond the memory is lost.
    pub fn put(&mut self, address: u16, bytes: &[u8]) {
        self.bytes_mut(address, bytes.len()).iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    }

    /// Sync manager `index`.
    pub fn sync_manager(&self, index: usize) -> SyncManager {
        let at = at::SYNC_MANAGER + 8 * index as u16;
        let active = index < self.sync_managers && self.u8(at + 6) & 1 != 0;
        SyncManager { start: self.u16(at), length: self.u16(at + 2), control: self.u8(at + 4), active }
    }

    /// Whether the mailbox of sync manager `index` is full.
    pub fn is_full(&self, index: usize) -> bool {
        self.u8(at::SYNC_MANAGER + 8 * index as u16 + 5) & 8 != 0
    }

    /// Fills or empties it.
    pub fn set_full(&mut self, index: usize, full: bool) {
        let status = &mut self.bytes_mut(at::SYNC_MANAGER + 8 * index as u16 + 5, 1)[0];
        *status = *status & !8 | u8::from(full) << 3;
    }

    /// The device has written the whole buffer of sync manager `index`: of its three buffers the next is the last written one (bits
    /// 4 and 5 of the status; Beckhoff's ESC data sheet, section II, register 0x0805).
    pub fn turn_buffer(&mut self, index: usize) {
        let status = &mut self.bytes_mut(at::SYNC_MANAGER + 8 * index as u16 + 5, 1)[0];
        let next = ((*status >> 4 & 3) + 1) % 3;
        *status = *status & !0x30 | next << 4;
    }

    /// Opens or shuts sync manager `index` from the device's side.
    pub fn shut(&mut self, index: usize, shut: bool) {
        self.shut = self.shut & !(1 << index) | u8::from(shut) << index;
    }

    /// The master reads `data.len()` bytes at `address`, OR-ed into `data` where `or`. Whether any could be read.
    pub fn read(&mut self, address: u16, data: &mut [u8], or: bool, touched: &mut Touched) -> bool {
        let range = usize::from(address)..usize::from(address) + data.len();
        if !self.may_read(&range) {
            return false;
        }
        for (to, from) in data.iter_mut().zip(&self.bytes[range.clone()]) {
            *to = if or { *to | *from } else { *from };
        }
        self.note_read(range.end - 1, touched);
        true
    }

    /// The master writes `data` at `address`. Whether any could be written.
    pub fn write(&mut self, address: u16, data: &[u8], touched: &mut Touched) -> bool {
        let range = usize::from(address)..usize::from(address) + data.len();
        if data.is_empty() || range.end > SIZE {
            return false;
        }
        if address < PROCESS_MEMORY {
            return self.write_registers(address, data);
        }
        match self.covering(&range) {
            Some(index) => {
                let manager = self.sync_manager(index);
                let full = manager.is_mailbox() && self.is_full(index);
                if !manager.is_written() || full || range.end > manager.end() || self.shut >> index & 1 != 0 {
                    return false;
                }
                self.bytes[range.clone()].copy_from_slice(data);
                if range.end == manager.end() {
                    touched.written |= 1 << index;
                    if manager.is_mailbox() {
                        self.set_full(index, true);
                    }
                }
            }
            None => self.bytes[range].copy_from_slice(data),
        }
        true
    }

    fn may_read(&self, range: &std::ops::Range<usize>) -> bool {
        if range.is_empty() || range.end > SIZE {
            return false;
        }
        let end_of = |start: u16, size: u16, count: usize| usize::from(start) + usize::from(size) * count;
        if range.start < usize::from(PROCESS_MEMORY) {
            let beyond_fmmus = range.start >= end_of(at::FMMU, 16, self.fmmus) && range.start < 0x0700;
            let beyond_managers =
                range.start >= end_of(at::SYNC_MANAGER, 8, self.sync_managers) && range.start < 0x0880;
            return !beyond_fmmus && !beyond_managers;
        }
        match self.covering(range) {
            Some(index) => {
                let manager = self.sync_manager(index);
                let filled = !manager.is_mailbox() || self.is_full(index);
                !manager.is_written() && filled && range.end <= manager.end() && self.shut >> index & 1 == 0
            }
            None => true,
        }
    }

    /// Emptying a mailbox, and whatever follows from reading up to the byte `last`.
    fn note_read(&mut self, last: usize, touched: &mut Touched) {
        for index in 0..self.sync_managers {
            let manager = self.sync_manager(index);
            if manager.active && !manager.is_written() && manager.length > 0 && manager.end() == last + 1 {
                touched.read |= 1 << index;
                if manager.is_mailbox() {
                    self.set_full(index, false);
                }
            }
        }
    }

    /// The active sync manager that `range` begins in.
    fn covering(&self, range: &std::ops::Range<usize>) -> Option<usize> {
        (0..self.sync_managers).find(|&index| {
            let manager = self.sync_manager(index);
            manager.active && range.start >= usize::from(manager.start) && range.start < manager.end()
        })
    }

    /// Those of the bytes that may be written; whether any was.
    fn write_registers(&mut self, address: u16, data: &[u8]) -> bool {
        let mut any = false;
        for (i, byte) in data.iter().enumerate() {
            let to = address.wrapping_add(i as u16);
            if self.is_writable(to) {
                self.bytes[usize::from(to)] = *byte;
                any = true;
            }
        }
        any
    }

    fn is_writable(&self, address: u16) -> bool {
        let within = |start: u16, size: u16, count: usize| {
            address >= start && usize::from(address) < usize::from(start) + usize::from(size) * count
        };
        // Of a sync manager the status and the device's own control are read only.
        let manager = within(at::SYNC_MANAGER, 8, self.sync_managers) && ![5, 7].contains(&(address & 7));
        manager
            || within(at::FMMU, 16, self.fmmus)
            || at::WRITABLE.iter().any(|(from, to)| (*from..*to).contains(&address))
    }
}
