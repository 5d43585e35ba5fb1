//! Light without extent, mirrors, and which side of a surface emits: exact at one sample.

use crate::common::{Stage, assert_constant, emitter, lambert, render, settings};
use glam::Vec3;
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{LightKind, Material};
use steradian::settings::Strategy;

/// A receiver at the origin that faces up, seen over so small a field that light does not vary.
fn receiver(albedo: f32) -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-9);
    stage.floor(Vec3::new(0.2, 0.0, 0.1), 1.0, lambert(albedo));
    stage
}

/// A mirror of this reflectance at normal incidence.
fn mirror(reflectance: f32) -> Material {
    Material {
        base_color: Vec3::splat(reflectance),
        metallic: 1.0,
        roughness: 0.0,
        ..Material::default()
    }
}

/// KHR_lights_punctual: clamp(1 - (d / range)⁴) times the inverse square.
#[test]
fn a_range_windows_the_light() {
    for (range, window) in [(4.0, 1.0 - 0.5_f64.powi(4)), (2.0, 0.0), (1.0, 0.0)] {
        let mut stage = receiver(0.5);
        stage.light(LightKind::Point { position: Vec3::Y * 2.0, range }, 4.0);
        let truth = 0.5 * 4.0 / (PI * 4.0) * window;
        assert_constant("range", &render(&stage.scene, &settings(4, 4, 1)), truth);
    }
}

/// KHR_lights_punctual: the square of (cos - cos outer) / (cos inner - cos outer).
#[test]
fn a_spot_falls_off_between_its_cones() {
    let (cos_inner, cos_outer) = (0.9_f32, 0.5);
    for degrees in [0.0_f64, 20.0, 30.0, 45.0, 55.0, 65.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut stage = receiver(0.5);
        let direction = Vec3::new(sin as f32, -cos as f32, 0.0);
        let position = Vec3::Y;
        let range = f32::INFINITY;
        let kind = LightKind::Spot { position, direction, cos_inner, cos_outer, range };
        stage.light(kind, 3.0);
        let falloff =
            ((cos - f64::from(cos_outer)) / f64::from(cos_inner - cos_outer)).clamp(0.0, 1.0);
        let truth = 0.5 * 3.0 / PI * falloff * falloff;
        assert_constant(&format!("{degrees}°"), &render(&stage.scene, &settings(4, 4, 1)), truth);
    }
}

/// Two mirrors at 45° to the path, and at its end an emitter: F1 F2 L by Schlick's formula.
#[test]
fn a_chain_of_mirrors_multiplies() {
    let side = Vec3::Z;
    let tilted = |x: f32, y: f32| (side, Vec3::new(x, y, 0.0));
    let mut stage = Stage::orthographic(Vec3::Y * 0.5, Vec3::ZERO, 1e-3);
    // Down, then along +x, then up, to an emitter above.
    let (u, v) = tilted(0.2, -0.2);
    stage.quad(Vec3::new(0.01, -0.01, 0.0), u, v, mirror(0.5));
    let (u, v) = tilted(0.2, 0.2);
    stage.quad(Vec3::new(2.01, 0.01, 0.0), u, v, mirror(0.25));
    stage.ceiling(Vec3::new(2.0, 1.0, 0.0), 0.1, emitter(8.0));
    let fresnel = |f0: f64| f0 + (1.0 - f0) * (1.0 - 0.5_f64.sqrt()).powi(5);
    let truth = fresnel(0.5) * fresnel(0.25) * 8.0;
    assert_constant("mirrors", &render(&stage.scene, &settings(4, 4, 1)), truth);
}

/// A single-sided emitter is dark from behind, to the camera and to what it might light.
#[test]
fn only_fronts_emit_unless_double_sided() {
    for double_sided in [false, true] {
        let lamp = Material { double_sided, ..emitter(3.0) };
        let mut stage = Stage::orthographic(Vec3::Y * 0.5, Vec3::ZERO, 1e-3);
        stage.ceiling(Vec3::new(0.1, 0.0, 0.2), 1.0, lamp.clone());
        let seen = if double_sided { 3.0 } else { 0.0 };
        assert_constant("from behind", &render(&stage.scene, &settings(4, 4, 4)), seen);

        for strategy in [Strategy::Mis, Strategy::Bsdf] {
            let mut stage = receiver(0.5);
            stage.floor(Vec3::new(0.1, 1.0, 0.2), 1.0, lamp.clone());
            let settings = RenderSettings { strategy, ..settings(8, 8, 64) };
            let light = render(&stage.scene, &settings).picture().rgb;
            assert_eq!(light.iter().any(|c| c[0] > 0.0), double_sided, "{strategy:?}");
        }
    }
}
