//! `steradian completions` and `steradian man`, for packagers and for shells' start files.

use super::{Arguments, talk};
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::path::PathBuf;
use std::process::ExitCode;
use steradian::{Error, Result};

/// Flags of `completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionFlags {
    /// Which shell
    shell: Shell,
}

/// Flags of `man`.
#[derive(Debug, Args)]
pub(crate) struct ManFlags {
    /// The folder, which must exist
    folder: PathBuf,
}

/// Prints the completions of a shell.
pub(super) fn complete(flags: &CompletionFlags) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(flags.shell, &mut Arguments::command(), "steradian", &mut script);
    talk::data(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}

/// Writes a page for the program and one for each command.
pub(super) fn man(flags: &ManFlags) -> Result<ExitCode> {
    let failure = |e| Error::io(&flags.folder, e);
    clap_mangen::generate_to(Arguments::command(), &flags.folder).map_err(failure)?;
    Ok(ExitCode::SUCCESS)
}
