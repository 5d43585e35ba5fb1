//! How well a rule keeps its word: many runs of one picture against a truth that is known.

mod report;
#[cfg(test)]
mod tests;
mod truth;

pub use report::{CoverageReport, Interval};
pub use truth::Truth;

use crate::film::Film;
use crate::shader::generated::StopReason;
use crate::statistics::{Estimate, normal_quantile};
use truth::{FLOOR, luminance, mean};

/// Collects the runs of one rule, and as many with as many samples for every pixel.
pub struct Coverage {
    /// Luminance of every pixel.
    truth: Vec<f64>,
    /// Standard error of the truth's mean, in means of the picture, and the streams it is of.
    truth_error: f64,
    truth_streams: usize,
    tolerance: f64,
    /// Luminance that darker pixels count as.
    floor: f64,
    /// Of each pixel: runs that stopped it within the tolerance, and all that stopped it.
    kept: Vec<(u32, u32)>,
    black_stops: usize,
    at_limit: usize,
    least: u32,
    most: u32,
    adaptive: Vec<Run>,
    uniform: Vec<Run>,
    uniform_spp: u32,
    /// Of each pixel: sums of the luminance of the uniform runs, and of its square.
    uniform_sums: Vec<(f64, f64)>,
}

/// One picture in numbers.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Mean over the pixels of the error, in means of the picture.
    bias: f64,
    relmse: f64,
    /// Mean over the pixels.
    samples: f64,
    seconds: f64,
    stopping_seconds: f64,
    /// Pixels that were stopped within the tolerance, and all that were stopped.
    kept: (usize, usize),
}

impl Coverage {
    /// Nothing measured yet. `tolerance`: share of the mean.
    pub fn new(truth: &Truth, tolerance: f64) -> Self {
        let picture = truth.picture_mean();
        let truth: Vec<f64> = truth.estimates().iter().map(|e| e.mean).collect();
        Self {
            truth_error: picture.standard_error / picture.mean,
            truth_streams: picture.count,
            floor: FLOOR * picture.mean,
            tolerance,
            kept: vec![(0, 0); truth.len()],
            black_stops: 0,
            at_limit: 0,
            least: u32::MAX,
            most: 0,
            adaptive: Vec::new(),
            uniform: Vec::new(),
            uniform_spp: 0,
            uniform_sums: vec![(0.0, 0.0); truth.len()],
            truth,
        }
    }

    /// Adds a run of the rule that took so many seconds, of them `stopping_seconds` for the rule.
    pub fn add_adaptive(&mut self, film: &Film, seconds: f64, stopping_seconds: f64) {
        let values = luminance(film);
        let mut kept = (0, 0);
        for (i, stop) in film.stops().unwrap_or_default().iter().enumerate() {
            self.at_limit += usize::from(stop.reason == StopReason::Limit);
            if stop.reason != StopReason::Converged {
                continue;
            }
            let allowed = self.tolerance * self.truth[i].max(self.floor);
            let is_kept = (values[i] - self.truth[i]).abs() <= allowed;
            self.kept[i].0 += u32::from(is_kept);
            self.kept[i].1 += 1;
            kept.0 += usize::from(is_kept);
            kept.1 += 1;
            self.black_stops += usize::from(values[i] == 0.0 && !is_kept);
        }
        self.least = self.least.min(film.least_samples());
        self.most = self.most.max(film.most_samples());
        let run = self.run(film, &values, seconds);
        self.adaptive.push(Run { stopping_seconds, kept, ..run });
    }

    /// Samples of a pixel in uniform runs that cost as many as the runs so far.
    pub fn equal_spp(&self) -> u32 {
        mean(self.adaptive.iter().map(|r| r.samples)).round().max(1.0) as u32
    }

    /// Adds a run with `spp` samples for every pixel, the same in every run.
    pub fn add_uniform(&mut self, film: &Film, spp: u32, seconds: f64) {
        let values = luminance(film);
        self.uniform_spp = spp;
        for (sums, value) in self.uniform_sums.iter_mut().zip(&values) {
            sums.0 += value;
            sums.1 += value * value;
        }
        let run = self.run(film, &values, seconds);
        self.uniform.push(run);
    }

    fn run(&self, film: &Film, values: &[f64], seconds: f64) -> Run {
        let picture = self.floor / FLOOR;
        let pairs = || values.iter().zip(&self.truth);
        let square = |(v, t): (&f64, &f64)| (v - t).powi(2) / (t * t + self.floor.powi(2));
        Run {
            bias: mean(pairs().map(|(v, t)| v - t)) / picture,
            relmse: mean(pairs().map(square)),
            samples: mean(film.sample_counts().iter().map(|&n| f64::from(n))),
            seconds,
            stopping_seconds: 0.0,
            kept: (0, 0),
        }
    }

    /// Samples that a pixel would need on average to keep the tolerance with that confidence,
    /// were the variance known: from `first` to `limit`. The variance is that of the uniform
    /// runs, as if it fell as 1/n.
    fn oracle(&self, confidence: f64, first: f64, limit: f64) -> f64 {
        let z = normal_quantile(0.5 + 0.5 * confidence);
        let runs = self.uniform.len() as f64;
        let of = |(sums, truth): (&(f64, f64), &f64)| {
            let variance = ((sums.1 - sums.0 * sums.0 / runs) / (runs - 1.0)).max(0.0);
            let needed = variance * (z / (self.tolerance * truth.max(self.floor))).powi(2);
            (needed * f64::from(self.uniform_spp)).max(first).min(limit)
        };
        mean(self.uniform_sums.iter().zip(&self.truth).map(of))
    }

    /// `confidence`, `first` and `limit` are the rule's: the samples of a pixel at least and most.
    ///
    /// # Panics
    /// With fewer than two runs of the rule, or two uniform ones.
    pub fn report(&self, confidence: f64, first: u32, limit: u32) -> CoverageReport {
        let runs = self.adaptive.len();
        let of = |runs: &[Run], value: fn(&Run) -> f64| {
            Estimate::of(&runs.iter().map(value).collect::<Vec<_>>())
        };
        let coverage = report::share(&self.adaptive.iter().map(|r| r.kept).collect::<Vec<_>>());
        let is_often = |pixel: &(u32, u32)| 2 * pixel.1 as usize > runs;
        let often: Vec<_> = self.kept.iter().copied().filter(is_often).collect();
        let (tenth_percentile, worst) = report::low_shares(&often);

        let errors = [&self.adaptive, &self.uniform].map(|runs| of(runs, |r| r.relmse));
        let times = [&self.adaptive, &self.uniform].map(|runs| of(runs, |r| r.seconds));
        let samples = of(&self.adaptive, |r| r.samples).mean;
        // Uniform runs have a whole number of samples, and errors that fall as 1/n.
        let errors_ratio = errors[0].mean / errors[1].mean;
        let at_equal_samples = errors_ratio * samples / f64::from(self.uniform_spp);
        let at_equal_time = errors_ratio * times[0].mean / times[1].mean;
        let biases: Vec<_> = self.adaptive.iter().map(|r| r.bias).collect();
        CoverageReport {
            coverage,
            tenth_percentile,
            tenth_percentile_by_chance: report::chance_percentile(
                coverage.value,
                often.iter().map(|pixel| pixel.1),
            ),
            worst,
            pixels: often.len(),
            black_stops: self.black_stops,
            at_limit: self.at_limit as f64 / (runs * self.truth.len()) as f64,
            bias: report::difference(&biases, self.truth_error, self.truth_streams),
            samples: (self.least, samples, self.most),
            samples_over_oracle: samples / self.oracle(confidence, first.into(), limit.into()),
            relmse_ratio: report::product(at_equal_samples, &errors),
            relmse_ratio_at_equal_time: report::product(
                at_equal_time,
                &[errors[0], errors[1], times[0], times[1]],
            ),
            overhead: of(&self.adaptive, |r| r.stopping_seconds).mean / times[0].mean,
        }
    }
}
