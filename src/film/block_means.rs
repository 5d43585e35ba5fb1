//! Means of 8 to 15 equal, consecutive runs of a pixel's samples.
//!
//! The points of one Sobol sequence are not independent, so the spread of single
//! samples says nothing of the error of their mean. The spread of the means of
//! consecutive, aligned runs of a power of two does, and errs to the large side.

use crate::shader::generated;

/// Observations that fill a pixel's memory; then pairs are merged.
pub(crate) const RUNS: usize = generated::RUNS as usize;

/// Luminance means of one pixel.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockMeans {
    /// Mean of the first block: all others are held as differences to it, so that f32
    /// tells means of long runs apart.
    first: f64,
    /// Sum of the differences of the run that is under way.
    pending: f64,
    /// Differences of the runs' means.
    slots: [f32; RUNS],
    /// Whole blocks so far.
    block_count: u32,
}

/// Of so many blocks: the blocks of a run, and the runs that are complete.
pub(crate) fn runs(block_count: u32) -> (u32, usize) {
    let blocks_per_run = (block_count / (RUNS as u32 / 2)).max(1);
    let blocks_per_run = 1 << blocks_per_run.ilog2();
    (blocks_per_run, (block_count / blocks_per_run) as usize)
}

impl BlockMeans {
    /// Adds the mean of a block.
    pub(super) fn add(&mut self, mean: f64) {
        if self.block_count == 0 {
            self.first = mean;
        }
        self.pending += mean - self.first;
        // Runs are as long as before this block: they become longer when all slots are full.
        let (blocks_per_run, complete) = runs(self.block_count);
        self.block_count += 1;
        if self.block_count % blocks_per_run != 0 {
            return;
        }
        self.slots[complete] = (self.pending / f64::from(blocks_per_run)) as f32;
        self.pending = 0.0;
        if complete + 1 == RUNS {
            for k in 0..RUNS / 2 {
                self.slots[k] = 0.5 * (self.slots[2 * k] + self.slots[2 * k + 1]);
            }
        }
    }

    /// Estimated variance of the pixel's mean; `None` with fewer than two observations.
    pub(super) fn variance_of_mean(&self) -> Option<f64> {
        let (_, n) = runs(self.block_count);
        if n < 2 {
            return None;
        }
        let values = || self.slots[..n].iter().map(|&s| f64::from(s));
        let mean = values().sum::<f64>() / n as f64;
        let squares: f64 = values().map(|v| (v - mean).powi(2)).sum();
        Some(squares / (n as f64 - 1.0) / n as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_double_when_sixteen_are_full() {
        let cases = [(0, 1, 0), (1, 1, 1), (15, 1, 15), (16, 2, 8), (17, 2, 8), (31, 2, 15)];
        for (blocks, per_run, complete) in cases {
            assert_eq!(runs(blocks), (per_run, complete), "{blocks}");
        }
        assert_eq!(runs(32), (4, 8));
        assert_eq!(runs(1000), (64, 15));
    }

    /// Against the variance of means of runs that are cut from the whole sequence.
    #[test]
    fn slots_hold_the_means_of_the_runs() {
        let value = |i: u32| f64::from(i.wrapping_mul(2_654_435_769) >> 8) / 16_777_216.0;
        let mut means = BlockMeans::default();
        for count in 1..200_u32 {
            means.add(value(count - 1));
            let (per_run, complete) = runs(count);
            let run = |k: usize| {
                let first = k as u32 * per_run;
                (first..first + per_run).map(value).sum::<f64>() / f64::from(per_run)
            };
            for k in 0..complete {
                let held = means.first + f64::from(means.slots[k]);
                assert!((held - run(k)).abs() < 1e-6, "{count} blocks, run {k}");
            }
        }
    }
}
