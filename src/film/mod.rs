//! Per-pixel sums of radiance, wide enough for any number of samples, and how
//! far they are from converged.

mod file;
mod memory;
mod run_means;
mod stored;
mod sums;

pub use file::{FilmFile, Sections, write_film_file};
pub use stored::FilmHead;

use crate::image::Picture;
use crate::settings::Crop;
#[cfg(doc)]
use crate::shader::generated::Fault;
use crate::shader::generated::StopReason;
use run_means::RunMeans;
pub(crate) use run_means::{RUNS, runs};
use serde::{Deserialize, Serialize};
use sums::Sums;

/// One value for every pixel of a window, row by row.
type PixelSums<T> = Vec<T>;

/// Luminance below this share of the picture's mean does not make an error count more.
pub(crate) const ERROR_FLOOR: f64 = 0.01;

/// The sums of one render.
#[derive(Debug, Clone)]
pub struct Film {
    window: Crop,
    /// Samples of the smallest whole block.
    unit: u32,
    /// Of the render, if its pixels take as many each.
    samples: Option<SampleRange>,
    /// Samples of a segment of the sums.
    segment: u32,
    sums: Sums,
    sample_count: Vec<u32>,
    means: RunMeans,
    stops: Option<Vec<PixelStop>>,
    /// Samples at fault of every pixel, by cause; `None` while there are none.
    faults: Option<Vec<[u32; 4]>>,
}

/// Consecutive samples of a render in which every pixel takes as many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SampleRange {
    /// Samples of the whole render.
    pub total: u32,
    /// First of these: a multiple of [`Self::segment`].
    pub first: u32,
    /// One after the last: `total`, or a multiple of [`Self::segment`].
    pub end: u32,
}

impl SampleRange {
    /// All samples.
    pub fn whole(total: u32) -> Self {
        Self { total, first: 0, end: total }
    }

    /// Samples of a segment, in blocks of `unit`: the shortest part whose sums are kept apart. There
    /// are 8 to 15 of them, or as many as there are blocks, and less than one at the end.
    pub fn segment(&self, unit: u32) -> u32 {
        runs(self.total / unit).0 * unit
    }

    /// Whether it is a part of `total` samples in blocks of `unit` that begins and ends with a segment.
    pub fn fits(&self, total: u32, unit: u32) -> bool {
        let segment = self.segment(unit);
        self.total == total
            && self.first < self.end
            && self.end <= total
            && self.first.is_multiple_of(segment)
            && (self.end == total || self.end.is_multiple_of(segment))
    }

    /// Part `index` of `count` of the whole, in whole segments; `None` if there are fewer segments.
    pub fn part(&self, unit: u32, index: u32, count: u32) -> Option<Self> {
        let segment = self.segment(unit);
        let segments = self.total.div_ceil(segment);
        let at = |i: u32| {
            let first = (u64::from(segments) * u64::from(i) / u64::from(count)) as u32;
            first.saturating_mul(segment).min(self.total)
        };
        (count <= segments).then(|| Self { first: at(index), end: at(index + 1), ..*self })
    }
}

/// Why a pixel of an adaptive render has no more samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelStop {
    /// What ended it.
    pub reason: StopReason,
    /// Half-width of the rule's interval of its mean luminance, W/(sr m²); infinite where it was
    /// never judged.
    pub half_width: f32,
}

/// What a pixel gained in one block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockMean {
    /// Mean of the samples' radiance.
    pub mean: [f64; 3],
    /// Samples in it.
    pub sample_count: u32,
}

/// How far a picture is from converged, by its own samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// Mean over pixels of variance / (mean² + ε) of the luminance, with
    /// ε = (0.01 × mean luminance of the picture)².
    pub relmse: f64,
    /// Mean luminance of the picture.
    pub mean_luminance: f64,
}

fn luminance(c: [f64; 3]) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

impl Film {
    /// An empty film for a window of pixels, and for any number of samples. `unit`: samples of the
    /// smallest whole block.
    pub fn new(window: Crop, unit: u32) -> Self {
        Self::with(window, unit, None)
    }

    /// An empty film for some of the samples of a render.
    pub fn of_samples(window: Crop, unit: u32, samples: &SampleRange) -> Self {
        Self::with(window, unit, Some(*samples))
    }

    fn with(window: Crop, unit: u32, samples: Option<SampleRange>) -> Self {
        let count = window.width as usize * window.height as usize;
        let is_part = samples.is_some_and(|range| range != SampleRange::whole(range.total));
        let is_later = samples.is_some_and(|range| range.first > 0);
        let segment = samples.map_or(u32::MAX, |range| range.segment(unit));
        Self {
            window,
            unit,
            samples,
            segment,
            sums: Sums::new(count, samples.is_some(), is_later),
            sample_count: vec![0; count],
            means: RunMeans::new(count, is_part.then_some(segment / unit)),
            stops: None,
            faults: None,
        }
    }

    /// The pixels that it covers.
    pub fn window(&self) -> Crop {
        self.window
    }

    /// Folds the block of the pixel in column `x` and row `y` of the window. Blocks of
    /// a pixel come in sample order. A block of whole units counts for the variance; any other
    /// is its pixel's last.
    pub fn add_block(&mut self, x: u32, y: u32, block: BlockMean) {
        if block.sample_count == 0 {
            return;
        }
        let i = y as usize * self.window.width as usize + x as usize;
        let n = f64::from(block.sample_count);
        self.sums.add(i, block.mean.map(|m| m * n));
        self.sample_count[i] += block.sample_count;
        if block.sample_count.is_multiple_of(self.unit) {
            self.means.add(i, luminance(block.mean), block.sample_count / self.unit);
        }
        // All blocks but the last are whole: segments end where units do.
        if self.sample_count[i].is_multiple_of(self.segment) {
            self.sums.end_segment(i, (self.sample_count[i] / self.segment) as usize - 1);
        }
    }

    /// Units of a segment.
    fn segment_units(&self) -> u32 {
        self.segment / self.unit
    }

    /// Mean radiance of a pixel by its index in the window; 0 without samples.
    fn mean(&self, i: usize) -> [f64; 3] {
        let n = f64::from(self.sample_count[i].max(1));
        self.sums.of(i).map(|s| s / n)
    }

    /// Mean luminance of all pixels.
    pub fn mean_luminance(&self) -> f64 {
        let sum: f64 = (0..self.sample_count.len()).map(|i| luminance(self.mean(i))).sum();
        sum / self.sample_count.len() as f64
    }

    /// How every pixel of an adaptive render ended.
    pub(crate) fn set_stops(&mut self, stops: Vec<PixelStop>) {
        self.stops = Some(stops);
    }

    /// How every pixel ended, row by row; `None` where all have as many samples.
    pub fn stops(&self) -> Option<&[PixelStop]> {
        self.stops.as_deref()
    }

    /// Adds samples at fault of a pixel, in the order of [`Fault::ALL`].
    pub fn add_faults(&mut self, x: u32, y: u32, counts: [u32; 4]) {
        if counts == [0; 4] {
            return;
        }
        let i = y as usize * self.window.width as usize + x as usize;
        let faults = self.faults.get_or_insert_with(|| vec![[0; 4]; self.sample_count.len()]);
        for (total, count) in faults[i].iter_mut().zip(counts) {
            *total += count;
        }
    }

    /// Samples at fault of every pixel, in the order of [`Fault::ALL`]; `None` where no sample is.
    pub fn faults(&self) -> Option<&[[u32; 4]]> {
        self.faults.as_deref()
    }

    /// Mean radiance of every pixel.
    pub fn picture(&self) -> Picture {
        let rgb = (0..self.sample_count.len()).map(|i| self.mean(i).map(|c| c as f32)).collect();
        Picture::new(self.window.width, self.window.height, rgb)
    }

    /// The picture and the samples of every pixel once `blocks`, by column and row, are added.
    pub(crate) fn picture_with(
        &self,
        blocks: impl Iterator<Item = ((u32, u32), BlockMean)>,
    ) -> (Picture, Vec<u32>) {
        let mut picture = self.picture();
        let mut counts = self.sample_count.clone();
        for ((x, y), block) in blocks {
            let i = y as usize * self.window.width as usize + x as usize;
            counts[i] += block.sample_count;
            let n = f64::from(counts[i].max(1));
            let sum = self.sums.of(i);
            picture.rgb[i] = std::array::from_fn(|c| {
                ((sum[c] + block.mean[c] * f64::from(block.sample_count)) / n) as f32
            });
        }
        (picture, counts)
    }

    /// Samples of the pixel that has fewest.
    pub fn least_samples(&self) -> u32 {
        self.sample_count.iter().copied().min().unwrap_or(0)
    }

    /// Samples of the pixel that has most.
    pub fn most_samples(&self) -> u32 {
        self.sample_count.iter().copied().max().unwrap_or(0)
    }

    /// Samples of every pixel.
    pub fn sample_counts(&self) -> &[u32] {
        &self.sample_count
    }

    /// Standard error of every pixel's mean luminance, from the spread of the means of
    /// 8 to 15 consecutive runs of its samples (fewer at the beginning). `None`
    /// before there are two.
    pub fn standard_error(&self) -> Option<Vec<f32>> {
        let pixels = 0..self.sample_count.len();
        pixels.map(|i| self.means.variance_of_mean(i)).map(|v| v.map(|v| v.sqrt() as f32)).collect()
    }

    /// The picture's error by its own samples. `None` before there are two whole blocks.
    pub fn estimated_error(&self) -> Option<ErrorEstimate> {
        let n = self.sample_count.len() as f64;
        let mean_luminance = self.mean_luminance();
        let floor = (ERROR_FLOOR * mean_luminance).powi(2);
        let mut relmse = 0.0;
        for i in 0..self.sample_count.len() {
            let v = self.means.variance_of_mean(i)?;
            if v > 0.0 {
                relmse += v / (luminance(self.mean(i)).powi(2) + floor);
            }
        }
        Some(ErrorEstimate { relmse: relmse / n, mean_luminance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Crop = Crop { x: 0, y: 0, width: 1, height: 1 };

    fn block(value: f32, n: u32) -> BlockMean {
        BlockMean { mean: [f64::from(value); 3], sample_count: n }
    }

    #[test]
    fn a_constant_pixel_stays_exact() {
        for value in [0.1_f32, 12.5, 1e4, 1e-4] {
            let mut film = Film::new(WINDOW, 16);
            for _ in 0..62_500 {
                film.add_block(0, 0, block(value, 16));
            }
            let mean = film.picture().rgb[0][0];
            assert!((mean - value).abs() <= 2.0 * value * f32::EPSILON, "{value}: {mean}");
            assert_eq!(film.standard_error().unwrap(), [0.0]);
            assert_eq!(film.most_samples(), 1_000_000);
        }
    }

    /// With independent blocks s²/R is unbiased: its mean over many pixels is the
    /// true variance of their means within 4 standard errors.
    #[test]
    fn the_standard_error_is_that_of_the_mean() {
        let window = Crop { width: 64, height: 64, ..WINDOW };
        let mut film = Film::new(window, 1);
        let mut state = 1_u32;
        let mut uniform = move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
            (word >> 22 ^ word) as f32 / u32::MAX as f32
        };
        let rounds = 40;
        for _ in 0..rounds {
            for i in 0..64 * 64 {
                film.add_block(i % 64, i / 64, block(uniform(), 1));
            }
        }
        // 40 blocks: ten observations of four blocks each.
        let expected = 1.0 / 12.0 / f64::from(rounds);
        let se = film.standard_error().unwrap();
        let n = se.len() as f64;
        let mean = se.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>() / n;
        // The variance of s² of ten normal observations is 2/9 of its square.
        let spread = expected * (2.0 / 9.0_f64).sqrt() / n.sqrt();
        assert!((mean - expected).abs() < 4.0 * spread, "{mean} {expected} {spread}");
    }

    #[test]
    fn one_block_gives_no_error() {
        let mut film = Film::new(WINDOW, 16);
        film.add_block(0, 0, block(1.0, 16));
        assert_eq!(film.estimated_error(), None);
        film.add_block(0, 0, block(1.0, 4));
        assert_eq!(film.estimated_error(), None);
        assert_eq!(film.least_samples(), 20);
    }
}
