//! Russian roulette: the mean stays, and no path becomes heavy.

use crate::common::{
    Estimate, assert_at_most, assert_naive_fails, assert_truth, bundled, grey, report, settings,
    with_device,
};
use glam::Vec3;
use steradian::film::Film;
use steradian::passes::Tuning;
use steradian::scene::Scene;
use steradian::settings::{Sampler, Strategy};
use steradian::{RenderSettings, Renderer};

const ALBEDO: f32 = 0.99;
const EMISSION: f32 = 0.01;
/// What is cut off is a hundredth, and part of the truth.
const BOUNCES: u32 = 400;

/// The closed box of radiance E / (1 - albedo) = 1.
fn bright_box() -> Scene {
    let mut scene = bundled("tests/furnace-box");
    for material in &mut scene.materials {
        material.base_color = Vec3::splat(ALBEDO);
        material.emission = Vec3::splat(EMISSION);
    }
    scene
}

/// Paths alone: without roulette they have no variance, with it none but its own.
fn paths(side: u32, spp: u32, bounces: u32) -> RenderSettings {
    RenderSettings {
        strategy: Strategy::Bsdf,
        sampler: Sampler::Independent,
        max_bounces: Some(bounces),
        ..settings(side, side, spp)
    }
}

/// Renders with `from` in the text of the path's module replaced by `to`. Long paths: one sample
/// a submission, for drivers that count a thread's loops.
fn render_with(scene: &Scene, settings: &RenderSettings, (from, to): (&str, &str)) -> Film {
    let mut tuning = Tuning { submit_samples: 1, ..Tuning::default() };
    let text = tuning.library.get_mut("path/path").unwrap();
    assert_eq!(text.matches(from).count(), 1, "path/path has changed: {from}");
    *text = text.replace(from, to).into();
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        assert_eq!(renderer.statistics().faults, [0; 4]);
        renderer.film().clone()
    })
}

const LEAST: &str = "const ROULETTE_LEAST: f32 = 0.1;";
const MOST: &str = "ROULETTE_LEAST, 1.0)";

/// Radiance of the box by up to k bounces.
fn truth(bounces: u32) -> f64 {
    let (albedo, emission) = (f64::from(ALBEDO), f64::from(EMISSION));
    emission * (1.0 - albedo.powi(bounces as i32 + 1)) / (1.0 - albedo)
}

#[test]
fn h4_roulette_leaves_the_mean() {
    let scene = bright_box();
    let without = RenderSettings { roulette: false, ..paths(8, 1, BOUNCES) };
    let film = render_with(&scene, &without, (LEAST, LEAST));
    let worst = grey(&film).iter().map(|v| (v / truth(BOUNCES) - 1.0).abs()).fold(0.0, f64::max);
    assert_at_most("H4", "albedo 0.99, 400 bounces, no roulette: relative error", worst, 1e-5);
    check_bright_box(16, 64, 0.05);
}

#[test]
#[ignore = "tier N: about 20 minutes"]
fn h4_roulette_leaves_the_mean_to_a_thousandth() {
    check_bright_box(256, 256, 1e-3);
}

/// The box with roulette, to that visible bias.
fn check_bright_box(side: u32, spp: u32, visible_bias: f64) {
    let film = render_with(&bright_box(), &paths(side, spp, BOUNCES), (LEAST, LEAST));
    let estimate = Estimate::of_pixels(&film);
    let deviation = estimate.deviation * f64::from(spp).sqrt();
    report("H4", "albedo 0.99, roulette: deviation of a path", deviation);
    let error = (estimate.mean / truth(BOUNCES) - 1.0).abs();
    report("H4", &format!("albedo 0.99, roulette, {visible_bias} visible: relative error"), error);
    assert_truth("albedo 0.99, roulette", estimate, truth(BOUNCES), visible_bias);
}

/// The floor acts where the albedo is below the floor: to 1e-3.
#[test]
fn h4_the_floor_of_roulette_does_not_matter_where_it_acts() {
    let mut scene = bundled("tests/furnace-box");
    for material in &mut scene.materials {
        material.base_color = Vec3::splat(0.05);
        material.emission = Vec3::splat(0.95);
    }
    let truth = 0.95_f32 as f64 / (1.0 - 0.05_f32 as f64);
    for floor in ["0.1", "0.5"] {
        let patch = format!("const ROULETTE_LEAST: f32 = {floor};");
        let film = render_with(&scene, &paths(32, 256, 64), (LEAST, &patch));
        let estimate = Estimate::of_pixels(&film);
        let what = format!("albedo 0.05, roulette from {floor}: relative standard error");
        assert_at_most("H4", &what, estimate.standard_error / truth, 2.5e-4);
        assert_truth(&what, estimate, truth, 1e-3);
    }
}

/// What a path weighs after k bounces: with one path a pixel, the light that was scattered k
/// times is the weight times the emission, or nothing. Were paths ended by chance even where
/// nothing is lost, the rest would gain weight with every bounce and the variance have no bound.
#[test]
fn h4_no_path_becomes_heavy() {
    let scene = bright_box();
    let heaviest = |patch: (&str, &str)| {
        let mut heaviest = 0.0_f64;
        for k in [6, 30, 100] {
            let settings = RenderSettings { only_bounce: Some(k), ..paths(64, 1, k) };
            let film = render_with(&scene, &settings, patch);
            let brightest = grey(&film).into_iter().fold(0.0, f64::max);
            assert!(brightest > 0.0, "no path of {k} bounces");
            heaviest = heaviest.max(brightest / f64::from(EMISSION));
        }
        heaviest
    };
    let what = "largest weight of 4096 paths after 6, 30, 100 bounces, albedo 0.99";
    assert_at_most("H4", what, heaviest((LEAST, LEAST)), 20.0);
    let what = format!("{what}, one in 20 ended always");
    assert_naive_fails("H4", &what, heaviest((MOST, "ROULETTE_LEAST, 0.95)")), 20.0);
}
