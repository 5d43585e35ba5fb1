//! How well a rule keeps its word: many runs of one picture against a truth that is known.

use crate::film::{Film, PixelStop};
use crate::shader::generated::StopReason;
use crate::statistics::{Estimate, normal_quantile, student_t_quantile, wilson_interval};

/// Shares of the picture's mean below which luminance counts as that much.
const FLOOR: f64 = 0.01;
/// Confidence of the intervals of what is reported.
const REPORT_CONFIDENCE: f64 = 0.95;

/// Luminance of every pixel of a picture, f64.
fn luminance(film: &Film) -> Vec<f64> {
    let of = |c: &[f32; 3]| {
        let [r, g, b] = c.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    film.picture().rgb.iter().map(of).collect()
}

/// What every pixel converges to, from independent streams of equal length.
pub struct Truth {
    /// Sums of the luminance of each stream, and samples of a pixel in it.
    streams: Vec<Vec<f64>>,
    samples: f64,
}

impl Truth {
    /// No samples yet.
    pub fn new(pixels: usize, streams: usize) -> Self {
        Self { streams: vec![vec![0.0; pixels]; streams], samples: 0.0 }
    }

    /// Adds a render of `spp` samples to each stream; `film(k)` is that of stream k.
    ///
    /// # Errors
    /// What `film` gives.
    pub fn extend<E>(
        &mut self,
        spp: u32,
        mut film: impl FnMut(usize) -> Result<Film, E>,
    ) -> Result<(), E> {
        for (k, stream) in self.streams.iter_mut().enumerate() {
            for (sum, value) in stream.iter_mut().zip(luminance(&film(k)?)) {
                *sum += value * f64::from(spp);
            }
        }
        self.samples += f64::from(spp);
        Ok(())
    }

    /// Samples of a pixel in all streams.
    pub fn samples(&self) -> f64 {
        self.samples * self.streams.len() as f64
    }

    /// Mean and standard error of every pixel.
    pub fn estimates(&self) -> Vec<Estimate> {
        let of = |i: usize| self.streams.iter().map(|s| s[i] / self.samples).collect::<Vec<_>>();
        (0..self.streams[0].len()).map(|i| Estimate::of(&of(i))).collect()
    }

    /// Share of the pixels whose standard error is at most `tolerance` of their mean, or of
    /// the hundredth part of the picture's.
    pub fn resolved(&self, tolerance: f64) -> f64 {
        let estimates = self.estimates();
        let floor = FLOOR * mean(estimates.iter().map(|e| e.mean));
        let is_known = |e: &&Estimate| e.standard_error <= tolerance * e.mean.max(floor);
        estimates.iter().filter(is_known).count() as f64 / estimates.len() as f64
    }
}

/// Collects the runs of one rule, and as many with as many samples for every pixel.
pub struct Coverage {
    truth: Vec<f64>,
    tolerance: f64,
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
    uniform_sums: Vec<(f64, f64)>,
}

/// One picture in numbers.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Mean over the pixels of the error, in means of the picture.
    bias: f64,
    relmse: f64,
    samples: f64,
    seconds: f64,
    stopping_seconds: f64,
}

/// A number with its interval at a confidence of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What came of it.
#[derive(Debug, Clone, Copy)]
pub struct CoverageReport {
    /// Share of the stopped pixels of all runs that are within the tolerance of the truth.
    pub coverage: Interval,
    /// Its 10th percentile over those pixels that most runs stopped.
    pub tenth_percentile: f64,
    /// What that would be, with as few runs, if every pixel were covered as the mean is.
    pub tenth_percentile_by_chance: f64,
    /// Pixels that most runs stopped.
    pub pixels: usize,
    /// The least of them.
    pub worst: f64,
    /// Pixels of all runs that were stopped black and are not.
    pub black_stops: usize,
    /// Share of the pixels of all runs that had all samples and were not converged.
    pub at_limit: f64,
    /// Mean error over the picture's mean.
    pub bias: Interval,
    /// Samples of a pixel: least, mean, most.
    pub samples: (u32, f64, u32),
    /// Samples over those that pixels would have needed, had their variance been known.
    pub samples_over_oracle: f64,
    /// relMSE over that of uniform sampling with as many samples.
    pub relmse_ratio: Interval,
    /// The same with as much time, by the measured times and an error that falls as 1/n.
    pub relmse_ratio_at_equal_time: Interval,
    /// Seconds of bookkeeping over those of the render.
    pub overhead: f64,
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

impl Coverage {
    /// Nothing measured yet. `tolerance`: share of the mean.
    pub fn new(truth: &Truth, tolerance: f64) -> Self {
        let truth: Vec<f64> = truth.estimates().iter().map(|e| e.mean).collect();
        Self {
            floor: FLOOR * mean(truth.iter().copied()),
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
        let stops: &[PixelStop] = film.stops().unwrap_or_default();
        for (i, stop) in stops.iter().enumerate() {
            self.at_limit += usize::from(stop.reason == StopReason::Limit);
            if stop.reason != StopReason::Converged {
                continue;
            }
            let allowed = self.tolerance * self.truth[i].max(self.floor);
            self.kept[i].0 += u32::from((values[i] - self.truth[i]).abs() <= allowed);
            self.kept[i].1 += 1;
            let is_wrong = (values[i] - self.truth[i]).abs() > allowed;
            self.black_stops += usize::from(values[i] == 0.0 && is_wrong);
        }
        self.least = self.least.min(film.least_samples());
        self.most = self.most.max(film.most_samples());
        let run = self.run(film, &values, seconds);
        self.adaptive.push(Run { stopping_seconds, ..run });
    }

    /// Samples of a pixel in uniform runs that cost as many as the runs so far.
    pub fn equal_spp(&self) -> u32 {
        mean(self.adaptive.iter().map(|r| r.samples)).round().max(1.0) as u32
    }

    /// Adds a run with `spp` samples for every pixel.
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
        }
    }

    /// Samples that a pixel would need on average to keep the tolerance with that confidence,
    /// were the variance known: from `first` to `limit`.
    fn oracle(&self, confidence: f64, first: f64, limit: f64) -> f64 {
        let z = normal_quantile(0.5 + 0.5 * confidence);
        let runs = self.uniform.len() as f64;
        let of = |(sums, truth): (&(f64, f64), &f64)| {
            let variance = ((sums.1 - sums.0 * sums.0 / runs) / (runs - 1.0)).max(0.0);
            let needed = variance * (z / (self.tolerance * truth.max(self.floor))).powi(2);
            (needed * f64::from(self.uniform_spp)).clamp(first, limit)
        };
        mean(self.uniform_sums.iter().zip(&self.truth).map(of))
    }

    /// `confidence`, `first` and `limit` are the rule's: the samples of a pixel at least and most.
    pub fn report(&self, confidence: f64, first: u32, limit: u32) -> CoverageReport {
        let runs = self.adaptive.len();
        let (kept, stopped) =
            self.kept.iter().fold((0, 0), |a, k| (a.0 + k.0 as usize, a.1 + k.1 as usize));
        let (low, high) = wilson_interval(kept, stopped.max(1), REPORT_CONFIDENCE);
        let share = kept as f64 / stopped.max(1) as f64;
        let often: Vec<_> = self.kept.iter().filter(|k| 2 * k.1 as usize > runs).collect();
        let mut shares: Vec<f64> = often.iter().map(|k| f64::from(k.0) / f64::from(k.1)).collect();
        shares.sort_by(f64::total_cmp);
        let percentile = |sorted: &[f64]| sorted.get(sorted.len() / 10).copied().unwrap_or(1.0);
        let samples = mean(self.adaptive.iter().map(|r| r.samples));
        let time = |runs: &[Run]| mean(runs.iter().map(|r| r.seconds));
        let ratio = ratio(&self.adaptive, &self.uniform);
        let slower = time(&self.adaptive) / time(&self.uniform);
        let of_samples = f64::from(self.uniform_spp) / samples;
        let scaled = |v: f64| v * slower * of_samples;
        let bookkeeping = mean(self.adaptive.iter().map(|r| r.stopping_seconds));
        CoverageReport {
            coverage: Interval { value: share, low, high },
            tenth_percentile: percentile(&shares),
            tenth_percentile_by_chance: chance_percentile(share, runs),
            pixels: often.len(),
            worst: shares.first().copied().unwrap_or(1.0),
            black_stops: self.black_stops,
            at_limit: self.at_limit as f64 / (runs * self.truth.len()) as f64,
            bias: t_interval(&self.adaptive.iter().map(|r| r.bias).collect::<Vec<_>>()),
            samples: (self.least, samples, self.most),
            samples_over_oracle: samples / self.oracle(confidence, first.into(), limit.into()),
            relmse_ratio: ratio,
            relmse_ratio_at_equal_time: Interval {
                value: scaled(ratio.value),
                low: scaled(ratio.low),
                high: scaled(ratio.high),
            },
            overhead: bookkeeping / time(&self.adaptive),
        }
    }
}

/// Mean with Student's interval.
fn t_interval(values: &[f64]) -> Interval {
    let estimate = Estimate::of(values);
    let t = student_t_quantile(0.5 + 0.5 * REPORT_CONFIDENCE, values.len() as f64 - 1.0);
    let half = t * estimate.standard_error;
    Interval { value: estimate.mean, low: estimate.mean - half, high: estimate.mean + half }
}

/// Ratio of the mean relMSE of two sets of runs; the interval is that of its logarithm.
fn ratio(a: &[Run], b: &[Run]) -> Interval {
    let of = |runs: &[Run]| Estimate::of(&runs.iter().map(|r| r.relmse).collect::<Vec<_>>());
    let (a, b) = (of(a), of(b));
    let value = a.mean / b.mean;
    let spread = (a.standard_error / a.mean).hypot(b.standard_error / b.mean);
    let half = normal_quantile(0.5 + 0.5 * REPORT_CONFIDENCE) * spread;
    Interval { value, low: value * (-half).exp(), high: value * half.exp() }
}

/// 10th percentile of the share of successes in `runs` trials that succeed with probability `p`.
fn chance_percentile(p: f64, runs: usize) -> f64 {
    let (mut cumulative, mut term) = (0.0, (1.0 - p).powi(runs as i32));
    for successes in 0..=runs {
        cumulative += term;
        if cumulative >= 0.1 || p >= 1.0 {
            return if p >= 1.0 { 1.0 } else { successes as f64 / runs as f64 };
        }
        term *= (runs - successes) as f64 / (successes + 1) as f64 * p / (1.0 - p);
    }
    1.0
}
