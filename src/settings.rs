//! What to render and how: shared by the command line, tests and viewer.

use std::time::Duration;

/// Settings of one render. [`Default`] is what the command line does without flags.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// Width and height of the whole picture in pixels.
    pub resolution: (u32, u32),
    /// Part of the picture to render.
    pub crop: Option<Crop>,
    /// Samples per pixel to stop at.
    pub spp: u32,
    /// Wall-clock time to stop at; whichever of this and `spp` comes first.
    pub time: Option<Duration>,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Estimator of scattered light.
    pub strategy: Strategy,
    /// Light samples at each path vertex.
    pub light_samples: u32,
    /// Scattering events allowed on a path; `None` is no limit.
    pub max_bounces: Option<u32>,
    /// Keep only the light that was scattered exactly so often.
    pub only_bounce: Option<u32>,
    /// End paths at random, without bias, once their throughput is low.
    pub roulette: bool,
    /// Source of random numbers.
    pub sampler: Sampler,
    /// Index into [`crate::scene::Scene::cameras`].
    pub camera: usize,
    /// Samples per block: the unit in which sums are folded into the film, a
    /// power of two. Part of the definition of the result's bits.
    pub block_size: u32,
    /// Acceleration structure.
    pub accel: Accel,
    /// Compile every feature whether or not the scene needs it.
    pub all_features: bool,
}

/// A rectangle of pixels; (0, 0) is the upper left corner of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

/// Estimators of the scattered light. All have the same mean wherever all apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Directions uniform over the hemisphere; lights are found by chance.
    Hemisphere,
    /// Directions by the BSDF; lights are found by chance.
    Bsdf,
    /// Next event estimation alone; directions by the BSDF carry indirect light only.
    Light,
    /// Both, weighted by the power heuristic (Veach 1997).
    Mis,
}

/// Random number generators; each a pure function of (seed, pixel, sample, dimension).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampler {
    /// Owen-scrambled Sobol points (Burley 2020).
    Sobol,
    /// pcg4d hash (Jarzynski and Olano 2020).
    Independent,
}

/// Acceleration structures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accel {
    /// Binned surface area heuristic.
    Bvh,
    /// Longest axis, split at the median, for comparison.
    Median,
    /// Every ray tests every primitive, for comparison.
    None,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            resolution: (512, 512),
            crop: None,
            spp: 64,
            time: None,
            seed: 0,
            strategy: Strategy::Mis,
            light_samples: 1,
            max_bounces: None,
            only_bounce: None,
            roulette: true,
            sampler: Sampler::Sobol,
            camera: 0,
            block_size: 16,
            accel: Accel::Bvh,
            all_features: false,
        }
    }
}

impl RenderSettings {
    /// The rendered rectangle: the crop, or the whole picture.
    pub fn window(&self) -> Crop {
        let (width, height) = self.resolution;
        self.crop.unwrap_or(Crop { x: 0, y: 0, width, height })
    }
}
