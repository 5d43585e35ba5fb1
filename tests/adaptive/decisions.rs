//! What the device decides is what the rules say.

use super::{calibrated, render, scene, seed, with_rule};
use crate::common::{Stage, lambert, settings, with_device};
use glam::Vec3;
use steradian::film::Film;
use steradian::stopping::{
    CalibratedRule, Evidence, Preset, RunningSums, SeedRule, StopReason, StoppingRule,
};
use steradian::{RenderSettings, Renderer};

fn luminance(c: [f32; 3]) -> f64 {
    let [r, g, b] = c.map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Mean luminance of each block of `block_size` samples of every pixel: differences of the sums
/// of a picture that becomes better.
fn blocks(block_size: u32, spp: u32) -> Vec<Vec<f64>> {
    let settings = RenderSettings { block_size, ..settings(38, 21, spp) };
    with_device(|device| {
        let mut renderer = Renderer::new(device, &scene(), &settings).unwrap();
        let (mut before, mut all) = (vec![0.0; 38 * 21], Vec::new());
        while renderer.step().unwrap() {
            let count = renderer.film().least_samples();
            if count == block_size * all.len() as u32 {
                continue;
            }
            let sums: Vec<f64> = renderer
                .film()
                .picture()
                .rgb
                .iter()
                .map(|c| f64::from(count) * luminance(*c))
                .collect();
            let mean = |(sum, b): (&f64, &f64)| (sum - b) / f64::from(block_size);
            all.push(sums.iter().zip(&before).map(mean).collect());
            before = sums;
        }
        assert_eq!(all.len() as u32, spp / block_size);
        all
    })
}

/// What the film knows of every pixel.
fn evidence(film: &Film) -> Vec<Evidence> {
    let errors = film.standard_error().unwrap();
    let counts = film.sample_counts();
    // Only the default preset asks for it, and is tested at 128 samples: so far all blocks are
    // of eight.
    let units = blocks(8, 128);
    let largest = |i: usize| units.iter().map(|u| u[i]).fold(0.0, f64::max) as f32;
    let of_pixel = |i: usize| Evidence {
        mean: luminance(film.picture().rgb[i]) as f32,
        variance: errors[i].powi(2) * counts[i] as f32,
        is_lightable: true,
        largest: largest(i),
        sample_count: counts[i],
    };
    (0..counts.len()).map(of_pixel).collect()
}

/// With the limit at the first point of decision that counts, all pixels are judged with the
/// same number of samples.
fn check_decision(preset: Preset, spp: u32) {
    let rule = CalibratedRule::new(0.1, 0.95, preset);
    let (film, _) = render(&scene(), &with_rule(StoppingRule::Calibrated(rule), spp));
    assert!(film.sample_counts().iter().all(|&n| n == spp));
    let floor = rule.floor(film.mean_luminance());
    let width = film.window().width as usize;
    let judged = rule.judge(&evidence(&film), width, floor);
    let stops = film.stops().unwrap();
    let (mut done, mut differ) = (0, 0);
    for (i, (host, device)) in judged.iter().zip(stops).enumerate() {
        // The host has the statistics in f64, the device in f32: a thousandth is far above
        // what rounding makes, and a neighbour more or less far above that.
        let error = (host.half_width - device.half_width).abs();
        assert!(
            error <= 1e-3 * host.half_width,
            "pixel {i}: {} on the host, {} on the device",
            host.half_width,
            device.half_width
        );
        let is_converged = device.reason == StopReason::Converged;
        assert!(is_converged || device.reason == StopReason::Limit);
        done += u32::from(is_converged);
        differ += u32::from(is_converged != host.is_done);
    }
    assert_eq!(differ, 0, "decisions");
    let all = stops.len() as u32;
    assert!(done > all / 20 && done < all, "{done} of {all} pixels are done: no test");
}

#[test]
fn the_device_judges_as_the_rule_says() {
    check_decision(Preset::Default, 128);
    check_decision(Preset::Strict, 256);
}

/// Pixels that went on after a stop have fewer samples than others, and shorter blocks: they
/// keep to their own points of decision.
#[test]
fn pixels_stop_at_their_points_of_decision() {
    const LIMIT: u32 = 1000;
    let rule = calibrated(0.2, Preset::Default);
    let (film, statistics) = render(&scene(), &with_rule(rule, LIMIT));
    for (i, &count) in film.sample_counts().iter().enumerate() {
        assert!(rule.decides_at(count) || count == LIMIT, "pixel {i}: {count} samples");
    }
    // Those of the pixels that never stopped, and the limit.
    let points = (1..LIMIT).filter(|&n| rule.decides_at(n)).count() as u32 + 1;
    assert!(statistics.decisions > points, "{} decisions: no test", statistics.decisions);
}

#[test]
fn the_seeds_rule_stops_where_its_formula_says() {
    const LIMIT: u32 = 24;
    let rule = SeedRule { batch: 8, tolerance: 0.25 };
    let (film, _) = render(&scene(), &with_rule(StoppingRule::Seed(rule), LIMIT));
    let samples = blocks(1, LIMIT);
    let mut stopped_early = 0;
    for (i, stop) in film.stops().unwrap().iter().enumerate() {
        let mut sums = RunningSums::default();
        for of_picture in &samples {
            sums.add(of_picture[i]);
            if sums.count % rule.batch == 0 && rule.stops(&sums) {
                break;
            }
        }
        assert_eq!(film.sample_counts()[i], sums.count, "pixel {i}");
        // Samples are differences of f32 pictures: good to 24 × 2^-24 of the sums.
        let error = (f64::from(stop.half_width) - sums.half_width()).abs();
        assert!(error <= 1e-4 * sums.half_width() + 1e-5 * sums.mean(), "pixel {i}");
        assert_eq!(stop.reason == StopReason::Converged, rule.stops(&sums), "pixel {i}");
        stopped_early += u32::from(sums.count < LIMIT);
    }
    assert!(stopped_early > 100, "{stopped_early} pixels stopped early: no test");
}

/// A sphere without any light: nothing behind it, and nothing to see of it.
fn sphere_in_the_dark() -> steradian::scene::Scene {
    let mut stage = Stage::orthographic(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 1.0);
    stage.sphere(Vec3::ZERO, 0.5, lambert(0.5));
    stage.scene
}

#[test]
fn what_light_could_reach_takes_its_samples_before_it_is_black() {
    let corner_and_middle = |rule| {
        let (film, _) = render(&sphere_in_the_dark(), &with_rule(rule, 2048));
        let stops = film.stops().unwrap();
        assert!(stops.iter().all(|s| (s.reason, s.half_width) == (StopReason::Converged, 0.0)));
        let window = film.window();
        let middle = window.height / 2 * window.width + window.width / 2;
        [0, middle as usize].map(|i| film.sample_counts()[i])
    };
    assert_eq!(corner_and_middle(calibrated(0.1, Preset::Default)), [128, 1024]);
    assert_eq!(corner_and_middle(calibrated(0.1, Preset::Strict)), [256, 1024]);
    // 0 ≤ 0: the seed's rule takes one batch for the answer.
    assert_eq!(corner_and_middle(seed(32, 0.1)), [32, 32]);
}
