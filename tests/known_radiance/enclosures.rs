//! Closed rooms whose walls emit and reflect: E / (1 - albedo), bounce by bounce.

use crate::common::{Estimate, Stage, assert_truth, bundled, emitter, lambert, render, settings};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::settings::{Sampler, Strategy};

const ROOMS: [&str; 2] = ["tests/furnace-box", "tests/furnace-sphere"];

/// Paths of every length are wanted: none ends by chance.
fn without_roulette(settings: RenderSettings) -> RenderSettings {
    RenderSettings { roulette: false, sampler: Sampler::Independent, ..settings }
}

/// With E = albedo = ½: the light scattered k times is 2^-(k+1), up to k times 1 - 2^-(k+1).
#[test]
fn every_bounce_of_a_furnace_is_half_the_one_before() {
    for room in ROOMS {
        let scene = bundled(room);
        for k in 0..=6 {
            let expected = 0.5_f64.powi(k as i32 + 1);
            let base = without_roulette(settings(16, 16, 64));
            let only =
                RenderSettings { only_bounce: Some(k), max_bounces: Some(k), ..base.clone() };
            let up_to = RenderSettings { max_bounces: Some(k), ..base };
            let what = format!("{room}, bounce {k}");
            let film = render(&scene, &only);
            assert_truth(&what, Estimate::of_pixels(&film), expected, 0.04);
            let film = render(&scene, &up_to);
            assert_truth(&what, Estimate::of_pixels(&film), 1.0 - expected, 0.02);
        }
    }
}

/// Without light samples and roulette no random number changes a path's radiance.
#[test]
fn paths_alone_have_no_variance_in_a_furnace() {
    for room in ROOMS {
        let scene = bundled(room);
        for k in 0..=6 {
            let settings = RenderSettings {
                strategy: Strategy::Bsdf,
                max_bounces: Some(k),
                ..without_roulette(settings(8, 8, 16))
            };
            let estimate = Estimate::of_pixels(&render(&scene, &settings));
            let truth = 1.0 - 0.5_f64.powi(k as i32 + 1);
            assert!((estimate.mean - truth).abs() <= 1e-5 * truth, "{room}, {k}: {estimate:?}");
            assert!(estimate.deviation <= 1e-5 * truth, "{room}, {k}: {estimate:?}");
        }
    }
}

/// I = π, R = 1, albedo ½: the light of a lamp at the centre that is scattered k times is 2^-k.
#[test]
fn every_bounce_of_a_lamp_in_a_sphere() {
    let scene = bundled("tests/point-in-sphere");
    for k in 1..=6 {
        let base = without_roulette(settings(8, 8, 16));
        let settings = RenderSettings { only_bounce: Some(k), max_bounces: Some(k), ..base };
        let estimate = Estimate::of_pixels(&render(&scene, &settings));
        assert_truth(&format!("bounce {k}"), estimate, 0.5_f64.powi(k as i32), 1e-3);
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
