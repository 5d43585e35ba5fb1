//! What the person at the window wants to see: changed by the window, followed by the engine.

use crate::cli::flags::EnvironmentFlags;
use glam::Vec3;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use steradian::RenderSettings;
use steradian::bvh::Bvh;
use steradian::image::{DisplayTransform, ToneCurve};
use steradian::scene::Camera;
use steradian::settings::Crop;
use steradian::view::View;

/// All of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wish {
    /// The scene that it is about; see [`SceneInfo::generation`].
    pub(super) generation: u64,
    /// Camera of the file that [`Wish::camera`] began as.
    pub(super) base: usize,
    /// Where it is now.
    pub(super) camera: Camera,
    /// Everything else that decides the picture; its camera is not used.
    pub(super) settings: RenderSettings,
    /// In place of, or on top of, the scene's environment.
    pub(super) environment: EnvironmentFlags,
    /// How the picture is shown. Changes nothing of what is accumulated.
    pub(super) display: DisplayTransform,
    /// What is shown in place of light. Changes nothing of what is accumulated.
    pub(super) view: Option<View>,
    /// Nothing is traced.
    pub(super) is_paused: bool,
}

/// What the window needs to know of a scene.
#[derive(Debug)]
pub(super) struct SceneInfo {
    /// Counts the scenes that were loaded.
    pub(super) generation: u64,
    /// The same scene as the one before, read again: the view stays.
    pub(super) is_again: bool,
    /// Where it was read from.
    pub(super) path: PathBuf,
    /// The file's stem.
    pub(super) name: String,
    /// The file's cameras, with the lens of the command line.
    pub(super) cameras: Vec<Camera>,
    /// World-space bounds (min, max).
    pub(super) bounds: (Vec3, Vec3),
    /// What the command line asks for.
    pub(super) settings: RenderSettings,
    /// What the command line asks for.
    pub(super) environment: EnvironmentFlags,
    /// Whether the scene, or the command line, has an environment.
    pub(super) has_environment: bool,
    /// Whether the command line gives the picture's size; else it is that of the window.
    pub(super) has_fixed_size: bool,
    /// What the command line asks for.
    pub(super) exposure_ev: Option<f32>,
    /// What the command line asks for.
    pub(super) tone_curve: Option<ToneCurve>,
    /// What the command line asks for.
    pub(super) view: Option<View>,
    /// Cameras of the file; a further one is the command line's.
    pub(super) own_camera_count: usize,
    /// Whether the command line changes a camera's lens.
    pub(super) has_lens_flags: bool,
    /// The flags of animations, as they were given.
    pub(super) animation: [Option<String>; 2],
    /// Triangles after instancing, and spheres.
    pub(super) primitive_count: usize,
    /// Reading, and building trees, seconds.
    pub(super) seconds: (f64, f64),
    /// What of the file is not rendered as it says.
    pub(super) notices: Vec<String>,
}

/// A thing to do once.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Request {
    /// Another scene, or the same again.
    Open(PathBuf),
    /// The scene's file again; the view stays.
    Reload,
    /// The picture into a file, as `steradian render` writes it.
    Save(PathBuf),
    /// All samples again.
    Restart,
    /// One piece of work, then pause.
    Step,
    /// What is seen at a pixel of the whole picture, column and row.
    Pick((u32, u32)),
    /// The tree, to look at.
    Tree,
    /// Tests only: the device goes.
    #[cfg(test)]
    LoseDevice,
}

/// What is going on.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Phase {
    /// No scene.
    #[default]
    Empty,
    /// Samples are being taken.
    Rendering,
    /// By the person.
    Paused,
    /// The target is reached.
    Done,
    /// The device cannot go on; Restart tries again.
    Failed,
}

/// Where a render stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Progress {
    /// Samples of the pixels that have fewest and most.
    pub(super) spp: (u32, u32),
    /// Tracing.
    pub(super) seconds: f64,
    /// Camera paths.
    pub(super) samples: u64,
    /// Of both kinds.
    pub(super) rays: u64,
    /// Share of the pixels that need no more samples, where they stop one by one.
    pub(super) converged: Option<f64>,
    /// Estimated error of the picture, once there is one.
    pub(super) relmse: Option<f64>,
    /// Samples that cannot be right.
    pub(super) faults: u64,
}

/// A picture for the display.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// sRGB and alpha, row by row from the top.
    pub(super) rgba: Arc<Vec<[u8; 4]>>,
    /// Counts the pictures.
    pub(super) serial: u64,
    /// The camera that it was made with.
    pub(super) camera: Camera,
    /// The newest wish that it fulfils, by [`super::link::Link::send`].
    pub(super) wish: u64,
    /// Pixels of the picture that one of this frame stands for: above 1 while the camera moves.
    pub(super) scale: u32,
    /// The part of the picture that it shows, pixels of the whole resolution.
    pub(super) window: Crop,
    /// Of the whole picture.
    pub(super) resolution: (u32, u32),
    /// Whether every pixel has a sample of its own.
    pub(super) is_whole: bool,
    /// Whether a kernel had to be compiled for it.
    pub(super) has_compiled: bool,
}

/// A line for the person.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Message {
    /// The line.
    pub(super) text: String,
    /// Whether something went wrong.
    pub(super) is_error: bool,
    /// Counts the messages.
    pub(super) serial: u64,
}

/// What the engine tells the window.
#[derive(Debug, Clone, Default)]
pub(super) struct Report {
    /// What is going on.
    pub(super) phase: Phase,
    /// What a person waits for, if anything, such as "reading the scene", and since when.
    pub(super) busy: Option<(&'static str, Instant)>,
    /// The newest picture.
    pub(super) frame: Option<Frame>,
    /// What the colours mean, where they are not those of light.
    pub(super) legend: Option<String>,
    /// The scene that is shown.
    pub(super) scene: Option<Arc<SceneInfo>>,
    /// Where the render stands.
    pub(super) progress: Progress,
    /// The newest message.
    pub(super) message: Option<Message>,
    /// Name of the device.
    pub(super) device: String,
    /// Its driver's name and version.
    pub(super) driver: String,
    /// Whether it is software on the processor.
    pub(super) is_software: bool,
    /// The number of a wish that cannot be, and the one that is followed instead.
    pub(super) refused: Option<(u64, Option<Arc<Wish>>)>,
    /// The tree of the scene, once it was asked for.
    pub(super) tree: Option<Arc<Bvh>>,
    /// The newest answer to [`Request::Pick`].
    pub(super) picked: Option<Picked>,
}

/// What was seen at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Picked {
    /// Counts the answers.
    pub(super) serial: u64,
    /// Where the ray began, and where it met a surface.
    pub(super) ray: (Vec3, Vec3),
}
