//! The command line: raw flags become checked settings once, the library does
//! the work. What was asked for goes to standard output, all else to standard error.

mod batch;
mod bench;
mod checkpoint;
mod compare;
mod compare_flags;
pub(crate) mod destination;
mod device_render;
mod devices;
mod display;
mod drill;
mod existing;
mod exr_file;
mod film_output;
pub(crate) mod flags;
mod frames;
mod identity;
mod info;
pub(crate) mod job;
pub(crate) mod layer_flags;
mod log;
mod machine_flags;
mod memory;
mod merge;
mod names;
pub(crate) mod output;
mod pages;
mod picture_layers;
mod progress;
mod reference;
mod render;
pub(crate) mod report;
mod rescue;
pub(crate) mod scene_flags;
mod session;
mod settings_file;
mod shard;
pub(crate) mod signals;
mod stats;
pub(crate) mod stopping;
pub(crate) mod talk;
pub(crate) mod values;
pub(crate) mod view;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;
use steradian::Result;

const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 failed, 2 bad command line, 3 scene unusable, 4 no usable device, \
75 the same command may succeed later (stopped with a checkpoint, device \
lost or full, memory taken by others), 130 or 143 stopped by a signal after the partial picture was written.";

/// A physically based path tracer for glTF 2.0, on GPUs and on software Vulkan.
#[derive(Debug, Parser)]
#[command(name = "steradian", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a picture of a scene
    Render(Box<flags::RenderFlags>),
    /// Look at a scene in a window while the picture gets better
    #[cfg(feature = "viewer")]
    View(Box<flags::ViewFlags>),
    /// Measure how fast and how well scenes are rendered
    Bench(Box<bench::BenchFlags>),
    /// Say what is in a scene, and what of it is honoured, approximated or ignored
    Info(flags::InfoFlags),
    /// Say how far pictures are from each other, and whether that is too far
    Compare(Box<compare_flags::CompareFlags>),
    /// Join the parts of a render (--shard) to the picture of the whole
    Merge(Box<merge::MergeFlags>),
    /// List the devices that can render
    Devices,
    /// Print the completions of a shell
    Completions(pages::CompletionFlags),
    /// Write the manual pages into a folder
    Man(pages::ManFlags),
}

/// The arguments of this process. Ends it where they are wrong, and after `--help`.
pub(crate) fn parse() -> Result<Arguments> {
    let words = settings_file::expand(std::env::args_os().collect())?;
    let matches = Arguments::command().get_matches_from(words);
    let mut arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|e| e.exit());
    if let Command::Render(flags) = &mut arguments.command
        && let Some(render) = matches.subcommand_matches("render")
    {
        flags.machine.dumped = settings_file::dump(render);
    }
    Ok(arguments)
}

/// Does what the arguments ask for.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    match &arguments.command {
        Command::Render(flags) => render::run(flags),
        #[cfg(feature = "viewer")]
        Command::View(flags) => crate::viewer::run(flags),
        Command::Bench(flags) => bench::run(flags),
        Command::Info(flags) => info::run(flags),
        Command::Compare(flags) => compare::run(flags),
        Command::Merge(flags) => merge::run(flags),
        Command::Devices => devices::run(),
        Command::Completions(flags) => pages::complete(flags),
        Command::Man(flags) => pages::man(flags),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flags_do_not_contradict_each_other() {
        Arguments::command().debug_assert();
    }
}
