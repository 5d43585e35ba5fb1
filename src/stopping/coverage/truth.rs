//! What a picture converges to, and how well that is known.

use crate::film::Film;
use crate::statistics::Estimate;

/// Share of the picture's mean below which luminance counts as that much.
pub(super) const FLOOR: f64 = 0.01;

/// Luminance of every pixel of a picture, W/(sr m²).
pub(super) fn luminance(film: &Film) -> Vec<f64> {
    let of = |c: &[f32; 3]| {
        let [r, g, b] = c.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    film.picture().rgb.iter().map(of).collect()
}

pub(super) fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

/// What every pixel converges to, from independent streams of equal length.
pub struct Truth {
    /// Sums of the luminance of each stream.
    streams: Vec<Vec<f64>>,
    /// Samples of a pixel in one stream.
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

    /// Mean luminance and standard error of every pixel.
    pub fn estimates(&self) -> Vec<Estimate> {
        let of = |i: usize| self.streams.iter().map(|s| s[i] / self.samples).collect::<Vec<_>>();
        (0..self.streams[0].len()).map(|i| Estimate::of(&of(i))).collect()
    }

    /// Mean luminance of the picture.
    pub fn picture_mean(&self) -> Estimate {
        let of = |stream: &Vec<f64>| mean(stream.iter().copied()) / self.samples;
        Estimate::of(&self.streams.iter().map(of).collect::<Vec<_>>())
    }

    /// Share of the pixels whose standard error is at most `tolerance` of their mean, or of
    /// the hundredth part of the picture's.
    pub fn resolved(&self, tolerance: f64) -> f64 {
        let floor = FLOOR * self.picture_mean().mean;
        let estimates = self.estimates();
        let is_known = |e: &&Estimate| e.standard_error <= tolerance * e.mean.max(floor);
        estimates.iter().filter(is_known).count() as f64 / estimates.len() as f64
    }
}
