//! The software bus beside the specifications it stands for, in virtual time: no test here looks at the clock on the wall.

mod clocks;
mod drive;
mod eeprom;
mod faults;
mod joint;
mod line;
mod mailbox;
mod master;
mod process_data;
mod registers;
mod states;
mod veth;
