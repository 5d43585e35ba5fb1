//! Intervals of what is reported.

use crate::statistics::{Estimate, Welch, student_t_quantile, wilson_interval};
use std::collections::BTreeMap;

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;

/// A number with its interval at a confidence of 95 %.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What came of it. Shares of pixels that were stopped are NaN where none was.
#[derive(Debug, Clone, Copy)]
pub struct CoverageReport {
    /// Share of the stopped pixels of all runs that are within the tolerance of the truth. The
    /// truth's own error counts against it.
    pub coverage: Interval,
    /// Its 10th percentile over those pixels that most runs stopped.
    pub tenth_percentile: f64,
    /// What that would be, with as few stops of each, if every pixel were covered as the mean is.
    pub tenth_percentile_by_chance: f64,
    /// The least of them.
    pub worst: f64,
    /// Pixels that most runs stopped.
    pub pixels: usize,
    /// Pixels of all runs that were stopped black, and are brighter than the tolerance allows.
    pub black_stops: usize,
    /// Share of the pixels of all runs that had all samples and were not converged.
    pub at_limit: f64,
    /// Mean error over the picture's mean. The interval has the truth's own error.
    pub bias: Interval,
    /// Samples of a pixel: least, mean, most.
    pub samples: (u32, f64, u32),
    /// Samples over those that pixels would have needed, had their variance been known.
    pub samples_over_oracle: f64,
    /// relMSE over that of uniform sampling with as many samples. The truth's own error is in
    /// both, and draws the ratio to 1.
    pub relmse_ratio: Interval,
    /// The same with as much time of rendering, by the clock, if the error of uniform sampling
    /// falls as 1/n.
    pub relmse_ratio_at_equal_time: Interval,
    /// Seconds of bookkeeping over those of the render.
    pub overhead: f64,
}

/// Student's interval of a value with estimated variances and their degrees of freedom.
fn half_width(variances: impl Iterator<Item = (f64, f64)>) -> f64 {
    let welch = Welch::new(0.0, variances);
    student_t_quantile(0.5 + 0.5 * CONFIDENCE, welch.degrees_of_freedom) * welch.standard_error
}

/// Mean of independent `runs`, each the difference to an estimate of this standard error from
/// so many `streams`.
pub(super) fn difference(runs: &[f64], standard_error: f64, streams: usize) -> Interval {
    let value = Estimate::of(runs);
    let of_runs = (value.standard_error.powi(2), runs.len() as f64 - 1.0);
    let of_truth = (standard_error.powi(2), streams as f64 - 1.0);
    let half = half_width([of_runs, of_truth].into_iter());
    Interval { value: value.mean, low: value.mean - half, high: value.mean + half }
}

/// A product or quotient of independent means, all positive, that comes to `value`: the interval
/// is that of its logarithm.
pub(super) fn product(value: f64, means: &[Estimate]) -> Interval {
    let relative = |e: &Estimate| ((e.standard_error / e.mean).powi(2), e.count as f64 - 1.0);
    let half = half_width(means.iter().map(relative));
    Interval { value, low: value * (-half).exp(), high: value * half.exp() }
}

/// Share of successes among the trials of all runs; `runs`: successes and trials of each. The
/// wider of two intervals: Wilson's, as if all trials were independent, and Student's, as if only
/// the runs were (of a ratio of means: Cochran 1977, "Sampling Techniques", section 6.3).
pub(super) fn share(runs: &[(usize, usize)]) -> Interval {
    let (successes, trials) = runs.iter().fold((0, 0), |a, r| (a.0 + r.0, a.1 + r.1));
    if trials == 0 {
        return Interval { value: f64::NAN, low: 0.0, high: 1.0 };
    }
    let value = successes as f64 / trials as f64;
    let (low, high) = wilson_interval(successes, trials, CONFIDENCE);
    let excess: Vec<_> = runs.iter().map(|r| r.0 as f64 - value * r.1 as f64).collect();
    let per_run = trials as f64 / runs.len() as f64;
    let variance = (Estimate::of(&excess).standard_error / per_run).powi(2);
    let half = half_width([(variance, runs.len() as f64 - 1.0)].into_iter());
    Interval { value, low: low.min(value - half).max(0.0), high: high.max(value + half).min(1.0) }
}

/// 10th percentile, and least, of the pixels' shares of successes in their trials.
pub(super) fn low_shares(pixels: &[(u32, u32)]) -> (f64, f64) {
    let mut shares: Vec<f64> = pixels.iter().map(|p| f64::from(p.0) / f64::from(p.1)).collect();
    shares.sort_by(f64::total_cmp);
    // The least that a tenth of them do not exceed.
    let tenth = shares.len().div_ceil(10).max(1) - 1;
    (*shares.get(tenth).unwrap_or(&f64::NAN), *shares.first().unwrap_or(&f64::NAN))
}

/// 10th percentile of the shares of successes of pixels with so many trials, all of which
/// succeed with probability `p`.
pub(super) fn chance_percentile(p: f64, trials: impl Iterator<Item = u32>) -> f64 {
    let mut pixels = BTreeMap::new();
    for n in trials {
        *pixels.entry(n).or_insert(0.0) += 1.0;
    }
    let all: f64 = pixels.values().sum();
    let mut outcomes = Vec::new();
    for (&n, &count) in &pixels {
        let probabilities = binomial(p, n).into_iter().enumerate();
        outcomes.extend(probabilities.map(|(k, q)| (k as f64 / f64::from(n), q * count / all)));
    }
    outcomes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut cumulative = 0.0;
    let reached = |(_, q): &&(f64, f64)| {
        cumulative += q;
        cumulative >= 0.1
    };
    outcomes.iter().find(reached).map_or(f64::NAN, |(share, _)| *share)
}

/// Probabilities of 0 to n successes; by logarithms, as the first underflows where n is large.
fn binomial(p: f64, n: u32) -> Vec<f64> {
    if p <= 0.0 || p >= 1.0 {
        let certain = if p >= 1.0 { n } else { 0 };
        return (0..=n).map(|k| if k == certain { 1.0 } else { 0.0 }).collect();
    }
    let mut log = f64::from(n) * (-p).ln_1p();
    let of = |k: u32| {
        let probability = log.exp();
        log += (f64::from(n - k) / f64::from(k + 1)).ln() + p.ln() - (-p).ln_1p();
        probability
    };
    (0..=n).map(of).collect()
}
