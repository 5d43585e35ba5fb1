//! A floor under a lamp that shows a picture: its light by quadrature over the texels.

use super::strategies::STRATEGIES;
use crate::common::{
    Estimate, Stage, assert_truth, emitter, lambert, quad_mesh, render, settings, with_uvs,
};
use glam::{Affine2, Affine3A, Vec2, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{ColorSpace, Image, Material, TextureRef, Wrap};

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
        assert_truth(&format!("{strategy:?}"), Estimate::of_pixels(&film), truth(), 0.02);
    }
}
