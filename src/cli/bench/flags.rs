//! Flags of `bench`.

use super::coverage::{RULES, Rule};
use crate::cli::destination::PngFlags;
use crate::cli::flags::{CameraFlags, EnvironmentFlags, JobFlags, PictureFlags, SamplingFlags};
use crate::cli::scene_flags::SceneFlags;
use crate::cli::stopping::{CONFIDENCE, PRESETS, StoppingFlags};
use crate::cli::values::{self, Parsed};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;
use steradian::settings::Crop;
use steradian::stopping::{CalibratedRule, Preset};
use steradian::{Error, Result};

/// What a cost is scaled with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Scale {
    /// Triangles of a knot in a room
    Triangles,
    /// Emissive triangles below a ceiling
    Lights,
    /// Pixels of the picture
    Pixels,
    /// Scattering events on a path
    Bounces,
    /// Threads of Mesa's software device
    Threads,
}

/// Renderers to measure beside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Rival {
    /// Mitsuba 3, variant llvm_ad_rgb; needs Python with the package mitsuba
    Mitsuba,
}

/// Flags of `bench`.
#[derive(Debug, Args)]
#[command(override_usage = "steradian bench [OPTIONS] <SCENE>...\n       \
    steradian bench [OPTIONS] --scale <WHAT>\n       \
    steradian bench [OPTIONS] --coverage --noise <TOL> <SCENE>")]
pub(crate) struct BenchFlags {
    /// The scenes: .gltf or .glb files
    #[arg(value_name = "SCENE", required_unless_present = "scale")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Samples per pixel of the points of a curve; 4,16,64,256 by default
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) spp: Vec<u32>,

    /// Independent runs of each point, with seeds of their own; 16 by default, 64 with --coverage
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub(crate) runs: Option<u32>,

    /// No more runs of a scene after this time, such as 90s or 2m, once there are four
    #[arg(long, value_name = "TIME", value_parser = values::duration, conflicts_with = "coverage")]
    pub(crate) scene_time: Option<Duration>,

    /// Errors to which the seconds are told
    #[arg(long, value_name = "E,...", value_delimiter = ',', default_value = "1e-2,1e-3", value_parser = positive)]
    pub(crate) targets: Vec<f64>,

    /// Seconds after which the errors are told
    #[arg(long, value_name = "S,...", value_delimiter = ',', default_value = "1,4", value_parser = positive)]
    pub(crate) times: Vec<f64>,

    /// The picture that errors are measured against, .exr; by default one is rendered
    #[arg(long, value_name = "FILE", conflicts_with = "coverage")]
    pub(crate) reference_file: Option<PathBuf>,

    /// Samples per pixel of that; 8 times the most of --spp by default
    #[arg(long, value_name = "N", conflicts_with_all = ["reference_file", "coverage"], value_parser = clap::value_parser!(u32).range(16..))]
    pub(crate) reference_spp: Option<u32>,

    /// Measure another renderer in the same run, by turns
    #[arg(long, value_enum, conflicts_with = "coverage")]
    pub(crate) against: Option<Rival>,

    /// The sampler of Mitsuba
    #[arg(long, value_name = "NAME", requires = "against", default_value = "multijitter", value_parser = ["multijitter", "independent", "stratified", "orthogonal", "ldsampler"])]
    pub(crate) mitsuba_sampler: String,

    /// The Python that has Mitsuba
    #[arg(long, value_name = "PROGRAM", default_value = "python3", env = "STERADIAN_PYTHON")]
    pub(crate) python: String,

    /// Also with each of light sampling, MIS, roulette, the sampler and specialisation switched
    /// off, and with adaptive sampling on; on the first N scenes, all by default
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "1000000", conflicts_with = "coverage")]
    pub(crate) ablation: Option<usize>,

    /// Also what specialising the kernel saves: text, SPIR-V, bindings, compile time, time per
    /// sample; on the first N scenes, all by default
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "1000000", conflicts_with = "coverage")]
    pub(crate) specialise: Option<usize>,

    /// Also the time to the first pixel, with and without the driver's shader cache
    #[arg(long, conflicts_with = "coverage")]
    pub(crate) startup: bool,

    /// Also how costs grow with these
    #[arg(
        long,
        value_enum,
        value_name = "WHAT,...",
        value_delimiter = ',',
        conflicts_with = "coverage"
    )]
    pub(crate) scale: Vec<Scale>,

    /// The most triangles of --scale triangles
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1000..=20_000_000))]
    pub(crate) most_triangles: u32,

    /// The most lights of --scale lights
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(10..=1_000_000))]
    pub(crate) most_lights: u32,

    /// Seconds that compiling the kernel of every feature may take
    #[arg(long, value_name = "S", default_value = "120", value_parser = positive)]
    pub(crate) compile_limit: f64,

    /// How well the rules by which pixels stop keep their word, instead of all that: many runs of each
    /// against a truth that is known to a tenth of the tolerance
    #[arg(long, requires = "noise", conflicts_with = "seed")]
    pub(crate) coverage: bool,

    /// The tolerance of --coverage, such as 0.05
    #[arg(long, value_name = "TOL", requires = "coverage", value_parser = values::share, conflicts_with_all = ["reference", "block"])]
    noise: Option<f32>,

    /// Confidence of its interval
    #[arg(long, value_name = "P", requires = "noise", default_value_t = CONFIDENCE, value_parser = values::confidence)]
    confidence: f64,

    /// How much evidence a pixel needs
    #[arg(long, requires = "noise", default_value = "default", value_parser = values::one_of(PRESETS))]
    preset: Preset,

    /// Rules of --coverage
    #[arg(long, value_name = "RULE,...", value_delimiter = ',', default_value = "seed,default,strict", value_parser = values::one_of(RULES))]
    pub(super) rules: Vec<Rule>,

    /// Samples of a pixel that the truth of --coverage may take; 4096 at least
    #[arg(long, value_name = "N", default_value_t = 262_144, value_parser = clap::value_parser!(u32).range(4096..))]
    pub(crate) truth_spp: u32,

    /// The figures as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,

    /// Everything as one page with plots
    #[arg(long, value_name = "FILE", conflicts_with = "coverage")]
    pub(crate) report: Option<PathBuf>,

    /// Everything as Markdown, with the plots in a folder of the same name beside it
    #[arg(long, value_name = "FILE.md", conflicts_with = "coverage")]
    pub(crate) markdown: Option<PathBuf>,

    /// Name or index of the device (see `steradian devices`)
    #[arg(long, value_name = "NAME|INDEX", env = "STERADIAN_DEVICE")]
    pub(crate) device: Option<String>,

    #[command(flatten)]
    pub(crate) scene: SceneFlags,

    /// Size in pixels; 256 rows in the camera's aspect ratio by default, 512 with --coverage
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    pub(crate) resolution: Option<(u32, u32)>,

    /// Render only this rectangle, in pixels from the upper left corner
    #[arg(long, value_name = "x,y,w,h", value_parser = values::crop)]
    pub(crate) crop: Option<Crop>,

    #[command(flatten)]
    pub(crate) sampling: SamplingFlags,

    #[command(flatten)]
    pub(crate) camera: CameraFlags,

    #[command(flatten)]
    pub(crate) environment: EnvironmentFlags,
}

/// A finite number more than 0.
fn positive(text: &str) -> Parsed<f64> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a finite number more than 0".into()),
    }
}

impl BenchFlags {
    fn picture(&self, scale: Option<f32>) -> PictureFlags {
        PictureFlags {
            resolution: self.resolution,
            scale: scale.filter(|_| self.resolution.is_none()),
            crop: self.crop,
            pixel: None,
            png: PngFlags::default(),
            view: None,
        }
    }

    /// What a curve renders, with the most samples.
    pub(super) fn job(&self, spp: u32) -> JobFlags {
        // 256 rows: time for many runs.
        let picture = self.picture(Some(0.5));
        JobFlags {
            scene: self.scene.clone(),
            picture,
            stopping: StoppingFlags::of_spp(Some(spp)),
            sampling: self.sampling.clone(),
            camera: self.camera.clone(),
            environment: self.environment.clone(),
        }
    }

    /// Whether nothing but the file says what is seen.
    pub(super) fn sees_the_file(&self) -> bool {
        let (scene, camera) = (&self.scene, &self.camera);
        self.crop.is_none()
            && self.sampling.only_bounce.is_none()
            && self.environment == EnvironmentFlags::default()
            && camera.camera.is_none()
            && camera.aperture.is_none()
            && camera.focus.is_none()
            && scene.frame_time.is_none()
            && scene.variant.is_none()
    }

    /// What `--coverage` renders.
    pub(super) fn coverage_job(&self) -> Result<JobFlags> {
        let spp = match self.spp[..] {
            [] => None,
            [spp] => Some(spp),
            _ => {
                return Err(Error::Settings(
                    "--coverage: one number of samples, not a list".into(),
                ));
            }
        };
        let tolerance = self.noise.unwrap_or(0.0);
        let rule = CalibratedRule { tolerance, confidence: self.confidence, preset: self.preset };
        Ok(JobFlags {
            picture: self.picture(None),
            stopping: StoppingFlags::of_noise(spp, &rule),
            ..self.job(1)
        })
    }

    /// Samples of the points of a curve, in order and once each.
    pub(super) fn points(&self) -> Vec<u32> {
        let mut points = match self.spp[..] {
            [] => vec![4, 16, 64, 256],
            _ => self.spp.clone(),
        };
        points.sort_unstable();
        points.dedup();
        points
    }
}
