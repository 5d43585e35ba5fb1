//! Mean luminances of 8 to 15 equal, consecutive runs of a pixel's samples.
//!
//! The points of one Sobol sequence are not independent, so the spread of single
//! samples says nothing of the error of their mean. The spread of the means of
//! consecutive, aligned runs of a power of two does, and errs to the large side.
//! Runs are whole units of samples: the film's smallest blocks.
//!
//! The mean of a run is that of its halves, down to the units: so that it has the same bits
//! whether the runs grew to their length or had it from the beginning, as in a shard.

use super::PixelSums;
use crate::shader::generated;

/// Observations that fill a pixel's memory; then pairs are merged.
pub(crate) const RUNS: usize = generated::RUNS as usize;

/// Of so many units: the units of a run, and the runs that are complete.
pub(crate) fn runs(unit_count: u32) -> (u32, usize) {
    let units_per_run = 1 << (unit_count / (RUNS as u32 / 2)).max(1).ilog2();
    (units_per_run, (unit_count / units_per_run) as usize)
}

/// Luminance means of all pixels.
#[derive(Debug, Clone)]
pub(super) struct RunMeans {
    /// Units of every run, where they do not grow.
    fixed: Option<u32>,
    pub(super) runs: PixelSums<[f64; RUNS]>,
    /// Whole units so far.
    pub(super) unit_counts: PixelSums<u32>,
    /// Of the run under way: the mean of its last 2^k units at index k, where bit k of the number of
    /// its units is set.
    pub(super) parts: Vec<PixelSums<f64>>,
}

impl RunMeans {
    /// `fixed`: units of a run, where the number of samples is known; 15 runs at most.
    pub(super) fn new(pixel_count: usize, fixed: Option<u32>) -> Self {
        debug_assert!(fixed.is_none_or(u32::is_power_of_two), "runs have a power of two of units");
        Self {
            fixed,
            runs: vec![[0.0; RUNS]; pixel_count],
            unit_counts: vec![0; pixel_count],
            parts: Vec::new(),
        }
    }

    /// Units of a run of the pixel, and its complete runs.
    pub(super) fn complete(&self, i: usize) -> (u32, usize) {
        let units = self.unit_counts[i];
        self.fixed.map_or_else(|| runs(units), |per_run| (per_run, (units / per_run) as usize))
    }

    /// Adds the mean of a block of `units`. One that is not a power of two, or not aligned to it, is
    /// its pixel's last, cut by a limit, and does not count.
    pub(super) fn add(&mut self, i: usize, mean: f64, units: u32) {
        // Runs are as long as before this block: they become longer when all slots are full.
        let (units_per_run, complete) = self.complete(i);
        let in_run = self.unit_counts[i] % units_per_run;
        if !units.is_power_of_two() || !in_run.is_multiple_of(units) {
            return;
        }
        debug_assert!(in_run + units <= units_per_run, "a block reaches over the end of a run");
        let (mut mean, mut level) = (mean, units.ilog2() as usize);
        while in_run >> level & 1 == 1 {
            mean = 0.5 * (self.parts[level][i] + mean);
            level += 1;
        }
        self.unit_counts[i] += units;
        if 1 << level < units_per_run {
            while self.parts.len() <= level {
                self.parts.push(vec![0.0; self.runs.len()]);
            }
            self.parts[level][i] = mean;
            return;
        }
        let runs = &mut self.runs[i];
        runs[complete] = mean;
        if self.fixed.is_none() && complete + 1 == RUNS {
            for k in 0..RUNS / 2 {
                runs[k] = 0.5 * (runs[2 * k] + runs[2 * k + 1]);
            }
        }
    }

    /// Estimated variance of the pixel's mean; `None` with fewer than two observations.
    pub(super) fn variance_of_mean(&self, i: usize) -> Option<f64> {
        let (_, n) = self.complete(i);
        if n < 2 {
            return None;
        }
        let values = &self.runs[i][..n];
        // Relative to the first, so that equal runs have none at all.
        let mean = values.iter().map(|v| v - values[0]).sum::<f64>() / n as f64;
        let squares: f64 = values.iter().map(|v| (v - values[0] - mean).powi(2)).sum();
        Some(squares / (n as f64 - 1.0) / n as f64)
    }
}

/// Of films that are joined.
impl RunMeans {
    /// From here on runs have this length, which those so far have too.
    pub(super) fn take_fixed_length(&mut self, units: u32) {
        self.fixed = Some(units);
    }

    /// Adds the runs that come next; all of these are complete.
    pub(super) fn append(&mut self, next: &Self) {
        for i in 0..self.runs.len() {
            let ((_, mine), (_, n)) = (self.complete(i), next.complete(i));
            self.runs[i][mine..mine + n].copy_from_slice(&next.runs[i][..n]);
            self.unit_counts[i] += next.unit_counts[i];
        }
    }

    /// Copies the runs of `n` pixels of another from index `from` on.
    pub(super) fn insert(&mut self, other: &Self, to: usize, from: usize, n: usize) {
        self.runs[to..to + n].copy_from_slice(&other.runs[from..from + n]);
        self.unit_counts[to..to + n].copy_from_slice(&other.unit_counts[from..from + n]);
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

    fn value(i: u32) -> f64 {
        f64::from(i.wrapping_mul(2_654_435_769) >> 8) / 16_777_216.0
    }

    /// Against the means of runs that are cut from the whole sequence, with blocks of one unit
    /// and with blocks that grow with the runs.
    #[test]
    fn runs_are_those_of_the_sequence() {
        let mean = |first: u32, n: u32| (first..first + n).map(value).sum::<f64>() / f64::from(n);
        for grows in [false, true] {
            let mut means = RunMeans::new(1, None);
            while means.unit_counts[0] < 200 {
                let at = means.unit_counts[0];
                let units = if grows { runs(at).0.min(4) } else { 1 };
                means.add(0, mean(at, units), units);
                let (per_run, complete) = runs(at + units);
                for k in 0..complete {
                    let expected = mean(k as u32 * per_run, per_run);
                    let held = means.runs[0][k];
                    assert!((held - expected).abs() < 1e-12, "{} units, run {k}", at + units);
                }
            }
        }
    }

    /// Bits: runs that grew are those that were long from the beginning, wherever that is.
    #[test]
    fn runs_of_a_part_are_those_of_the_whole() {
        for total in [16, 40, 100, 1000] {
            let (per_run, complete) = runs(total);
            let mut whole = RunMeans::new(1, None);
            (0..total).for_each(|unit| whole.add(0, value(unit), 1));
            for first in [0, 1, complete as u32 / 2, complete as u32 - 1] {
                let mut part = RunMeans::new(1, Some(per_run));
                (first * per_run..total).for_each(|unit| part.add(0, value(unit), 1));
                let n = complete - first as usize;
                assert_eq!(part.complete(0), (per_run, n));
                assert_eq!(part.runs[0][..n], whole.runs[0][first as usize..complete], "{total}");
            }
        }
    }

    #[test]
    fn blocks_cut_by_a_limit_do_not_count() {
        let mut means = RunMeans::new(1, None);
        (0..32).for_each(|unit| means.add(0, value(unit), 1));
        let before = means.clone();
        means.add(0, 1e9, 3);
        assert_eq!(means.unit_counts, before.unit_counts);
        assert_eq!(means.runs, before.runs);
    }
}
