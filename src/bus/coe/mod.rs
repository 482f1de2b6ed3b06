//! CANopen over EtherCAT: object dictionary, SDO server, mailbox.

mod abort;
mod dictionary;
mod mailbox;
mod sdo;

pub use dictionary::{Access, Dictionary, Entry};
pub use mailbox::{Emergency, IN, Mailbox, OUT};
