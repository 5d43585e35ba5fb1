//! Estimates: their moments, the criterion, and Welch's test.

use crate::random::Random;
use steradian::statistics::{CHANCE, Criterion, Estimate, Verdict, Welch, wilson_interval};

const CRITERION: Criterion = Criterion { visible_bias: 0.01, rounding: 0.0 };

#[test]
fn moments() {
    // Mean 5, squares 9 + 1 + 1 + 1 + 0 + 0 + 4 + 16 = 32 over 7.
    let e = Estimate::of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
    assert_eq!((e.mean, e.count), (5.0, 8));
    assert!((e.deviation - (32.0_f64 / 7.0).sqrt()).abs() < 1e-15);
    assert!((e.standard_error - (4.0_f64 / 7.0).sqrt()).abs() < 1e-15);
    assert!((e.z(4.0) - (7.0_f64 / 4.0).sqrt()).abs() < 1e-14);
}

#[test]
fn the_criterion_asks_for_power() {
    let estimate =
        |mean, standard_error| Estimate { mean, standard_error, deviation: 1.0, count: 100 };
    let judge = |mean, s| estimate(mean, s).judge(2.0, &CRITERION);
    assert_eq!(judge(2.0 + 3.89 * 0.005, 0.005), Verdict::Agrees);
    assert_eq!(judge(2.0 - 3.91 * 0.005, 0.005), Verdict::Differs);
    // e T / 4 = 0.005.
    assert_eq!(judge(2.0, 0.0051), Verdict::Inconclusive);
    assert_eq!(judge(3.0, 0.0051), Verdict::Differs);
    assert_eq!(judge(f64::NAN, 0.001), Verdict::Differs);
    assert_eq!(estimate(-2.0, 0.004).judge(-2.0, &CRITERION), Verdict::Agrees);
    let rounding = Criterion { rounding: 1e-6, ..CRITERION };
    assert_eq!(estimate(2.000_001_9, 0.0).judge(2.0, &rounding), Verdict::Agrees);
    assert_eq!(estimate(2.000_002_1, 0.0).judge(2.0, &rounding), Verdict::Differs);
    // Errors of two estimates add in square: 3-4-5.
    let (a, b) = (estimate(2.0, 0.003), estimate(2.0 - 3.8 * 0.005, 0.004));
    assert_eq!(
        a.judge_against(&b, &Criterion { visible_bias: 0.02, ..CRITERION }),
        Verdict::Agrees
    );
    let b = Estimate { mean: 2.0 - 4.0 * 0.005, ..b };
    assert_eq!(
        a.judge_against(&b, &Criterion { visible_bias: 0.02, ..CRITERION }),
        Verdict::Differs
    );
}

/// The criterion with a bias of exactly the size that it must see finds it in half of all cases.
#[test]
fn the_criterion_sees_what_it_promises() {
    let mut random = Random::new(11);
    let mut found = 0;
    for _ in 0..2000 {
        let observations: Vec<f64> = (0..400).map(|_| 1.0 + 0.05 * random.normal()).collect();
        // The standard error is 0.0025 = 0.01 T / 4 with T = 1.
        let biased = 1.0 - CHANCE * 0.0025;
        let verdict = Estimate::of(&observations).judge(biased, &CRITERION);
        found += usize::from(verdict == Verdict::Differs);
    }
    let (low, high) = wilson_interval(found, 2000, 0.999);
    println!("found {found} of 2000, {low:.3} to {high:.3}");
    assert!(low <= 0.5 && 0.5 <= high, "{found} of 2000");
}

#[test]
fn welch_by_hand() {
    // Variances of the means 0.04 with 9 degrees and 0.09 with 4:
    // 0.13² / (0.0016 / 9 + 0.0081 / 4) = 7.672...
    let w = Welch::new(0.5, [(0.04, 9.0), (0.09, 4.0)].into_iter());
    assert!((w.standard_error - 0.13_f64.sqrt()).abs() < 1e-15);
    assert!((w.degrees_of_freedom - 0.0169 / (0.0016 / 9.0 + 0.0081 / 4.0)).abs() < 1e-12);
    assert_eq!(Welch::new(0.0, [(0.0, 9.0)].into_iter()).p_value(), 1.0);
    assert_eq!(Welch::new(1e-9, [(0.0, 9.0)].into_iter()).p_value(), 0.0);
    let large = Welch::new(-1.96, [(1.0, 1e9)].into_iter());
    assert!((large.z() + 1.96).abs() < 1e-6 && (large.p_value() - 0.049_996).abs() < 1e-5);
}
