//! The chi-square test of directions: exact cells, right alarms, and power.

use crate::random::Random;
use std::f64::consts::{FRAC_PI_3, PI, TAU};
use steradian::statistics::{DirectionGrid, FALSE_ALARM, GoodnessOfFit, Verdict, wilson_interval};

const AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// A direction with cosine `z` and azimuth `phi`.
fn direction(z: f64, phi: f64) -> [f64; 3] {
    let r = (1.0 - z * z).sqrt();
    [r * phi.cos(), r * phi.sin(), z]
}

fn cosine_weighted(random: &mut Random) -> Option<[f64; 3]> {
    Some(direction(random.unit().sqrt(), TAU * random.unit()))
}

fn cosine_pdf(d: [f64; 3]) -> f64 {
    d[2].max(0.0) / PI
}

/// GGX half vectors by their own density D cos θ (Walter et al. 2007).
fn ggx_half(random: &mut Random, alpha: f64) -> [f64; 3] {
    let u = random.unit();
    let tangent_squared = alpha * alpha * u / (1.0 - u);
    direction((1.0 + tangent_squared).powf(-0.5), TAU * random.unit())
}

fn ggx_half_pdf(d: [f64; 3], alpha: f64) -> f64 {
    let (z2, a2) = (d[2] * d[2], alpha * alpha);
    let s = a2 * z2 + (d[0] * d[0] + d[1] * d[1]);
    if d[2] <= 0.0 { 0.0 } else { a2 * d[2] / (PI * s * s) }
}

fn draws(count: usize, seed: u64, draw: impl Fn(&mut Random) -> Option<[f64; 3]>) -> Vec<Draw> {
    let mut random = Random::new(seed);
    (0..count).map(|_| draw(&mut random)).collect()
}

type Draw = Option<[f64; 3]>;

/// A row between z0 and z1 of a cosine-weighted hemisphere has the probability z1² - z0².
#[test]
fn cells_have_their_exact_probability() {
    let grid = DirectionGrid::hemisphere([1.0, 2.0, -0.5], 8, 4);
    let axis = [1.0, 2.0, -0.5].map(|c: f64| c / 5.25_f64.sqrt());
    let cells = grid.probabilities(|d| d.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>() / PI);
    for (i, &cell) in cells.iter().enumerate() {
        // Rows go from the axis down, in equal steps of the cosine.
        let z = |k: usize| 1.0 - k as f64 / 8.0;
        let row = i / 4;
        let truth = (z(row).powi(2) - z(row + 1).powi(2)) / 4.0;
        assert!((cell - truth).abs() < 1e-10, "cell {i}: {cell} for {truth}");
    }
}

/// A cap of 60 degrees that no edge of the grid follows has a quarter of the sphere.
#[test]
fn a_jump_across_cells_is_integrated() {
    let cap = |d: [f64; 3]| f64::from(u8::from(d[0] > FRAC_PI_3.cos()));
    let cells = DirectionGrid::sphere(AXIS, 16, 32).probabilities(cap);
    let area = cells.iter().sum::<f64>();
    assert!((area - PI).abs() < 1e-5 * PI, "{area}");
}

/// A peak of half a milliradian, on a grid that knows where it is.
#[test]
fn a_narrow_peak_is_integrated() {
    for alpha in [5e-4, 0.02, 1.0] {
        let grid = DirectionGrid::around(AXIS, 2.0 * alpha, 16, 8);
        let cells = grid.probabilities(|d| ggx_half_pdf(d, alpha));
        let total = cells.iter().sum::<f64>();
        assert!((total - 1.0).abs() < 1e-5, "alpha {alpha}: {total}");
        let draws = draws(100_000, 3, |random| Some(ggx_half(random, alpha)));
        let fit = grid.test(draws, |d| ggx_half_pdf(d, alpha));
        assert_eq!(fit.verdict(FALSE_ALARM), Verdict::Agrees, "alpha {alpha}: {fit}");
    }
}

#[test]
fn directions_find_their_cell() {
    let grid = DirectionGrid::sphere([0.3, -0.7, 0.2], 5, 7);
    let mut random = Random::new(5);
    let uniform = |random: &mut Random| direction(2.0 * random.unit() - 1.0, TAU * random.unit());
    let mut counts = vec![0_u64; grid.cell_count()];
    for _ in 0..35_000 {
        counts[grid.cell(uniform(&mut random)).unwrap()] += 1;
    }
    let fit = GoodnessOfFit::of(&counts, &[1000.0; 35]);
    assert_eq!(fit.verdict(FALSE_ALARM), Verdict::Agrees, "{fit}");
    assert_eq!(grid.cell([-0.3, 0.7, -0.2]).map(|c| c / 7), Some(4), "the far pole");
    assert_eq!(DirectionGrid::hemisphere(AXIS, 5, 7).cell([0.1, 0.0, -0.01]), None);
}

/// The share of alarms over 2000 sets of 4000 draws is the level that was asked for.
#[test]
fn alarms_come_at_the_stated_rate() {
    let grid = DirectionGrid::hemisphere(AXIS, 6, 6);
    let expected = grid.probabilities(cosine_pdf);
    for level in [0.05, 0.01] {
        let mut alarms = 0;
        for seed in 0..2000 {
            let (counts, missed) = grid.count(draws(4000, seed, cosine_weighted));
            assert_eq!(missed, 0);
            let expected: Vec<_> = expected.iter().map(|p| 4000.0 * p).collect();
            let fit = GoodnessOfFit::of(&counts, &expected);
            alarms += usize::from(fit.verdict(level) == Verdict::Differs);
        }
        let (low, high) = wilson_interval(alarms, 2000, 0.999);
        println!("level {level}: {alarms} of 2000, {low:.4} to {high:.4}");
        assert!(low <= level && level <= high, "{alarms} alarms of 2000 at the level {level}");
    }
}

/// Densities that are off by 2 % in scale or in shape are found in 20 of 20 sets of
/// 400,000 draws. In k cells a relative error e adds N <e²> to a statistic that spreads by
/// √(2 k): 107 to 16 here. Four times the cells need twice the draws.
#[test]
fn a_density_off_by_two_percent_is_found() {
    const DRAWS: usize = 400_000;
    let grid = DirectionGrid::hemisphere(AXIS, 8, 16);
    let scaled = |scale: f64| move |d| scale * cosine_pdf(d);
    // Too large towards the pole by as much as it is too small at the rim.
    let tilt = |d: [f64; 3]| 0.02 * (4.0 * d[2] * d[2] - 2.0).clamp(-1.0, 1.0);
    let tilted = |d| (1.0 + tilt(d)) * cosine_pdf(d);
    // A power of the cosine of 1.05 instead of 1.
    let steeper = |d: [f64; 3]| 2.05 / TAU * d[2].max(0.0).powf(1.05);
    for seed in 0..20 {
        let draws = draws(DRAWS, seed, cosine_weighted);
        let verdict = |pdf: &dyn Fn([f64; 3]) -> f64| {
            grid.test(draws.iter().copied(), pdf).verdict(FALSE_ALARM)
        };
        assert_eq!(verdict(&cosine_pdf), Verdict::Agrees, "the truth");
        assert_eq!(verdict(&scaled(1.02)), Verdict::Differs, "2 % too large");
        assert_eq!(verdict(&scaled(0.98)), Verdict::Differs, "2 % too small");
        assert_eq!(verdict(&tilted), Verdict::Differs, "tilted by 2 %");
        assert_eq!(verdict(&steeper), Verdict::Differs, "too steep");
    }
}

#[test]
fn what_is_impossible_or_missing_is_found() {
    let grid = DirectionGrid::sphere(AXIS, 8, 8);
    let mut sample = draws(10_000, 1, cosine_weighted);
    let half_lost = |d| 0.5 * cosine_pdf(d);
    assert_eq!(grid.test(sample.clone(), cosine_pdf).verdict(FALSE_ALARM), Verdict::Agrees);
    // Failed draws are right when the density accounts for them, and only then.
    let mut random = Random::new(9);
    let thinned = sample.iter().map(|d| d.filter(|_| random.unit() < 0.5)).collect::<Vec<_>>();
    assert_eq!(grid.test(thinned.clone(), half_lost).verdict(FALSE_ALARM), Verdict::Agrees);
    assert_eq!(grid.test(thinned, cosine_pdf).verdict(FALSE_ALARM), Verdict::Differs);
    assert_eq!(grid.test(sample.clone(), half_lost).verdict(FALSE_ALARM), Verdict::Differs);
    // One direction of ten thousand where there can be none.
    sample[77] = Some([0.3, 0.1, -0.5]);
    let fit = grid.test(sample, cosine_pdf);
    assert_eq!((fit.impossible, fit.verdict(FALSE_ALARM)), (1, Verdict::Differs));
}

#[test]
fn small_cells_are_pooled() {
    // 1 + 2 + 3 expect 6; 4 alone would be too few and joins it; 50 stands alone.
    let fit = GoodnessOfFit::of(&[2, 1, 3, 4, 50], &[1.0, 2.0, 3.0, 4.0, 50.0]);
    assert_eq!((fit.degrees_of_freedom, fit.statistic), (1, 0.0));
    let fit = GoodnessOfFit::of(&[0, 4], &[0.0, 4.0]);
    assert_eq!(fit.verdict(FALSE_ALARM), Verdict::Inconclusive);
    let fit = GoodnessOfFit::of(&[10, 20], &[15.0, 15.0]);
    assert!((fit.statistic - 50.0 / 15.0).abs() < 1e-12, "{fit}");
}
