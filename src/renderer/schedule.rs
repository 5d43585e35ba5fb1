//! How a render with as many samples for every pixel is cut: blocks of samples, and of each the
//! regions that the film buffer can hold. Nothing of it changes the result: a pixel's samples are
//! added in order within a block, and blocks in order.

use super::sweep::{MOST_TILES, Sweep};
use crate::gpu::Device;
use crate::passes::PathTrace;
use crate::settings::RenderSettings;
use crate::{Error, Result};

/// Where a render stands.
pub(super) struct Schedule {
    tile_count: u32,
    region_tiles: u32,
    block_size: u32,
    spp: u32,
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
        let block_size = settings.block_size;
        Ok(Self {
            tile_count,
            region_tiles,
            block_size,
            spp: settings.spp,
            block_first: 0,
            region_first: 0,
            sweep: Sweep::new(region_tiles, block_size.min(settings.spp)),
        })
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
        let tiles = self.region_tiles.min(self.tile_count - self.region_first);
        self.sweep = Sweep::new(tiles, self.block_size.min(self.spp - self.block_first));
    }

    /// Share of all samples that is taken.
    pub(super) fn progress(&self) -> f64 {
        let before_region = f64::from(self.region_first) * f64::from(self.sweep.block_samples());
        let before_block = f64::from(self.block_first) * f64::from(self.tile_count);
        let done = before_block + before_region + self.sweep.tile_samples();
        done / (f64::from(self.spp) * f64::from(self.tile_count))
    }
}
