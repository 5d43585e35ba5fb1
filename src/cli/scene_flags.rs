//! Flags about how a scene file is read.

use clap::Args;
use std::path::PathBuf;
use steradian::scene::gltf::LoadOptions;

/// How the scene file is read: the same for every command that reads one.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Scene")]
pub(crate) struct SceneFlags {
    /// Refuse a scene with anything that is approximated or ignored
    #[arg(long)]
    pub(crate) strict: bool,
    /// A folder besides the scene's own whose files it may refer to; may be given several times
    #[arg(long, value_name = "DIR")]
    pub(crate) allow_external: Vec<PathBuf>,

    /// Show animations at this time, seconds, instead of the rest pose
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub(crate) frame_time: Option<f64>,

    /// Which of the scene's animations: its name, its number, or `all`
    #[arg(long, value_name = "NAME|INDEX", requires = "frame_time")]
    pub(crate) animation: Option<String>,
}

impl SceneFlags {
    /// What the loader is told.
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions {
            strict: self.strict,
            allow_external: self.allow_external.clone(),
            frame_time: self.frame_time,
            animation: self.animation.clone(),
        }
    }
}
