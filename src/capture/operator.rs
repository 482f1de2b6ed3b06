//! Whoever stands beside the joint: asked before there is torque, on an open bus, after everything is shown.

use std::fmt::Debug;

/// Someone to ask. The bus goes on cycling until the answer is there: nothing here may wait.
pub trait Operator: Debug {
    /// Shows `lines` and asks for `word`.
    fn ask(&self, lines: &[String], word: &str);

    /// Whether torque is granted; nothing until there is an answer.
    fn answer(&self) -> Option<bool>;
}

/// Agrees to everything: for software joints, which hurt nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Agrees;

impl Operator for Agrees {
    fn ask(&self, _: &[String], _: &str) {}

    fn answer(&self) -> Option<bool> {
        Some(true)
    }
}
