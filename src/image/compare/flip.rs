//! FLIP, the difference that a viewer sees who flips between two pictures (Andersson et al. 2020;
//! for linear radiance 2021), by the crate `flip-rs`. `tools/check_flip.py` compares it with NVIDIA's
//! own package.

use crate::image::{Picture, srgb_from_linear};
use flip_rs::{DEFAULT_PPD, FlipError, HdrOptions, MAGMA, RgbImage};

/// A map of FLIP errors, 0 (none) to 1, one for each pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// Row by row from the top.
    pub map: Vec<f32>,
    /// The exposures that were looked at, of linear pictures.
    pub exposures: Option<FlipExposures>,
}

/// The exposures of FLIP for linear pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlipExposures {
    /// Stops of the first.
    pub start: f32,
    /// Stops of the last.
    pub stop: f32,
    /// How many, equally spaced.
    pub count: usize,
}

/// FLIP of what a display shows: linear values are clipped to [0, 1] and encoded as sRGB. The
/// viewer is as far away as the reference implementation assumes (67 pixels per degree).
///
/// # Panics
/// If sizes differ, a picture is empty, or a value is not finite.
pub fn ldr_flip(actual: &Picture, expected: &Picture) -> Flip {
    let encode = |v: f32| srgb_from_linear(v.clamp(0.0, 1.0));
    let [actual, expected] = [actual, expected].map(|p| image(p, encode));
    let map = flip_rs::ldr_flip(&expected, &actual, DEFAULT_PPD).expect("pictures of one size");
    Flip { map: map.into_pixels(), exposures: None }
}

/// FLIP of linear radiance: the largest error over the exposures that suit `expected`.
///
/// # Panics
/// If sizes differ, a picture is empty, or a value is not finite.
pub fn hdr_flip(actual: &Picture, expected: &Picture) -> Flip {
    let [actual, expected] = [actual, expected].map(|p| image(p, |v| v));
    let mut options = HdrOptions::default();
    options.return_exposure_map = false;
    let result = flip_rs::hdr_flip(&expected, &actual, options);
    let result = result.or_else(|_| {
        // No exposure suits a black picture, and none a range beyond the limit on their number.
        options.start_exposure = Some(0.0);
        options.stop_exposure = Some(0.0);
        options.num_exposures = Some(2);
        flip_rs::hdr_flip(&expected, &actual, options)
    });
    let result = result.expect("pictures of one size");
    let used = result.parameters;
    let exposures = FlipExposures {
        start: used.start_exposure,
        stop: used.stop_exposure,
        count: used.num_exposures,
    };
    Flip { map: result.error_map.into_pixels(), exposures: Some(exposures) }
}

/// Values of a map in [0, 1] as indices into [`magma`].
pub(super) fn magma_bytes(map: &[f32]) -> Vec<u8> {
    map.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8).collect()
}

/// The colours that FLIP is usually shown in, from 0 to 1, sRGB with 8 bits.
pub fn magma() -> [[u8; 3]; 256] {
    MAGMA.map(|color| color.map(|c| (c * 255.0 + 0.5) as u8))
}

impl Flip {
    /// Mean, 95th percentile and maximum over pixels.
    pub(super) fn statistics(&self) -> [f64; 3] {
        let mean = self.map.iter().map(|&v| f64::from(v)).sum::<f64>() / self.map.len() as f64;
        let mut sorted = self.map.clone();
        sorted.sort_by(f32::total_cmp);
        let at = |share| f64::from(sorted[super::metrics::rank(sorted.len(), share)]);
        [mean, at(0.95), at(1.0)]
    }
}

fn image(picture: &Picture, encode: impl Fn(f32) -> f32) -> RgbImage<f32> {
    let values = picture.rgb.iter().flatten().map(|&v| encode(v)).collect();
    let image: Result<_, FlipError> =
        RgbImage::new(picture.width as usize, picture.height as usize, values);
    image.expect("a picture that is not empty")
}
