//! Paths shared by the pixels of a block of 4 by 2: the means stay, the errors shrink, and the bits
//! depend on nothing that they should not. What is independent are blocks, not pixels.

use crate::common::{
    Estimate, assert_truth, bundled, bundled_truth, grey, render, settings, with_device,
};
use steradian::film::Film;
use steradian::passes::Tuning;
use steradian::scene::Scene;
use steradian::settings::{Accel, Crop};
use steradian::statistics::{GoodnessOfFit, Welch};
use steradian::{RenderSettings, Renderer};

fn shared(settings: RenderSettings) -> RenderSettings {
    RenderSettings { path_reuse: true, ..settings }
}

/// Means of the blocks of a picture of `width` columns.
fn blocks(pixels: &[f64], width: usize) -> Vec<f64> {
    let height = pixels.len() / width;
    let block = |x: usize, y: usize| {
        let at = |k: usize| pixels[(y + k / 4) * width + x + k % 4];
        (0..8).map(at).sum::<f64>() / 8.0
    };
    (0..height).step_by(2).flat_map(|y| (0..width).step_by(4).map(move |x| block(x, y))).collect()
}

#[test]
fn shared_paths_have_the_known_radiance() {
    for (name, max_bounces) in [
        ("tests/furnace-box", Some(17)),
        ("tests/furnace-sphere", Some(17)),
        ("tests/sphere-in-sphere", None),
    ] {
        let spp = if max_bounces.is_some() { 64 } else { 256 };
        let settings = shared(RenderSettings { max_bounces, ..settings(32, 32, spp) });
        let film = render(&bundled(name), &settings);
        let estimate = Estimate::of(&blocks(&grey(&film), 32));
        assert_truth(name, estimate, bundled_truth(name), 0.02);
    }
}

/// Per block, the p-values of the difference to paths that are not shared: uniform if the means are
/// the same everywhere, at edges, in corners, on mirrors, under smooth normals.
fn check_same_means(name: &str) {
    const RUNS: u32 = 10;
    const SIDE: u32 = 32;
    let scene = bundled(name);
    let runs = |settings: RenderSettings, first: u32| -> Vec<Vec<f64>> {
        let picture = |seed| {
            let film = render(&scene, &RenderSettings { seed, ..settings.clone() });
            blocks(&grey(&film), SIDE as usize)
        };
        (first..first + RUNS).map(picture).collect()
    };
    let settings = settings(SIDE, SIDE, 32);
    let (own, shared) = (runs(settings.clone(), 0), runs(shared(settings), RUNS));
    let mut bins = [0_u64; 8];
    let mut total = 0.0;
    for i in 0..own[0].len() {
        let of = |runs: &[Vec<f64>]| Estimate::of(&runs.iter().map(|r| r[i]).collect::<Vec<_>>());
        let (a, b) = (of(&own), of(&shared));
        let variances = [a, b].map(|e| (e.standard_error.powi(2), f64::from(RUNS - 1)));
        let welch = Welch::new(a.mean - b.mean, variances.into_iter());
        bins[((welch.p_value() * 8.0) as usize).min(7)] += 1;
        total += b.mean / a.mean.max(1e-6) - 1.0;
    }
    let p = GoodnessOfFit::of(&bins, &[own[0].len() as f64 / 8.0; 8]).p_value;
    println!("{name}: {bins:?}, p = {p}, mean excess {:.5}", total / own[0].len() as f64);
    assert!(p > 1e-3, "{name}: p = {p} of {bins:?}");
}

#[test]
fn shared_paths_have_the_means_of_their_own() {
    check_same_means("cornell-box");
}

#[test]
fn shared_paths_have_the_means_of_their_own_beside_mirrors_and_glass() {
    check_same_means("cornell-spheres");
}

#[test]
fn shared_paths_have_the_means_of_their_own_on_smooth_meshes() {
    check_same_means("statue");
}

/// For a third more time. Measured at 64 by 64 pixels: 3.9 times; the more the finer the pixels.
#[test]
fn shared_paths_have_less_than_half_the_variance() {
    let scene = bundled("cornell-box");
    let variance = |settings: RenderSettings| -> f64 {
        let pictures: Vec<Vec<f64>> = (0..8)
            .map(|seed| grey(&render(&scene, &RenderSettings { seed, ..settings.clone() })))
            .collect();
        let of = |i: usize| {
            let values: Vec<f64> = pictures.iter().map(|p| p[i]).collect();
            let e = Estimate::of(&values);
            e.standard_error.powi(2) / (e.mean * e.mean).max(1e-6)
        };
        (0..pictures[0].len()).map(of).sum()
    };
    let own = variance(settings(64, 64, 8));
    let ratio = own / variance(shared(settings(64, 64, 8)));
    println!("variance falls by {ratio:.2}");
    assert!(ratio > 2.0, "the variance falls by {ratio}");
}

type Bits = Vec<[u32; 3]>;

fn bits(film: &Film) -> Bits {
    film.picture().rgb.iter().map(|c| c.map(f32::to_bits)).collect()
}

fn tuned(scene: &Scene, settings: &RenderSettings, tuning: &Tuning) -> Bits {
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        bits(renderer.film())
    })
}

/// Also of a picture whose edges cut through blocks, and with lanes that exchange through memory.
#[test]
fn shared_paths_have_the_same_bits_however_the_work_is_cut() {
    let scene = bundled("cornell-box");
    let plain = shared(settings(26, 15, 4));
    let whole = bits(&render(&scene, &plain));
    assert_ne!(whole, bits(&render(&scene, &settings(26, 15, 4))), "paths are shared");
    for workgroup_size in [32, 128] {
        let tuning = Tuning { workgroup_size, ..Tuning::default() };
        assert!(tuned(&scene, &plain, &tuning) == whole, "workgroups of {workgroup_size}");
    }
    for (submit_samples, submit_seconds) in [(1, 0.075), (4, 1e-9), (4, 60.0)] {
        let tuning = Tuning { submit_samples, submit_seconds, ..Tuning::default() };
        assert!(tuned(&scene, &plain, &tuning) == whole, "submissions of {submit_samples}");
    }
    let brute_force = RenderSettings { accel: Accel::None, ..plain.clone() };
    assert!(bits(&render(&scene, &brute_force)) == whole, "without a tree, each lane by itself");
    let crop = Crop { x: 5, y: 3, width: 13, height: 9 };
    let part = bits(&render(&scene, &RenderSettings { crop: Some(crop), ..plain }));
    let rows = whole.chunks(26).skip(3).take(9);
    let expected: Bits = rows.flat_map(|row| row[5..18].iter().copied()).collect();
    assert!(part == expected, "a crop");
}
