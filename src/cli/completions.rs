//! `tautline completions`.

use crate::problem::Result;
use clap::CommandFactory;
use clap_complete::Shell;
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tautline completions bash > ~/.local/share/bash-completion/completions/tautline")]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut super::Arguments::command(), "tautline", &mut script);
    super::outcome::say(|out| out.write_all(&script))?;
    Ok(ExitCode::SUCCESS)
}
