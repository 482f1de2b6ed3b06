//! All integration tests in one binary: it links once.

mod architecture;
mod campaigns;
mod cli;
mod combination;
mod covariance;
mod few;
mod friction;
mod golden;
mod load;
mod log;
mod model;
mod recovery;
mod reference;
