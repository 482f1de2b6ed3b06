//! What may go wrong on a wire, in a device, at the joint: injected at a time or at a cycle.

/// One thing that goes wrong. Devices are counted from 0 in the order of the wire; what has no count lasts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// The next `frames` frames of process data come back later than they would.
    Late {
        /// How many.
        frames: u32,
        /// By how much, ns.
        by_ns: u64,
    },
    /// The next `frames` frames of process data reach the devices and are lost on the way back.
    Lost {
        /// How many.
        frames: u32,
    },
    /// The next `frames` frames of process data never reach the devices.
    Unsent {
        /// How many.
        frames: u32,
    },
    /// The next `frames` frames of process data come back twice.
    Duplicated {
        /// How many.
        frames: u32,
    },
    /// The next `frames` frames of process data come back damaged, in turn: a datagram's number, a length, a working counter, the end
    /// missing. Damage that neither header nor counter shows would have failed Ethernet's checksum.
    Corrupted {
        /// How many.
        frames: u32,
    },
    /// A device lets the next `frames` frames pass without taking or giving process data: the working counter falls short.
    WorkingCounterShort {
        /// Which device.
        device: usize,
        /// How many.
        frames: u32,
    },
    /// A device falls back to SAFE-OP with an error of this AL status code.
    SafeOp {
        /// Which device.
        device: usize,
        /// ETG.1000.6 table 11; 0x001A is a synchronisation error.
        code: u16,
    },
    /// A device, and all behind it, are no longer on the wire.
    Gone {
        /// Which device.
        device: usize,
    },
    /// Another master on the wire resets all devices: they go to INIT.
    SecondMaster,
    /// A device sends an emergency message (CoE) and goes on.
    Emergency {
        /// Which device.
        device: usize,
        /// CiA 301 error code.
        code: u16,
    },
    /// A device takes its output watchdog for expired.
    Watchdog {
        /// Which device.
        device: usize,
    },
    /// The drive finds a fault of its own.
    Drive {
        /// CiA 402 error code, 0x2310 being too much current.
        code: u16,
    },
    /// The drive stops by its own quick stop.
    QuickStop,
    /// The drive's enable input falls: no torque at once.
    Inhibit,
    /// The drive reports that a limit of its own acts (status word, bit 11).
    InternalLimit,
    /// The joint is blocked where it is.
    Blocked,
    /// The cable breaks: no torque reaches the sensor, nothing moves the joint's mass.
    CableBreak,
    /// The drive's encoder loses count by so much, rad at the joint.
    EncoderJump {
        /// By how much.
        by_rad: f64,
    },
    /// The torque sensor's terminal stops converting: value and toggle bit stay as they are.
    StaleSensor,
    /// The torque sensor's reading goes to the end of its range.
    SaturatedSensor,
    /// The torque sensor's reading is not a number (a float terminal), or has its error bit set.
    NotANumber,
    /// A device's firmware hangs on its input side: what it sends stays as it is, while its bus interface goes on answering.
    FrozenInputs {
        /// Which device.
        device: usize,
    },
    /// The drive's encoder, as it is reported, stands still: the motor still moves as it is told.
    FrozenEncoder,
    /// The drive ignores its control word from now on.
    IgnoredControl,
    /// The drive ignores a quick stop, and obeys every other command.
    IgnoredQuickStop,
    /// In speed mode the drive runs at this multiple of the commanded speed.
    Runaway {
        /// How many times.
        factor: f64,
    },
    /// The output watchdog of a device no longer acts; its time reads 0 and is not taken.
    WatchdogOff {
        /// Which device.
        device: usize,
    },
}

impl Fault {
    /// Faults by the names that a command line gives them; what follows a colon is their number.
    pub const NAMES: [&'static str; 26] = [
        "late:FRAMES",
        "lost:FRAMES",
        "unsent:FRAMES",
        "corrupted:FRAMES",
        "short:FRAMES",
        "safe-op:DEVICE",
        "gone:DEVICE",
        "second-master",
        "emergency:CODE",
        "watchdog",
        "watchdog-off",
        "drive-fault:CODE",
        "quick-stop",
        "inhibit",
        "internal-limit",
        "blocked",
        "cable-break",
        "encoder-jump:RAD",
        "frozen-encoder",
        "frozen-inputs",
        "ignored-control",
        "ignored-quick-stop",
        "stale-sensor",
        "saturated-sensor",
        "not-a-number",
        "runaway:FACTOR",
    ];

    /// The fault of that name; nothing where there is none, or its number is missing or too large.
    pub fn named(text: &str) -> Option<Self> {
        let (name, number) = text.split_once(':').unwrap_or((text, ""));
        let whole = || number.parse::<u32>().ok();
        let code = || match number.strip_prefix("0x") {
            Some(hex) => u16::from_str_radix(hex, 16).ok(),
            None => number.parse().ok(),
        };
        let device = || number.parse::<usize>().ok();
        let real = || number.parse().ok().filter(|real: &f64| real.is_finite());
        Some(match name {
            "late" => Self::Late { frames: whole()?, by_ns: 3_000_000 },
            "lost" => Self::Lost { frames: whole()? },
            "unsent" => Self::Unsent { frames: whole()? },
            "corrupted" => Self::Corrupted { frames: whole()? },
            "short" => Self::WorkingCounterShort { device: 0, frames: whole()? },
            "safe-op" => Self::SafeOp { device: device()?, code: 0x001A },
            "gone" => Self::Gone { device: device()? },
            "second-master" => Self::SecondMaster,
            "emergency" => Self::Emergency { device: 0, code: code()? },
            "watchdog" => Self::Watchdog { device: 0 },
            "watchdog-off" => Self::WatchdogOff { device: 0 },
            "drive-fault" => Self::Drive { code: code()? },
            "quick-stop" => Self::QuickStop,
            "inhibit" => Self::Inhibit,
            "internal-limit" => Self::InternalLimit,
            "blocked" => Self::Blocked,
            "cable-break" => Self::CableBreak,
            "encoder-jump" => Self::EncoderJump { by_rad: real()? },
            "frozen-encoder" => Self::FrozenEncoder,
            "frozen-inputs" => Self::FrozenInputs { device: 0 },
            "ignored-control" => Self::IgnoredControl,
            "ignored-quick-stop" => Self::IgnoredQuickStop,
            "stale-sensor" => Self::StaleSensor,
            "saturated-sensor" => Self::SaturatedSensor,
            "not-a-number" => Self::NotANumber,
            "runaway" => Self::Runaway { factor: real()? },
            _ => return None,
        })
    }
}

/// When a fault strikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// At this virtual time, ns.
    Time(u64),
    /// With this frame of process data, counted from 0.
    Cycle(u64),
}

impl From<u64> for When {
    fn from(at_ns: u64) -> Self {
        Self::Time(at_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_fault() {
        for name in Fault::NAMES {
            let (word, number) = name.split_once(':').unwrap_or((name, ""));
            let text = if number.is_empty() { word.to_string() } else { format!("{word}:1") };
            assert!(Fault::named(&text).is_some(), "{text}");
            assert!(number.is_empty() || Fault::named(word).is_none(), "{word}");
        }
        assert_eq!(Fault::named("drive-fault:0x2310"), Some(Fault::Drive { code: 0x2310 }));
    }
}
