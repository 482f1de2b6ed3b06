//! The figures of a diagnosis.

pub mod motion;
