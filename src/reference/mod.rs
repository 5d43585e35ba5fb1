//! The same light transport in plain f64 on the processor: what the renderer is held to.
//!
//! Written for clarity and from the definitions alone: it has nothing in common with the
//! shaders, the trees and the buffers of the renderer, so that a mistake is not made twice.
//! Each vertex takes a sample of the emitting shapes, one of the environment and all punctual
//! lights; what paths find by chance is weighed against that by the power heuristic. Nothing
//! is clamped, and no path ends by chance.
//!
//! ```text
//!  scene ─► geometry, tree ─► surface ─► shading ─► bsdf ─► path ─► film
//!         light, environment ─► shadow, media ─────────────┘
//! ```

mod bsdf;
mod camera;
mod environment;
mod geometry;
mod light;
mod media;
mod path;
mod random;
mod shading;
mod shadow;
mod surface;
mod texture;
mod tree;

#[cfg(test)]
mod tests;

pub use geometry::{Primitive, Ray};

use crate::Result;
use crate::film::{BlockMean, Film};
use crate::scene::Scene;
use crate::settings::RenderSettings;
use environment::Sky;
use geometry::{Geometry, Hit};
use glam::DVec3;
use light::Emitters;
use path::Path;
use random::Random;
use rayon::prelude::*;
use std::time::Instant;
use surface::Surface;

/// A scene ready to be sampled. Of the settings, those that choose among ways to the same mean
/// have no meaning here: strategy, sampler, light samples, roulette, acceleration structure.
#[derive(Debug)]
pub struct Reference<'a> {
    scene: &'a Scene,
    settings: RenderSettings,
    geometry: Geometry,
    emitters: Emitters,
    sky: Option<Sky<'a>>,
    /// Scattering events after which nothing more is wanted.
    bounce_limit: u32,
}

/// A nearest hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intersection {
    /// Distance from the ray's origin.
    pub t: f64,
    /// World position.
    pub position: DVec3,
    /// What was hit.
    pub primitive: Primitive,
    /// Unit geometric normal of the front.
    pub ng: DVec3,
    /// Unit shading normal of the front, before a normal map.
    pub ns: DVec3,
}

/// What was done, and what went wrong.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rays that looked for their nearest hit.
    pub closest_rays: u64,
    /// Rays that looked for what is between a point and a light.
    pub shadow_rays: u64,
    /// Samples whose path had 4096 scattering events and was cut off.
    pub cut_off: u64,
    /// Samples that were not finite, and count as black.
    pub non_finite: u64,
}

impl Tally {
    fn plus(self, other: Self) -> Self {
        Self {
            closest_rays: self.closest_rays + other.closest_rays,
            shadow_rays: self.shadow_rays + other.shadow_rays,
            cut_off: self.cut_off + other.cut_off,
            non_finite: self.non_finite + other.non_finite,
        }
    }
}

/// Renders `scene`. `keep_going` hears after every row of a block which share of the work is
/// done, 0 to 1, and ends the render by returning `false`; so does the time of the settings.
///
/// # Errors
/// [`Error::Settings`](crate::Error::Settings) if the settings do not fit the scene.
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    keep_going: impl FnMut(f64) -> bool,
) -> Result<(Film, Tally)> {
    Ok(Reference::new(scene, settings)?.render(keep_going))
}

impl<'a> Reference<'a> {
    /// Places the scene and builds what is needed to sample it.
    ///
    /// # Errors
    /// [`Error::Settings`](crate::Error::Settings) if the settings do not fit the scene.
    pub fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self> {
        Self::over(scene, settings, true)
    }

    /// As [`new`](Self::new), but every ray tests every primitive.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn brute_force(scene: &'a Scene, settings: &RenderSettings) -> Result<Self> {
        Self::over(scene, settings, false)
    }

    fn over(scene: &'a Scene, settings: &RenderSettings, with_tree: bool) -> Result<Self> {
        settings.validate(scene)?;
        let geometry = Geometry::new(scene, with_tree);
        let limits = [settings.max_bounces, settings.only_bounce];
        Ok(Self {
            scene,
            settings: settings.clone(),
            emitters: Emitters::new(scene, &geometry),
            sky: scene.environment.as_ref().map(Sky::new),
            geometry,
            bounce_limit: limits.into_iter().flatten().min().unwrap_or(u32::MAX),
        })
    }

    /// Radiance of one sample of the pixel in column `x` and row `y` of the whole picture.
    pub fn sample(&self, x: u32, y: u32, index: u32) -> DVec3 {
        self.trace(x, y, index).0
    }

    /// The nearest hit of a ray, whatever its alpha.
    pub fn intersect(&self, ray: &Ray) -> Option<Intersection> {
        let (hit, surface) = self.surface(ray, None)?;
        Some(Intersection {
            t: hit.t,
            position: surface.position,
            primitive: self.geometry.primitive(hit.primitive),
            ng: surface.front_ng,
            ns: surface.front_ns,
        })
    }

    /// Takes all samples; `keep_going` as for [`render`].
    pub fn render(&self, mut keep_going: impl FnMut(f64) -> bool) -> (Film, Tally) {
        let begin = Instant::now();
        let window = self.settings.window();
        let mut film = Film::new(window, self.settings.block_size);
        let mut tally = Tally::default();
        let mut first = 0;
        while first < self.settings.spp {
            let count = self.settings.block_size.min(self.settings.spp - first);
            for row in 0..window.height {
                let pixel = |x: u32| self.block(window.x + x, window.y + row, first, count);
                let blocks: Vec<_> = (0..window.width).into_par_iter().map(pixel).collect();
                for (x, (block, of_block)) in (0..).zip(blocks) {
                    film.add_block(x, row, block);
                    tally = tally.plus(of_block);
                }
                let in_block = f64::from(row + 1) / f64::from(window.height) * f64::from(count);
                let done = (f64::from(first) + in_block) / f64::from(self.settings.spp);
                let is_late = self.settings.time.is_some_and(|limit| begin.elapsed() >= limit);
                if !keep_going(done) || is_late {
                    return (film, tally);
                }
            }
            first += count;
        }
        (film, tally)
    }

    /// The mean of `count` samples of a pixel.
    fn block(&self, x: u32, y: u32, first: u32, count: u32) -> (BlockMean, Tally) {
        let (mut sum, mut tally) = (DVec3::ZERO, Tally::default());
        for index in first..first + count {
            let (radiance, of_sample) = self.trace(x, y, index);
            tally = tally.plus(of_sample);
            if radiance.is_finite() {
                sum += radiance;
            } else {
                tally.non_finite += 1;
            }
        }
        let mean = (sum / f64::from(count)).to_array();
        (BlockMean { mean, sample_count: count }, tally)
    }

    fn trace(&self, x: u32, y: u32, index: u32) -> (DVec3, Tally) {
        let mut random = Random::new(self.settings.seed, (x, y), index);
        let camera = &self.scene.cameras[self.settings.camera];
        let ray = camera::sample_ray(camera, self.settings.resolution, (x, y), &mut random);
        Path::new(self, random).trace(ray)
    }

    /// The nearest surface beyond the primitive `left` on which the ray begins, if it does.
    fn surface(&self, ray: &Ray, left: Option<usize>) -> Option<(Hit, Surface<'a>)> {
        let hit = self.geometry.nearest(ray, left)?;
        Some((hit, Surface::new(self.scene, &self.geometry, ray, &hit)))
    }
}
