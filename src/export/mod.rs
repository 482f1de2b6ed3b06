//! A model where it is used: as code for a controller, as attributes of a simulator's joint, as tables.
//!
//! | file | what it makes |
//! |---|---|
//! | `code` | a formula as lines of C99 or of Rust |
//! | `controller` | the C header and the Rust module |
//! | `robot` | the joint of a MuJoCo XML or a URDF, and what such a joint cannot be |
//! | `table` | parameters with their confidence as CSV, LaTeX, Markdown |

mod code;
mod controller;
mod robot;
mod table;

pub use controller::{Language, Settings, controller};
pub use robot::{Likeness, mujoco_xml, urdf_xml};
pub use table::{csv, latex, markdown};

use crate::model::Model;

/// The joint's name as code and files can have it: `elbow`, `left_elbow_2`.
pub fn plain_name(model: &Model) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let name: String = model.joint.name.chars().map(plain).collect();
    match name.chars().next() {
        Some(first) if first.is_ascii_digit() => format!("joint_{name}"),
        Some(_) => name,
        None => "joint".to_string(),
    }
}
