//! Whether two pictures, each of independent runs, show the same thing.
//!
//! Four tests a channel look for a difference of four kinds: in the mean of the whole, in
//! a tile, in one pixel, and in many pixels at once by the distribution of their p-values
//! (after Jung, Hanika, Dachsbacher 2020, "Detecting bias in Monte Carlo renderers using
//! Welch's t-test"). Together they raise a false alarm at most at the stated rate: each of
//! the twelve is held to the level that Šidák's formula gives for independent tests, and
//! channels of one picture share their noise, which only makes alarms rarer.
//!
//! The two pictures must have independent noise. With shared random numbers they are more
//! alike than their variances say, p-values crowd near 1, and the fourth test says so; it
//! does the same when variances are overestimated. Pixels that can take few values only
//! (a rare path in a handful of runs) have few p-values and fail it too: give runs more
//! samples.

use super::NoisyPicture;
use crate::statistics::{
    GoodnessOfFit, Verdict, Welch, normal_quantile, sidak, student_t_quantile,
};
use std::fmt;

/// Tests of one picture: four in each of three channels.
const TESTS: usize = 12;

/// Bins for p-values.
const BINS: usize = 20;

/// What is asked of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparisonSettings {
    /// Rate of false alarms of the whole comparison.
    pub level: f64,
    /// Columns and rows of tiles, at most the picture's.
    pub tiles: (u32, u32),
    /// Relative bias of the mean of the picture that must be visible.
    pub visible_bias: f64,
    /// Bias that must be visible in half of the tiles, relative to the mean of the tile or,
    /// where that is smaller, of the picture.
    pub visible_tile_bias: f64,
    /// Relative difference that rounding explains.
    pub rounding: f64,
}

/// What the comparison of two pictures found.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureComparison {
    /// What was asked.
    pub settings: ComparisonSettings,
    /// Red, green, blue.
    pub channels: [ChannelComparison; 3],
}

/// What was found in a part of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Mean over the pixels of the second picture.
    pub reference_mean: f64,
    /// Difference of the means.
    pub test: Welch,
}

/// What was found in one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelComparison {
    /// The whole picture.
    pub whole: Region,
    /// Every tile, row by row.
    pub tiles: Vec<Region>,
    /// Index and difference of the pixel with the smallest p-value; `None` if no pixel
    /// has noise.
    pub worst_pixel: Option<(usize, Welch)>,
    /// P-values of pixels with noise, against the uniform distribution; `None` if there are
    /// too few for two bins.
    pub uniformity: Option<GoodnessOfFit>,
    /// Pixels with noise.
    pub noisy_pixels: usize,
    /// Pixels without noise in either picture, which differ by more than rounding.
    pub exact_differences: usize,
}

impl PictureComparison {
    /// Compares `picture` with `reference`, both with independent noise.
    ///
    /// # Panics
    /// If the sizes differ, or there are more tiles than pixels.
    pub fn of(
        picture: &NoisyPicture,
        reference: &NoisyPicture,
        settings: &ComparisonSettings,
    ) -> Self {
        let size = (picture.width, picture.height);
        assert_eq!(size, (reference.width, reference.height), "pictures of different sizes");
        let (columns, rows) = settings.tiles;
        assert!((1..=size.0).contains(&columns) && (1..=size.1).contains(&rows), "tiles");
        let channel = |c| ChannelComparison::of(picture, reference, c, settings);
        Self { settings: *settings, channels: [channel(0), channel(1), channel(2)] }
    }

    /// Agrees if no test alarms and the biases that were asked for would have been visible.
    pub fn verdict(&self) -> Verdict {
        if self.channels.iter().any(|channel| !channel.alarms(&self.settings).is_empty()) {
            return Verdict::Differs;
        }
        let sees = |channel: &ChannelComparison| {
            channel.visible_bias(&self.settings) <= self.settings.visible_bias
                && channel.visible_tile_bias(&self.settings) <= self.settings.visible_tile_bias
        };
        if self.channels.iter().all(sees) { Verdict::Agrees } else { Verdict::Inconclusive }
    }
}

/// Level of each test.
fn test_level(settings: &ComparisonSettings) -> f64 {
    sidak(settings.level, TESTS)
}

impl ChannelComparison {
    fn of(
        a: &NoisyPicture,
        b: &NoisyPicture,
        channel: usize,
        settings: &ComparisonSettings,
    ) -> Self {
        let (width, height) = (a.width as usize, a.height as usize);
        let pair = |i: usize| {
            let terms = [
                (a.variance[i][channel], a.degrees_of_freedom()),
                (b.variance[i][channel], b.degrees_of_freedom()),
            ];
            (a.mean[i][channel] - b.mean[i][channel], terms)
        };
        // Welch's test of the mean over pixels, whose noise is independent.
        let region = |pixels: &[usize]| {
            let n = pixels.len() as f64;
            let reference_mean = pixels.iter().map(|&i| b.mean[i][channel]).sum::<f64>() / n;
            let difference = pixels.iter().map(|&i| pair(i).0).sum::<f64>() / n;
            let variances = pixels.iter().flat_map(|&i| pair(i).1);
            let variances = variances.map(|(v, degrees)| (v / (n * n), degrees));
            Region { reference_mean, test: Welch::new(difference, variances) }
        };
        let all: Vec<usize> = (0..width * height).collect();
        let (columns, rows) = (settings.tiles.0 as usize, settings.tiles.1 as usize);
        let tile_of =
            |i: usize| (i / width) * rows / height * columns + (i % width) * columns / width;
        let mut tiles = vec![Vec::new(); columns * rows];
        all.iter().for_each(|&i| tiles[tile_of(i)].push(i));

        let (mut noisy, mut exact_differences) = (Vec::new(), 0);
        for &i in &all {
            let welch = region(&[i]).test;
            let rounding =
                settings.rounding * a.mean[i][channel].abs().max(b.mean[i][channel].abs());
            if welch.standard_error > rounding {
                noisy.push((i, welch));
            } else if welch.difference.is_nan() || welch.difference.abs() > rounding {
                exact_differences += 1;
            }
        }
        let p_values: Vec<f64> = noisy.iter().map(|(_, welch)| welch.p_value()).collect();
        let by_p = |&x: &usize, &y: &usize| p_values[x].total_cmp(&p_values[y]);
        let worst_pixel = (0..noisy.len()).min_by(by_p).map(|k| noisy[k]);
        Self {
            whole: region(&all),
            tiles: tiles.iter().map(|pixels| region(pixels)).collect(),
            worst_pixel,
            uniformity: uniformity(&p_values),
            noisy_pixels: noisy.len(),
            exact_differences,
        }
    }

    /// The tests that found a difference, by name.
    pub fn alarms(&self, settings: &ComparisonSettings) -> Vec<&'static str> {
        let level = test_level(settings);
        let tile_level = sidak(level, self.tiles.len());
        let pixel_level = sidak(level, self.noisy_pixels);
        // Rounding moves a mean by no more than its share of it.
        let differs = |test: &Welch, mean: f64, level: f64| {
            let beyond = (test.difference.abs() - settings.rounding * mean.abs()).max(0.0);
            let p = Welch { difference: beyond, ..*test }.p_value();
            p.is_nan() || p < level
        };
        let region = |r: &Region, level: f64| differs(&r.test, r.reference_mean, level);
        let found = [
            ("mean", region(&self.whole, level)),
            ("tile", self.tiles.iter().any(|tile| region(tile, tile_level))),
            ("pixel", self.worst_pixel.is_some_and(|(_, pixel)| differs(&pixel, 0.0, pixel_level))),
            ("p-values", self.uniformity.is_some_and(|fit| fit.verdict(level) == Verdict::Differs)),
            ("pixel without noise", self.exact_differences > 0),
        ];
        found.into_iter().filter(|(_, found)| *found).map(|(name, _)| name).collect()
    }

    /// The tile that differs most.
    pub fn worst_tile(&self) -> (usize, Region) {
        let tiles = self.tiles.iter().copied().enumerate();
        tiles.min_by(|a, b| a.1.test.p_value().total_cmp(&b.1.test.p_value())).expect("a tile")
    }

    /// Relative bias of the mean that would raise an alarm with probability 0.84.
    pub fn visible_bias(&self, settings: &ComparisonSettings) -> f64 {
        visible(&self.whole.test, test_level(settings)) / self.whole.reference_mean.abs()
    }

    /// The same for the median tile, as [`ComparisonSettings::visible_tile_bias`].
    pub fn visible_tile_bias(&self, settings: &ComparisonSettings) -> f64 {
        let level = sidak(test_level(settings), self.tiles.len());
        let floor = self.whole.reference_mean.abs();
        let bias =
            |tile: &Region| visible(&tile.test, level) / tile.reference_mean.abs().max(floor);
        let mut biases: Vec<f64> = self.tiles.iter().map(bias).collect();
        biases.sort_by(f64::total_cmp);
        biases[biases.len() / 2]
    }
}

/// The difference that is beyond the critical value in 84 % of cases: one standard error more.
fn visible(welch: &Welch, level: f64) -> f64 {
    let critical = -student_t_quantile(0.5 * level, welch.degrees_of_freedom);
    (critical + 1.0) * welch.standard_error
}

/// Chi-square of p-values in bins of equal width.
fn uniformity(p_values: &[f64]) -> Option<GoodnessOfFit> {
    let bins = BINS.min(p_values.len() / 5);
    if bins < 2 {
        return None;
    }
    let mut counts = vec![0; bins];
    for p in p_values {
        counts[((p * bins as f64) as usize).min(bins - 1)] += 1;
    }
    let expected = vec![p_values.len() as f64 / bins as f64; bins];
    Some(GoodnessOfFit::of(&counts, &expected))
}

impl fmt::Display for PictureComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let critical = -normal_quantile(0.5 * test_level(&self.settings));
        writeln!(
            f,
            "{:?}; false alarms {:.1e}, |z| of one test up to {critical:.2}",
            self.verdict(),
            self.settings.level
        )?;
        for (name, channel) in ["red", "green", "blue"].iter().zip(&self.channels) {
            let (tile, worst) = channel.worst_tile();
            write!(
                f,
                "  {name:5}: mean {:+.3} % (z {:+.2}, visible {:.2} %), tile {tile} z {:+.2} (visible {:.1} %)",
                100.0 * channel.whole.test.difference / channel.whole.reference_mean,
                channel.whole.test.z(),
                100.0 * channel.visible_bias(&self.settings),
                worst.test.z(),
                100.0 * channel.visible_tile_bias(&self.settings),
            )?;
            if let Some((pixel, worst)) = channel.worst_pixel {
                write!(f, ", pixel {pixel} z {:+.2}", worst.z())?;
            }
            if let Some(fit) = channel.uniformity {
                write!(f, ", p-values of {}: p {:.2e}", channel.noisy_pixels, fit.p_value)?;
            }
            let alarms = channel.alarms(&self.settings);
            if alarms.is_empty() {
                writeln!(f)?
            } else {
                writeln!(f, "; ALARM: {}", alarms.join(", "))?
            }
        }
        Ok(())
    }
}
