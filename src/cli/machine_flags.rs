//! Flags for programs that call this one.

use super::display;
use super::log::{self, Busy, LOG_FORMATS, LogFormat};
use super::progress::{PROGRESS_KINDS, ProgressKind};
use super::values;
use clap::Args;
use std::path::{Path, PathBuf};
use steradian::{Error, Result};

/// How the program talks with others, and where settings come from.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Machines")]
pub(crate) struct MachineFlags {
    /// Form of what is said on standard error
    #[arg(long, value_parser = values::one_of(LOG_FORMATS), default_value = "text")]
    pub(crate) log_format: LogFormat,

    /// A file that gets every line that is said, and those of --verbose
    #[arg(long, value_name = "FILE")]
    pub(crate) log_file: Option<PathBuf>,

    /// How progress is told
    #[arg(long, value_parser = values::one_of(PROGRESS_KINDS), default_value = "auto")]
    pub(crate) progress: ProgressKind,

    /// Show the picture as it gets better in the viewer tev, such as 127.0.0.1:14158
    #[arg(long, value_name = "HOST:PORT", value_parser = display::address, conflicts_with = "reference")]
    pub(crate) display_server: Option<String>,

    /// Settings as JSON, as --dump-settings prints them; flags and --set win over it
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,

    /// Set a flag by its long name; wins over --settings, flags win over it
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,

    /// Print all settings as JSON and render nothing
    #[arg(long)]
    pub(crate) dump_settings: bool,

    /// What that prints.
    #[arg(skip)]
    pub(crate) dumped: String,
}

impl MachineFlags {
    /// Prepares the log. It begins anew before the names of other files are known in full, and must be none of
    /// those that are named here.
    pub(crate) fn set_up(&self, scene: &Path, output: Option<&Path>) -> Result<()> {
        let is_json = self.log_format == LogFormat::Json;
        if is_json && self.progress == ProgressKind::Bar {
            let message = "--progress bar: --log-format json has lines alone";
            return Err(Error::Settings(message.into()));
        }
        if self.progress == ProgressKind::OpenJd && output == Some(Path::new("-")) {
            let message = "--progress openjd: standard output has the picture";
            return Err(Error::Settings(message.into()));
        }
        for (name, path) in [("the scene", Some(scene)), ("--output", output)] {
            if self.log_file.is_some() && self.log_file.as_deref() == path {
                let message = format!("--log-file and {name} are the same file");
                return Err(Error::Settings(message));
            }
        }
        let busy = match self.progress {
            ProgressKind::Auto | ProgressKind::Bar if !is_json => Busy::Spinner,
            ProgressKind::None => Busy::Nothing,
            _ => Busy::Lines,
        };
        log::set_up(self.log_format, self.log_file.as_deref(), busy)
    }
}
