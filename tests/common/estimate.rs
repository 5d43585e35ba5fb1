//! When an estimate agrees with a truth. With M the mean and s its
//! standard error, |M - T| <= 3.9 s; and s <= e T / 4, without which a bias of
//! size e would not be seen.

use steradian::film::Film;

/// Standard errors that chance may explain: 1e-4 of all normal estimates lie beyond.
const CHANCE: f64 = 3.9;

/// Relative error that rounding may add to an estimate: 128 units of 2^-24, for
/// paths of some ten vertices with some ten rounded factors each.
const ROUNDING: f64 = 128.0 / 16_777_216.0;

/// A mean and its standard error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) standard_error: f64,
    /// Standard deviation of one observation.
    pub(crate) deviation: f64,
}

impl Estimate {
    /// From independent observations of the same number.
    pub(crate) fn of(observations: &[f64]) -> Self {
        let n = observations.len() as f64;
        assert!(n >= 8.0, "too few observations to know their spread");
        let mean = observations.iter().sum::<f64>() / n;
        let squares: f64 = observations.iter().map(|x| (x - mean).powi(2)).sum();
        let deviation = (squares / (n - 1.0)).sqrt();
        Self { mean, standard_error: deviation / n.sqrt(), deviation }
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
    let Estimate { mean, standard_error: s, .. } = estimate;
    let error = mean - truth;
    println!("{what}: {mean:.6} for {truth:.6}, z = {:.2}, s/T = {:.1e}", error / s, s / truth);
    assert!(s <= visible_bias * truth / 4.0, "{what}: {s:e} is too coarse to decide");
    assert!(
        error.abs() <= CHANCE * s + ROUNDING * truth,
        "{what}: {mean} differs from {truth} by {:.1} standard errors of {s:e}",
        error / s
    );
}

/// Asserts that two independent estimates are of one number, in the same sense.
#[track_caller]
pub(crate) fn assert_agree(what: &str, a: Estimate, b: Estimate, visible_bias: f64) {
    let standard_error = a.standard_error.hypot(b.standard_error);
    assert_truth(what, Estimate { standard_error, ..a }, b.mean, visible_bias);
}

/// Asserts that every pixel of every channel is `truth`: no random number matters.
#[track_caller]
pub(crate) fn assert_constant(what: &str, film: &Film, truth: f64) {
    for channel in film.picture().rgb.iter().flatten() {
        let error = f64::from(*channel) - truth;
        assert!(error.abs() <= ROUNDING * truth, "{what}: {channel} differs from {truth}");
    }
}
