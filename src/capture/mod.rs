//! The wire: a joint driven over EtherCAT, safely, and recorded as a campaign without losing anything.
//!
//! ```text
//! rig.toml, plan.toml -> master: the bus to OP -> cycle: command and measurement -> safety -> drive
//!                                                        '-> recorder -> campaign's folder
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `rig`, `plan` | what is on the bus and what is to be recorded |
//! | `wire`, `socket`, `in_process`, `clock`, `line` | frames and time, real or virtual, and the EtherCAT stack on them |
//! | `found`, `master`, `own_limits` | who is there; the way to OP; what the drive itself watches over |
//! | `mailbox` | messages that nobody asked for |
//! | `drive`, `sensor` | what the words on the wire mean |
//! | `safety` | the machine that decides what the drive is told: every state, every transition |
//! | `cause`, `limits`, `ramp` | why to stop, what is allowed, moves without corners |
//! | `axis`, `cycle` | one cycle as a pure step; the exchange |
//! | `run`, `session` | the trials one after the other; a whole capture |
//! | `folder`, `recorder` | samples to the disk as they come |
//! | `realtime` | what the operating system grants |

pub mod axis;
pub mod cause;
mod clock;
pub mod cycle;
pub mod drive;
pub mod folder;
pub mod found;
pub mod in_process;
pub mod limits;
pub mod line;
mod mailbox;
pub mod master;
mod own_limits;
pub mod plan;
pub mod ramp;
pub mod realtime;
pub mod recorder;
pub mod rig;
mod run;
pub mod safety;
pub mod sensor;
pub mod session;
#[cfg(target_os = "linux")]
pub mod socket;
pub mod wire;
