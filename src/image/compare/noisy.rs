//! Pictures that know how uncertain they are.

use super::noise::LUMINANCE;
use crate::image::Picture;

/// Mean of independent runs, with the variance of that mean in every pixel and channel.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisyPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Mean radiance, row by row from the top.
    pub mean: Vec<[f64; 3]>,
    /// Estimated variance of `mean`.
    pub variance: Vec<[f64; 3]>,
    /// Runs that the variance was estimated from, at least 2.
    pub runs: usize,
}

impl NoisyPicture {
    /// From pictures of one size, rendered independently.
    ///
    /// # Panics
    /// With fewer than two, or of different sizes.
    pub fn of_runs(runs: &[Picture]) -> Self {
        let [first, _, ..] = runs else { panic!("the spread of fewer than two runs") };
        let (width, height) = (first.width, first.height);
        let same_size = |p: &Picture| (p.width, p.height) == (width, height);
        assert!(runs.iter().all(same_size), "runs of different sizes");
        let n = runs.len() as f64;
        let value = |run: &Picture, i: usize, c: usize| f64::from(run.rgb[i][c]);
        let (mut mean, mut variance) = (Vec::new(), Vec::new());
        for i in 0..first.rgb.len() {
            let m = [0, 1, 2].map(|c| runs.iter().map(|r| value(r, i, c)).sum::<f64>() / n);
            variance.push([0, 1, 2].map(|c| {
                let squares = runs.iter().map(|r| (value(r, i, c) - m[c]).powi(2));
                squares.sum::<f64>() / (n - 1.0) / n
            }));
            mean.push(m);
        }
        Self { width, height, mean, variance, runs: runs.len() }
    }

    /// From a stored mean and the variance of it, which came from `runs` runs.
    ///
    /// # Panics
    /// If the sizes differ, a variance is negative, or there are fewer than two runs.
    pub fn from_moments(mean: &Picture, variance: &Picture, runs: usize) -> Self {
        let (width, height) = (mean.width, mean.height);
        assert_eq!((width, height), (variance.width, variance.height), "sizes");
        assert!(variance.rgb.iter().flatten().all(|&v| v >= 0.0), "a negative variance");
        assert!(runs > 1, "the spread of fewer than two runs");
        let wide = |p: &Picture| p.rgb.iter().map(|c| c.map(f64::from)).collect();
        Self { width, height, mean: wide(mean), variance: wide(variance), runs }
    }

    /// The mean, rounded to f32.
    pub fn mean_picture(&self) -> Picture {
        let rgb = self.mean.iter().map(|c| c.map(|v| v as f32)).collect();
        Picture::new(self.width, self.height, rgb)
    }

    /// Variance of the mean luminance of independent runs, which their channels' variances do
    /// not tell.
    ///
    /// # Panics
    /// As [`NoisyPicture::of_runs`].
    pub fn luminance_variance(runs: &[Picture]) -> Vec<f64> {
        let grey = |p: &[f32; 3]| {
            let luminance: f64 = (0..3).map(|c| LUMINANCE[c] * f64::from(p[c])).sum();
            [luminance as f32; 3]
        };
        let grey = |p: &Picture| Picture::new(p.width, p.height, p.rgb.iter().map(grey).collect());
        let grey: Vec<Picture> = runs.iter().map(grey).collect();
        Self::of_runs(&grey).variance.iter().map(|v| v[0]).collect()
    }

    /// Degrees of freedom of each variance.
    pub(super) fn degrees_of_freedom(&self) -> f64 {
        self.runs as f64 - 1.0
    }
}
