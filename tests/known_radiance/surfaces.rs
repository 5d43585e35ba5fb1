//! Alpha, textures and normal maps.

use crate::common::{
    Estimate, STRIP, Stage, assert_constant, assert_truth, emitter, lambert, quad_mesh, render,
    settings, strips, with_uvs,
};
use glam::{Affine2, Affine3A, Vec2, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::scene::{AlphaMode, ColorSpace, Image, LightKind, Material, TextureRef, Wrap};

fn see_through(alpha_mode: AlphaMode, alpha: f32) -> Material {
    Material { alpha_mode, alpha, ..lambert(0.0) }
}

/// n sheets present with probability ½ let 2^-n through, to the camera and to light samples.
#[test]
fn blended_sheets_let_the_rest_through() {
    for n in 1..=3 {
        let mut stage = Stage::orthographic(Vec3::Y * 2.0, Vec3::ZERO, 1e-3);
        stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, emitter(1.0));
        for k in 1..=n {
            let at = Vec3::new(0.1, 0.2 * k as f32, 0.2);
            stage.floor(at, 1.0, see_through(AlphaMode::Blend, 0.5));
        }
        let film = render(&stage.scene, &settings(32, 32, 1024));
        assert_truth("seen", Estimate::of_pixels(&film), 0.5_f64.powi(n), 0.015);

        let mut stage = Stage::orthographic(Vec3::Y * 0.1, Vec3::ZERO, 1e-3);
        stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, lambert(1.0));
        for k in 1..=n {
            let at = Vec3::new(0.1, 0.2 * k as f32, 0.2);
            stage.floor(at, 1.0, see_through(AlphaMode::Blend, 0.5));
        }
        stage.light(LightKind::Directional { direction: Vec3::NEG_Y }, PI as f32);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(32, 32, 1024) };
        let film = render(&stage.scene, &settings);
        assert_truth("lit", Estimate::of_pixels(&film), 0.5_f64.powi(n), 0.015);
    }
}

#[test]
fn masked_sheets_are_there_or_not() {
    for (alpha, seen) in [(0.4, 1.0), (0.5, 0.0), (0.6, 0.0)] {
        let mut stage = Stage::orthographic(Vec3::Y * 2.0, Vec3::ZERO, 1e-3);
        stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, emitter(1.0));
        let sheet = see_through(AlphaMode::Mask(0.5), alpha);
        stage.floor(Vec3::new(0.1, 0.5, 0.2), 1.0, sheet);
        assert_constant("mask", &render(&stage.scene, &settings(8, 8, 4)), seen);
    }
}

/// The linear value of an 8-bit sRGB code (IEC 61966-2-1).
fn linear(code: u8) -> f64 {
    let c = f64::from(code) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Two by two texels: 0 and 255 above, 128 and 10 below.
fn four_texels() -> Image {
    let grey = |c: u8| [c, c, c, 255];
    Image { name: "texels".into(), width: 2, height: 2, rgba: [0, 255, 128, 10].map(grey).into() }
}

fn texture(image: u32, color_space: ColorSpace) -> TextureRef {
    TextureRef {
        image,
        color_space,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    }
}

/// An emissive texture looked up at one place, which is the same over a whole strip.
#[test]
fn texels_are_decoded_filtered_and_wrapped() {
    let code = |c: u8| f64::from(c) / 255.0;
    let nearest = |space| texture(0, space);
    let smooth = |wrap| TextureRef { nearest: false, wrap: [wrap; 2], ..nearest(ColorSpace::Srgb) };
    let turned = TextureRef {
        transform: Affine2::from_translation(Vec2::new(0.5, 0.0)),
        ..nearest(ColorSpace::Linear)
    };
    let mean = |codes: [u8; 2]| (linear(codes[0]) + linear(codes[1])) / 2.0;
    let cases = [
        (nearest(ColorSpace::Srgb), [0.25, 0.25], linear(0)),
        (nearest(ColorSpace::Srgb), [0.75, 0.25], linear(255)),
        (nearest(ColorSpace::Srgb), [0.25, 0.75], linear(128)),
        (nearest(ColorSpace::Srgb), [0.75, 0.75], linear(10)),
        (nearest(ColorSpace::Linear), [0.25, 0.75], code(128)),
        (nearest(ColorSpace::Linear), [-0.75, 2.75], code(128)),
        (turned, [0.25, 0.75], code(10)),
        // Values are decoded before they are filtered.
        (smooth(Wrap::Repeat), [0.5, 0.25], mean([0, 255])),
        (smooth(Wrap::Repeat), [0.25, 0.5], mean([0, 128])),
        (smooth(Wrap::Repeat), [0.0, 0.75], mean([10, 128])),
        (smooth(Wrap::ClampToEdge), [0.0, 0.75], linear(128)),
        (smooth(Wrap::ClampToEdge), [9.0, 0.75], linear(10)),
        (smooth(Wrap::MirroredRepeat), [0.0, 0.75], linear(128)),
        (smooth(Wrap::MirroredRepeat), [1.25, 0.75], linear(10)),
        (smooth(Wrap::MirroredRepeat), [1.75, 0.75], linear(128)),
    ];
    let count = cases.len() as f32;
    let mut stage = Stage::orthographic(Vec3::Y, Vec3::ZERO, 0.5);
    let camera = &mut stage.scene.cameras[0].world_from_camera.matrix3;
    (camera.x_axis, camera.y_axis) = (Vec3::X.into(), Vec3::NEG_Z.into());
    stage.scene.images.push(four_texels());
    for (k, (texture, at, _)) in cases.iter().enumerate() {
        let x = k as f32 - (count - 1.0) / 2.0;
        let strip = quad_mesh(Vec3::new(x, 0.0, 0.0), Vec3::Z * 0.5, Vec3::X * 0.5);
        let glow = Material { emission_texture: Some(*texture), ..emitter(2.0) };
        let mesh = stage.mesh(with_uvs(strip, [Vec2::from(*at); 4]), glow);
        stage.place(mesh, Affine3A::IDENTITY);
    }
    let settings =
        RenderSettings { max_bounces: Some(0), ..settings(STRIP * cases.len() as u32, STRIP, 1) };
    for ((texture, at, expected), strip) in
        cases.iter().zip(strips(&render(&stage.scene, &settings)))
    {
        // WGSL allows pow an error of 16 units in the last place here, filtering adds a few.
        let error = (strip.mean - 2.0 * expected).abs();
        assert!(
            error <= 2.0 * (expected * 2e-6 + 1e-7),
            "{texture:?} at {at:?}: {strip:?}, {expected}"
        );
        assert!(strip.deviation <= 1e-6, "{at:?} varies: {strip:?}");
    }
}

/// Radiance of a white quad with this normal map texel under parallel light from `to_light`.
fn normal_mapped(texel: [u8; 3], normal_scale: f32, to_light: Vec3, mirrored: bool) -> Film {
    let mut stage = Stage::orthographic(Vec3::Y * 0.1, Vec3::ZERO, 1e-3);
    let [r, g, b] = texel;
    let rgba = vec![[r, g, b, 255]];
    stage.scene.images.push(Image { name: "normal".into(), width: 1, height: 1, rgba });
    let normal_texture = Some(texture(0, ColorSpace::Linear));
    let surface = Material { normal_texture, normal_scale, ..lambert(1.0) };
    // u grows along x and v along z, as in a picture that is seen from above with v downwards.
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(Vec2::from);
    let mesh = quad_mesh(Vec3::new(0.1, 0.0, 0.2), Vec3::Z, Vec3::X);
    let mesh = stage.mesh(with_uvs(mesh, corners), surface);
    let across = if mirrored { -1.0 } else { 1.0 };
    stage.place(mesh, Affine3A::from_scale(Vec3::new(across, 1.0, 1.0)));
    stage.light(LightKind::Directional { direction: -to_light }, PI as f32);
    render(&stage.scene, &RenderSettings { max_bounces: Some(1), ..settings(4, 4, 1) })
}

/// Red tilts the normal along u, green against v, by glTF's convention.
#[test]
fn normal_maps_tilt_the_normal() {
    let texel = [200, 90, 220];
    let decoded = texel.map(|c| f64::from(c) / 255.0 * 2.0 - 1.0);
    let to_light = Vec3::new(0.3, 0.8, -0.4).normalize();
    for (scale, mirrored) in [(1.0, false), (0.5, false), (1.0, true)] {
        let side = if mirrored { -1.0 } else { 1.0 };
        let n = glam::DVec3::new(side * decoded[0] * scale, decoded[2], -decoded[1] * scale)
            .normalize();
        let truth = n.dot(to_light.as_dvec3());
        let film = normal_mapped(texel, scale as f32, to_light, mirrored);
        assert_constant(&format!("scale {scale}, mirrored {mirrored}"), &film, truth);
    }
}

#[test]
fn a_neutral_normal_map_changes_nothing() {
    let to_light = Vec3::new(0.3, 0.8, -0.4).normalize();
    // Eight bits have no ½: the scale 0 makes it so.
    let film = normal_mapped([128, 128, 255], 0.0, to_light, false);
    assert_constant("neutral", &film, f64::from(to_light.y));
}
