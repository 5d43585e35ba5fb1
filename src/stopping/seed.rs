//! The rule that this project began with: I = 1.96 σ / √n against a share of the mean.

use crate::shader::generated::{MOST_BLOCK_SAMPLES, NORMAL_95};

/// Stops for good when 1.96 σ / √n ≤ tolerance × mean, tested every `batch` samples. Its 95 %
/// holds for nearly normal samples only, and a pixel whose samples are all black stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeedRule {
    /// Samples between two tests.
    pub batch: u32,
    /// Share of the mean; 0 never stops.
    pub tolerance: f32,
}

impl Default for SeedRule {
    fn default() -> Self {
        Self { batch: 32, tolerance: 0.05 }
    }
}

impl SeedRule {
    /// The largest unit that batches are whole multiples of, four at least: so that a
    /// pixel that stops after one batch has an estimate of its error.
    pub(super) fn unit(&self) -> u32 {
        let most = (self.batch / 4).clamp(1, MOST_BLOCK_SAMPLES);
        let fits = |size: &u32| self.batch.is_multiple_of(*size);
        (1..=most).rev().find(fits).unwrap_or(1)
    }

    /// The largest block that does not reach over the end of a batch.
    pub(super) fn largest_block(&self) -> u32 {
        let units = self.batch / self.unit();
        (self.unit() << units.trailing_zeros()).min(MOST_BLOCK_SAMPLES)
    }

    /// Whether a pixel with these sums stops.
    pub fn stops(&self, sums: &RunningSums) -> bool {
        sums.half_width() <= f64::from(self.tolerance) * sums.mean()
    }
}

/// Running sums of a sample's illuminance and its square.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RunningSums {
    /// Samples.
    pub count: u32,
    /// Their sum.
    pub sum: f64,
    /// The sum of their squares.
    pub squares: f64,
}

impl RunningSums {
    /// Adds one sample.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        self.sum += value;
        self.squares += value * value;
    }

    /// Mean; 0 without samples.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    /// Unbiased variance of a sample; 0 with fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            return 0.0;
        }
        let n = f64::from(self.count);
        ((self.squares - self.sum * self.sum / n) / (n - 1.0)).max(0.0)
    }

    /// 1.96 σ / √n.
    pub fn half_width(&self) -> f64 {
        f64::from(NORMAL_95) * (self.variance() / f64::from(self.count.max(1))).sqrt()
    }
}
