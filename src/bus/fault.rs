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
    /// The next `frames` frames of process data come back damaged, in turn: a datagram's number, a length, a working counter, the
    /// end missing. What no header or counter betrays, Ethernet's checksum would have.
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
    /// In speed mode the drive runs at so many times the speed it is told.
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
