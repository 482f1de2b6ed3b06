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
//! | `wire`, `socket`, `lock`, `in_process`, `clock`, `line` | frames and time, real or virtual, and the EtherCAT stack on them |
//! | `found`, `master`, `own_limits`, `watchdog` | who is there; the way to OP; what drive and bus interfaces watch over |
//! | `esi` | devices as their makers describe them |
//! | `mapping`, `pulses` | what is written to a device before it exchanges data; its clock |
//! | `mailbox`, `unasked`, `managers` | messages that nobody asked for, in OP and before; where process data stand in a device |
//! | `drive`, `sensor` | what the words on the wire mean |
//! | `safety` | the machine that decides what the drive is told: every state, every transition |
//! | `cause`, `limits`, `ramp` | why to stop, what is allowed, moves without corners |
//! | `watch` | what is measured, held against the limits |
//! | `bound`, `follow`, `fresh` | what is sent kept within the limits; whether the joint follows; whether inputs are new |
//! | `axis`, `exchange`, `cycle` | one cycle as a pure step; process data in and out; the two together |
//! | `operator`, `briefing` | who is asked before there is torque, and what is shown first |
//! | `run`, `tried`, `session` | the trials one after the other, after a first small motion; a whole capture |
//! | `torque` | whether it is known to be off at the end |
//! | `commission` | a jog -> the rig's signs, scales and zero |
//! | `folder`, `origin`, `recorder` | samples to the disk as they come; by which clock |
//! | `evidence`, `history` | what the bus told of itself during each trial; what the drives remember of their faults |
//! | `realtime` | what the operating system grants |

pub mod axis;
mod bound;
mod briefing;
pub mod cause;
mod clock;
pub mod commission;
pub mod cycle;
pub mod drive;
pub mod esi;
mod evidence;
mod exchange;
pub mod folder;
mod follow;
pub mod found;
mod fresh;
pub mod group;
mod history;
pub mod in_process;
pub mod limits;
pub mod line;
#[cfg(target_os = "linux")]
mod lock;
mod mailbox;
mod managers;
mod mapping;
pub mod master;
pub mod operator;
mod origin;
mod own_limits;
pub mod plan;
mod pulses;
pub mod ramp;
pub mod realtime;
pub mod recorder;
pub mod rig;
pub mod run;
pub mod safety;
pub mod sensor;
pub mod session;
#[cfg(target_os = "linux")]
pub mod socket;
mod task;
mod torque;
mod tried;
mod unasked;
mod watch;
mod watchdog;
pub mod wire;
