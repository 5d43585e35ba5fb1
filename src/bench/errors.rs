//! A picture's errors against a reference.

use super::Reference;
use crate::image::Picture;
use serde::Serialize;

/// Share of the pixels that the trimmed error leaves out.
const TRIMMED: f64 = 0.001;
/// Added to the reference in the form that pbrt uses.
const OFFSET: f64 = 0.01;

/// Errors of one picture, linear radiance, means over pixels and channels. A value that is not
/// finite makes all of them NaN.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PictureErrors {
    /// (x - r)² / (r² + ε), less what the reference's own variance adds, where that is known.
    pub relmse: f64,
    /// The same with the reference's variance in it.
    pub raw: f64,
    /// `raw` without the worst 0.1 % of the pixels.
    pub trimmed: f64,
    /// Share of `raw` that those have.
    pub removed: f64,
    /// (x - r)² / (r + 0.01)².
    pub offset: f64,
}

impl PictureErrors {
    /// Of `picture`.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn of(picture: &Picture, reference: &Reference) -> Self {
        assert_eq!((picture.width, picture.height), reference.size, "pictures of different sizes");
        let mut pixels = Vec::with_capacity(picture.rgb.len());
        let mut offset = 0.0;
        for (x, r) in picture.rgb.iter().zip(&reference.rgb) {
            let mut of_pixel = 0.0;
            for (x, r) in x.iter().map(|&x| f64::from(x)).zip(r) {
                let square = (x - r).powi(2);
                // Equal values do not count, also where the whole reference is black. NaN does.
                if square != 0.0 {
                    of_pixel += square / (r * r + reference.epsilon);
                    offset += square / (r + OFFSET).powi(2);
                }
            }
            pixels.push(of_pixel);
        }
        let values = (3 * pixels.len()) as f64;
        let sum: f64 = pixels.iter().sum();
        if !(sum.is_finite() && offset.is_finite()) {
            let none = f64::NAN;
            return Self { relmse: none, raw: none, trimmed: none, removed: none, offset: none };
        }
        pixels.sort_by(f64::total_cmp);
        let kept = pixels.len() - (TRIMMED * pixels.len() as f64).ceil() as usize;
        let rest: f64 = pixels[..kept].iter().sum();
        let raw = sum / values;
        Self {
            relmse: raw - reference.relmse().unwrap_or(0.0),
            raw,
            trimmed: rest / (3 * kept.max(1)) as f64,
            removed: if sum > 0.0 { 1.0 - rest / sum } else { 0.0 },
            offset: offset / values,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Picture {
        Picture::new(values.len() as u32, 1, values.iter().map(|&v| [v; 3]).collect())
    }

    #[test]
    fn errors_have_their_definitions() {
        let reference = Reference::of_file(&grey(&[1.0, 3.0]), None);
        assert!((reference.epsilon - 4e-4).abs() < 1e-12);
        let errors = PictureErrors::of(&grey(&[2.0, 3.0]), &reference);
        assert!((errors.raw - 0.5 / (1.0 + 4e-4)).abs() < 1e-9, "{errors:?}");
        assert!((errors.offset - 0.5 / 1.0201).abs() < 1e-6, "{errors:?}");
        // One pixel of two is the worst 0.1 %, rounded up.
        assert_eq!((errors.trimmed, errors.removed, errors.relmse), (0.0, 1.0, errors.raw));
        let same = PictureErrors::of(&grey(&[1.0, 3.0]), &reference);
        assert_eq!((same.raw, same.offset, same.removed), (0.0, 0.0, 0.0));
        let public = crate::image::compare::relmse(&grey(&[2.0, 3.0]), &grey(&[1.0, 3.0]));
        assert!((public.value - errors.raw).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_finite_fails() {
        let reference = Reference::of_file(&grey(&[1.0, 3.0]), None);
        for bad in [f32::NAN, f32::INFINITY] {
            let errors = PictureErrors::of(&grey(&[bad, 3.0]), &reference);
            assert!(errors.relmse.is_nan() && errors.trimmed.is_nan(), "{errors:?}");
        }
        let black = Reference::of_file(&grey(&[0.0, 0.0]), None);
        assert_eq!(PictureErrors::of(&grey(&[0.0, 0.0]), &black).raw, 0.0);
    }
}
