//! All integration tests in one binary: it links once.

mod architecture;
mod campaigns;
mod cli;
mod combination;
mod free;
mod friction;
mod golden;
mod log;
mod model;
mod recovery;
mod reference;
