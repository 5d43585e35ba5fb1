//! One block of samples of a list of tiles, in pieces that each take about the same time.

use crate::gpu::{Device, DeviceKind};
use crate::passes::Tuning;
use serde::{Deserialize, Serialize};

/// Tile samples of the first dispatch.
const FIRST_TILE_SAMPLES: f64 = 16.0;

/// By how much a dispatch may exceed the one before.
const GROWTH: f64 = 4.0;

/// Samples of a pixel in one dispatch on software drivers: some of them end a
/// thread's loops after 65,535 iterations in all, without saying so.
const SOFTWARE_SAMPLES: u32 = 4;

/// Most tiles of a dispatch: the least number of workgroups that every device allows.
pub(super) const MOST_TILES: u32 = 65_535;

/// How much work a dispatch may hold.
pub(super) struct Pace {
    most_samples: u32,
    /// Seconds that a dispatch should take.
    target_seconds: f64,
    /// Tile samples that take so long.
    tile_samples: f64,
}

/// A part of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    /// First tile of the list.
    pub(super) first_tile: u32,
    pub(super) tile_count: u32,
    /// First sample within the block.
    pub(super) first_sample: u32,
    pub(super) sample_count: u32,
}

/// A block of samples of a list of tiles, and how much of it is done.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Sweep {
    tile_count: u32,
    block_samples: u32,
    /// Samples that all tiles have.
    sample: u32,
    /// Tiles that have one more.
    tile: u32,
}

impl Pace {
    pub(super) fn new(device: &Device, largest_block: u32, tuning: &Tuning) -> Self {
        let is_software = device.info().kind == DeviceKind::Cpu;
        let most_samples = if is_software { SOFTWARE_SAMPLES } else { largest_block };
        Self {
            most_samples: most_samples.min(tuning.submit_samples),
            target_seconds: tuning.submit_seconds,
            tile_samples: FIRST_TILE_SAMPLES,
        }
    }

    /// A piece took so long.
    pub(super) fn learn(&mut self, piece: Piece, seconds: f64) {
        let done = f64::from(piece.tile_count) * f64::from(piece.sample_count);
        let ideal = done * self.target_seconds / seconds.max(1e-6);
        self.tile_samples = ideal.min(self.tile_samples.max(done) * GROWTH).max(1.0);
    }
}

impl Sweep {
    pub(super) fn new(tile_count: u32, block_samples: u32) -> Self {
        Self { tile_count, block_samples, sample: 0, tile: 0 }
    }

    /// The same, of which nothing is done.
    pub(super) fn begun_anew(&self) -> Self {
        Self { sample: 0, tile: 0, ..*self }
    }

    /// The next piece; `None` when all are done.
    pub(super) fn next(&self, pace: &Pace) -> Option<Piece> {
        if self.is_done() {
            return None;
        }
        let left = self.block_samples - self.sample;
        let whole = (pace.tile_samples / f64::from(self.tile_count)) as u32;
        let most_tiles = (self.tile_count - self.tile).min(MOST_TILES);
        let (tile_count, sample_count) = if most_tiles == self.tile_count && whole >= 1 {
            (self.tile_count, whole.min(left).min(pace.most_samples))
        } else {
            ((pace.tile_samples as u32).clamp(1, most_tiles), 1)
        };
        let (first_tile, first_sample) = (self.tile, self.sample);
        Some(Piece { first_tile, tile_count, first_sample, sample_count })
    }

    /// `piece` is done.
    pub(super) fn advance(&mut self, piece: Piece) {
        self.tile += piece.tile_count;
        if self.tile == self.tile_count {
            self.tile = 0;
            self.sample += piece.sample_count;
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.tile_count == 0 || self.sample == self.block_samples
    }

    /// Whether no piece is done yet.
    pub(super) fn is_new(&self) -> bool {
        self.sample == 0 && self.tile == 0
    }

    pub(super) fn tile_count(&self) -> u32 {
        self.tile_count
    }

    /// Samples of every pixel when it is done.
    pub(super) fn block_samples(&self) -> u32 {
        self.block_samples
    }

    /// Whether it is a stage of the sweep `of`.
    pub(super) fn is_stage_of(&self, of: &Self) -> bool {
        let same = |s: &Self| (s.tile_count, s.block_samples);
        same(self) == same(of)
            && self.sample <= self.block_samples
            && (self.tile == 0 || self.tile < self.tile_count && self.sample < self.block_samples)
    }

    /// Tile samples that are done.
    pub(super) fn tile_samples(&self) -> f64 {
        f64::from(self.sample) * f64::from(self.tile_count) + f64::from(self.tile)
    }
}
