//! The chain that a model's joint is part of, named on the command line.

use crate::dynamics::Chain;
use crate::model::Model;
use crate::problem::{Problem, Result};
use std::path::{Path, PathBuf};

/// A joint of a URDF.
#[derive(Debug, clap::Args)]
pub struct ArmArguments {
    /// URDF of the whole arm, in place of the model's gravity and inertia
    #[arg(long, requires = "joint")]
    pub urdf: Option<PathBuf>,
    /// The model's joint in the URDF
    #[arg(long, requires = "urdf")]
    pub joint: Option<String>,
}

impl ArmArguments {
    /// The chain for `model`, which was read from `file`.
    ///
    /// Errors: no such joint, one of another kind, a model that needs a chain and gets none.
    pub fn chain(&self, model: &Model, file: &Path) -> Result<Option<Chain>> {
        let (Some(urdf), Some(name)) = (&self.urdf, &self.joint) else {
            return match &model.chain {
                None => Ok(None),
                Some(of) => {
                    let what = format!("takes gravity and inertia from joint `{}` of {}", of.joint, of.urdf);
                    Problem::error(file, what, "name the arm with --urdf and --joint").alone()
                }
            };
        };
        let joint = &model.joint;
        let chain = Chain::read(urdf, name)?;
        if chain.kind() != joint.kind {
            let what = format!("`{name}` is {}, the model's joint {}", chain.kind().name(), joint.kind.name());
            return Problem::error(urdf, what, "name the joint that the model is of").alone();
        }
        Ok(Some(chain.carrying(&model.dynamics.payload)))
    }
}
