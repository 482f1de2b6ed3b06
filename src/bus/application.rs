//! What a device is for, behind its bus interface.

use super::coe::{Dictionary, Emergency};
use super::fault::Fault;
use super::world::World;

/// When an application works, and in what state its device is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moment {
    /// The bus's time, ns.
    pub now_ns: u64,
    /// Whether the device is in OP: outputs count.
    pub operational: bool,
    /// Whether outputs came since it last worked.
    pub fresh: bool,
    /// Whether inputs are sampled now: by a pulse of the clock or as process data pass.
    pub samples: bool,
}

/// What a device is for. Objects hold what it is told and what it tells.
pub trait Application: std::fmt::Debug + Send {
    /// Works once; may have something to warn of.
    fn work(&mut self, dictionary: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency>;

    /// Something goes wrong, should it be of this application's kind.
    fn fail(&mut self, fault: Fault);
}
