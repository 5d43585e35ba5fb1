//! How far a picture is from another, as one number.

use crate::image::Picture;

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
    let epsilon = (0.01 * mean).powi(2);
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
