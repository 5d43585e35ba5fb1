//! Closed rooms whose walls emit and reflect: E / (1 - albedo), bounce by bounce.

use crate::common::{Estimate, assert_truth, bundled, render, settings};
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
