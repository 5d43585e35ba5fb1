//! False-alarm rates: of one test, of many, and as counted.

use super::normal_quantile;

/// Standard errors that chance may explain: the usual criterion of one test.
pub const CHANCE: f64 = 3.9;

/// Rate of false alarms of one test, near that of [`CHANCE`] (9.6e-5, both sides).
pub const FALSE_ALARM: f64 = 1e-4;

/// The level for each of `tests` independent tests at which all together raise a false
/// alarm at the rate `level` (Šidák 1967).
pub fn sidak(level: f64, tests: usize) -> f64 {
    -((-level).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// Interval for a probability of which `successes` of `trials` were seen, that holds the
/// true one in the share `confidence` of all cases (Wilson 1927).
pub fn wilson_interval(successes: usize, trials: usize, confidence: f64) -> (f64, f64) {
    let (n, z) = (trials as f64, normal_quantile(0.5 + 0.5 * confidence));
    let p = successes as f64 / n;
    let scale = 1.0 / (1.0 + z * z / n);
    let center = scale * (p + z * z / (2.0 * n));
    let half = scale * z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    (center - half, center + half)
}
