//! When an estimate agrees with a truth: `steradian::statistics::Criterion`, for films, with
//! messages.

use std::ops::{Deref, DerefMut};
use steradian::film::Film;
use steradian::statistics::{self, Criterion, Verdict};

/// Relative error that rounding may add to an estimate: 128 units of 2^-24, for
/// paths of some ten vertices with some ten rounded factors each.
const ROUNDING: f64 = 128.0 / 16_777_216.0;

/// A mean and its standard error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate(statistics::Estimate);

impl Deref for Estimate {
    type Target = statistics::Estimate;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Estimate {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl Estimate {
    /// From independent observations of the same number.
    pub(crate) fn of(observations: &[f64]) -> Self {
        assert!(observations.len() >= 8, "too few observations to know their spread");
        Self(statistics::Estimate::of(observations))
    }

    /// Of the radiance that all pixels of `film` share. Pixels are independent
    /// observations with both samplers: each has its own scramble.
    pub(crate) fn of_pixels(film: &Film) -> Self {
        Self::of(&grey(film))
    }
}

/// Mean of the channels of every pixel.
pub(crate) fn grey(film: &Film) -> Vec<f64> {
    let channels = |c: &[f32; 3]| c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
    film.picture().rgb.iter().map(channels).collect()
}

/// Asserts that `estimate` is `truth`, and would show a bias of the share `visible_bias`.
#[track_caller]
pub(crate) fn assert_truth(what: &str, estimate: Estimate, truth: f64, visible_bias: f64) {
    let (mean, s, z) = (estimate.mean, estimate.standard_error, estimate.z(truth));
    println!("{what}: {mean:.6} for {truth:.6}, z = {z:.2}, s/T = {:.1e}", s / truth);
    match estimate.judge(truth, &Criterion { visible_bias, rounding: ROUNDING }) {
        Verdict::Agrees => {}
        Verdict::Inconclusive => panic!("{what}: {s:e} is too coarse to decide"),
        Verdict::Differs => {
            panic!("{what}: {mean} differs from {truth} by {z:.1} standard errors of {s:e}")
        }
    }
}

/// Asserts that two independent estimates are of one number, in the same sense.
#[track_caller]
pub(crate) fn assert_agree(what: &str, a: Estimate, b: Estimate, visible_bias: f64) {
    let standard_error = a.standard_error.hypot(b.standard_error);
    let difference = Estimate(statistics::Estimate { standard_error, ..a.0 });
    assert_truth(what, difference, b.mean, visible_bias);
}

/// Asserts that every pixel of every channel is `truth`: no random number matters.
#[track_caller]
pub(crate) fn assert_constant(what: &str, film: &Film, truth: f64) {
    for channel in film.picture().rgb.iter().flatten() {
        let error = f64::from(*channel) - truth;
        assert!(error.abs() <= ROUNDING * truth, "{what}: {channel} differs from {truth}");
    }
}

/// Pixels on a strip's side: strips are squares side by side in a picture.
pub(crate) const STRIP: u32 = 8;

/// Estimates of the strips of a picture that is one strip high.
pub(crate) fn strips(film: &Film) -> Vec<Estimate> {
    let (pixels, width) = (grey(film), film.window().width as usize);
    let side = STRIP as usize;
    let of_strip = |k: usize| {
        let rows = pixels.chunks(width).flat_map(|row| &row[k * side..(k + 1) * side]);
        Estimate::of(&rows.copied().collect::<Vec<_>>())
    };
    (0..width / side).map(of_strip).collect()
}
