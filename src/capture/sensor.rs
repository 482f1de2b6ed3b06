//! The torque sensor's terminal: counts and status bits -> torque, or what is wrong with it.

use super::cause::Cause;
use super::rig::{Place, Sensor, StaleBy};

/// Bits of a 16-bit status word as EL3xxx terminals send it.
const UNDERRANGE: u32 = 1 << 0;
const OVERRANGE: u32 = 1 << 1;
const ERROR: u32 = 1 << 6;
const TOGGLE: u32 = 1 << 15;

/// The sensor, read cycle by cycle.
#[derive(Debug, Clone)]
pub struct SensorReader {
    nm_per_count: f64,
    zero_counts: f64,
    saturated_counts: f64,
    stale_by: StaleBy,
    stale_cycles: u32,
    torque: Option<Place>,
    status: Option<Place>,
    /// Underrange, overrange, error, toggle where they stand alone.
    bits: [Option<Place>; 4],
    /// The toggle bit, or the value, of the last cycle.
    last: Option<f64>,
    unchanged: u32,
}

/// What one cycle says.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// As it came, counts.
    pub counts: f64,
    /// Torque, N m; `None` where it is not valid.
    pub torque_nm: Option<f64>,
    /// The status word, 0 where there is none.
    pub status: u16,
    /// What is wrong.
    pub cause: Option<Cause>,
}

impl SensorReader {
    /// Reads what `sensor` sends.
    pub fn new(sensor: &Sensor) -> Self {
        let place = |role| sensor.inputs.place(role);
        Self {
            nm_per_count: sensor.nm_per_count,
            zero_counts: sensor.zero_counts,
            saturated_counts: sensor.saturated_counts,
            stale_by: sensor.stale_by,
            stale_cycles: sensor.stale_cycles,
            torque: place("torque"),
            status: place("status"),
            bits: ["underrange", "overrange", "error", "toggle"].map(place),
            last: None,
            unchanged: 0,
        }
    }

    /// What the terminal's `inputs` say, `periods` after the last ones.
    pub fn read(&mut self, inputs: &[u8], periods: u32) -> Reading {
        let counts = self.torque.map_or(f64::NAN, |place| place.get(inputs));
        let word = self.status.map_or(0, |place| place.get(inputs) as u32);
        let [underrange, overrange, error, toggle] = self.bits.map(|bit| bit.is_some_and(|bit| bit.get(inputs) > 0.0));
        let is_saturated =
            word & (UNDERRANGE | OVERRANGE) != 0 || underrange || overrange || counts.abs() >= self.saturated_counts;
        self.follow(toggle || word & TOGGLE != 0, counts, periods);
        let cause = if !counts.is_finite() {
            Some(Cause::SensorNotANumber)
        } else if is_saturated {
            Some(Cause::SensorSaturated)
        } else if error || word & ERROR != 0 {
            Some(Cause::SensorError)
        } else {
            (self.unchanged >= self.stale_cycles).then_some(Cause::SensorStale(self.unchanged))
        };
        let torque_nm = cause.is_none().then_some((counts - self.zero_counts) * self.nm_per_count);
        Reading { counts, torque_nm, status: word as u16, cause }
    }

    /// Counts the cycles in which nothing is new.
    fn follow(&mut self, toggle: bool, counts: f64, periods: u32) {
        let now = match self.stale_by {
            StaleBy::Toggle => f64::from(u8::from(toggle)),
            StaleBy::Value => counts,
            StaleBy::Nothing => return,
        };
        // After missed cycles a bit may have changed and changed back.
        let stands = self.last == Some(now) && (periods == 1 || self.stale_by == StaleBy::Value);
        self.unchanged = if stands { self.unchanged + 1 } else { 0 };
        self.last = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::rig::{Entry, Identity, Kind, ProcessData, Setup};

    fn reader(stale_by: StaleBy) -> SensorReader {
        let entry = |role: &str, kind| Entry { role: Some(role.to_string()), index: 0x6000, sub: 1, kind };
        let entries = vec![entry("status", Kind::Unsigned(16)), entry("torque", Kind::Signed(16))];
        SensorReader::new(&Sensor {
            identity: Identity {
                place: 1,
                name: "sensor".to_string(),
                vendor: 1,
                product: 1,
                revision: None,
                serial: None,
                alias: None,
            },
            is_in_drive: false,
            setup: Setup::default(),
            nm_per_count: 1e-3,
            zero_counts: 100.0,
            saturated_counts: 32_767.0,
            stale_by,
            stale_cycles: 3,
            inputs: ProcessData::one(0x1A00, entries),
        })
    }

    fn inputs(status: u32, counts: i16) -> Vec<u8> {
        [(status as u16).to_le_bytes(), counts.to_le_bytes()].concat()
    }

    #[test]
    fn counts_become_torque() {
        let reading = reader(StaleBy::Toggle).read(&inputs(0, 600), 1);
        assert_eq!((reading.torque_nm, reading.cause), (Some(0.5), None));
    }

    #[test]
    fn what_is_wrong_is_told() {
        let cause = |status, counts| reader(StaleBy::Toggle).read(&inputs(status, counts), 1).cause;
        assert_eq!(cause(UNDERRANGE, 5), Some(Cause::SensorSaturated));
        assert_eq!(cause(OVERRANGE, 5), Some(Cause::SensorSaturated));
        assert_eq!(cause(0, i16::MAX), Some(Cause::SensorSaturated));
        assert_eq!(cause(ERROR, 5), Some(Cause::SensorError));
        assert_eq!(reader(StaleBy::Toggle).read(&[], 1).cause, Some(Cause::SensorNotANumber));
    }

    #[test]
    fn a_toggle_that_stands_still_is_stale() {
        let mut reader = reader(StaleBy::Toggle);
        for i in 0..10 {
            assert_eq!(reader.read(&inputs(if i % 2 == 0 { TOGGLE } else { 0 }, 5), 1).cause, None);
        }
        let causes: Vec<bool> = (0..5).map(|_| reader.read(&inputs(TOGGLE, 5), 1).cause.is_some()).collect();
        assert_eq!(causes, [false, false, false, true, true]);
        assert_eq!(reader.read(&inputs(0, 5), 1).cause, None);
    }

    #[test]
    fn without_a_toggle_the_value_itself_tells() {
        let mut by_value = reader(StaleBy::Value);
        assert!((0..10).all(|counts| by_value.read(&inputs(0, counts), 1).cause.is_none()));
        let causes: Vec<bool> = (0..4).map(|_| by_value.read(&inputs(0, 9), 1).cause.is_some()).collect();
        assert_eq!(causes, [false, false, true, true]);
        let mut by_nothing = reader(StaleBy::Nothing);
        assert!((0..10).all(|_| by_nothing.read(&inputs(0, 9), 1).cause.is_none()));
    }
}
