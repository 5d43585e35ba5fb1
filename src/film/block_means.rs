//! Means of 8 to 15 equal, consecutive runs of a pixel's samples.
//!
//! The points of one Sobol sequence are not independent, so the spread of single
//! samples says nothing of the error of their mean. The spread of the means of
//! consecutive, aligned runs of a power of two does, and errs to the large side.
//! Runs are whole units of samples: the film's smallest blocks.

use crate::shader::generated;

/// Observations that fill a pixel's memory; then pairs are merged.
pub(crate) const RUNS: usize = generated::RUNS as usize;

/// Luminance means of one pixel.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockMeans {
    /// Mean of the first block: all others are held as differences to it, so that f32
    /// tells means of long runs apart.
    first: f64,
    /// Sum of the differences of the units of the run that is under way.
    pending: f64,
    /// Differences of the runs' means.
    runs: [f32; RUNS],
    /// Whole units so far.
    unit_count: u32,
}

/// Of so many units: the units of a run, and the runs that are complete.
pub(crate) fn runs(unit_count: u32) -> (u32, usize) {
    let units_per_run = 1 << (unit_count / (RUNS as u32 / 2)).max(1).ilog2();
    (units_per_run, (unit_count / units_per_run) as usize)
}

impl BlockMeans {
    /// Adds the mean of a block of `units`: a power of two of them that is no more than the run
    /// under way lacks.
    pub(super) fn add(&mut self, mean: f64, units: u32) {
        if self.unit_count == 0 {
            self.first = mean;
        }
        self.pending += (mean - self.first) * f64::from(units);
        // Runs are as long as before this block: they become longer when all slots are full.
        let (units_per_run, complete) = runs(self.unit_count);
        let in_run = self.unit_count % units_per_run;
        debug_assert!(in_run + units <= units_per_run, "a block reaches over the end of a run");
        self.unit_count += units;
        if !self.unit_count.is_multiple_of(units_per_run) {
            return;
        }
        self.runs[complete] = (self.pending / f64::from(units_per_run)) as f32;
        self.pending = 0.0;
        if complete + 1 == RUNS {
            for k in 0..RUNS / 2 {
                self.runs[k] = 0.5 * (self.runs[2 * k] + self.runs[2 * k + 1]);
            }
        }
    }

    /// Estimated variance of the pixel's mean; `None` with fewer than two observations.
    pub(super) fn variance_of_mean(&self) -> Option<f64> {
        let (_, n) = runs(self.unit_count);
        if n < 2 {
            return None;
        }
        let values = || self.runs[..n].iter().map(|&s| f64::from(s));
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
        for (units, per_run, complete) in cases {
            assert_eq!(runs(units), (per_run, complete), "{units}");
        }
        assert_eq!(runs(32), (4, 8));
        assert_eq!(runs(1000), (64, 15));
    }

    /// Against the means of runs that are cut from the whole sequence, with blocks of one unit
    /// and with blocks that grow with the runs.
    #[test]
    fn runs_are_those_of_the_sequence() {
        let value = |i: u32| f64::from(i.wrapping_mul(2_654_435_769) >> 8) / 16_777_216.0;
        let mean = |first: u32, n: u32| (first..first + n).map(value).sum::<f64>() / f64::from(n);
        for grows in [false, true] {
            let mut means = BlockMeans::default();
            while means.unit_count < 200 {
                let units = if grows { runs(means.unit_count).0.min(4) } else { 1 };
                means.add(mean(means.unit_count, units), units);
                let (per_run, complete) = runs(means.unit_count);
                for k in 0..complete {
                    let held = means.first + f64::from(means.runs[k]);
                    let expected = mean(k as u32 * per_run, per_run);
                    assert!((held - expected).abs() < 1e-6, "{} units, run {k}", means.unit_count);
                }
            }
        }
    }
}
