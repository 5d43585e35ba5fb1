//! How far a picture is from another, in numbers.

use super::flip::{Flip, FlipExposures};
use crate::image::Picture;

/// Share of the mean luminance that keeps black pixels from counting without bound.
const FLOOR: f64 = 0.01;

/// Mean over pixels and channels of (a - b)²; linear radiance squared. Not finite when a
/// pixel is not.
///
/// # Panics
/// If the sizes differ.
pub fn mse(a: &Picture, b: &Picture) -> f64 {
    mean_over_channels(a, b, |a, b| (a - b).powi(2))
}

/// The relative error of a picture, with the floor that was used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelMse {
    /// Mean over pixels and channels of (x - r)² / (r² + ε).
    pub value: f64,
    /// ε = (0.01 × mean luminance of the reference)²: keeps black pixels from counting
    /// without bound.
    pub epsilon: f64,
}

/// Relative mean squared error of `picture`. Not finite when a pixel of either is not.
///
/// # Panics
/// If the sizes differ.
pub fn relmse(picture: &Picture, reference: &Picture) -> RelMse {
    let luminance = |c: &[f32; 3]| {
        let [r, g, b] = c.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let mean = reference.rgb.iter().map(luminance).sum::<f64>() / reference.rgb.len() as f64;
    let epsilon = (FLOOR * mean).powi(2);
    // Pixels that are equal do not count, also where the reference is black.
    let term = |x: f64, r: f64| if x == r { 0.0 } else { (x - r).powi(2) / (r * r + epsilon) };
    RelMse { value: mean_over_channels(picture, reference, term), epsilon }
}

fn mean_over_channels(a: &Picture, b: &Picture, term: impl Fn(f64, f64) -> f64) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height), "pictures of different sizes");
    let pairs = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    let sum: f64 = pairs.map(|(&a, &b)| term(f64::from(a), f64::from(b))).sum();
    sum / (3 * a.rgb.len()) as f64
}

/// Names of FLIP's mean, 95th percentile and maximum.
pub(super) const FLIP: [&str; 3] = ["flip.mean", "flip.p95", "flip.max"];

/// The same for linear radiance.
pub(super) const HDR_FLIP: [&str; 3] = ["hdrflip.mean", "hdrflip.p95", "hdrflip.max"];

/// Share of the pixels that the trimmed relMSE leaves out.
const TRIMMED: f64 = 0.001;

/// Percentiles of the absolute difference that are given.
const PERCENTILES: [(&str, f64); 4] =
    [("error.p50", 0.5), ("error.p95", 0.95), ("error.p99", 0.99), ("error.p99.9", 0.999)];

/// Named errors of one layer, in the order in which they are shown. All are 0 for equal pictures,
/// and not a number where a value of either picture is not finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    values: Vec<(&'static str, f64)>,
    /// ε of `relmse` and, its root, of `smape`.
    pub epsilon: f64,
    /// Exposures of `hdrflip`.
    pub exposures: Option<FlipExposures>,
}

impl Metrics {
    /// Errors of `actual`; both have the same channels, `luminance` gives their weights in
    /// the mean that ε is taken from.
    pub(super) fn of(actual: &[&[f32]], expected: &[&[f32]], luminance: &[f64]) -> Self {
        let pixels = expected[0].len();
        let values = (pixels * expected.len()) as f64;
        let at = |planes: &[&[f32]], c: usize, i: usize| f64::from(planes[c][i]);
        let pairs =
            |i: usize| (0..expected.len()).map(move |c| (at(actual, c, i), at(expected, c, i)));
        let mean = (0..pixels).flat_map(|i| {
            luminance.iter().enumerate().map(move |(c, w)| w * at(expected, c, i).abs())
        });
        let mean = mean.sum::<f64>() / pixels as f64;
        let floor = FLOOR * mean;
        let epsilon = floor * floor;
        // Equal values do not count, also where both are 0 and so is ε.
        let ratio = |error: f64, scale: f64| if error == 0.0 { 0.0 } else { error / scale };
        let mut squares = 0.0;
        let mut absolute = 0.0;
        let mut symmetric = 0.0;
        let mut relative = Vec::with_capacity(pixels);
        let mut largest = Vec::with_capacity(pixels);
        let mut different = 0;
        for i in 0..pixels {
            let mut of_pixel = 0.0;
            let mut most = 0.0_f64;
            for (x, r) in pairs(i) {
                let error = (x - r).abs();
                squares += error * error;
                absolute += error;
                symmetric += ratio(error, x.abs() + r.abs() + floor);
                of_pixel += ratio(error * error, r * r + epsilon);
                most = if error > most || error.is_nan() { error } else { most };
            }
            relative.push(of_pixel);
            largest.push(most);
            different += usize::from(most != 0.0);
        }
        relative.sort_by(f64::total_cmp);
        largest.sort_by(f64::total_cmp);
        let kept = pixels - (TRIMMED * pixels as f64).ceil() as usize;
        let trimmed = relative[..kept].iter().sum::<f64>() / (kept * expected.len()).max(1) as f64;
        let mut list = vec![
            ("mse", squares / values),
            ("rmse", (squares / values).sqrt()),
            ("mae", absolute / values),
            ("relmse", relative.iter().sum::<f64>() / values),
            ("relmse.trimmed", trimmed),
            ("smape", symmetric / values),
            ("error.max", largest[pixels - 1]),
        ];
        list.extend(PERCENTILES.map(|(name, share)| (name, largest[rank(pixels, share)])));
        list.push(("different", different as f64 / pixels as f64));
        Self { values: list, epsilon, exposures: None }
    }

    /// Adds the mean, 95th percentile and maximum of a FLIP map.
    pub(super) fn add_flip(&mut self, flip: &Flip) {
        let names = if flip.exposures.is_some() { HDR_FLIP } else { FLIP };
        self.exposures = flip.exposures.or(self.exposures);
        self.values.extend(names.into_iter().zip(flip.statistics()));
    }

    /// The same metrics of pictures with a value that is not finite: none is a number. `flips`:
    /// those of FLIP that the pictures would have.
    pub(super) fn failed(mut self, flips: &[[&'static str; 3]]) -> Self {
        self.values.extend(flips.iter().flatten().map(|name| (*name, f64::NAN)));
        self.values.iter_mut().for_each(|(_, value)| *value = f64::NAN);
        self
    }

    /// The metric of a name; `None` if it does not exist for this layer.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(n, _)| *n == name).map(|(_, value)| *value)
    }

    /// Names and values.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        self.values.iter().copied()
    }
}

/// Index in ascending order of the value that `share` of all do not exceed.
pub(super) fn rank(count: usize, share: f64) -> usize {
    ((share * count as f64).ceil() as usize).clamp(1, count) - 1
}
