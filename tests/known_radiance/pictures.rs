//! A floor under a lamp that shows a picture, and under a large map of the sky: their light by
//! quadrature over the texels.

use super::strategies::STRATEGIES;
use crate::common::{
    Estimate, Stage, assert_truth, emitter, lambert, quad_mesh, render, settings, with_uvs,
};
use glam::{Affine2, Affine3A, Mat3, Vec2, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{ColorSpace, Environment, Image, Material, TextureRef, Wrap};
use steradian::settings::Strategy;

const SIDE: u32 = 32;
const ALBEDO: f32 = 0.5;
/// Where the lamp hangs, and half of its sides.
const LAMP: Vec3 = Vec3::new(0.3, 1.0, -0.2);

/// One bright block off the middle, some grey, the rest nearly black.
fn code(x: u32, y: u32) -> u8 {
    match (x, y) {
        (20..23, 5..9) => 255,
        (_, 28..) => 60,
        _ => 2,
    }
}

/// Radiance of the floor at the origin under the lamp of radiance 1 at code 255.
fn truth() -> f64 {
    // Midpoints of a texel's parts.
    const PARTS: u32 = 8;
    let n = SIDE * PARTS;
    let step = 2.0 / f64::from(n);
    let mut sum = 0.0;
    for i in 0..n {
        for k in 0..n {
            let x = f64::from(LAMP.x) - 1.0 + (f64::from(i) + 0.5) * step;
            let z = f64::from(LAMP.z) - 1.0 + (f64::from(k) + 0.5) * step;
            let d2 = x * x + f64::from(LAMP.y).powi(2) + z * z;
            // Both cosines are height over distance.
            let radiance = f64::from(code(i / PARTS, k / PARTS)) / 255.0;
            sum += radiance * f64::from(LAMP.y).powi(2) / (d2 * d2) * step * step;
        }
    }
    f64::from(ALBEDO) / PI * sum
}

#[test]
fn a_lamp_that_shows_a_picture() {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(ALBEDO));
    let rgba = (0..SIDE * SIDE).map(|i| code(i % SIDE, i / SIDE)).map(|c| [c, c, c, 255]);
    let image = Image { name: "picture".into(), width: SIDE, height: SIDE, rgba: rgba.collect() };
    stage.scene.images.push(image);
    let texture = TextureRef {
        image: 0,
        color_space: ColorSpace::Linear,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    let lamp = Material { emission_texture: Some(texture), ..emitter(1.0) };
    // u grows along x and v along z; it faces down.
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
    let mesh = stage.mesh(with_uvs(quad_mesh(LAMP, Vec3::X, Vec3::Z), corners), lamp);
    stage.place(mesh, Affine3A::IDENTITY);
    for strategy in STRATEGIES {
        let settings = RenderSettings { strategy, max_bounces: Some(1), ..settings(32, 32, 256) };
        let film = render(&stage.scene, &settings);
        // Directions of the surface seldom find the bright block.
        let visible_bias = match strategy {
            Strategy::Hemisphere | Strategy::Bsdf => 0.06,
            Strategy::Light | Strategy::Mis => 0.02,
        };
        let estimate = Estimate::of_pixels(&film);
        assert_truth(&format!("{strategy:?}"), estimate, truth(), visible_bias);
    }
}

/// So many texels that cells of the sampling table have several, and odd ones at the edges.
#[test]
fn a_sky_of_many_texels() {
    let (width, height) = (2049, 1027);
    // A bright patch that begins and ends within cells, on a dark sky.
    let is_bright = |x: u32, y: u32| (301..318).contains(&x) && (255..268).contains(&y);
    let texel = |x, y| if is_bright(x, y) { 400.0 } else { 0.05 };
    let radiance = (0..width * height).map(|i| Vec3::splat(texel(i % width, i / width)));
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(ALBEDO));
    stage.scene.environment = Some(Environment {
        name: "sky".into(),
        width,
        height,
        radiance: radiance.collect(),
        environment_from_world: Mat3::from_rotation_y(0.4),
        intensity: 1.0,
    });
    // A texel's light goes to its neighbours too, by symmetric weights: over so small a patch that
    // moves nothing that would show.
    let (step, turn) = (PI / f64::from(height), 2.0 * PI / f64::from(width));
    let mut irradiance = 0.0;
    for y in 0..height {
        let (top, bottom) = (f64::from(y) * step, f64::from(y + 1) * step);
        // Of the cosine over the upper half's part of the row.
        let projected =
            0.5 * (bottom.min(PI / 2.0).sin().powi(2) - top.min(PI / 2.0).sin().powi(2));
        irradiance += (0..width).map(|x| f64::from(texel(x, y))).sum::<f64>() * projected * turn;
    }
    let truth = f64::from(ALBEDO) / PI * irradiance;
    for strategy in [Strategy::Light, Strategy::Mis] {
        let settings = RenderSettings { strategy, max_bounces: Some(1), ..settings(32, 32, 256) };
        let film = render(&stage.scene, &settings);
        assert_truth(&format!("{strategy:?}"), Estimate::of_pixels(&film), truth, 0.01);
    }
}
