//! How a render with as many samples for every pixel is cut: blocks of samples, and of each the
//! regions that the film buffer can hold. Nothing of it changes the result: a pixel's samples are
//! added in order within a block, and blocks in order.

use super::sweep::{MOST_TILES, Sweep};
use crate::film::SampleRange;
use crate::gpu::Device;
use crate::passes::PathTrace;
use crate::settings::RenderSettings;
use crate::{Error, Result};

/// Where a render stands.
pub(super) struct Schedule {
    tile_count: u32,
    region_tiles: u32,
    block_size: u32,
    samples: SampleRange,
    /// First sample of the block.
    block_first: u32,
    /// First tile of the region.
    region_first: u32,
    /// The block of the region under way.
    pub(super) sweep: Sweep,
}

impl Schedule {
    pub(super) fn new(device: &Device, settings: &RenderSettings) -> Result<Self> {
        let window = settings.traced_window();
        let (across, down) = PathTrace::tiles(window.width, window.height);
        let tile_count = across * down;
        let fits = device.info().max_binding_size / PathTrace::TILE_BYTES;
        if fits == 0 {
            return Err(Error::Limit("the device cannot hold one tile of the film".into()));
        }
        let region_tiles = tile_count.min(MOST_TILES).min(fits as u32);
        let (block_size, samples) = (settings.block_size, settings.samples());
        Ok(Self {
            tile_count,
            region_tiles,
            block_size,
            samples,
            block_first: samples.first,
            region_first: 0,
            sweep: Sweep::new(region_tiles, block_size.min(samples.end - samples.first)),
        })
    }

    /// Begins the block of the region of that first tile and first sample; `None` if there is no
    /// such.
    pub(super) fn go_to(&mut self, region_first: u32, block_first: u32) -> Option<()> {
        let range = self.samples.first..=self.samples.end;
        let is_region =
            region_first < self.tile_count && region_first.is_multiple_of(self.region_tiles);
        if !is_region || !range.contains(&block_first) {
            return None;
        }
        (self.region_first, self.block_first) = (region_first, block_first);
        self.begin();
        Some(())
    }

    fn begin(&mut self) {
        let tiles = self.region_tiles.min(self.tile_count - self.region_first);
        let samples = self.block_size.min(self.samples.end - self.block_first);
        self.sweep = Sweep::new(tiles, samples);
    }

    /// Tiles of the largest region.
    pub(super) fn region_tiles(&self) -> u32 {
        self.region_tiles
    }

    /// First tile of the region, and first sample of the block.
    pub(super) fn first(&self) -> (u32, u32) {
        (self.region_first, self.block_first)
    }

    /// The region's block is in the film: goes on with the next region or block.
    pub(super) fn next_region(&mut self) {
        self.region_first += self.sweep.tile_count();
        if self.region_first == self.tile_count {
            self.region_first = 0;
            self.block_first += self.sweep.block_samples();
        }
        self.begin();
    }

    /// Share of all samples that is taken.
    pub(super) fn progress(&self) -> f64 {
        let before_region = f64::from(self.region_first) * f64::from(self.sweep.block_samples());
        let taken = f64::from(self.block_first - self.samples.first);
        let before_block = taken * f64::from(self.tile_count);
        let done = before_block + before_region + self.sweep.tile_samples();
        let all = f64::from(self.samples.end - self.samples.first);
        done / (all * f64::from(self.tile_count))
    }
}
