//! F5 to F7: triangles that emit.

use super::{ALBEDO, draw};
use crate::common::{
    Estimate, Random, Stage, assert_at_most, assert_naive_fails, emitter, grey, lambert, render,
    settings,
};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use steradian::RenderSettings;
use steradian::scene::{Material, Scene};
use steradian::settings::Strategy;

/// A square light of area `area` and radiance 1 / area at distance 1, above a receiver that is
/// tilted by 40°: E = cos 40°. Gives the relative error.
fn tiny_light(area: f64) -> f64 {
    let (sin, cos) = 40.0_f64.to_radians().sin_cos();
    let normal = DVec3::new(sin, cos, 0.0).as_vec3();
    let across = Vec3::new(-normal.y, normal.x, 0.0);
    let mut stage = Stage::orthographic(normal * 0.01, Vec3::ZERO, 1e-7);
    let center = 0.002 * across + Vec3::Z * 0.001;
    stage.quad(center, Vec3::Z * 0.01, -across * 0.01, lambert(ALBEDO));
    let half = (0.5 * area.sqrt()) as f32;
    let radiance = (1.0 / area) as f32;
    stage.ceiling(Vec3::Y, half, emitter(radiance));
    let area = (2.0 * f64::from(half)).powi(2);
    let truth = f64::from(ALBEDO) / PI * f64::from(radiance) * area * cos;
    (Estimate::of_pixels(&render(&stage.scene, &settings(8, 8, 4))).mean / truth - 1.0).abs()
}

#[test]
fn f5_a_tiny_light_of_vast_radiance() {
    let error = tiny_light(1e-12);
    assert_at_most("F5", "irradiance of area 1e-12, radiance 1e12: relative error", error, 1e-5);
    let error = tiny_light(1e-24);
    assert_at_most("F5", "irradiance of area 1e-24, radiance 1e24: relative error", error, 1e-5);
    // The density 1e24 squared, as in the usual form of the power heuristic.
    let (p, q) = (1e24_f32, 0.3_f32);
    let weight = f64::from(p * p / (p * p + q * q));
    let error = if weight.is_nan() { f64::INFINITY } else { (weight - 1.0).abs() };
    assert_naive_fails("F5", "weight by squares of densities: error", error, 1.0);
}

/// A receiver and a light in one plane, on either side of which the light emits.
fn coplanar() -> Scene {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(ALBEDO));
    let lamp = Material { double_sided: true, ..emitter(1.0) };
    stage.floor(Vec3::X * 0.5, 0.4, lamp);
    stage.scene
}

#[test]
fn f6_a_light_in_the_receivers_plane_gives_nothing() {
    let scene = coplanar();
    for strategy in [Strategy::Mis, Strategy::Light, Strategy::Bsdf] {
        let settings = RenderSettings { strategy, ..settings(16, 16, 16) };
        let most = grey(&render(&scene, &settings)).into_iter().fold(0.0, f64::max);
        assert_at_most("F6", &format!("light seen edge-on, {strategy:?}: radiance"), most, 0.0);
    }
    let mut random = Random(70);
    let places: Vec<Vec3> =
        (0..1 << 12).map(|_| Vec3::new(random.unit() * 2.0, 0.0, random.unit() - 0.5)).collect();
    let drawn = draw(&scene, &places, &mut random);
    let wrong = drawn.iter().filter(|d| d.pdf != 0.0 || d.weight != Vec3::ZERO).count();
    assert_at_most("F6", "samples of a light seen edge-on, of 4096", wrong as f64, 0.0);
    // The usual density d² / (A cos) of such a sample, and its weight.
    let p = 1.0_f32 / (0.64 * 0.0);
    let is_lost = !(p * p / (p * p + 1.0)).is_finite();
    assert_naive_fails(
        "F6",
        "weights with the density d²/(A cos), not finite",
        f64::from(u8::from(is_lost)),
        1.0,
    );
}

/// Lambert's formula: the form factor of a polygon above the horizon of the normal `n`.
fn polygon_form_factor(corners: &[DVec3], n: DVec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % corners.len()].normalize());
        let cross = a.cross(b);
        // The edge's angle times the cosine between the normals.
        cross.length().atan2(a.dot(b)) * cross.dot(n) / cross.length()
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / TAU
}

/// A unit square in a wall that meets the floor; the receiver is on the floor, at `distance`
/// from the wall.
fn flush(distance: f32) -> (Scene, f64) {
    let eye = Vec3::Y * 0.1 * distance;
    let mut stage = Stage::orthographic(eye, Vec3::ZERO, 1e-3 * distance);
    let half = 0.9 * distance;
    stage.floor(Vec3::new(0.2, 0.0, 0.1) * half, half, lambert(ALBEDO));
    let x = -distance;
    // v × u of these sides points along +x.
    stage.quad(Vec3::new(x, 0.5, 0.0), Vec3::Y * 0.5, Vec3::Z * 0.5, emitter(1.0));
    let corner = |y: f64, z: f64| DVec3::new(x.into(), y, z);
    let corners = [corner(0.0, -0.5), corner(1.0, -0.5), corner(1.0, 0.5), corner(0.0, 0.5)];
    (stage.scene, f64::from(ALBEDO) * polygon_form_factor(&corners, DVec3::Y))
}

/// One sample a pixel, so that the picture shows the spread of samples. Samples of an area have
/// the factor 1/d², which MIS takes away.
#[test]
fn f7_a_receiver_that_touches_a_light() {
    let (mut worst_z, mut most, mut usual) = (0.0_f64, 0.0_f64, 0.0_f64);
    for distance in [1e-1_f32, 1e-2, 1e-3, 1e-4, 1e-5] {
        let (scene, truth) = flush(distance);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(256, 256, 1) };
        let pixels = grey(&render(&scene, &settings));
        let e = Estimate::of(&pixels);
        let largest = pixels.iter().copied().fold(0.0, f64::max) / truth;
        let z = (e.mean - truth) / e.standard_error;
        println!("at {distance}: {} for {truth}, z = {z:.2}, max/mean {largest}", e.mean);
        assert!(e.standard_error <= 0.01 * truth / 2.0, "{e:?}");
        worst_z = worst_z.max(z.abs());
        most = most.max(largest);
        let alone = RenderSettings { strategy: Strategy::Light, ..settings };
        let pixels = grey(&render(&scene, &alone));
        usual = usual.max(pixels.into_iter().fold(0.0, f64::max) / truth);
    }
    let what = "flush light, distance 1e-1..1e-5, against Lambert's formula: largest |z|";
    assert_at_most("F7", what, worst_z, 3.9);
    assert_at_most("F7", "flush light, the same: largest sample over mean", most, 1e3);
    let what = "flush light by area samples alone: largest sample over mean";
    assert_naive_fails("F7", what, usual, 1e3);
}
