//! What a render shows while it is under way: the film, and with it the samples of the block that
//! is not folded yet. Nothing of it changes what the render ends with.

use super::statistics::fault_counts;
use super::{Plan, RenderStatistics, Renderer};
use crate::Result;
use crate::film::{BlockMean, Film};
use crate::gpu::GpuFilmPixel;
use crate::image::Picture;
use crate::shader::generated::TILE_PIXELS;

/// A picture of all samples so far.
#[derive(Debug, Clone)]
pub struct Preview {
    /// Means; black where there is no sample.
    pub picture: Picture,
    /// Samples of every pixel, row by row.
    pub sample_counts: Vec<u32>,
    /// Counts and times so far.
    pub statistics: RenderStatistics,
}

impl Renderer {
    /// The picture as it stands.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn preview(&self) -> Result<Preview> {
        let pending = self.pending()?;
        let mut statistics = self.statistics.clone();
        let window = self.film.window();
        for (pixel, block) in &pending {
            if let Some((x, y)) = self.place(*pixel) {
                statistics.add_block((window.x + x, window.y + y), block);
            }
        }
        let means = pending
            .iter()
            .filter_map(|(pixel, block)| Some((self.place(*pixel)?, BlockMean::of(block))));
        let (picture, sample_counts) = self.film.picture_with(means);
        Ok(Preview { picture, sample_counts, statistics })
    }

    /// What [`Renderer::finish`] would leave: the film, and what was counted.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn snapshot(&self) -> Result<(Film, RenderStatistics)> {
        let (mut film, mut statistics) = (self.film.clone(), self.statistics.clone());
        let window = film.window();
        for (pixel, block) in self.pending()? {
            let Some((x, y)) = self.place(pixel) else { continue };
            film.add_block(x, y, BlockMean::of(&block));
            film.add_faults(x, y, fault_counts(&block));
            statistics.add_block((window.x + x, window.y + y), &block);
        }
        if let Plan::Adaptive(rounds) = &self.plan {
            film.set_stops(rounds.stops(&self.prepared.device, window)?);
        }
        Ok((film, statistics))
    }

    /// Share of the pixels that need no more samples, 0 to 1; `None` where all take as many.
    pub fn converged(&self) -> Option<f64> {
        match &self.plan {
            Plan::Fixed(_) => None,
            Plan::Adaptive(rounds) => Some(rounds.done_share()),
        }
    }

    /// Whether all samples are taken.
    pub fn is_done(&self) -> bool {
        self.sweep().is_done()
    }

    /// The blocks under way, by their pixels in the order of tiles.
    fn pending(&self) -> Result<Vec<(u32, GpuFilmPixel)>> {
        if self.sweep().is_new() || self.sweep().is_done() {
            return Ok(Vec::new());
        }
        let device = &self.prepared.device;
        Ok(match &self.plan {
            Plan::Fixed(schedule) => {
                let first = schedule.first().0 * TILE_PIXELS;
                let blocks = self.pass.read(device, schedule.sweep.tile_count() * TILE_PIXELS)?;
                (first..).zip(blocks).collect()
            }
            Plan::Adaptive(rounds) => {
                let blocks = self.pass.read(device, rounds.active_count)?;
                blocks.into_iter().map(|block| (block.pixel, block)).collect()
            }
        })
    }
}
