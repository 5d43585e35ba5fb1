//! The rule whose confidence is measured (docs/adaptive.md says how well it keeps its word).

use crate::statistics::normal_quantile;

/// Samples of the smallest block: the first decision, at eight of them, has 64 samples.
pub(super) const UNIT: u32 = 8;

/// Means count as at least this share of the picture's mean luminance.
const FLOOR: f32 = 0.01;

/// Samples that a black pixel takes before it counts as black, if its paths meet surfaces from
/// which they go on. An empty background is black for good.
const BLACK_SAMPLES: u32 = 1024;

/// How much evidence a pixel needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// Its own, and that of the neighbours whose means could be the same.
    Default,
    /// More samples, and that of all its neighbours: the confidence is kept.
    Strict,
}

/// Stops a pixel when the half-width of the interval of its mean is within the tolerance. The
/// interval's variance is the larger of the pixel's own, from the spread of 8 to 15 consecutive
/// runs of its samples, and the mean of its neighbourhood of 3 × 3: a neighbour may have met
/// rare light that the pixel has missed so far. Pixels that have stopped are judged again
/// whenever others are, and go on when their neighbours have learnt of such light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibratedRule {
    /// Share of the mean.
    pub tolerance: f32,
    /// Of the interval, from 0.5 to below 1.
    pub confidence: f64,
    /// How much evidence is needed.
    pub preset: Preset,
}

/// What is known of a pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Evidence {
    /// Mean luminance, W/(sr m²).
    pub mean: f32,
    /// Variance of one sample: that of the mean times the samples.
    pub variance: f32,
    /// Whether a path went on from the first surface: it might have found light.
    pub is_lightable: bool,
    /// Largest mean of a block of samples, as it would be of the smallest block.
    pub largest: f32,
    /// Samples.
    pub sample_count: u32,
}

/// What follows for a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Half-width of the interval of the mean luminance; infinite with fewer than two runs.
    pub half_width: f32,
    /// Whether it may stop.
    pub is_done: bool,
}

/// What differs between presets; both are the outcome of measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// Samples before a pixel may stop.
    pub least_samples: u32,
    /// Samples before a black pixel may stop that light could reach.
    pub black_samples: u32,
    /// Standard errors in a half-width.
    pub factor: f32,
    /// Squared difference of two means over the sum of their variances up to which a neighbour
    /// counts.
    pub consistency: f32,
    /// 1: the pixel's variance is as if one more of the smallest blocks came, as bright as its
    /// brightest. 0: not.
    pub outlier_weight: f32,
}

impl CalibratedRule {
    /// A rule.
    pub fn new(tolerance: f32, confidence: f64, preset: Preset) -> Self {
        Self { tolerance, confidence, preset }
    }

    /// The numbers of its preset. Half-widths are calibrated at a confidence of 0.95, where
    /// they have 1.75 and 2.05 standard errors; others are in proportion to the normal quantile.
    pub fn constants(&self) -> Constants {
        let quantiles = normal_quantile(0.5 + 0.5 * self.confidence) / normal_quantile(0.975);
        let factor = |at_95: f64| (at_95 * quantiles) as f32;
        match self.preset {
            Preset::Default => Constants {
                least_samples: 128,
                black_samples: BLACK_SAMPLES,
                factor: factor(1.75),
                consistency: 36.0,
                outlier_weight: 1.0,
            },
            Preset::Strict => Constants {
                least_samples: 256,
                black_samples: BLACK_SAMPLES,
                factor: factor(2.05),
                // A million standard errors: all of them.
                consistency: 1e12,
                outlier_weight: 0.0,
            },
        }
    }

    /// Luminance that dark pixels count as, in a picture of that mean.
    pub fn floor(&self, mean_luminance: f64) -> f32 {
        FLOOR * mean_luminance as f32
    }

    /// Judges every pixel of a picture of rows of `width` pixels.
    pub fn judge(&self, picture: &[Evidence], width: usize, floor: f32) -> Vec<Judgement> {
        let neighbours = |i: usize| {
            let (x, y) = (i % width, i / width);
            let rows = y.saturating_sub(1)..=(y + 1).min(picture.len() / width - 1);
            let columns = move || x.saturating_sub(1)..=(x + 1).min(width - 1);
            rows.flat_map(move |y| columns().map(move |x| &picture[y * width + x]))
        };
        (0..picture.len()).map(|i| self.judge_one(&picture[i], neighbours(i), floor)).collect()
    }

    /// `neighbours`: the pixel is one of them.
    fn judge_one<'a>(
        &self,
        own: &Evidence,
        neighbours: impl Iterator<Item = &'a Evidence>,
        floor: f32,
    ) -> Judgement {
        let constants = self.constants();
        let of_mean = |e: &Evidence| e.variance / e.sample_count.max(1) as f32;
        let is_consistent = |e: &&Evidence| {
            (own.mean - e.mean).powi(2) <= constants.consistency * (of_mean(own) + of_mean(e))
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for neighbour in neighbours.filter(is_consistent) {
            sum += neighbour.variance;
            count += 1.0;
        }
        let n = own.sample_count as f32;
        let outlier = (own.largest - own.mean).max(0.0) / (n / UNIT as f32 + 1.0);
        let variance =
            own.variance.max(sum / count) / n + constants.outlier_weight * outlier * outlier;
        let has_spread = own.sample_count >= 2 * UNIT;
        let half_width =
            if has_spread { constants.factor * variance.sqrt() } else { f32::INFINITY };
        let is_hopeful = own.mean == 0.0 && own.is_lightable;
        let least = if is_hopeful { constants.black_samples } else { constants.least_samples };
        let is_done =
            own.sample_count >= least && half_width <= self.tolerance * own.mean.max(floor);
        Judgement { half_width, is_done }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: Evidence =
        Evidence { mean: 1.0, variance: 0.01, largest: 1.1, is_lightable: true, sample_count: 256 };

    /// The middle one of nine pixels.
    fn middle(picture: &[Evidence; 9], preset: Preset) -> Judgement {
        CalibratedRule::new(0.05, 0.95, preset).judge(picture, 3, 0.01)[4]
    }

    #[test]
    fn the_half_width_is_that_of_the_normal_distribution_times_a_factor() {
        let strict = middle(&[QUIET; 9], Preset::Strict);
        assert!((strict.half_width - 2.05 * 0.1 / 16.0).abs() < 1e-6, "{strict:?}");
        assert!(strict.is_done);
        let half = CalibratedRule::new(0.05, 0.6827, Preset::Strict).constants().factor;
        assert!((half - 2.05 / 1.96).abs() < 1e-3, "{half}");
    }

    /// One pixel in the neighbourhood has met a light that the others have missed.
    #[test]
    fn what_a_neighbour_has_seen_counts() {
        let mut picture = [QUIET; 9];
        picture[0] = Evidence {
            mean: 1.5,
            variance: 64.0,
            largest: 64.0,
            is_lightable: true,
            sample_count: 256,
        };
        for preset in [Preset::Default, Preset::Strict] {
            assert!(middle(&[QUIET; 9], preset).is_done);
            assert!(!middle(&picture, preset).is_done, "{preset:?}");
        }
    }

    /// Beyond the edge of a lamp all is known: it does not hold its neighbours.
    #[test]
    fn an_edge_holds_nobody_by_default() {
        let mut picture = [QUIET; 9];
        picture[..3].fill(Evidence { mean: 40.0, variance: 25.0, largest: 42.0, ..QUIET });
        assert!(middle(&picture, Preset::Default).is_done);
        assert!(!middle(&picture, Preset::Strict).is_done);
    }

    #[test]
    fn one_run_gives_no_interval() {
        let judged = |sample_count| {
            middle(&[Evidence { sample_count, ..QUIET }; 9], Preset::Default).half_width
        };
        assert_eq!(judged(15), f32::INFINITY);
        assert!(judged(16).is_finite());
    }

    #[test]
    fn black_pixels_take_a_thousand_samples() {
        let black =
            |sample_count| Evidence { sample_count, is_lightable: true, ..Evidence::default() };
        for preset in [Preset::Default, Preset::Strict] {
            assert!(!middle(&[black(512); 9], preset).is_done);
            assert!(middle(&[black(1024); 9], preset).is_done);
            let empty = Evidence { is_lightable: false, ..black(256) };
            assert!(middle(&[empty; 9], preset).is_done);
        }
    }
}
