//! What the bus tells of itself during a trial: how far the clocks were apart, what the ports counted, which emergency messages came.
//!
//! One register of one device is read every few cycles, beside the process data, so that nothing of the cycle waits for it.

use super::line::Line;
use super::wire::Wire;
use ethercrab::{Command, MainDevice};
use serde_json::{Value, json};

/// Difference of the device's clock from the reference, ns; bit 31 is the sign.
const CLOCK_DIFFERENCE: u16 = 0x092C;
const SIGN: u32 = 1 << 31;
/// Error counters: 0x0300 on, per port invalid frames and receive errors by turns; 0x0308 on forwarded ones; 0x030C of the processing
/// unit, 0x030D of its interface; 0x0310 on lost links.
const COUNTERS: u16 = 0x0300;
const COUNTERS_BYTES: u16 = 20;

/// One device.
#[derive(Debug, Clone)]
struct Witness {
    name: String,
    station: u16,
    has_clock: bool,
    /// The largest since it was last told, ns.
    clock_difference_ns: Option<u32>,
    /// As last read.
    counters: Option<Vec<u8>>,
    emergencies: Vec<Option<u16>>,
}

/// All devices on the bus.
#[derive(Debug, Clone, Default)]
pub(super) struct Evidence {
    devices: Vec<Witness>,
    next: usize,
}

impl Evidence {
    /// Nothing seen yet; `devices` by name, station address, and whether it has a clock.
    pub fn new(devices: impl Iterator<Item = (String, u16, bool)>) -> Self {
        let witness = |(name, station, has_clock)| Witness {
            name,
            station,
            has_clock,
            clock_difference_ns: None,
            counters: None,
            emergencies: Vec::new(),
        };
        Self { devices: devices.map(witness).collect(), next: 0 }
    }

    /// Reads the next register of the next device, until `until_ns` at most.
    pub fn look<W: Wire>(&mut self, line: &mut Line<'_, W>, main: &MainDevice<'_>, until_ns: u64) {
        let turns = 2 * self.devices.len();
        if turns == 0 {
            return;
        }
        let turn = self.next % turns;
        self.next = (turn + 1) % turns;
        let witness = &mut self.devices[turn / 2];
        if turn % 2 == 1 {
            let asked = async {
                let bytes = Command::fprd(witness.station, COUNTERS).receive_slice(main, COUNTERS_BYTES).await?;
                Ok(bytes.to_vec())
            };
            witness.counters = line.run_until(until_ns, asked).ok().or(witness.counters.take());
        } else if witness.has_clock {
            let asked = Command::fprd(witness.station, CLOCK_DIFFERENCE).receive::<u32>(main);
            if let Ok(difference) = line.run_until(until_ns, asked) {
                let largest = witness.clock_difference_ns.unwrap_or(0).max(difference & !SIGN);
                witness.clock_difference_ns = Some(largest);
            }
        }
    }

    /// The device at `place` sent an emergency message of this code, where it can be read.
    pub fn heard(&mut self, place: usize, code: Option<u16>) {
        if let Some(witness) = self.devices.get_mut(place) {
            witness.emergencies.push(code);
        }
    }

    /// What was seen since this was last asked for; counters are as they stand.
    pub fn tell(&mut self) -> Value {
        self.devices.iter_mut().map(Witness::tell).collect()
    }
}

impl Witness {
    fn tell(&mut self) -> Value {
        let counters = self.counters.as_deref().unwrap_or_default();
        let at =
            |indexes: &[usize]| indexes.iter().filter_map(|index| counters.get(*index)).copied().collect::<Vec<u8>>();
        json!({
            "device": self.name,
            "clock_difference_ns": self.clock_difference_ns.take(),
            "invalid_frames": at(&[0, 2, 4, 6]),
            "receive_errors": at(&[1, 3, 5, 7]),
            "forwarded_errors": at(&[8, 9, 10, 11]),
            "processing_errors": counters.get(12),
            "lost_links": at(&[16, 17, 18, 19]),
            "emergencies": std::mem::take(&mut self.emergencies),
        })
    }
}
