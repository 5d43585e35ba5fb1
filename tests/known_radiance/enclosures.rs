//! Closed rooms whose walls emit and reflect: E / (1 - albedo), bounce by bounce.

use crate::common::{
    Estimate, Stage, assert_at_most, assert_truth, bundled, emitter, grey, lambert, render,
    settings,
};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::settings::{Sampler, Strategy};

const ROOMS: [&str; 2] = ["tests/furnace-box", "tests/furnace-sphere"];

/// Paths of every length are wanted: none ends by chance.
fn without_roulette(settings: RenderSettings) -> RenderSettings {
    RenderSettings { roulette: false, sampler: Sampler::Independent, ..settings }
}

/// Bounces of the series.
const SERIES: std::ops::RangeInclusive<u32> = 0..=8;

/// Settings for the light that was scattered exactly k times, and for all up to it.
fn only_and_up_to(k: u32, base: &RenderSettings) -> [RenderSettings; 2] {
    let up_to = RenderSettings { max_bounces: Some(k), ..base.clone() };
    [RenderSettings { only_bounce: Some(k), ..up_to.clone() }, up_to]
}

/// With E = albedo = ½ the light scattered k times is 2^-(k+1), and up to k times 1 - 2^-(k+1).
fn check_series(
    bounces: impl Iterator<Item = u32> + Clone,
    side: u32,
    spp: u32,
    visible_bias: f64,
) {
    for room in ROOMS {
        let scene = bundled(room);
        for k in bounces.clone() {
            let expected = 0.5_f64.powi(k as i32 + 1);
            let both = only_and_up_to(k, &without_roulette(settings(side, side, spp)));
            for (settings, truth) in both.iter().zip([expected, 1.0 - expected]) {
                let estimate = Estimate::of_pixels(&render(&scene, settings));
                assert_truth(&format!("{room}, bounce {k}"), estimate, truth, visible_bias);
            }
        }
    }
}

#[test]
fn every_bounce_of_a_furnace_is_half_the_one_before() {
    check_series([0, 1, 2, 8].into_iter(), 16, 32, 0.06);
}

#[test]
#[ignore = "tier N: about 4 minutes"]
fn h5_every_bounce_of_a_furnace_to_a_thousandth() {
    check_series(SERIES, 128, 256, 1e-3);
}

/// Without light samples and roulette no random number changes a path's radiance.
#[test]
fn h5_paths_alone_have_no_variance_in_a_furnace() {
    let mut worst = 0.0_f64;
    for room in ROOMS {
        let scene = bundled(room);
        for k in SERIES {
            let base = RenderSettings { strategy: Strategy::Bsdf, ..settings(8, 8, 4) };
            let both = only_and_up_to(k, &without_roulette(base));
            let expected = 0.5_f64.powi(k as i32 + 1);
            for (settings, truth) in both.iter().zip([expected, 1.0 - expected]) {
                let pixels = grey(&render(&scene, settings));
                worst = pixels.iter().map(|v| (v / truth - 1.0).abs()).fold(worst, f64::max);
            }
        }
    }
    let what = "bounces 0 to 8 of 2 furnaces, alone and summed, paths alone: relative error";
    assert_at_most("H5", what, worst, 1e-5);
}

/// I = π, R = 1, albedo ½: the light of a lamp at the centre that is scattered k times is 2^-k.
/// All of it is light samples.
#[test]
fn h5_every_bounce_of_a_lamp_in_a_sphere() {
    let scene = bundled("tests/point-in-sphere");
    let mut worst = 0.0_f64;
    for k in SERIES.skip(1) {
        let both = only_and_up_to(k, &without_roulette(settings(8, 8, 16)));
        let expected = 0.5_f64.powi(k as i32);
        for (settings, truth) in both.iter().zip([expected, 1.0 - expected]) {
            let estimate = Estimate::of_pixels(&render(&scene, settings));
            worst = worst.max((estimate.mean / truth - 1.0).abs());
            assert_truth(&format!("bounce {k}"), estimate, truth, 1e-3);
        }
    }
    let what = "bounces 1 to 8 of a point light in a sphere, light samples: relative error";
    assert_at_most("H5", what, worst, 1e-3);
}

/// The bounces one by one draw the numbers that they draw together: they add up to the whole in
/// every pixel, but for rounding.
#[test]
fn h5_the_bounces_add_up_to_the_whole() {
    let scene = bundled("cornell-spheres");
    let base = without_roulette(settings(16, 16, 4));
    let mut sum = vec![0.0; 256];
    for k in SERIES {
        let [only, up_to] = only_and_up_to(k, &base);
        for (total, v) in sum.iter_mut().zip(grey(&render(&scene, &only))) {
            *total += v;
        }
        if k == *SERIES.end() {
            let whole = grey(&render(&scene, &up_to));
            let error = |(a, b): (&f64, &f64)| (a - b).abs() / b.max(1e-3);
            let worst = sum.iter().zip(&whole).map(error).fold(0.0, f64::max);
            let what = "bounces 0 to 8 one by one against all together, pixel by pixel";
            // Some ten terms, each rounded some ten times in different sums.
            assert_at_most("H5", what, worst, 1e-5);
        }
    }
}

/// A black lamp of radius r in a sphere of radius 1 that reflects a: scattered twice, its light
/// is a² r² (1 - r²). By light samples alone nearly nothing is left to chance, so that a few
/// samples in a thousand that find the lamp hidden by itself would be seen.
#[test]
fn a_lamp_does_not_hide_itself() {
    for radius in [0.3_f32, 0.2, 0.1, 0.03] {
        let mut stage = Stage::perspective(Vec3::Y * 0.4, Vec3::Y, 1.5);
        stage.sphere(Vec3::ZERO, 1.0, lambert(0.8));
        stage.sphere(Vec3::ZERO, radius, emitter(1.0));
        let settings = RenderSettings {
            strategy: Strategy::Light,
            max_bounces: Some(2),
            only_bounce: Some(2),
            ..settings(32, 32, 256)
        };
        let estimate = Estimate::of_pixels(&render(&stage.scene, &settings));
        let share = f64::from(radius).powi(2);
        let truth = f64::from(0.8_f32).powi(2) * share * (1.0 - share);
        assert_truth(&format!("radius {radius}"), estimate, truth, 0.001);
    }
}
