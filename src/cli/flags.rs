//! The flags as they are spelt. [`super::job`] gives them their meaning.

use super::checkpoint::FarmFlags;
use super::destination::PngFlags;
use super::frames::FrameFlags;
use super::layer_flags::LayerFlags;
use super::machine_flags::MachineFlags;
use super::scene_flags::SceneFlags;
use super::stopping::{MAP_COLORS, StoppingFlags};
use super::talk::Verbosity;
use super::values;
use clap::Args;
use glam::Vec3;
use std::path::PathBuf;
use steradian::image::MapColors;
use steradian::settings::{Accel, Crop, LightSelection, Sampler, Strategy};
use steradian::view::View;

/// Flags of `render`.
#[derive(Debug, Args)]
#[command(override_usage = "steradian render [OPTIONS] <SCENE> --output <FILE>\n       \
    steradian render [OPTIONS] <SCENE> --pixel <x,y>")]
pub(crate) struct RenderFlags {
    /// The scene: a .gltf or .glb file
    pub(crate) scene: PathBuf,

    /// The picture: .png (what a display shows) or .exr (linear radiance, 32-bit floats); - is
    /// standard output
    #[arg(short, long, value_name = "FILE", required_unless_present_any = ["pixel", "dump_settings"])]
    pub(crate) output: Option<PathBuf>,

    /// Statistics of the render as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,

    /// Name or index of the device (see `steradian devices`)
    #[arg(long, value_name = "NAME|INDEX", env = "STERADIAN_DEVICE")]
    pub(crate) device: Option<String>,

    /// Processor threads that load images and build trees; all by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Say how it was done: device, features, trees, times
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,

    /// Say nothing but errors and warnings
    #[arg(short, long)]
    quiet: bool,

    /// A picture of the samples taken, .png
    #[arg(long, value_name = "FILE")]
    pub(crate) sample_map: Option<PathBuf>,

    /// Its colours
    #[arg(long, requires = "sample_map", value_parser = values::one_of(MAP_COLORS), default_value = "viridis")]
    pub(crate) sample_map_colors: MapColors,

    #[command(flatten)]
    pub(crate) layers: LayerFlags,

    #[command(flatten)]
    pub(crate) frames: FrameFlags,

    #[command(flatten)]
    pub(crate) machine: MachineFlags,

    #[command(flatten)]
    pub(crate) job: JobFlags,

    #[command(flatten)]
    pub(crate) farm: FarmFlags,
}

/// Flags of `view`.
#[cfg(feature = "viewer")]
#[derive(Debug, Args)]
pub(crate) struct ViewFlags {
    /// The scene: a .gltf or .glb file; another can be dropped on the window at any time
    pub(crate) scene: Option<PathBuf>,

    /// Where the key S saves the picture, .png or .exr; by default a new file named as the scene
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// How long answers took, as JSON at the end
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,

    /// Name or index of the device that renders (see `steradian devices`)
    #[arg(long, value_name = "NAME|INDEX", env = "STERADIAN_DEVICE")]
    pub(crate) device: Option<String>,

    /// Read the shaders from this folder, and again whenever one changes
    #[arg(long, value_name = "FOLDER")]
    pub(crate) shaders: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) job: JobFlags,
}

/// What to render, and how: the same for every command that does.
#[derive(Debug, Clone, Args)]
pub(crate) struct JobFlags {
    #[command(flatten)]
    pub(crate) scene: SceneFlags,

    #[command(flatten)]
    pub(crate) picture: PictureFlags,

    #[command(flatten)]
    pub(crate) stopping: StoppingFlags,

    #[command(flatten)]
    pub(crate) sampling: SamplingFlags,

    #[command(flatten)]
    pub(crate) camera: CameraFlags,

    #[command(flatten)]
    pub(crate) environment: EnvironmentFlags,
}

/// Size and form of the picture.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct PictureFlags {
    /// Size in pixels; 512 rows in the camera's aspect ratio by default
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    pub(crate) resolution: Option<(u32, u32)>,

    /// Multiplies width and height
    #[arg(long, value_name = "F", value_parser = values::positive)]
    pub(crate) scale: Option<f32>,

    /// Render only this rectangle, in pixels from the upper left corner
    #[arg(long, value_name = "x,y,w,h", value_parser = values::crop, conflicts_with = "pixel")]
    pub(crate) crop: Option<Crop>,

    /// Render one pixel; print its radiance, sample count and standard error
    #[arg(long, value_name = "x,y", value_parser = values::pixel)]
    pub(crate) pixel: Option<Crop>,

    /// Show this instead of light, in false colours (PNG) or as numbers (EXR)
    #[arg(long, value_parser = values::one_of(values::VIEWS), conflicts_with_all = [
        "pixel", "exposure", "tone_map",
    ])]
    pub(crate) view: Option<View>,

    #[command(flatten)]
    pub(crate) png: PngFlags,
}

impl PictureFlags {
    /// The part of the picture that is rendered.
    pub(crate) fn region(&self) -> Option<Crop> {
        self.crop.or(self.pixel)
    }
}

/// How light is sampled.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Sampling")]
pub(crate) struct SamplingFlags {
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u32,

    /// Estimator of scattered light
    #[arg(long, value_parser = values::one_of(values::STRATEGIES), default_value = "mis")]
    pub(crate) strategy: Strategy,

    /// Light samples at each path vertex
    #[arg(long, value_name = "L", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) light_samples: u32,

    /// How a light is chosen for a sample
    #[arg(long, value_parser = values::one_of(values::LIGHT_SELECTIONS), default_value = "tree")]
    pub(crate) light_selection: LightSelection,

    /// Lights drawn for a sample where there are more than 4, of which one is kept
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) light_candidates: u32,

    /// Scattering events on a path: 0 emission alone, 1 direct light; no limit by default
    #[arg(long, value_name = "N")]
    pub(crate) max_bounces: Option<u32>,

    /// Keep only light that was scattered exactly so often
    #[arg(long, value_name = "K")]
    pub(crate) only_bounce: Option<u32>,

    /// Do not end dim paths at random
    #[arg(long)]
    pub(crate) no_roulette: bool,

    /// Let the pixels of blocks of 4 by 2 share their paths from the second vertex on: less noise
    /// for the same time where light arrives in several steps, but alike within a block
    #[arg(long)]
    pub(crate) path_reuse: bool,

    /// Trace in plain f64 on the processor, without a device: slow, and what the renderer is held to
    #[arg(long, conflicts_with_all = [
        "strategy", "light_samples", "light_selection", "light_candidates", "no_roulette", "path_reuse",
        "sampler", "accel", "features",
    ])]
    pub(crate) reference: bool,

    /// Source of random numbers
    #[arg(long, value_parser = values::one_of(values::SAMPLERS), default_value = "sobol")]
    pub(crate) sampler: Sampler,

    /// Samples in a block, a power of two: part of what defines the picture's bits.
    /// By default at most a quarter of the samples, and at most 16
    #[arg(long, value_name = "N", value_parser = values::block_size)]
    pub(crate) block: Option<u32>,

    /// Acceleration structure
    #[arg(long, value_parser = values::one_of(values::ACCELS), default_value = "bvh")]
    pub(crate) accel: Accel,

    /// Brighten rough metals by what GGX loses where light scatters once only; not exact
    #[arg(long)]
    pub(crate) energy_compensation: bool,

    /// Compile what the scene needs (default), or everything
    #[arg(long, value_name = "needed|all", value_parser = ["needed", "all"])]
    pub(crate) features: Option<String>,
}

/// The camera.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraFlags {
    /// Name or index of the camera, or a file of one, as `info --dump-camera` prints it; the
    /// first by default
    #[arg(long, value_name = "NAME|INDEX|FILE")]
    pub(crate) camera: Option<String>,

    /// Radius of the lens in metres; 0 is a pinhole
    #[arg(long, value_name = "RADIUS", value_parser = values::not_negative)]
    pub(crate) aperture: Option<f32>,

    /// Distance of the plane in focus in metres
    #[arg(long, value_name = "DISTANCE", value_parser = values::positive)]
    pub(crate) focus: Option<f32>,
}

/// Light from infinity.
#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Environment")]
pub(crate) struct EnvironmentFlags {
    /// Equirectangular map, .hdr or .exr, in place of the scene's environment
    #[arg(long, value_name = "FILE", conflicts_with = "environment_radiance")]
    pub(crate) environment: Option<PathBuf>,

    /// The same radiance from everywhere, in place of the scene's environment
    #[arg(long, value_name = "R[,G,B]", value_parser = values::radiance)]
    pub(crate) environment_radiance: Option<Vec3>,

    /// Turn of the environment about +Y in degrees, counter-clockwise seen from above
    #[arg(long, value_name = "DEG", value_parser = values::finite, allow_negative_numbers = true)]
    pub(crate) environment_rotation: Option<f32>,

    /// Multiplies the environment's radiance
    #[arg(long, value_name = "F", value_parser = values::not_negative)]
    pub(crate) environment_intensity: Option<f32>,

    /// Average the environment down to at most so many texels across
    #[arg(long, value_name = "WIDTH", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) max_environment_size: Option<u32>,
}

#[cfg(feature = "viewer")]
impl EnvironmentFlags {
    /// The same map, as bright, not turned.
    pub(crate) fn without_rotation(&self) -> Self {
        Self { environment_rotation: None, ..self.clone() }
    }
}

/// Flags of `info`.
#[derive(Debug, Args)]
pub(crate) struct InfoFlags {
    /// The scene: a .gltf or .glb file
    pub(crate) scene: PathBuf,

    /// Print this camera alone, as JSON that `render --camera FILE` takes
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) dump_camera: Option<String>,

    /// Name or index of the device whose limits are compared with; all by default
    #[arg(long, value_name = "NAME|INDEX", env = "STERADIAN_DEVICE")]
    pub(crate) device: Option<String>,

    #[command(flatten)]
    pub(crate) reading: SceneFlags,
}

impl RenderFlags {
    /// How much is said.
    pub(crate) fn verbosity(&self) -> Verbosity {
        match (self.quiet, self.verbose) {
            (true, _) => Verbosity::Quiet,
            (false, false) => Verbosity::Normal,
            (false, true) => Verbosity::Verbose,
        }
    }
}
