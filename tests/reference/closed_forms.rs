//! The reference against radiance that is known on paper.

use crate::common::{
    Estimate, Stage, assert_truth, bundled, bundled_truth, emitter, lambert, settings,
};
use glam::Vec3;
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::reference::{Reference, render};
use steradian::scene::{AlphaMode, LightKind, Material, Scene};
use steradian::settings::Crop;

/// Relative error of a path in f64 with f32 numbers of the scene, in which only rounding is left
/// to chance: positions and colours of the scene are off by 2^-24 each from the paper's.
const ROUNDING: f64 = 8.0 / 16_777_216.0;

/// Samples of all pixels of a small picture: independent observations of one radiance.
pub(crate) fn samples(scene: &Scene, settings: &RenderSettings) -> Vec<f64> {
    let reference = Reference::new(scene, settings).unwrap();
    let (width, height) = settings.resolution;
    let mut all = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        all.extend((0..settings.spp).map(|i| reference.sample(x, y, i).element_sum() / 3.0));
    }
    all
}

fn check(name: &str, spp: u32, visible_bias: f64) {
    let name = format!("tests/{name}");
    let estimate = Estimate::of(&samples(&bundled(&name), &settings(8, 8, spp)));
    assert_truth(&name, estimate, bundled_truth(&name), visible_bias);
}

/// That no sample deviates from `truth` by more than rounding.
pub(crate) fn check_exact(what: &str, scene: &Scene, settings: &RenderSettings, truth: f64) {
    for sample in samples(scene, settings) {
        assert!((sample - truth).abs() <= ROUNDING * truth, "{what}: {sample} for {truth}");
    }
}

#[test]
fn the_bundled_scenes_have_the_radiance_that_they_say() {
    for name in ["furnace-box", "furnace-sphere", "white-furnace", "white-furnace-mixed"] {
        check(name, 128, 0.01);
    }
    for name in ["sphere-light", "quad-light"] {
        check(name, 512, 0.01);
    }
    check("sphere-in-sphere", 256, 0.03);
    check("glass-slab", 256, 0.02);
}

#[test]
fn what_chance_has_no_part_in_is_exact() {
    for name in ["point-light", "spot-light", "directional-light", "metal-fresnel"] {
        let name = format!("tests/{name}");
        check_exact(&name, &bundled(&name), &settings(4, 4, 2), bundled_truth(&name));
    }
}

/// With E = albedo = ½ the light scattered k times is 2^-(k+1), up to k times 1 - 2^-(k+1).
#[test]
fn every_bounce_of_a_furnace_is_half_the_one_before() {
    for room in ["tests/furnace-box", "tests/furnace-sphere"] {
        let scene = bundled(room);
        for k in [0, 1, 2, 5] {
            let truth = 0.5_f64.powi(k as i32 + 1);
            let only = RenderSettings { only_bounce: Some(k), ..settings(8, 8, 64) };
            let up_to = RenderSettings { max_bounces: Some(k), ..settings(8, 8, 64) };
            let what = format!("{room}, bounce {k}");
            assert_truth(&what, Estimate::of(&samples(&scene, &only)), truth, 0.05);
            assert_truth(&what, Estimate::of(&samples(&scene, &up_to)), 1.0 - truth, 0.05);
        }
    }
}

/// I = π, R = 1, albedo ½: the light of a lamp at the centre that is scattered k times is 2^-k.
#[test]
fn every_bounce_of_a_lamp_in_a_sphere_is_exact() {
    let scene = bundled("tests/point-in-sphere");
    for k in 1..=6 {
        let settings = RenderSettings { only_bounce: Some(k), ..settings(4, 4, 4) };
        check_exact(&format!("bounce {k}"), &scene, &settings, 0.5_f64.powi(k as i32));
    }
}

/// A rough metal under a white sky shows its directional albedo: a quadrature over half vectors.
#[test]
fn rough_metal_has_the_albedo_of_single_scattering() {
    for (alpha, cos) in [(0.05, 0.7), (0.25, 1.0), (0.25, 0.1), (0.5, 0.3), (1.0, 0.02)] {
        let sin = f64::sqrt(1.0 - cos * cos);
        let eye = Vec3::new(-sin as f32, cos as f32, 0.0);
        let mut stage = Stage::orthographic(eye * 100.0, Vec3::ZERO, 1e-3);
        let metal = Material { roughness: f64::sqrt(alpha) as f32, ..Material::default() };
        stage.floor(Vec3::new(0.3, 0.0, 0.2), 1.0, metal);
        stage.sky(1.0);
        let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 1024)));
        let truth = ggx_albedo(alpha, cos);
        assert_truth(&format!("alpha {alpha}, cos {cos}"), estimate, truth, 0.01);
    }
}

/// ∫ D G2 / (4 cos_o) dwi with height-correlated masking: over the cosine m of the half vector
/// and its azimuth, with dwi = 4 |wo·h| dh, by midpoints. In m the distribution is sharp near
/// 1; with m² = 1/(1 + α² s/(1-s)) it is uniform in s.
fn ggx_albedo(alpha: f64, cos_o: f64) -> f64 {
    let sin_o = (1.0 - cos_o * cos_o).sqrt();
    let root = |cos: f64| (alpha * alpha + (1.0 - alpha * alpha) * cos * cos).sqrt();
    let (rings, sectors) = (2000, 1000);
    let mut sum = 0.0;
    for i in 0..rings {
        let s = (f64::from(i) + 0.5) / f64::from(rings);
        let m = (1.0 / (1.0 + alpha * alpha * s / (1.0 - s))).sqrt();
        let sin_m = (1.0 - m * m).sqrt();
        for j in 0..sectors {
            let phi = PI * (f64::from(j) + 0.5) / f64::from(sectors);
            let o_dot_h = sin_o * sin_m * phi.cos() + cos_o * m;
            let cos_i = 2.0 * o_dot_h * m - cos_o;
            if o_dot_h > 0.0 && cos_i > 0.0 {
                let g2 = 2.0 * cos_i * cos_o / (cos_o * root(cos_i) + cos_i * root(cos_o));
                // D m dh is what is uniform in s and φ.
                sum += g2 * o_dot_h / (cos_o * m);
            }
        }
    }
    sum / f64::from(rings * sectors)
}

/// The edge of a lamp lies out of focus: a pixel sees it through a segment of the lens. From a
/// lens point at x the ray through the middle of the plane in focus, at 1, is at -x at 2.
#[test]
fn a_lens_blurs_what_is_out_of_focus() {
    for (edge, truth) in [(-0.05, segment(0.5)), (0.0, 0.5), (0.03, 1.0 - segment(0.3))] {
        let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1e-6);
        let camera = &mut stage.scene.cameras[0];
        (camera.aperture_radius, camera.focus_distance) = (0.1, 1.0);
        stage.quad(Vec3::new(edge - 1.0, 0.1, -2.0), Vec3::X, Vec3::Y, emitter(1.0));
        let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 512)));
        assert_truth(&format!("edge at {edge}"), estimate, truth, 0.1);
        // In focus the edge is where the camera without a lens has it.
        stage.scene.cameras[0].focus_distance = 2.0;
        if edge != 0.0 {
            let seen = f64::from(u8::from(edge > 0.0));
            assert!(samples(&stage.scene, &settings(4, 4, 16)).iter().all(|s| *s == seen));
        }
    }
}

/// Share of a unit disk beyond the distance `h` from its centre.
fn segment(h: f64) -> f64 {
    (h.acos() - h * (1.0 - h * h).sqrt()) / PI
}

/// Fresnel reflectance of a smooth interface, as amplitudes by Snell's angles.
pub(crate) fn fresnel(sin_o: f64, ior: f64) -> f64 {
    let (o, t) = (sin_o.asin(), (sin_o / ior).asin());
    0.5 * (((o - t).sin() / (o + t).sin()).powi(2) + ((o - t).tan() / (o + t).tan()).powi(2))
}

/// A thin pane before a lamp: 1 - F passes straight on, and the other side is black.
#[test]
fn a_thin_pane_is_crossed_once() {
    for (sin, ior) in [(0.3, 1.5_f32), (0.8, 1.5), (0.6, 2.4)] {
        let pane = Material {
            base_color: Vec3::ONE,
            metallic: 0.0,
            transmission: 1.0,
            ior,
            roughness: 0.0,
            double_sided: true,
            ..Material::default()
        };
        let eye = Vec3::new(sin, f32::sqrt(1.0 - sin * sin), 0.0);
        for from in [eye, -eye] {
            let mut stage = Stage::orthographic(from, Vec3::ZERO, 1e-6);
            stage.floor(Vec3::new(0.1, 0.0, 0.2), 0.5, pane.clone());
            let towards_camera = from.y.signum();
            let lamp = Material { double_sided: true, ..emitter(2.0) };
            stage.floor(Vec3::new(-0.5, -0.5, 0.1) * towards_camera, 5.0, lamp);
            let estimate = Estimate::of(&samples(&stage.scene, &settings(8, 8, 256)));
            let truth = 2.0 * (1.0 - fresnel(sin.into(), ior.into()));
            assert_truth(&format!("sin {sin}, index {ior}"), estimate, truth, 0.03);
        }
    }
}

/// n sheets present with probability ½ let 2^-n through; light samples take that as it is.
#[test]
fn sheets_let_the_rest_through() {
    for n in 1..=3 {
        let mut stage = Stage::orthographic(Vec3::Y * 0.1, Vec3::ZERO, 1e-3);
        stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, lambert(1.0));
        let sheet = Material { alpha_mode: AlphaMode::Blend, alpha: 0.5, ..lambert(0.0) };
        for k in 1..=n {
            stage.floor(Vec3::new(0.1, 0.2 * k as f32, 0.2), 1.0, sheet.clone());
        }
        let down = LightKind::Directional { direction: Vec3::NEG_Y };
        stage.light(down, PI as f32);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(4, 4, 2) };
        check_exact("sheets", &stage.scene, &settings, 0.5_f64.powi(n));
    }
}

#[test]
fn a_crop_is_the_crop_of_the_whole_and_the_work_can_be_cut_short() {
    let scene = bundled("cornell-box");
    let whole = RenderSettings { block_size: 4, ..settings(12, 10, 12) };
    let crop = Crop { x: 3, y: 2, width: 5, height: 4 };
    let part = RenderSettings { crop: Some(crop), ..whole.clone() };
    let (film, tally) = render(&scene, &whole, |_| true).unwrap();
    let cropped = render(&scene, &part, |_| true).unwrap().0;
    assert_eq!((tally.cut_off, tally.non_finite), (0, 0));
    assert!(tally.closest_rays >= 12 * 10 * 12);
    for (x, y) in (0..4).flat_map(|y| (0..5).map(move |x| (x, y))) {
        let (picture, cropped) = (film.picture(), cropped.picture());
        assert_eq!(cropped.rgb[y * 5 + x], picture.rgb[(y + 2) * 12 + x + 3]);
    }
    // Ended in the second block: 10 rows of 4 samples, then 3 of 4 more.
    let mut rows = 0;
    let film = render(&scene, &whole, |_| {
        rows += 1;
        rows < 13
    });
    let film = film.unwrap().0;
    assert_eq!((film.most_samples(), film.least_samples()), (8, 4));
    assert!(film.standard_error().is_none(), "one whole block of each pixel says nothing");
    assert!(Reference::new(&scene, &RenderSettings { spp: 0, ..whole }).is_err());
}
