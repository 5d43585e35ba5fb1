//! The smallest roughness, and reflectances that no surface has.

use crate::common::{Stage, assert_at_most, assert_naive_fails, grey, render, report, settings};
use crate::gltf_fixture::{Fixture, has_notice};
use glam::{Mat3, Vec3};
use serde_json::json;
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{Environment, Material, Treatment};
use steradian::settings::Strategy;

/// A curved metal of this roughness under a sky that grows brighter towards one side.
fn metal_under_a_gradient(roughness: f32, spp: u32) -> Vec<f64> {
    const ROWS: u32 = 64;
    let row = |y: u32| 1.0 + 0.5 * (PI * (f64::from(y) + 0.5) / f64::from(ROWS)).cos();
    let mut stage = Stage::perspective(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO, 0.5);
    stage.sphere(Vec3::ZERO, 1.0, Material { roughness, ..Material::default() });
    stage.scene.environment = Some(Environment {
        width: 4,
        height: ROWS,
        radiance: (0..ROWS).flat_map(|y| [Vec3::splat(row(y) as f32); 4]).collect(),
        environment_from_world: Mat3::from_rotation_z(1.0),
        ..Environment::constant(Vec3::ZERO)
    });
    let settings = RenderSettings { strategy: Strategy::Bsdf, ..settings(16, 16, spp) };
    grey(&render(&stage.scene, &settings))
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max)
}

/// Alpha is the square of roughness; the lobe of the least alpha that is one looks like a mirror.
#[test]
fn g2_the_least_rough_metal_is_nearly_a_mirror() {
    let mirror = metal_under_a_gradient(0.0, 256);
    let below = metal_under_a_gradient(0.0316, 256);
    let least = metal_under_a_gradient(0.031_63, 256);
    assert_eq!(mirror, below, "alpha below 1e-3 is a mirror");
    assert_ne!(mirror, least, "alpha from 1e-3 is a lobe");
    let what = "alpha 1e-3 against a mirror, gradient sky, 256 pixels: largest difference";
    assert_at_most("G2", what, largest_difference(&least, &mirror), 1e-3);
    let wide = largest_difference(&metal_under_a_gradient(0.1_f32.sqrt(), 64), &mirror);
    assert_naive_fails("G2", "the same for a visible roughness, alpha 0.1", wide, 1e-3);
}

#[test]
fn g13_reflectances_out_of_range_are_clamped_and_told() {
    let mut fixture = Fixture::with_material(json!({
        "emissiveFactor": [-1.0, 0.0, 3.0],
        "pbrMetallicRoughness": {
            "baseColorFactor": [1.5, -0.5, 0.5, 1.0], "metallicFactor": 2.0, "roughnessFactor": -1.0,
        },
        "extensions": {
            "KHR_materials_ior": {"ior": 0.5},
            "KHR_materials_specular": {"specularFactor": 1.5, "specularColorFactor": [-1.0, 1.0, 9.0]},
            "KHR_materials_transmission": {"transmissionFactor": -0.5},
        },
    }));
    let colors = [2.0, 0.5, -1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let colors = fixture.floats("VEC3", &colors);
    fixture.attribute("COLOR_0", colors);
    let scene = fixture.scene();
    let m = &scene.materials[0];
    assert_eq!(m.base_color, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!((m.metallic, m.roughness, m.ior), (1.0, 0.0, 1.0));
    assert_eq!((m.specular, m.transmission), (1.0, 0.0));
    assert_eq!(m.specular_color, Vec3::new(0.0, 1.0, 9.0));
    assert_eq!(m.emission, Vec3::new(0.0, 0.0, 3.0));
    assert_eq!(scene.meshes[0].colors[0].truncate(), Vec3::new(1.0, 0.5, 0.0));
    let told = [
        "baseColorFactor outside [0, 1] clamped",
        "metallicFactor outside [0, 1] clamped",
        "roughnessFactor outside [0, 1] clamped",
        "specularFactor outside [0, 1] clamped",
        "transmissionFactor outside [0, 1] clamped",
        "negative specularColorFactor clamped",
        "negative emissiveFactor clamped",
        "ior below 1 clamped",
        "vertex colours outside [0, 1] clamped",
    ];
    for what in told {
        assert!(has_notice(&scene, Treatment::Approximated, what), "{what}: {:?}", scene.notices);
    }
    report("G13", "reflectances out of range that are told and clamped", told.len() as f64);
    let message = fixture.load_strict().unwrap_err().to_string();
    assert!(message.contains("clamped"), "{message}");
}
