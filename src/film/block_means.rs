//! Means of 8 to 16 equal, consecutive runs of a pixel's samples.
//!
//! The points of one Sobol sequence are not independent, so the spread of single
//! samples says nothing of the error of their mean. The spread of the means of
//! consecutive, aligned runs of a power of two does, and errs to the large side.

/// Observations that are kept; when they are full, pairs are merged.
const SLOTS: usize = 16;

/// Luminance means of every pixel.
#[derive(Debug, Clone)]
pub(super) struct BlockMeans {
    /// Mean of a pixel's first block: all others are held as differences to it, so that f32
    /// tells means of long runs apart.
    first: Vec<f64>,
    /// Differences of the runs' means; one vector a slot, one entry a pixel.
    slots: Vec<Vec<f32>>,
    /// Sum of the differences of the run that is under way.
    pending: Vec<f64>,
    pending_blocks: u32,
    blocks_per_slot: u32,
}

impl BlockMeans {
    pub(super) fn new(pixel_count: usize) -> Self {
        Self {
            first: vec![0.0; pixel_count],
            slots: Vec::new(),
            pending: vec![0.0; pixel_count],
            pending_blocks: 0,
            blocks_per_slot: 1,
        }
    }

    /// Adds the mean of a pixel's block.
    pub(super) fn add(&mut self, pixel: usize, mean: f64) {
        if self.slots.is_empty() && self.pending_blocks == 0 {
            self.first[pixel] = mean;
        }
        self.pending[pixel] += mean - self.first[pixel];
    }

    /// Every pixel has had its block.
    pub(super) fn end_round(&mut self) {
        self.pending_blocks += 1;
        if self.pending_blocks < self.blocks_per_slot {
            return;
        }
        let n = f64::from(self.blocks_per_slot);
        self.slots.push(self.pending.iter().map(|p| (p / n) as f32).collect());
        self.pending.fill(0.0);
        self.pending_blocks = 0;
        if self.slots.len() == SLOTS {
            self.merge_pairs();
        }
    }

    fn merge_pairs(&mut self) {
        for k in 0..SLOTS / 2 {
            let (left, right) = self.slots.split_at_mut(2 * k + 1);
            let merged: Vec<f32> =
                left[2 * k].iter().zip(&right[0]).map(|(a, b)| 0.5 * (a + b)).collect();
            self.slots[k] = merged;
        }
        self.slots.truncate(SLOTS / 2);
        self.blocks_per_slot *= 2;
    }

    /// Estimated variance of the pixel's mean; `None` with fewer than two observations.
    pub(super) fn variance_of_mean(&self, pixel: usize) -> Option<f64> {
        let n = self.slots.len();
        if n < 2 {
            return None;
        }
        let values = || self.slots.iter().map(|s| f64::from(s[pixel]));
        let mean = values().sum::<f64>() / n as f64;
        let squares: f64 = values().map(|v| (v - mean).powi(2)).sum();
        Some(squares / (n as f64 - 1.0) / n as f64)
    }
}
