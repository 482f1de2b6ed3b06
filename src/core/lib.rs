//! tautline's core: what works on samples, from recorded logs to identified, evaluated and diagnosed models.
//!
//! The modules stand in the order in which data flow; a module may use those above it, never those below. The program's other
//! half (arguments, reports, capture) is the crate `tautline`, which shows these modules as its own. They are two crates because
//! this one is compiled for speed and that one for a short build.

/// Ground: what is wrong with an input, and how to mend it.
pub mod problem;

/// Ground: how large an input may be, and how much it may make the program allocate.
pub mod limits;

/// Ground: TOML and JSON as one tree that remembers its rows and knows which keys were asked for.
pub mod document;

/// Ground: least squares, bounded Levenberg-Marquardt, zero-phase filter, statistics; numbers that carry derivatives or print code.
pub mod numerics;

/// Ground: gravity and inertia of one joint, or of a chain of bodies (URDF).
pub mod dynamics;

/// Ground: quantities and their units; everything inside is SI and radians.
pub mod units;

/// Ground: what a joint or its sensors may have beyond the paper's formula: one effect, one file, one list.
pub mod effects;

/// Ground: the paper's formula: friction branches, their combination, the predicted torque; `model.json`.
pub mod model;

/// A robot's URDF or MuJoCo XML -> what it says of one joint, as a model.
pub mod robots;

/// Ground: a motion's plan: rests, sweeps, cosines, sums of sines, one after the other; `trajectory/1`.
pub mod trajectory;

/// Logs in other programs' formats (MATLAB, ROS 2, TwinCAT) -> columns by name.
pub mod import;

/// A campaign's folder -> `Campaign` and, trial by trial, `Log`: the only place that reads data frames.
pub mod log;

/// `Model` x trajectory -> a campaign, as if recorded.
pub mod simulate;

/// `Log` -> `Trial`: filtered, differentiated, cut into legs.
pub mod prepare;

/// `Model` x `Trial` -> y and its parts, sample by sample.
pub mod predict;

/// `Trial`s -> A(v), B(v) -> friction -> combination -> `Model` with its confidence.
pub mod identify;

/// `Model` x `Trial` -> figures: how well the model predicts motions that it was not identified from.
pub mod evaluate;

/// `Model` x `Trial` -> the torque that a person adds, from logs or as samples come.
pub mod interaction;

/// `Model` x `Trial`s -> where the gap lies, what causes it, and by how much it shrinks once that is added.
pub mod diagnose;
