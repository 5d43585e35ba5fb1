//! Weights of the two ways to find a light.

use crate::common::{
    Call, Stage, assert_at_least, assert_at_most, assert_naive_fails, emitter, harness, lambert,
    report,
};
use glam::{Mat3, Vec3};
use steradian::RenderSettings;
use steradian::scene::{Environment, Material, Scene};

/// Densities of light samples and of scattering, and the weights of both.
const PAIRS: [([f32; 2], [f32; 2]); 9] = [
    ([1e20, 1e20], [0.5, 0.5]),
    ([3e19, 1e-3], [1.0, 0.0]),
    ([1e-3, 3e19], [0.0, 1.0]),
    ([1e-23, 1e-23], [0.5, 0.5]),
    ([1e-23, 1e20], [0.0, 1.0]),
    ([0.0, 0.0], [0.0, 0.0]),
    ([1.0, 0.0], [1.0, 0.0]),
    ([0.0, 1.0], [0.0, 1.0]),
    ([3.0, 1.0], [0.9, 0.1]),
];

#[test]
fn h1_weights_of_extreme_densities() {
    let mut stage = Stage::perspective(Vec3::Y, Vec3::ZERO, 1.0);
    stage.floor(Vec3::ZERO, 1.0, lambert(0.5));
    let settings = RenderSettings::default();
    let mut inputs: Vec<[f32; 2]> = PAIRS.iter().map(|(pdfs, _)| *pdfs).collect();
    inputs.resize(64, [1.0, 1.0]);
    let outputs: Vec<[f32; 4]> =
        Call::new(harness!("mis"), &[]).on(&stage.scene, &settings).run(&inputs, 1);
    let (mut worst, mut naive) = (0.0_f64, 0);
    for ((pdfs, weights), out) in PAIRS.iter().zip(&outputs) {
        let [light, emission, by_squares, _] = *out;
        for (weight, expected) in [light, emission].into_iter().zip(weights) {
            assert!(weight.is_finite(), "{pdfs:?}: {weight}");
            worst = worst.max(f64::from((weight - expected).abs()));
        }
        let error = (by_squares - weights[0]).abs();
        naive += usize::from(error > 1e-6 || by_squares.is_nan());
    }
    let what = "power heuristic, 9 pairs of densities";
    assert_at_most("H1", &format!("{what}: error of a weight"), worst, 1e-6);
    assert_naive_fails("H1", &format!("{what}, squares: wrong"), naive as f64, 3.0);
}

/// A glossy floor, a plastic wall and a dull sphere under a square, a sphere and a sky.
fn mixed() -> Scene {
    let metal = Material { base_color: Vec3::splat(0.8), roughness: 0.5, ..Material::default() };
    let plastic = Material { metallic: 0.0, roughness: 0.4, ..metal.clone() };
    let mut stage = Stage::perspective(Vec3::new(-3.0, 2.5, 2.0), Vec3::new(0.5, 0.3, 0.0), 0.8);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 4.0, metal);
    stage.quad(Vec3::new(2.0, 1.0, 0.0), Vec3::Z * 3.0, Vec3::Y * 2.0, plastic);
    stage.sphere(Vec3::new(0.3, 0.5, 0.9), 0.5, lambert(0.7));
    stage.ceiling(Vec3::new(0.3, 3.0, 0.1), 0.7, emitter(4.0));
    stage.sphere(Vec3::new(-0.4, 1.3, -0.9), 0.3, emitter(6.0));
    const ROWS: u32 = 32;
    let row = |y: u32| Vec3::splat(0.2 + (y as f32 / ROWS as f32));
    stage.scene.environment = Some(Environment {
        width: 4,
        height: ROWS,
        radiance: (0..ROWS).flat_map(|y| [row(y); 4]).collect(),
        environment_from_world: Mat3::from_rotation_z(0.7),
        ..Environment::constant(Vec3::ZERO)
    });
    stage.scene
}

/// Where a light is sampled, what a scattered ray in that direction would weigh the light with
/// is one less the light sample's weight. The ray finds its own point on the light and its own
/// density there, through the same functions.
#[test]
fn h2_weights_of_both_ways_add_up_to_one() {
    let scene = mixed();
    let settings = RenderSettings { light_samples: 2, ..RenderSettings::default() };
    let inputs: Vec<u32> = (0..9 << 17).map(|i| i % 2).collect();
    let outputs: Vec<[f32; 4]> =
        Call::new(harness!("mis_vertices"), &[]).on(&scene, &settings).run(&inputs, 1);
    let count = |what: f32| outputs.iter().filter(|o| o[0] == what).count() as f64;
    println!("no light {}, hidden {}, missed {}", count(-1.0), count(-2.0), count(-3.0));
    let met: Vec<_> = outputs.iter().filter(|o| o[0] >= 0.0).collect();
    let error = |o: &[f32; 4]| (f64::from(o[0]) + f64::from(o[1]) - 1.0).abs();
    // Weights of every kind, not only those near 0 or 1.
    let balanced = met.iter().filter(|o| (0.1..0.9).contains(&o[0])).count();
    assert_at_least("H2", "vertices whose sampled light was met", met.len() as f64, 1e6);
    assert!(balanced * 10 >= met.len(), "{balanced} of {}", met.len());
    let worst = met.iter().map(|o| error(o)).fold(0.0, f64::max);
    let beyond = met.iter().filter(|o| error(o) > 1e-6).count() as f64;
    report(
        "H2",
        "share of vertices with |sum of the weights - 1| over 1e-6",
        beyond / met.len() as f64,
    );
    assert_at_most("H2", "largest |sum of the weights - 1|, 1e6 vertices", worst, 1e-6);
}
