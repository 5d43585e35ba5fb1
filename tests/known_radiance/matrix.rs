//! Every estimator on every scene of known radiance, to two thousandths: long.

use super::strategies::{ALL, Choice};
use crate::common::{
    Estimate, assert_at_least, assert_at_most, bundled, bundled_truth, grey, render, report,
    settings,
};
use steradian::RenderSettings;
use steradian::scene::Scene;
use steradian::settings::{Sampler, Strategy};
use steradian::statistics::{CHANCE, GoodnessOfFit};

/// Scenes with the bounces that leave less than 4e-6 of the light, where nothing else ends
/// paths, and whether scattered rays can find all lights.
const SCENES: [(&str, Option<u32>, bool); 11] = [
    ("tests/furnace-box", Some(17), true),
    ("tests/furnace-sphere", Some(17), true),
    ("tests/white-furnace", Some(64), true),
    ("tests/sphere-light", None, true),
    ("tests/quad-light", None, true),
    ("tests/sphere-in-sphere", Some(48), true),
    ("tests/point-in-sphere", Some(17), false),
    ("tests/point-light", None, false),
    ("tests/spot-light", None, false),
    ("tests/directional-light", None, false),
    ("tests/glass-slab", Some(64), true),
];

/// Samples to begin with, and at most, of each of 64 × 64 pixels.
const FEWEST: u32 = 64;
const MOST: u32 = 65_536;

/// With a standard error of 5e-4 of the truth: as many samples as the error of a first picture
/// asks for, and half as many again, because that error is an estimate.
fn fine_estimate(scene: &Scene, base: &RenderSettings, truth: f64) -> Estimate {
    let mut spp = FEWEST;
    loop {
        let estimate = Estimate::of_pixels(&render(scene, &RenderSettings { spp, ..base.clone() }));
        let times = (estimate.standard_error / (5e-4 * truth)).powi(2);
        if times <= 1.0 || spp >= MOST {
            return estimate;
        }
        // Whole blocks of the film.
        spp = ((f64::from(spp) * 1.5 * times) as u32).next_multiple_of(FEWEST).min(MOST);
    }
}

/// Directions uniform over the hemisphere would need most of the time, and are no one's choice.
fn cells(finds_lights: bool) -> Vec<(Strategy, Choice)> {
    let strategies: &[Strategy] = match finds_lights {
        true => &[Strategy::Bsdf, Strategy::Light, Strategy::Mis],
        false => &[Strategy::Light, Strategy::Mis],
    };
    strategies.iter().flat_map(|&s| ALL.map(|choice| (s, choice))).collect()
}

#[test]
#[ignore = "tier N: about 25 minutes of one core"]
fn h3_every_cell_of_the_matrix_is_the_truth() {
    let (mut worst_z, mut worst_difference, mut worst_error) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut tested = 0;
    for (name, max_bounces, finds_lights) in SCENES {
        let (scene, truth) = (bundled(name), bundled_truth(name));
        let mut all: Vec<Estimate> = Vec::new();
        for (strategy, (sampler, roulette)) in cells(finds_lights) {
            let base = RenderSettings {
                strategy,
                sampler,
                roulette,
                max_bounces,
                // Another picture for every cell: the cells are compared with each other.
                seed: 1 + all.len() as u32,
                ..settings(64, 64, FEWEST)
            };
            let estimate = fine_estimate(&scene, &base, truth);
            println!("{name}, {strategy:?}, {sampler:?}, {roulette}: {estimate:?}");
            worst_error = worst_error.max(estimate.standard_error / truth);
            let rounding = 1e-5 * truth;
            let others = all.iter().map(|e| (e.mean, e.standard_error)).chain([(truth, 0.0)]);
            for (mean, error) in others {
                let difference = (estimate.mean - mean).abs();
                let s = estimate.standard_error.hypot(error);
                worst_difference = worst_difference.max(difference / truth);
                worst_z = worst_z.max((difference - rounding).max(0.0) / s.max(1e-12 * truth));
            }
            all.push(estimate);
            tested += 1;
        }
    }
    report("H3", "cells tested on 11 scenes", f64::from(tested));
    assert_at_most("H3", "cells and their pairs: largest |z|", worst_z, CHANCE);
    assert_at_most(
        "H3",
        "cells and their pairs: largest relative difference",
        worst_difference,
        2e-3,
    );
    assert_at_most("H3", "cells: largest relative standard error", worst_error, 5e-4);
}

/// Pixels of two strategies that have one mean: their p-values are uniform.
#[test]
fn h3_differences_of_strategies_are_chance() {
    const RUNS: u32 = 8;
    let scene = bundled("tests/sphere-light");
    let runs = |strategy: Strategy, first: u32| -> Vec<Vec<f64>> {
        let picture = |seed| {
            let sampler = Sampler::Independent;
            let settings = RenderSettings { strategy, sampler, seed, ..settings(32, 32, 64) };
            grey(&render(&scene, &settings))
        };
        (first..first + RUNS).map(picture).collect()
    };
    let (a, b) = (runs(Strategy::Light, 0), runs(Strategy::Mis, RUNS));
    let mut bins = [0_u64; 16];
    for i in 0..a[0].len() {
        let of = |runs: &[Vec<f64>]| Estimate::of(&runs.iter().map(|r| r[i]).collect::<Vec<_>>());
        let (a, b) = (of(&a), of(&b));
        let variances = [a, b].map(|e| (e.standard_error.powi(2), f64::from(RUNS - 1)));
        let welch = steradian::statistics::Welch::new(a.mean - b.mean, variances.into_iter());
        bins[((welch.p_value() * 16.0) as usize).min(15)] += 1;
    }
    let expected = [a[0].len() as f64 / 16.0; 16];
    let p = GoodnessOfFit::of(&bins, &expected).p_value;
    assert_at_least(
        "H3",
        "p of the uniformity of 1024 pixels' p-values, light against mis",
        p,
        0.01,
    );
}

/// log relMSE against log samples, spp 4^0 to 4^7, a line through them: its slope, the slope's
/// standard error, and the last relMSE. The logarithm of a mean of n squares has the variance
/// 2 / n.
fn slope(sampler: Sampler) -> (f64, f64, f64) {
    let name = "tests/sphere-light";
    let (scene, truth) = (bundled(name), bundled_truth(name));
    const POINTS: i32 = 8;
    let (mut xy, mut xx, mut last) = (0.0, 0.0, 0.0);
    for k in 0..POINTS {
        let spp = 4_u32.pow(k as u32);
        let base = RenderSettings { sampler, strategy: Strategy::Bsdf, ..settings(32, 32, spp) };
        let pixels = grey(&render(&scene, &RenderSettings { seed: k as u32, ..base }));
        let squares: f64 = pixels.iter().map(|v| (v / truth - 1.0).powi(2)).sum();
        last = squares / pixels.len() as f64;
        let x = f64::from(2 * k - POINTS + 1) * 2.0_f64.ln();
        xy += x * last.ln();
        xx += x * x;
    }
    (xy / xx, (2.0 / 1024.0 / xx).sqrt(), last)
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn h15_the_error_falls_with_the_samples() {
    let (fitted, error, last) = slope(Sampler::Independent);
    let what = "slope of log relMSE, spp 1 to 16384, independent numbers";
    assert_at_most("H15", &format!("{what}: standard error"), error, 0.0125);
    assert_at_most("H15", &format!("{what}: |slope + 1|"), (fitted + 1.0).abs(), 0.05);
    report("H15", what, fitted);
    report("H15", "relMSE at 16384 independent samples", last);
    let (fitted, _, last) = slope(Sampler::Sobol);
    report("H15", "the same with Sobol points", fitted);
    report("H15", "relMSE at 16384 Sobol points", last);
}
