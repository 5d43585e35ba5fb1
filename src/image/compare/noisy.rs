//! Pictures that know how uncertain they are.

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

    /// Degrees of freedom of each variance.
    pub(super) fn degrees_of_freedom(&self) -> f64 {
        self.runs as f64 - 1.0
    }
}
