//! The picture that errors are measured against, with its own variance.

use crate::image::Picture;
use crate::statistics::{Estimate, Welch};

/// Share of the mean luminance that keeps black pixels from counting without bound.
const FLOOR: f64 = 0.01;

/// Sums of pictures of equal weight and different seeds.
#[derive(Debug, Clone)]
pub struct ReferenceParts {
    size: (u32, u32),
    sums: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
    /// Mean luminance of each.
    luminances: Vec<f64>,
}

/// A picture to measure against, linear radiance.
#[derive(Debug, Clone)]
pub struct Reference {
    pub(super) size: (u32, u32),
    pub(super) rgb: Vec<[f64; 3]>,
    /// Variance of `rgb`; `None` where it is not known.
    variance: Option<Vec<[f64; 3]>>,
    /// ε of relMSE: (0.01 × mean luminance)².
    pub epsilon: f64,
    luminances: Vec<f64>,
}

/// How far two references of one scene are from each other.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Difference {
    /// Mean luminance of the second over that of the first, less 1.
    pub mean: f64,
    /// The same in standard errors, from the spread of the parts; NaN where either is one file.
    pub mean_in_standard_errors: f64,
    /// Mean over pixels and channels of the squared difference over r² + ε, both variances taken
    /// off: 0 in the mean where both estimate the same picture.
    pub relmse: f64,
    /// Standard error of `relmse` from noise alone, as if the noise were normal.
    pub relmse_standard_error: f64,
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn mean_luminance(rgb: impl ExactSizeIterator<Item = [f64; 3]>) -> f64 {
    let n = rgb.len() as f64;
    rgb.map(luminance).sum::<f64>() / n
}

impl ReferenceParts {
    /// None yet, of pictures of so many columns and rows.
    pub fn new(size: (u32, u32)) -> Self {
        let zeros = vec![[0.0; 3]; size.0 as usize * size.1 as usize];
        Self { size, sums: zeros.clone(), squares: zeros, luminances: Vec::new() }
    }

    /// Adds a part.
    ///
    /// # Panics
    /// If its size is another.
    pub fn add(&mut self, part: &Picture) {
        assert_eq!((part.width, part.height), self.size, "size of a part");
        for (i, pixel) in part.rgb.iter().enumerate() {
            for (c, value) in pixel.iter().map(|&v| f64::from(v)).enumerate() {
                self.sums[i][c] += value;
                self.squares[i][c] += value * value;
            }
        }
        self.luminances.push(mean_luminance(part.rgb.iter().map(|p| p.map(f64::from))));
    }

    /// Their mean, whose variance is that of the parts over their number.
    ///
    /// # Panics
    /// With fewer than two parts.
    pub fn mean(&self) -> Reference {
        let n = self.luminances.len() as f64;
        assert!(n > 1.0, "one part has no spread");
        let rgb: Vec<_> = self.sums.iter().map(|s| s.map(|s| s / n)).collect();
        let of = |(m, q): (&[f64; 3], &[f64; 3])| {
            std::array::from_fn(|c| ((q[c] / n - m[c] * m[c]) / (n - 1.0)).max(0.0))
        };
        let variance = Some(rgb.iter().zip(&self.squares).map(of).collect());
        Reference::new(self.size, rgb, variance, self.luminances.clone())
    }
}

impl Reference {
    fn new(
        size: (u32, u32),
        rgb: Vec<[f64; 3]>,
        variance: Option<Vec<[f64; 3]>>,
        luminances: Vec<f64>,
    ) -> Self {
        let epsilon = (FLOOR * mean_luminance(rgb.iter().copied())).powi(2);
        Self { size, rgb, variance, epsilon, luminances }
    }

    /// A picture of a file. `standard_error`: of every pixel's luminance, where the file has it; the
    /// channels are taken to have that of the luminance relative to it.
    ///
    /// # Panics
    /// If there are not as many standard errors as pixels.
    pub fn of_file(picture: &Picture, standard_error: Option<&[f32]>) -> Self {
        let rgb: Vec<_> = picture.rgb.iter().map(|p| p.map(f64::from)).collect();
        let variance = standard_error.map(|errors| {
            assert_eq!(errors.len(), rgb.len(), "standard errors of pixels");
            let of = |(p, &e): (&[f64; 3], &f32)| match luminance(*p) {
                y if y > 0.0 => p.map(|c| (c / y * f64::from(e)).powi(2)),
                _ => [f64::from(e).powi(2); 3],
            };
            rgb.iter().zip(errors).map(of).collect()
        });
        Self::new((picture.width, picture.height), rgb, variance, Vec::new())
    }

    /// Columns and rows.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// What its own variance adds to the relMSE of any independent picture; `None` where it is not
    /// known.
    pub fn relmse(&self) -> Option<f64> {
        let variance = self.variance.as_ref()?;
        let values = self.rgb.iter().flatten().zip(variance.iter().flatten());
        let sum: f64 = values.map(|(r, v)| v / (r * r + self.epsilon)).sum();
        Some(sum / (3 * self.rgb.len()) as f64)
    }

    /// To another of the same scene and size. `None` where a variance is not known or a size
    /// differs.
    pub fn difference(&self, other: &Self) -> Option<Difference> {
        if self.size != other.size {
            return None;
        }
        let (a, b) = (self.variance.as_ref()?, other.variance.as_ref()?);
        let (mut sum, mut noise) = (0.0, 0.0);
        for i in 0..self.rgb.len() {
            // Noise of a pixel's channels is taken to be the same noise.
            let mut of_pixel = 0.0;
            for c in 0..3 {
                let scale = self.rgb[i][c].powi(2) + self.epsilon;
                let variance = a[i][c] + b[i][c];
                if scale > 0.0 {
                    sum += ((self.rgb[i][c] - other.rgb[i][c]).powi(2) - variance) / scale;
                    of_pixel += variance / scale;
                }
            }
            noise += 2.0 * of_pixel * of_pixel;
        }
        let values = (3 * self.rgb.len()) as f64;
        let means = [self, other].map(|r| mean_luminance(r.rgb.iter().copied()));
        let has_spread = [self, other].iter().all(|r| r.luminances.len() > 1);
        let z = has_spread.then(|| {
            let parts = [self, other].map(|r| Estimate::of(&r.luminances));
            let variances = parts.map(|e| (e.standard_error.powi(2), e.count as f64 - 1.0));
            Welch::new(means[1] - means[0], variances.into_iter()).z()
        });
        Some(Difference {
            mean: means[1] / means[0] - 1.0,
            mean_in_standard_errors: z.unwrap_or(f64::NAN),
            relmse: sum / values,
            relmse_standard_error: noise.sqrt() / values,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::PictureErrors;
    use super::super::resample::tests::normal;
    use super::*;

    const SIZE: (u32, u32) = (64, 64);

    /// Radiance from 0.5 to 1.5 with noise of a standard deviation of `spread` of it.
    fn noisy(draw: &mut impl FnMut() -> f64, spread: f64, scale: f64) -> Picture {
        let of = |i: usize| {
            let truth = scale * (0.5 + (i % 97) as f64 / 96.0);
            [0, 1, 2].map(|_| (truth * (1.0 + spread * draw())) as f32)
        };
        Picture::new(SIZE.0, SIZE.1, (0..64 * 64).map(of).collect())
    }

    fn reference(seed: u64, spread: f64, scale: f64) -> Reference {
        let mut draw = normal(seed);
        let mut parts = ReferenceParts::new(SIZE);
        for _ in 0..16 {
            parts.add(&noisy(&mut draw, spread, scale));
        }
        parts.mean()
    }

    /// Noise of 0.2 in each of 16 parts adds 0.2² / 16 to every error; what is left is the
    /// picture's own, 0.1². The tolerances are four standard errors over 12,288 values.
    #[test]
    fn its_own_variance_is_known_and_taken_off() {
        let reference = reference(1, 0.2, 1.0);
        let own = reference.relmse().unwrap();
        let expected = 0.2 * 0.2 / 16.0;
        let width = 4.0 * (2.0 / (15.0 * 12_288.0_f64)).sqrt();
        assert!((own / expected - 1.0).abs() < width + 1e-3, "{own} {expected}");
        let mut draw = normal(2);
        let errors = PictureErrors::of(&noisy(&mut draw, 0.1, 1.0), &reference);
        let truth = 0.1 * 0.1;
        let width = 4.0 * (2.0 / 12_288.0_f64).sqrt() * (1.0 + expected / truth);
        assert!((errors.relmse / truth - 1.0).abs() < width + 1e-3, "{errors:?}");
        assert!((errors.raw - errors.relmse - own).abs() < 1e-12);
    }

    #[test]
    fn references_of_one_picture_agree_and_others_do_not() {
        let first = reference(1, 0.2, 1.0);
        let same = first.difference(&reference(2, 0.3, 1.0)).unwrap();
        assert!(same.mean_in_standard_errors.abs() < 3.9, "{same:?}");
        assert!(same.relmse.abs() < 3.9 * same.relmse_standard_error, "{same:?}");
        let other = first.difference(&reference(3, 0.3, 1.01)).unwrap();
        assert!(other.mean_in_standard_errors > 3.9, "{other:?}");
        let far = first.difference(&reference(3, 0.3, 1.1)).unwrap();
        assert!((far.relmse / 0.01 - 1.0).abs() < 0.2, "{far:?}");
        assert!(far.relmse > 3.9 * far.relmse_standard_error, "{far:?}");
    }

    #[test]
    fn a_file_may_know_its_error() {
        let picture = noisy(&mut normal(1), 0.0, 1.0);
        assert_eq!(Reference::of_file(&picture, None).relmse(), None);
        let errors: Vec<f32> = picture.rgb.iter().map(|p| 0.1 * p[0]).collect();
        let own = Reference::of_file(&picture, Some(&errors)).relmse().unwrap();
        assert!((own / 0.01 - 1.0).abs() < 1e-3, "{own}");
    }
}
