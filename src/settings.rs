//! What to render and how: shared by the command line, tests and viewer.

mod content_hash;

use crate::film::{Film, SampleRange};
use crate::scene::Scene;
use crate::shader::generated::{MOST_BLOCK_SAMPLES, TILE_SIDE};
use crate::stopping::StoppingRule;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
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
    /// Only these of them, to be joined with others; all by default.
    pub part: Option<SampleRange>,
    /// Wall-clock time to stop at; whichever of this and `spp` comes first.
    pub time: Option<Duration>,
    /// Pixels may stop before `spp`, each by its own samples.
    pub stopping: Option<StoppingRule>,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Estimator of scattered light.
    pub strategy: Strategy,
    /// Light samples at each path vertex.
    pub light_samples: u32,
    /// How a light is chosen among many.
    pub light_selection: LightSelection,
    /// Lights that are drawn for one light sample where there are many; one of them is kept, by
    /// what it would give if nothing were in the way.
    pub light_candidates: u32,
    /// Scattering events allowed on a path; `None` is no limit.
    pub max_bounces: Option<u32>,
    /// Keep only the light that was scattered exactly so often.
    pub only_bounce: Option<u32>,
    /// End paths at random, without bias, once their throughput is low.
    pub roulette: bool,
    /// Neighbouring pixels share their paths from the second vertex on (Bekaert, Sbert and Halton
    /// 2002). Without bias, but the errors of the pixels of a block of 4 by 2 are alike then: not
    /// for [`Self::stopping`].
    pub path_reuse: bool,
    /// Source of random numbers.
    pub sampler: Sampler,
    /// Index into [`crate::scene::Scene::cameras`].
    pub camera: usize,
    /// Samples per block: the unit in which sums are folded into the film, a
    /// power of two. Part of the definition of the result's bits.
    pub block_size: u32,
    /// Acceleration structure.
    pub accel: Accel,
    /// Multiply GGX's reflection by what single scattering loses of it (Turquin 2019): brighter
    /// rough metals, not exact.
    pub energy_compensation: bool,
    /// Compile every feature whether or not the scene needs it.
    pub all_features: bool,
}

/// A rectangle of pixels; (0, 0) is the upper left corner of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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

impl Crop {
    /// Whether all of `inner` lies within.
    pub fn contains(&self, inner: &Self) -> bool {
        let end = |first: u32, length: u32| u64::from(first) + u64::from(length);
        inner.x >= self.x
            && inner.y >= self.y
            && end(inner.x, inner.width) <= end(self.x, self.width)
            && end(inner.y, inner.height) <= end(self.y, self.height)
    }

    /// Pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
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

/// How a light is chosen. All have the same mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightSelection {
    /// Every light alike, for comparison.
    Uniform,
    /// By power.
    Power,
    /// More than 4 that have a place: by what they may give to the receiver, with a tree; fewer,
    /// and those at infinity, by power.
    Tree,
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
            part: None,
            time: None,
            stopping: None,
            seed: 0,
            strategy: Strategy::Mis,
            light_samples: 1,
            light_selection: LightSelection::Tree,
            light_candidates: 2,
            max_bounces: None,
            only_bounce: None,
            roulette: true,
            path_reuse: false,
            sampler: Sampler::Sobol,
            camera: 0,
            block_size: 16,
            accel: Accel::Bvh,
            energy_compensation: false,
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

    /// The samples of [`Self::spp`] that are taken.
    pub fn samples(&self) -> SampleRange {
        self.part.unwrap_or(SampleRange::whole(self.spp))
    }

    /// An empty film for them.
    pub(crate) fn film(&self) -> Film {
        match self.stopping_rule() {
            Some(rule) => Film::new(self.window(), rule.unit()),
            None => Film::of_samples(self.window(), self.block_size, &self.samples()),
        }
    }

    /// Bytes of the host's memory that the film of a render takes.
    pub fn film_bytes(&self) -> u64 {
        let window = self.window();
        match self.stopping_rule() {
            Some(rule) => Film::bytes(window, rule.unit(), None, self.spp),
            None => Film::bytes(window, self.block_size, Some(&self.samples()), self.spp),
        }
    }

    /// Whether paths are shared: those of one bounce are not.
    pub fn shares_paths(&self) -> bool {
        self.path_reuse && self.max_bounces.is_none_or(|n| n > 1)
    }

    /// What is traced for the window: with [`Self::path_reuse`] whole tiles of the picture, so
    /// that the pixels at a crop's edge have all that they share with.
    pub fn traced_window(&self) -> Crop {
        let window = self.window();
        if !self.shares_paths() {
            return window;
        }
        let (x, y) = (window.x / TILE_SIDE * TILE_SIDE, window.y / TILE_SIDE * TILE_SIDE);
        let end = |last: u32, side: u32| last.next_multiple_of(TILE_SIDE).min(side);
        Crop {
            x,
            y,
            width: end(window.x + window.width, self.resolution.0) - x,
            height: end(window.y + window.height, self.resolution.1) - y,
        }
    }

    /// The rule by which pixels stop early; none where its tolerance is 0.
    pub fn stopping_rule(&self) -> Option<StoppingRule> {
        self.stopping.filter(|rule| rule.tolerance() > 0.0)
    }

    /// Samples of the film's smallest whole block: the rule's, where pixels stop early.
    pub fn samples_per_block(&self) -> u32 {
        self.stopping_rule().map_or(self.block_size, |rule| rule.unit())
    }

    /// Samples of the largest block: more where pixels stop early, and have many samples.
    pub fn largest_block(&self) -> u32 {
        self.stopping_rule().map_or(self.block_size, |rule| rule.largest_block())
    }

    /// Checks what cannot be rendered.
    ///
    /// # Errors
    /// [`Error::Settings`] naming the setting and what it may be.
    pub fn validate(&self, scene: &Scene) -> Result<()> {
        let (width, height) = self.resolution;
        let range = 1..=65_535;
        let window = self.window();
        let right = u64::from(window.x) + u64::from(window.width);
        let bottom = u64::from(window.y) + u64::from(window.height);
        let wrong = if !range.contains(&width) || !range.contains(&height) {
            format!("resolution {width}x{height}: each side must be 1 to 65535 pixels")
        } else if window.width == 0 || window.height == 0 {
            "crop: width and height must be at least 1".into()
        } else if right > u64::from(width) || bottom > u64::from(height) {
            format!("crop: reaches to {right},{bottom}, outside the picture of {width}x{height}")
        } else if self.spp == 0 {
            "spp must be at least 1".into()
        } else if !self.block_size.is_power_of_two() || self.block_size > MOST_BLOCK_SAMPLES {
            let most = MOST_BLOCK_SAMPLES;
            format!("block {}: must be a power of two up to {most}", self.block_size)
        } else if let Some(wrong) = self.stopping.as_ref().and_then(StoppingRule::fault) {
            wrong
        } else if self.path_reuse && self.stopping_rule().is_some() {
            "path reuse: pixels that stop one by one (--noise, --adaptive) must not share paths"
                .into()
        } else if self.part.is_some() && (self.stopping_rule().is_some() || self.time.is_some()) {
            "a part of the samples: pixels that stop one by one (--noise, --adaptive), and --time, \
             need all of them"
                .into()
        } else if self.part.is_some_and(|part| !part.fits(self.spp, self.block_size)) {
            format!("part {:?}: must lie in {} samples, in whole segments", self.part, self.spp)
        } else if self.light_samples == 0 {
            "light samples must be at least 1".into()
        } else if self.light_candidates == 0 {
            "light candidates must be at least 1".into()
        } else if self.camera >= scene.cameras.len() {
            let n = scene.cameras.len();
            format!("camera {}: the scene has {n}, counted from 0", self.camera)
        } else {
            return Ok(());
        };
        Err(Error::Settings(wrong))
    }
}
