//! Process data in and out, once a cycle, with the time of the bus where a device has a clock.

use super::group::Group;
use ethercrab::error::Error;
use ethercrab::subdevice_group::{HasPdi, Op};
use ethercrab::{MainDevice, SubDeviceState};

/// The bus exchanging data in OP.
pub struct Exchange<C> {
    /// The stack's group.
    pub group: Group<Op, C>,
    /// Working counter with every device at work.
    pub working_counter: u16,
}

/// What came back.
pub(super) struct Answer {
    /// How many took part, weighted.
    pub working_counter: u16,
    /// The first device that is not in OP, by its place, and where it is.
    pub fallen: Option<(usize, SubDeviceState)>,
    /// The time of the first clock, ns.
    pub bus_time_ns: Option<u64>,
}

impl Answer {
    fn of(working_counter: u16, states: &[SubDeviceState], bus_time_ns: Option<u64>) -> Self {
        let fallen = states.iter().position(|state| *state != SubDeviceState::Op);
        Self { working_counter, fallen: fallen.map(|place| (place, states[place])), bus_time_ns }
    }
}

/// One exchange with all devices of `group`.
///
/// The stack's exchange that spreads the time of a clock never comes back where no device has one: it waits for a lock that it holds
/// itself. So it is asked only where there is a clock.
///
/// Errors: what the stack says.
pub(super) async fn exchange<'m, S: HasPdi, C>(group: &Group<S, C>, main: &'m MainDevice<'m>) -> Result<Answer, Error> {
    if group.iter(main).any(|device| device.dc_support().any()) {
        let seen = group.tx_rx_sync_system_time(main).await?;
        Ok(Answer::of(seen.working_counter, &seen.subdevice_states, seen.extra))
    } else {
        let seen = group.tx_rx(main).await?;
        Ok(Answer::of(seen.working_counter, &seen.subdevice_states, None))
    }
}
