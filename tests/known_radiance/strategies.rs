//! Four estimators, two samplers, roulette on and off: one mean.

use crate::common::{
    Estimate, Stage, assert_agree, assert_truth, box_mesh, bundled, bundled_truth, emitter, grey,
    lambert, render, settings,
};
use glam::{Affine3A, Vec3};
use steradian::RenderSettings;
use steradian::scene::{Material, Mesh, Scene};
use steradian::settings::{LightSelection, Sampler, Strategy};

pub(super) const STRATEGIES: [Strategy; 4] =
    [Strategy::Hemisphere, Strategy::Bsdf, Strategy::Light, Strategy::Mis];

/// Sampler and roulette.
pub(super) type Choice = (Sampler, bool);

/// Two of the four choices, the other two for every other strategy: each setting is met on and
/// off by every strategy, and a kernel is compiled for each.
const HALVES: [[Choice; 2]; 2] = [
    [(Sampler::Sobol, true), (Sampler::Independent, false)],
    [(Sampler::Sobol, false), (Sampler::Independent, true)],
];

pub(super) const ALL: [Choice; 4] = [
    (Sampler::Sobol, true),
    (Sampler::Sobol, false),
    (Sampler::Independent, true),
    (Sampler::Independent, false),
];

/// Estimates in half of the cells of the matrix, in order.
fn estimates(scene: &Scene, base: &RenderSettings) -> Vec<(String, Estimate)> {
    let mut all = Vec::new();
    for (strategy, choices) in STRATEGIES.into_iter().zip(HALVES.into_iter().cycle()) {
        for (sampler, roulette) in choices {
            let settings = RenderSettings { strategy, sampler, roulette, ..base.clone() };
            let what = format!("{strategy:?}, {sampler:?}, roulette {roulette}");
            all.push((what, Estimate::of_pixels(&render(scene, &settings))));
        }
    }
    all
}

fn assert_all_agree(all: &[(String, Estimate)], visible_bias: f64) {
    for (i, (a_name, a)) in all.iter().enumerate() {
        for (b_name, b) in &all[..i] {
            assert_agree(&format!("{a_name} and {b_name}"), *a, *b, visible_bias);
        }
    }
}

/// Occlusion, a sampled light, and some twenty bounces.
#[test]
fn a_lamp_in_a_sphere() {
    let name = "tests/sphere-in-sphere";
    let all = estimates(&bundled(name), &settings(32, 32, 256));
    for (what, estimate) in &all {
        assert_truth(what, *estimate, bundled_truth(name), 0.035);
    }
    assert_all_agree(&all, 0.05);
}

/// Walls that emit and reflect, with lights sampled from inside them.
#[test]
fn a_furnace() {
    let name = "tests/furnace-sphere";
    // Without roulette nothing else ends a path; what is cut off is 2^-33.
    let settings = RenderSettings { max_bounces: Some(32), ..settings(16, 16, 128) };
    let all = estimates(&bundled(name), &settings);
    for (what, estimate) in &all {
        assert_truth(what, *estimate, bundled_truth(name), 0.02);
    }
}

/// A rough metal floor, a glossy dielectric wall and two kinds of light.
fn glossy_corner() -> Scene {
    let metal = Material {
        base_color: Vec3::splat(0.8),
        metallic: 1.0,
        roughness: 0.4,
        ..Material::default()
    };
    let plastic = Material {
        base_color: Vec3::splat(0.6),
        metallic: 0.0,
        roughness: 0.5,
        ..Material::default()
    };
    let mut stage = Stage::orthographic(Vec3::new(-1.0, 1.0, 0.3), Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, metal);
    stage.quad(Vec3::new(1.0, 0.9, 0.0), Vec3::Z, Vec3::Y, plastic);
    stage.ceiling(Vec3::new(0.3, 1.2, 0.1), 0.4, Material { double_sided: true, ..emitter(2.0) });
    stage.sphere(Vec3::new(0.5, 0.4, -0.4), 0.2, emitter(3.0));
    // Something to be in the way.
    stage.sphere(Vec3::new(0.3, 0.5, 0.3), 0.15, lambert(0.7));
    stage.scene
}

#[test]
fn glossy_surfaces_under_two_lights() {
    let all: Vec<_> = STRATEGIES
        .iter()
        .map(|&strategy| {
            let settings = RenderSettings { strategy, ..settings(32, 32, 256) };
            (format!("{strategy:?}"), Estimate::of_pixels(&render(&glossy_corner(), &settings)))
        })
        .collect();
    assert_all_agree(&all, 0.03);
}

/// With independent numbers and light samples alone the variance of n samples is 1/n of one's.
/// The variance of 1024 pixels is known to √(2/1023), so the logarithm of a ratio of two
/// to √(4/1023).
#[test]
fn more_light_samples_leave_the_mean_and_divide_the_variance() {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(0.5));
    stage.sphere(Vec3::new(1.9, 0.2, 0.0), 1.0, emitter(1.0));
    let estimate = |light_samples| {
        let settings = RenderSettings {
            strategy: Strategy::Light,
            sampler: Sampler::Independent,
            light_samples,
            ..settings(32, 32, 64)
        };
        Estimate::of_pixels(&render(&stage.scene, &settings))
    };
    let one = estimate(1);
    for n in [4, 16] {
        let many = estimate(n);
        assert_agree(&format!("{n} light samples"), many, one, 0.02);
        let ratio = (one.deviation / many.deviation).powi(2);
        let logarithm = (ratio / f64::from(n)).ln();
        let s = (4.0_f64 / 1023.0).sqrt();
        assert!(logarithm.abs() <= 3.9 * s, "variance falls by {ratio}, not by {n}");
    }
}

/// The same with the default strategy and sampler: the mean stays.
#[test]
fn more_light_samples_leave_the_mean_of_the_default() {
    let name = "tests/sphere-in-sphere";
    for light_samples in [4, 16] {
        let settings = RenderSettings { light_samples, ..settings(16, 16, 128) };
        let estimate = Estimate::of_pixels(&render(&bundled(name), &settings));
        assert_truth(
            &format!("{light_samples} light samples"),
            estimate,
            bundled_truth(name),
            0.02,
        );
    }
}

/// Where the truth differs from pixel to pixel: independent pictures of other seeds.
#[test]
fn a_picture_by_light_samples_and_without() {
    let scene = bundled("cornell-box");
    let observations = |strategy| -> Vec<f64> {
        let picture = |seed| {
            let settings = RenderSettings { strategy, seed, ..settings(16, 16, 64) };
            let pixels = grey(&render(&scene, &settings));
            pixels.iter().sum::<f64>() / pixels.len() as f64
        };
        (0..16).map(picture).collect()
    };
    let mis = Estimate::of(&observations(Strategy::Mis));
    let bsdf = Estimate::of(&observations(Strategy::Bsdf));
    assert_agree("cornell-box", mis, bsdf, 0.05);
}

/// Every way to choose a light, with and without candidates, and none.
fn selections(scene: &Scene, base: &RenderSettings) -> Vec<(String, Estimate)> {
    let mut all = Vec::new();
    let mut add = |what: &str, settings: RenderSettings| {
        all.push((what.to_owned(), Estimate::of_pixels(&render(scene, &settings))));
    };
    for (selection, candidates, strategy) in [
        (LightSelection::Uniform, 1, Strategy::Mis),
        (LightSelection::Power, 4, Strategy::Mis),
        (LightSelection::Tree, 1, Strategy::Light),
        (LightSelection::Tree, 1, Strategy::Mis),
        (LightSelection::Tree, 4, Strategy::Light),
        (LightSelection::Tree, 3, Strategy::Mis),
    ] {
        let settings = RenderSettings {
            strategy,
            light_selection: selection,
            light_candidates: candidates,
            ..base.clone()
        };
        add(&format!("{selection:?}, {candidates} candidates, {strategy:?}"), settings);
    }
    add("Bsdf", RenderSettings { strategy: Strategy::Bsdf, ..base.clone() });
    all
}

/// A closed box of albedo ½ whose walls, 768 triangles, emit 1: radiance 2 everywhere.
#[test]
fn a_furnace_of_many_lights() {
    let mut stage = Stage::perspective(Vec3::new(0.2, 0.1, 0.3), Vec3::new(0.0, 0.2, -1.0), 1.2);
    let wall = Material { emission: Vec3::ONE, ..lambert(0.5) };
    let outward = box_mesh(Vec3::ZERO, Vec3::new(1.0, 0.7, 1.3));
    let mut walls = Mesh { triangles: Vec::new(), ..outward.clone() };
    for [a, b, c] in outward.triangles {
        let [p, q, r] = [a, c, b].map(|i| outward.positions[i as usize]);
        const SIDE: u16 = 8;
        let at = |i: u16, j: u16| {
            p + (q - p) * (f32::from(i) / f32::from(SIDE))
                + (r - p) * (f32::from(j) / f32::from(SIDE))
        };
        for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE - i).map(move |j| (i, j))) {
            let mut add = |corners: [Vec3; 3]| {
                let first = walls.positions.len() as u32;
                walls.positions.extend(corners);
                walls.triangles.push([first, first + 1, first + 2]);
            };
            add([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < SIDE {
                add([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let walls = stage.mesh(walls, wall);
    stage.place(walls, Affine3A::IDENTITY);
    let settings = RenderSettings { max_bounces: Some(32), ..settings(16, 16, 128) };
    let all = selections(&stage.scene, &settings);
    for (what, estimate) in &all {
        assert_truth(what, *estimate, 2.0, 0.02);
    }
}

/// Lamps of powers that differ a thousandfold around a rough metal floor, seen from close by.
#[test]
fn lamps_of_many_powers() {
    let mut stage = Stage { scene: glossy_corner() };
    for k in 0..40_u8 {
        let (s, c) = (f32::from(k) * 2.399_963).sin_cos();
        let r = 0.15 * f32::from(k + 1).sqrt();
        let at = Vec3::new(r * s, 0.25 + 0.02 * f32::from(k % 17), r * c);
        let size = 0.02 + 0.004 * f32::from(k % 11);
        let both = Material { double_sided: k % 4 == 0, ..emitter(1.0 + f32::from(k % 7)) };
        stage.quad(at, Vec3::new(c, 0.3, s) * size, Vec3::new(-s, 0.4, c) * size, both);
    }
    let all = selections(&stage.scene, &settings(32, 32, 256));
    assert_all_agree(&all, 0.03);
}
