//! The four tests of one channel.

use super::VerdictSettings;
use crate::statistics::{Welch, binomial_survival, sidak, student_t_quantile};
use rayon::prelude::*;
use serde::Serialize;

/// P-values below this are counted, over all pixels.
const SMALL_P: f64 = 0.05;

/// Variances of one origin in every pixel, and their degrees of freedom.
pub(super) struct Term {
    pub(super) variance: Vec<f64>,
    pub(super) degrees: f64,
}

/// One channel of both pictures. A view is a list of terms whose sum is the variance of the
/// difference.
pub(super) struct Input {
    pub(super) name: &'static str,
    pub(super) actual: Vec<f64>,
    pub(super) reference: Vec<f64>,
    pub(super) views: Vec<Vec<Term>>,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Single pixels are tested, which needs their noise in this very channel.
    pub(super) has_pixels: bool,
}

/// What was found in one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaneVerdict {
    /// "red", "green", "blue" or "luminance".
    pub name: &'static str,
    /// Mean over the pixels of the reference.
    pub reference_mean: f64,
    /// Mean of the picture less that.
    pub difference: f64,
    /// The same as a standard normal value, at most 38 either way.
    pub z: f64,
    /// Bias of the mean, relative to it, that raises an alarm with probability 0.84.
    pub visible_bias: f64,
    /// The same for the median tile, relative to its mean or, where that is smaller, the picture's.
    pub visible_tile_bias: f64,
    /// Normal value of every tile, row by row.
    pub tiles: Vec<f64>,
    /// The tile that differs most: index into `tiles`.
    pub worst_tile: usize,
    /// The pixel that differs most, of those with noise; `None` too where pixels are not tested.
    pub worst_pixel: Option<PixelFinding>,
    /// Pixels with noise.
    pub noisy_pixels: usize,
    /// Those whose p-value is below 0.05; a twentieth is expected.
    pub small_p_values: usize,
    /// Pixels without noise that differ by more than rounding.
    pub exact_differences: usize,
    /// P-values of the tests, each for all that it looks at.
    pub p_values: PValues,
    /// The tests that found a difference, by name.
    pub alarms: Vec<&'static str>,
}

/// Chances of findings as improbable as these between pictures of the same thing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PValues {
    /// Of the mean.
    pub mean: f64,
    /// Of the worst of all tiles.
    pub tile: f64,
    /// Of the worst of all pixels, where they are tested.
    pub pixel: Option<f64>,
    /// Of so many pixels with small p-values, where they are tested.
    pub many_pixels: Option<f64>,
}

/// A pixel and how improbable its difference is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PixelFinding {
    /// Column in the window.
    pub x: u32,
    /// Row in the window.
    pub y: u32,
    /// Difference as a standard normal value, at most 38 either way.
    pub z: f64,
}

/// A region's difference in all views of its noise.
struct Region {
    reference_mean: f64,
    difference: f64,
    /// The view in which it is most probable, the difference reduced by what rounding explains.
    test: Welch,
    p: f64,
}

impl Region {
    fn z(&self) -> f64 {
        self.test.z()
    }

    /// The difference that is beyond the critical value of `level` in 84 % of cases.
    fn visible(&self, level: f64) -> f64 {
        if self.test.standard_error == 0.0 {
            return 0.0;
        }
        let critical = -student_t_quantile(0.5 * level, self.test.degrees_of_freedom);
        (critical + 1.0) * self.test.standard_error
    }
}

impl Input {
    fn region(&self, pixels: impl Iterator<Item = usize> + Clone, rounding: f64) -> Region {
        let n = pixels.clone().count() as f64;
        let mean = |values: &[f64]| pixels.clone().map(|i| values[i]).sum::<f64>() / n;
        let (actual, reference_mean) = (mean(&self.actual), mean(&self.reference));
        let difference = actual - reference_mean;
        let beyond =
            (difference.abs() - rounding * actual.abs().max(reference_mean.abs())).max(0.0);
        // NaN stays NaN, and is found.
        let beyond = if difference.is_nan() { f64::NAN } else { beyond.copysign(difference) };
        let views = self.views.iter().map(|terms| {
            let terms = terms.iter().flat_map(|term| {
                let variance = |i: usize| (term.variance[i] / (n * n), term.degrees);
                pixels.clone().map(variance)
            });
            Welch::new(beyond, terms)
        });
        let tests = views.map(|test| (test, test.p_value()));
        let (test, p) = tests.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a view");
        Region { reference_mean, difference, test, p: if p.is_nan() { 0.0 } else { p } }
    }
}

impl PlaneVerdict {
    /// `level`: rate of false alarms of each test.
    pub(super) fn of(input: &Input, settings: &VerdictSettings, level: f64) -> Self {
        let (width, height) = (input.width as usize, input.height as usize);
        let tile = settings.tile as usize;
        let (columns, rows) = (width.div_ceil(tile), height.div_ceil(tile));
        let rounding = settings.rounding;
        let whole = input.region(0..width * height, rounding);
        let tiles: Vec<Region> = (0..columns * rows)
            .into_par_iter()
            .map(|k| {
                let (x, y) = (k % columns * tile, k / columns * tile);
                let (right, bottom) = ((x + tile).min(width), (y + tile).min(height));
                let pixels = (y..bottom).flat_map(move |y| (x..right).map(move |x| y * width + x));
                input.region(pixels, rounding)
            })
            .collect();
        let pixels: Vec<Region> = (0..if input.has_pixels { width * height } else { 0 })
            .into_par_iter()
            .map(|i| input.region(std::iter::once(i), rounding))
            .collect();
        let is_noisy = |p: &Region| {
            p.test.standard_error > rounding * p.reference_mean.abs().max(f64::MIN_POSITIVE)
        };
        let noisy: Vec<(usize, &Region)> =
            pixels.iter().enumerate().filter(|(_, p)| is_noisy(p)).collect();
        let exact_differences =
            pixels.iter().filter(|p| !is_noisy(p) && p.test.difference != 0.0).count();
        let small_p_values = noisy.iter().filter(|(_, p)| p.p < SMALL_P).count();
        let worst = noisy.iter().min_by(|a, b| a.1.p.total_cmp(&b.1.p));
        let by_p = |a: &usize, b: &usize| tiles[*a].p.total_cmp(&tiles[*b].p);
        let worst_tile = (0..tiles.len()).min_by(by_p).unwrap_or(0);
        // 1 - (1 - p)^n: of the least of n.
        let of_many = |p: f64, n: usize| -(n as f64 * (-p).ln_1p()).exp_m1();
        let p_values = PValues {
            mean: whole.p,
            tile: tiles.get(worst_tile).map_or(1.0, |tile| of_many(tile.p, tiles.len())),
            pixel: input.has_pixels.then(|| match exact_differences {
                0 => worst.map_or(1.0, |(_, pixel)| of_many(pixel.p, noisy.len())),
                _ => 0.0,
            }),
            many_pixels: input
                .has_pixels
                .then(|| binomial_survival(small_p_values, noisy.len(), SMALL_P)),
        };
        let floor = whole.reference_mean.abs();
        let tile_level = sidak(level, tiles.len());
        let visible = |t: &Region| t.visible(tile_level) / t.reference_mean.abs().max(floor);
        let mut visible_tiles: Vec<f64> = tiles.iter().map(visible).collect();
        visible_tiles.sort_by(f64::total_cmp);
        Self {
            name: input.name,
            reference_mean: whole.reference_mean,
            difference: whole.difference,
            z: whole.z(),
            visible_bias: whole.visible(level) / floor,
            visible_tile_bias: visible_tiles[visible_tiles.len() / 2],
            tiles: tiles.iter().map(Region::z).collect(),
            worst_tile,
            worst_pixel: worst.map(|(i, pixel)| PixelFinding {
                x: (i % width) as u32,
                y: (i / width) as u32,
                z: pixel.z(),
            }),
            noisy_pixels: noisy.len(),
            small_p_values,
            exact_differences,
            p_values,
            alarms: p_values.tests().filter(|(_, p)| *p < level).map(|(name, _)| name).collect(),
        }
    }

    /// The least p-value of its tests.
    pub(super) fn least_p(&self) -> f64 {
        self.p_values.tests().map(|(_, p)| p).fold(1.0, f64::min)
    }
}

impl PValues {
    /// Names and p-values of the tests that were made.
    fn tests(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let all = [
            ("mean", Some(self.mean)),
            ("tile", Some(self.tile)),
            ("pixel", self.pixel),
            ("many pixels", self.many_pixels),
        ];
        all.into_iter().filter_map(|(name, p)| Some((name, p?)))
    }
}
