//! How a render is cut into dispatches. Nothing of it changes the result: a
//! pixel's samples are added in order within a block, and blocks in order.

use crate::gpu::{Device, DeviceKind};
use crate::passes::{PathTrace, Tuning, Work};
use crate::settings::RenderSettings;
use crate::{Error, Result};

/// Tile samples of the first dispatch.
const FIRST_TILE_SAMPLES: f64 = 16.0;

/// By how much a dispatch may exceed the one before.
const GROWTH: f64 = 4.0;

/// Samples of a pixel in one dispatch on software drivers: some of them end a
/// thread's loops after 65,535 iterations in all, without saying so.
const SOFTWARE_SAMPLES: u32 = 4;

/// Most tiles of a dispatch or of a region: the least number of workgroups that every device allows.
const MOST_TILES: u32 = 65_535;

/// Where a render stands.
pub(super) struct Schedule {
    tile_count: u32,
    region_tiles: u32,
    block_size: u32,
    spp: u32,
    most_samples: u32,
    /// Seconds that a dispatch should take.
    target_seconds: f64,
    /// Tile samples that take so long.
    tile_samples: f64,
    /// First sample of the block.
    block_first: u32,
    /// First tile of the region.
    region_first: u32,
    /// Samples of the block that all tiles of the region have.
    sample: u32,
    /// Tiles of the region that have one more.
    tile: u32,
    /// Region and block size of the fold that is due.
    folded: Option<(u32, u32, u32)>,
}

impl Schedule {
    pub(super) fn new(device: &Device, settings: &RenderSettings, tuning: &Tuning) -> Result<Self> {
        let window = settings.window();
        let (across, down) = PathTrace::tiles(window.width, window.height);
        let tile_count = across * down;
        let fits = device.info().max_binding_size / PathTrace::film_bytes(1);
        if fits == 0 {
            return Err(Error::Limit("the device cannot hold one tile of the film".into()));
        }
        let is_software = device.info().kind == DeviceKind::Cpu;
        let most_samples = if is_software { SOFTWARE_SAMPLES } else { settings.block_size };
        Ok(Self {
            tile_count,
            region_tiles: tile_count.min(MOST_TILES).min(fits as u32),
            block_size: settings.block_size,
            spp: settings.spp,
            most_samples: most_samples.min(tuning.submit_samples),
            target_seconds: tuning.submit_seconds,
            tile_samples: FIRST_TILE_SAMPLES,
            block_first: 0,
            region_first: 0,
            sample: 0,
            tile: 0,
            folded: None,
        })
    }

    /// Tiles of the largest region.
    pub(super) fn region_tiles(&self) -> u32 {
        self.region_tiles
    }

    /// A dispatch without samples: the driver compiles at the first.
    pub(super) fn warm_up() -> Work {
        Work {
            region_first_tile: 0,
            first_tile: 0,
            tile_count: 1,
            sample_first: 0,
            sample_count: 0,
        }
    }

    /// Tiles of the present region.
    fn region_size(&self) -> u32 {
        self.region_tiles.min(self.tile_count - self.region_first)
    }

    /// Samples of the present block.
    fn block_samples(&self) -> u32 {
        self.block_size.min(self.spp - self.block_first)
    }

    /// The next dispatch; `None` when all samples are taken.
    pub(super) fn next(&self) -> Option<Work> {
        if self.block_first >= self.spp {
            return None;
        }
        let region = self.region_size();
        let left = self.block_samples() - self.sample;
        let whole = (self.tile_samples / f64::from(region)) as u32;
        let (tile_count, sample_count) = if self.tile == 0 && whole >= 1 {
            (region, whole.min(left).min(self.most_samples))
        } else {
            ((self.tile_samples as u32).clamp(1, region - self.tile), 1)
        };
        Some(Work {
            region_first_tile: self.region_first,
            first_tile: self.tile,
            tile_count,
            sample_first: self.block_first + self.sample,
            sample_count,
        })
    }

    /// `work` is done and took so long. `true`: the region's block is complete and must be folded.
    pub(super) fn advance(&mut self, work: Work, seconds: f64) -> bool {
        let done = f64::from(work.tile_count) * f64::from(work.sample_count);
        let ideal = done * self.target_seconds / seconds.max(1e-6);
        self.tile_samples = ideal.min(self.tile_samples.max(done) * GROWTH).max(1.0);
        let region = (self.region_first, self.region_size());
        self.tile += work.tile_count;
        if self.tile < region.1 {
            return false;
        }
        self.tile = 0;
        self.sample += work.sample_count;
        if self.sample < self.block_samples() {
            return false;
        }
        self.folded = Some((region.0, region.1, self.block_samples()));
        self.sample = 0;
        self.region_first += region.1;
        if self.region_first == self.tile_count {
            self.region_first = 0;
            self.block_first += self.block_samples();
        }
        true
    }

    /// First tile and number of tiles of the region to fold: the one just completed,
    /// or the one under way.
    pub(super) fn folded_region(&self) -> (u32, u32) {
        if self.sample == 0 && self.tile == 0 {
            let (first, count, _) = self.folded.unwrap_or((0, self.region_size(), 0));
            return (first, count);
        }
        (self.region_first, self.region_size())
    }

    /// Whether the completed block has as many samples as every other.
    pub(super) fn is_full_block(&self) -> bool {
        self.folded.is_some_and(|(_, _, samples)| samples == self.block_size)
    }

    /// Whether the completed region was the window's last.
    pub(super) fn ended_round(&self) -> bool {
        self.region_first == 0
    }

    /// Share of all samples that is taken.
    pub(super) fn progress(&self) -> f64 {
        let region = f64::from(self.region_size());
        let in_region = f64::from(self.sample) * region + f64::from(self.tile);
        let in_block = f64::from(self.region_first) * f64::from(self.block_samples()) + in_region;
        let before = f64::from(self.block_first) * f64::from(self.tile_count);
        (before + in_block) / (f64::from(self.spp) * f64::from(self.tile_count))
    }
}
