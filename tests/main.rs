//! All integration tests in one binary: it links once.

mod architecture;
mod campaigns;
mod chain;
mod cli;
mod closed_loop;
mod combination;
mod compare;
mod covariance;
mod diagnose;
mod effects;
mod evaluate;
mod few;
mod free;
mod friction;
mod golden;
mod interaction;
mod load;
mod log;
mod model;
mod motion;
mod next;
mod recovery;
mod reference;
mod simulate;
mod trajectory;
mod validate;
