//! Distributions against closed forms and published values.

use std::f64::consts::{FRAC_2_PI, PI};
use steradian::statistics::{
    binomial_survival, chi_square_survival, normal_cdf, normal_quantile, normal_survival, sidak,
    student_t_cdf, student_t_quantile, student_t_survival, wilson_interval,
};

#[track_caller]
fn assert_close(value: f64, truth: f64, relative: f64) {
    assert!((value / truth - 1.0).abs() <= relative, "{value:e} for {truth:e}");
}

/// Φ(1.96), Φ⁻¹(0.975) and the upper tails at 3.9 and 8: Abramowitz and Stegun, tables
/// 26.1, 26.2 and 26.6, and the continued fraction 26.2.14 for the tails.
#[test]
fn the_normal_distribution() {
    assert_close(normal_cdf(1.96), 0.975_002_104_851_780, 1e-10);
    assert_close(normal_quantile(0.975), 1.959_963_984_540_054, 1e-10);
    for x in [3.9_f64, 8.0, 30.0] {
        let fraction = (1..400).rev().fold(x, |f, k| x + f64::from(k) / f);
        let density = (-0.5 * x * x).exp() / (2.0 * PI).sqrt();
        assert_close(normal_survival(x), density / fraction, 1e-10);
        assert_close(normal_cdf(-x), density / fraction, 1e-10);
    }
    for z in [-37.0, -8.0, -1.5, -0.01, 0.3, 2.5] {
        assert_close(normal_quantile(normal_cdf(z)), z, 1e-10);
    }
}

/// P(|T| < t) as the finite sums of Abramowitz and Stegun 26.7.3 and 26.7.4.
fn student_within(t: f64, degrees: u32) -> f64 {
    let theta = (t / f64::from(degrees).sqrt()).atan();
    let (sin, cos) = theta.sin_cos();
    let is_odd = degrees % 2 == 1;
    let (mut term, mut sum) = (if is_odd { cos } else { 1.0 }, 0.0);
    for k in (if is_odd { 1 } else { 0 }..=i64::from(degrees) - 2).step_by(2) {
        sum += term;
        term *= cos * cos * (k as f64 + 1.0) / (k as f64 + 2.0);
    }
    if is_odd { FRAC_2_PI * (theta + sin * sum) } else { sin * sum }
}

#[test]
fn the_student_distribution() {
    for degrees in [1, 2, 3, 4, 7, 15, 63, 100, 998, 999, 1000, 1001, 5000, 100_000] {
        for t in [0.01, 0.5, 1.0, 2.0, 3.9, 6.0] {
            let within = student_within(t, degrees);
            let degrees = f64::from(degrees);
            let cdf = student_t_cdf(t, degrees);
            assert!((cdf - 0.5 * (1.0 + within)).abs() < 1e-10, "{degrees} {t}: {cdf}");
            assert!((student_t_survival(t, degrees) + cdf - 1.0).abs() < 1e-12);
            let back = student_t_quantile(cdf, degrees);
            assert!((back - t).abs() < 1e-6 * t, "{degrees} {t}: quantile {back}");
        }
    }
    // One degree is Cauchy's distribution: far tails too.
    assert_close(student_t_survival(1e6, 1.0), 1e-6_f64.atan() / PI, 1e-10);
    // Infinitely many degrees are the normal distribution.
    assert_close(student_t_survival(3.9, f64::INFINITY), normal_survival(3.9), 1e-12);
    // Fisher's table, 5 % on both sides for ten degrees, to its printed digits.
    assert!((student_t_quantile(0.975, 10.0) - 2.228).abs() < 5e-4);
}

/// For an even number 2k of degrees the tail is that of a Poisson count below k with
/// mean x/2; for one degree that of a squared normal variable.
#[test]
fn the_chi_square_distribution() {
    for k in [1_u32, 2, 5, 50, 256] {
        for ratio in [0.5, 0.9, 1.0, 1.2, 1.5] {
            let mean = ratio * f64::from(k);
            let mut term = (-mean).exp();
            let mut tail = 0.0;
            for i in 0..k {
                tail += term;
                term *= mean / f64::from(i + 1);
            }
            let value = chi_square_survival(2.0 * mean, 2.0 * f64::from(k));
            assert!((value - tail).abs() < 1e-10 * tail.max(1e-3), "{k} {ratio}: {value} {tail}");
        }
    }
    for z in [0.1, 1.0, 5.0] {
        assert_close(chi_square_survival(z * z, 1.0), 2.0 * normal_survival(z), 1e-10);
    }
    // Abramowitz and Stegun, table 26.8: 5 % of 10 degrees.
    assert!((chi_square_survival(18.307, 10.0) - 0.05).abs() < 1e-5);
}

#[test]
fn levels_of_many_tests_and_intervals_of_counts() {
    assert_close(1.0 - (1.0 - sidak(0.05, 20)).powi(20), 0.05, 1e-12);
    // Where 1 - (1 - p)^n would lose all digits.
    assert_close(sidak(1e-4, 1_000_000), 1.000_05e-10, 1e-6);
    assert_close(sidak(0.01, 1), 0.01, 1e-12);
    // Wilson 1927 with z = 1.96: the bounds solve (p - 0.1)² = z² p (1 - p) / 100.
    let (low, high) = wilson_interval(10, 100, 0.95);
    let z = normal_quantile(0.975);
    for p in [low, high] {
        assert_close((p - 0.1).powi(2), z * z * p * (1.0 - p) / 100.0, 1e-10);
    }
    assert!(low < 0.1 && 0.1 < high);
}

/// The sum of the terms by hand.
#[test]
fn the_binomial_distribution() {
    let (n, p) = (20_i32, 0.05_f64);
    let mut term = (1.0 - p).powi(n);
    let mut below = 0.0;
    for k in 0..=n {
        let tail = binomial_survival(k as usize, n as usize, p);
        assert!((tail - (1.0 - below)).abs() < 1e-12, "{k}: {tail}");
        below += term;
        term *= f64::from(n - k) / f64::from(k + 1) * p / (1.0 - p);
    }
    assert_eq!(binomial_survival(0, 0, p), 1.0);
}
