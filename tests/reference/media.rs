//! Volumes, leaves and coats against radiance that is known on paper.

use crate::closed_forms::{check_exact, fresnel, samples};
use crate::common::{Estimate, Stage, assert_truth, emitter, settings};
use crate::forms::closed_box;
use glam::{Affine3A, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::reference::Reference;
use steradian::scene::{Clearcoat, DiffuseTransmission, LightKind, Material, SpecularGlossiness};

/// Clear glass with an absorption per metre.
fn glass(ior: f32, absorption: f32) -> Material {
    Material {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        volume: true,
        ior,
        absorption: Vec3::splat(absorption),
        ..Material::default()
    }
}

/// Under a white sky, seen at an angle of sine `sin` from the vertical.
fn under_sky(sin: f32) -> Stage {
    let eye = Vec3::new(sin, f32::sqrt(1.0 - sin * sin), 0.0);
    let mut stage = Stage::orthographic(eye * 5.0, Vec3::ZERO, 1e-4);
    stage.sky(1.0);
    stage
}

/// A wide slab from -`depth` to 0.
fn slab(stage: &mut Stage, depth: f32, material: Material) {
    let half = 1000.0;
    let solid = closed_box(Vec3::new(-half, -depth, -half), Vec3::new(half, 0.0, half));
    let mesh = stage.mesh(solid, material);
    stage.place(mesh, Affine3A::from_translation(Vec3::new(0.1, 0.0, 0.2)));
}

/// What comes back from between two interfaces of reflectance `f`, if each way between them leaves
/// the share `kept`, and the same radiance shines on both from outside.
fn between(f: f64, kept: f64) -> f64 {
    f + (1.0 - f) * (1.0 - f) * kept / (1.0 - f * kept)
}

/// Beer and Lambert's law along refracted paths: each crossing is d / cos of the angle inside.
#[test]
fn a_slab_absorbs_along_the_refracted_path() {
    for (sin, ior, absorption, depth) in
        [(0.0, 1.5_f32, 0.8, 1.0), (0.8, 1.5, 0.8, 1.0), (0.6, 1.2, 2.0, 0.3)]
    {
        let mut stage = under_sky(sin);
        slab(&mut stage, depth, glass(ior, absorption));
        let sin_t = f64::from(sin) / f64::from(ior);
        let kept = (-f64::from(absorption) * f64::from(depth) / (1.0 - sin_t * sin_t).sqrt()).exp();
        let f = fresnel(f64::from(sin).max(1e-6), ior.into());
        let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 512)));
        assert_truth(&format!("slab, sin {sin}"), estimate, between(f, kept), 0.02);
    }
}

/// In a ball each way between two reflections is 2 R cos of the angle inside.
#[test]
fn a_ball_absorbs_along_its_chords() {
    for offset in [0.0_f32, 0.6] {
        let mut stage =
            Stage::orthographic(Vec3::new(offset, 5.0, 0.0), Vec3::new(offset, 0.0, 0.0), 1e-4);
        stage.sky(1.0);
        stage.sphere(Vec3::ZERO, 1.0, glass(1.4, 0.5));
        let sin = f64::from(offset);
        let chord = 2.0 * (1.0 - (sin / 1.4).powi(2)).sqrt();
        let f = fresnel(sin.max(1e-6), 1.4);
        let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 512)));
        assert_truth("ball", estimate, between(f, (-0.5 * chord).exp()), 0.02);
    }
}

/// The camera is inside: half of a chord, and what the inside of the interface leaves.
#[test]
fn a_camera_can_be_in_a_volume() {
    let mut stage = Stage::orthographic(Vec3::ZERO, Vec3::NEG_Y, 1e-4);
    stage.sky(1.0);
    stage.sphere(Vec3::ZERO, 2.0, glass(1.5, 0.3));
    let f = fresnel(1e-6, 1.5);
    let [half, whole] = [-0.6_f64, -1.2].map(f64::exp);
    // Radiance within is higher by the square of the index.
    let truth = half * (1.0 - f) * 2.25 / (1.0 - f * whole);
    let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 512)));
    assert_truth("from within", estimate, truth, 0.02);
}

/// Layers of glass in glass, by adding: a sheet in the middle of a slab. With the same index the
/// inner sheet is seen by its absorption only; with another it reflects by the ratio of both.
#[test]
fn volumes_lie_in_volumes() {
    for (inner, sin) in [(1.33_f32, 0.5_f32), (1.7, 0.5)] {
        let mut stage = under_sky(sin);
        slab(&mut stage, 1.0, glass(1.33, 0.4));
        let half = 900.0;
        let sheet = closed_box(Vec3::new(-half, -0.7, -half), Vec3::new(half, -0.3, half));
        let sheet = stage.mesh(sheet, glass(inner, 1.5));
        stage.place(sheet, Affine3A::from_translation(Vec3::new(0.1, 0.0, 0.2)));
        let (outer, inner, sin) = (f64::from(1.33_f32), f64::from(inner), f64::from(sin));
        let kept = |ior: f64, absorption: f64, depth: f64| {
            (-absorption * depth / (1.0 - (sin / ior).powi(2)).sqrt()).exp()
        };
        let f = [fresnel(sin, outer), fresnel(sin / outer, inner / outer)];
        let gap = kept(outer, 0.4, 0.3);
        // Reflectance and transmittance, of power, of the layers so far, from above and below.
        let interface = |f: f64| [f, 1.0 - f, f];
        let add = |[r, t, under]: [f64; 3], kept: f64, f: f64| {
            let [r2, t2, under2] = interface(f);
            let echo = 1.0 / (1.0 - under * r2 * kept * kept);
            [
                r + t * t * kept * kept * r2 * echo,
                t * kept * t2 * echo,
                under2 + t2 * t2 * kept * kept * under * echo,
            ]
        };
        let layers = add(interface(f[0]), gap, f[1]);
        let layers = add(layers, kept(inner, 1.5, 0.4), f[1]);
        let [r, t, _] = add(layers, gap, f[0]);
        let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 512)));
        assert_truth(&format!("a sheet of index {inner}"), estimate, r + t, 0.02);
    }
}

/// Three strips at the bottom of a tank where Snell's law has the three channels arrive: each is
/// seen in its own channel, with (1 - F) of its radiance by the square of the index.
#[test]
fn channels_refract_by_their_own_index() {
    let (sin, ior, dispersion, depth) = (0.8_f32, 1.5_f32, 2.0_f32, 1.0);
    let indices = [-1.0, 0.0, 1.0].map(|step| 1.5 + step * 0.5 * 0.025 * f64::from(dispersion));
    let place = |n: f64| {
        let sin_t = f64::from(sin) / n;
        -(sin_t / (1.0 - sin_t * sin_t).sqrt()) as f32
    };
    for lit in 0..3 {
        let eye = Vec3::new(sin, f32::sqrt(1.0 - sin * sin), 0.0);
        let mut stage = Stage::orthographic(eye, Vec3::ZERO, 1e-5);
        let m = Material { dispersion, ..glass(ior, 0.0) };
        stage.floor(Vec3::ZERO, 0.5, m);
        let (u, v) = (Vec3::Z, Vec3::X * 2e-3);
        stage.quad(Vec3::new(place(indices[lit]), -depth, 0.0), u, v, emitter(1.0));
        let reference = Reference::new(&stage.scene, &settings(1, 1, 1)).unwrap();
        let n = 20_000;
        let mean = (0..n).map(|i| reference.sample(0, 0, i)).sum::<glam::DVec3>() / f64::from(n);
        for c in 0..3 {
            let f = fresnel(sin.into(), indices[c]);
            let truth = if c == lit { (1.0 - f) / indices[c].powi(2) } else { 0.0 };
            // Two thirds of the samples have another channel, and of the rest F is reflected.
            let s = truth * f64::sqrt((3.0 / (1.0 - f) - 1.0) / f64::from(n));
            assert!(
                (mean[c] - truth).abs() <= 3.9 * s + 1e-4 * truth,
                "{lit}, {c}: {} {truth}",
                mean[c]
            );
        }
    }
}

/// A leaf lit from behind: E d colour / pi.
#[test]
fn a_leaf_shines_through() {
    let leaf = DiffuseTransmission {
        factor: 0.7,
        texture: None,
        color: Vec3::splat(0.6),
        color_texture: None,
    };
    let m = Material {
        metallic: 0.0,
        specular: 0.0,
        double_sided: true,
        diffuse_transmission: Some(leaf),
        ..Material::default()
    };
    for (from, side) in [(Vec3::Y, 1.0_f32), (Vec3::NEG_Y, 1.0), (Vec3::Y, -1.0)] {
        let mut stage = Stage::orthographic(from * 3.0, Vec3::ZERO, 1e-3);
        stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, m.clone());
        let direction = (from * side + Vec3::X * 0.75).normalize();
        stage.light(LightKind::Directional { direction }, 2.0);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(4, 4, 2) };
        // From behind by what goes through, from before by the rest of a white base.
        let albedo = if side > 0.0 { 0.7 * 0.6 } else { 0.3 };
        let truth = 2.0 * 0.8 * albedo / PI;
        check_exact("leaf", &stage.scene, &settings, truth);
    }
}

/// Under a white sky a smooth coat over black shows Fresnel's share; and a glossy white mirror of
/// specular-glossiness all of it.
#[test]
fn mirrors_show_the_sky() {
    let coat = Clearcoat {
        factor: 0.75,
        texture: None,
        roughness: 0.0,
        roughness_texture: None,
        normal_texture: None,
        normal_scale: 1.0,
    };
    let black = Material { base_color: Vec3::ZERO, metallic: 0.0, ..Material::default() };
    let coated = Material { specular: 0.0, clearcoat: Some(coat), ..black.clone() };
    let shiny = SpecularGlossiness { specular: Vec3::splat(0.5), glossiness: 1.0, texture: None };
    let glossy = Material { specular_glossiness: Some(shiny), ..black };
    let grazing = |cos: f64| (1.0 - cos).powi(5);
    for sin in [0.0_f32, 0.8] {
        let cos = f64::sqrt(1.0 - f64::from(sin).powi(2));
        let cases = [
            ("coat", coated.clone(), 0.75 * (0.04 + 0.96 * grazing(cos))),
            ("glossy", glossy.clone(), 0.5 + 0.5 * grazing(cos)),
        ];
        for (what, m, truth) in cases {
            let mut stage = under_sky(sin);
            stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, m);
            for sample in samples(&stage.scene, &settings(4, 4, 2)) {
                assert!((sample - truth).abs() < 1e-6, "{what}: {sample} for {truth}");
            }
        }
    }
}

/// The camera looks through the back of an open single-sided sheet; light does not.
#[test]
fn backs_are_hidden_from_the_camera_alone() {
    for (double_sided, seen) in [(false, 1.0), (true, 0.0)] {
        let mut stage = Stage::orthographic(Vec3::Y * 2.0, Vec3::ZERO, 0.1);
        stage.floor(Vec3::ZERO, 1.0, emitter(1.0));
        let sheet = Material {
            double_sided,
            base_color: Vec3::ZERO,
            specular: 0.0,
            metallic: 0.0,
            ..Material::default()
        };
        stage.ceiling(Vec3::Y, 1.0, sheet);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(4, 4, 2) };
        assert!(samples(&stage.scene, &settings).iter().all(|s| *s == seen), "{double_sided}");
    }
}

/// An unlit ceiling is a lamp: a white floor below its middle has the radiance of its form factor.
#[test]
fn unlit_surfaces_shine() {
    let mut stage = Stage::orthographic(Vec3::Y * 0.5, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, crate::common::lambert(1.0));
    let unlit = Material { base_color: Vec3::splat(0.25), unlit: true, ..Material::default() };
    // Its back is as bright as its front.
    stage.floor(Vec3::Y, 1.0, unlit.clone());
    let settings = RenderSettings { max_bounces: Some(1), ..settings(8, 8, 512) };
    let s = f64::sqrt(0.5);
    let truth = 0.25 * 4.0 * s * s.atan() / PI;
    let estimate = Estimate::of(&samples(&stage.scene, &settings));
    assert_truth("unlit", estimate, truth, 0.01);
}
