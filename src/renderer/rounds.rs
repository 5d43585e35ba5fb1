//! An adaptive render: rounds of one block for every pixel that is not converged.

use super::sweep::Sweep;
use crate::film::{Film, PixelStop};
use crate::gpu::{Device, GpuFilmPixel};
use crate::passes::{ActiveList, Adaptive, PathTrace, Tuning};
use crate::settings::{Crop, RenderSettings};
use crate::shader::generated::{StopReason, TILE_PIXELS};
use crate::stopping::StoppingRule;
use crate::{Error, Result};

/// Where an adaptive render stands.
pub(super) struct Rounds {
    pub(super) pass: Adaptive,
    rule: StoppingRule,
    /// Samples of a pixel at most.
    limit: u32,
    pixel_count: u32,
    /// Pixels on the list.
    pub(super) active_count: u32,
    /// Samples of the one that has most.
    pub(super) most_samples: u32,
    /// The next block of each.
    pub(super) sweep: Sweep,
}

impl Rounds {
    /// Pixels of the film buffer: all that the window has can be on the list.
    pub(super) fn film_pixels(device: &Device, settings: &RenderSettings) -> Result<u64> {
        let window = settings.window();
        let (across, down) = PathTrace::tiles(window.width, window.height);
        let pixels = Adaptive::film_pixels(across * down);
        let fits = device.info().max_binding_size / size_of::<GpuFilmPixel>() as u64;
        if pixels <= fits {
            return Ok(pixels);
        }
        Err(Error::Limit(format!(
            "{pixels} pixels that stop one by one: {} holds {fits} at once: render parts with \
             --crop, or without --noise",
            device.info().name
        )))
    }

    /// All pixels are on the list, without samples.
    pub(super) fn new(
        device: &Device,
        rule: &StoppingRule,
        settings: &RenderSettings,
        pass: &PathTrace,
        tuning: &Tuning,
    ) -> Result<Self> {
        let window = settings.window();
        let (across, down) = PathTrace::tiles(window.width, window.height);
        let mut pass = Adaptive::new(device, rule, across * down, pass.buffers(), tuning)?;
        let list = pass.begin(device)?;
        Ok(Self {
            pass,
            rule: *rule,
            limit: settings.spp,
            pixel_count: list.pixel_count,
            active_count: list.pixel_count,
            most_samples: 0,
            sweep: sweep(list),
        })
    }

    /// Begins anew.
    pub(super) fn restart(&mut self, device: &Device) -> Result<()> {
        let list = self.pass.begin(device)?;
        self.most_samples = 0;
        self.next_round(list);
        Ok(())
    }

    fn next_round(&mut self, list: ActiveList) {
        self.active_count = list.pixel_count;
        self.sweep = sweep(list);
    }

    /// The round is in the film as `blocks`: begins the next. Whether pixels were judged.
    pub(super) fn end(
        &mut self,
        device: &Device,
        blocks: &[GpuFilmPixel],
        film: &Film,
    ) -> Result<bool> {
        self.pass.accumulate(device, self.active_count)?;
        let counts = || blocks.iter().map(|block| block.sample_first + block.sample_count);
        self.most_samples = counts().max().unwrap_or(self.most_samples);
        let decides = counts().any(|n| self.rule.decides_at(n) || n >= self.limit);
        let list = if decides {
            let floor = match &self.rule {
                StoppingRule::Calibrated(rule) => rule.floor(film.mean_luminance()),
                StoppingRule::Seed(_) => 0.0,
            };
            self.pass.decide(device, floor)?
        } else {
            let block = |n: u32| self.rule.block_at(n).min(self.limit - n);
            let block_samples = counts().map(block).max().unwrap_or(0);
            ActiveList { pixel_count: self.active_count, block_samples }
        };
        self.next_round(list);
        Ok(decides)
    }

    /// Why each pixel of the window, row by row, has no more samples.
    pub(super) fn stops(&self, device: &Device, window: Crop) -> Result<Vec<PixelStop>> {
        let tallies = self.pass.tallies(device)?;
        let (across, _) = PathTrace::tiles(window.width, window.height);
        let stop = |i: u32| {
            let tally = &tallies[PathTrace::index(i % window.width, i / window.width, across)];
            let is_reason = |reason: &StopReason| *reason as u32 == tally.reason;
            let reason = StopReason::ALL.into_iter().find(is_reason);
            PixelStop {
                reason: reason.unwrap_or(StopReason::Unfinished),
                half_width: tally.half_width,
            }
        };
        Ok((0..window.width * window.height).map(stop).collect())
    }

    /// Share of the pixels that are done.
    pub(super) fn done_share(&self) -> f64 {
        1.0 - f64::from(self.active_count) / f64::from(self.pixel_count.max(1))
    }

    /// Share of the pixels that are done, with that of the limit's samples for those that are not.
    pub(super) fn progress(&self) -> f64 {
        let active = f64::from(self.active_count) / f64::from(self.pixel_count.max(1));
        1.0 - active * (1.0 - f64::from(self.most_samples) / f64::from(self.limit))
    }
}

fn sweep(list: ActiveList) -> Sweep {
    Sweep::new(list.pixel_count.div_ceil(TILE_PIXELS), list.block_samples)
}
