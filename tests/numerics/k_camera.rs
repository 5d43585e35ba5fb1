//! Cameras.

use crate::common::{
    Estimate, Random, Stage, assert_at_least, assert_at_most, emitter, grey, render, report,
    settings,
};
use crate::probe::camera_rays;
use glam::{DVec2, DVec3, Quat, Vec3, Vec4};
use steradian::RenderSettings;
use steradian::scene::{Camera, Projection, Scene};
use steradian::settings::{Crop, Sampler};

/// A camera of this field at `eye`, turned at random.
fn camera_scene(random: &mut Random, eye: Vec3, yfov: f32) -> Scene {
    let turn = Quat::from_axis_angle(random.direction(), 6.0 * random.unit());
    Stage::perspective(eye, eye + 10.0 * eye.length().max(1.0) * (turn * Vec3::Z), yfov).scene
}

/// The unit direction through a film position of a square picture.
fn direction(camera: &Camera, film: DVec2) -> DVec3 {
    let m = camera.world_from_camera.matrix3;
    let [right, up, back] = [m.x_axis, m.y_axis, m.z_axis].map(|v| Vec3::from(v).as_dvec3());
    let Projection::Perspective { yfov } = camera.projection else { panic!("perspective only") };
    let half = (0.5 * f64::from(yfov)).tan();
    (right * (film.x * half) + up * (film.y * half) - back).normalize()
}

const FIELDS: [f32; 5] = [1e-3, 1e-1, 45.0, 120.0, 170.0];

#[test]
fn k2_primary_directions_at_every_field() {
    let mut random = Random(41);
    for degrees in FIELDS {
        let eye = Vec3::splat(1e5);
        let mut worst = 0.0_f64;
        for _ in 0..4 {
            let scene = camera_scene(&mut random, eye, degrees.to_radians());
            let film = |_| {
                let at = random.in_cube();
                Vec4::new(at.x, at.y, 0.5, 0.5)
            };
            let films: Vec<_> = (0..4096).map(film).collect();
            let rays = camera_rays(&scene, &settings(512, 512, 1), &films);
            for (film, [origin, found]) in films.iter().zip(rays) {
                assert_eq!(origin.truncate(), eye);
                let film = DVec2::new(f64::from(film.x), f64::from(film.y));
                let exact = direction(&scene.cameras[0], film);
                let error = (found.truncate().as_dvec3() - exact).abs().max_element();
                // An ulp of the largest component, which is between 0.57 and 1.
                worst = worst.max(error * 16_777_216.0);
            }
        }
        let what = format!("error of 16384 directions in ulp, field of {degrees} degrees at 1e5");
        assert_at_most("K2", &what, worst, 4.0);
    }
}

/// Rays through the middles of a row of pixels differ, or the camera says that they may not.
#[test]
fn k2_neighbouring_pixels_differ_or_it_is_said() {
    let mut random = Random(42);
    let mut unsaid = 0.0;
    for degrees in FIELDS {
        let scene = camera_scene(&mut random, Vec3::splat(1e5), degrees.to_radians());
        let middle = |k: u32| Vec4::new((2.0 * k as f32 + 1.0) / 512.0 - 1.0, 0.0, 0.5, 0.5);
        let films: Vec<_> = (0..512).map(middle).collect();
        let rays = camera_rays(&scene, &settings(512, 512, 1), &films);
        let same = rays.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64;
        let is_said = scene.cameras[0].precision_notice((512, 512)).is_some();
        report("K2", &format!("equal neighbours of 511, field of {degrees} degrees"), same);
        unsaid += if is_said { 0.0 } else { same };
        // A warning where pixels are wide would be noise.
        assert_eq!(is_said, degrees <= 1e-3, "{degrees}");
    }
    assert_at_most("K2", "equal neighbours without a warning", unsaid, 0.0);
    let mut far = Stage::orthographic(Vec3::splat(1e5), Vec3::ZERO, 1.0).scene.cameras.remove(0);
    assert!(far.precision_notice((512, 512)).is_some(), "coordinates are multiples of 2^-7");
    far.projection = Projection::Orthographic { ymag: 1e3 };
    assert!(far.precision_notice((512, 512)).is_none());
}

/// A small square lamp at 3 before a lens of radius 0.1 in focus at 1: a disk of confusion of
/// diameter c = A |s2 - s1| / (s1 s2) at unit distance behind the lens, second moment c² / 8.
#[test]
fn k1_circle_of_confusion() {
    let (focus, distance, radius) = (1.0_f64, 3.0_f64, 0.1_f64);
    let confusion = 2.0 * radius * (distance - focus) / (focus * distance);
    let side = 0.2 * confusion * distance;
    let half_field = 0.7 * confusion;
    const PIXELS: u32 = 64;
    let mut moments = Vec::new();
    for seed in 0..12 {
        let yfov = 2.0 * half_field.atan();
        let mut stage = Stage::perspective(Vec3::ZERO, -Vec3::Z, yfov as f32);
        let half = 0.5 * side as f32;
        let center = -Vec3::Z * distance as f32;
        stage.quad(center, Vec3::X * half, Vec3::Y * half, emitter(1.0));
        stage.scene.cameras[0].aperture_radius = radius as f32;
        stage.scene.cameras[0].focus_distance = focus as f32;
        let settings =
            RenderSettings { seed, max_bounces: Some(0), ..settings(PIXELS, PIXELS, 32) };
        let picture = grey(&render(&stage.scene, &settings));
        let (mut sum, mut second) = (0.0, 0.0);
        for (k, value) in (0..).zip(picture) {
            let middle = |i: u32| half_field * ((2 * i + 1) as f64 / f64::from(PIXELS) - 1.0);
            let (x, y) = (middle(k % PIXELS), middle(k / PIXELS));
            sum += value;
            second += value * (x * x + y * y);
        }
        moments.push(second / sum);
    }
    let estimate = Estimate::of(&moments);
    // The lamp's own extent blurs too, and so do the pixels.
    let pixel = 2.0 * half_field / f64::from(PIXELS);
    let truth = confusion.powi(2) / 8.0 + (side / distance).powi(2) / 6.0 + pixel.powi(2) / 6.0;
    let chance = 3.0 * estimate.standard_error / truth;
    assert_at_most("K1", "3 standard errors of the second moment", chance, 0.01);
    let error = (estimate.mean / truth - 1.0).abs();
    assert_at_most("K1", "error of the circle of confusion's second moment", error, 0.01);
    assert_at_most(
        "K1",
        "the same in standard errors",
        error * truth / estimate.standard_error,
        3.0,
    );
}

/// A lamp covers the left of the picture as far as a quarter into a column of pixels.
#[test]
fn k3_a_pixel_is_covered_as_far_as_an_edge_reaches() {
    const PIXELS: u32 = 64;
    for (column, share) in [(20_u32, 0.25_f64), (41, 0.75)] {
        let mut stage = Stage::orthographic(Vec3::Z, Vec3::ZERO, 1.0);
        // The stage's own idea of up and right.
        let m = stage.scene.cameras[0].world_from_camera.matrix3;
        let (right, up) = (Vec3::from(m.x_axis), Vec3::from(m.y_axis));
        let edge = 2.0 * (f64::from(column) + share) / f64::from(PIXELS) - 1.0;
        let half = 0.5 * (edge + 1.5);
        let center = right * (edge - half) as f32;
        stage.quad(center, right * half as f32, up * 2.0, emitter(1.0));
        let settings = RenderSettings { max_bounces: Some(0), ..settings(PIXELS, PIXELS, 4096) };
        // The column of the edge and the ones beside it.
        let crop = Some(Crop { x: column - 1, y: 0, width: 3, height: PIXELS });
        let settings = RenderSettings { crop, sampler: Sampler::Independent, ..settings };
        let picture = grey(&render(&stage.scene, &settings));
        let covered: Vec<f64> = picture.chunks(3).map(|row| row[1]).collect();
        let sides = picture.chunks(3).map(|row| row[0] - row[2]);
        assert_at_least("K3", "pixels beside the edge's column", sides.fold(1.0, f64::min), 1.0);
        let estimate = Estimate::of(&covered);
        let error = (estimate.mean - share).abs();
        let what = format!("error of a coverage of {share}, 262144 samples");
        assert_at_most("K3", &what, error, 3.0 * estimate.standard_error);
        let chance = estimate.standard_error;
        assert_at_most("K3", "standard error of a coverage", chance, 0.001);
    }
}
