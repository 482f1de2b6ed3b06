//! CANopen over EtherCAT: object dictionary, SDO server, mailbox.

mod abort;
mod dictionary;
mod information;
mod mailbox;
mod sdo;

pub use dictionary::{Access, Dictionary, Entry};
pub use mailbox::{Emergency, IN, Mailbox, OUT};
