//! Light that is caught by total reflection loses nothing, and its path still ends.

use crate::common::{
    Estimate, Stage, assert_at_least, assert_at_most, assert_naive_fails, assert_truth, grey,
    report, settings, with_device,
};
use glam::{Affine3A, Vec3};
use steradian::passes::Tuning;
use steradian::scene::{Material, Mesh, Scene};
use steradian::settings::Sampler;
use steradian::shader::generated::Fault;
use steradian::{RenderSettings, Renderer};

const INDEX: f32 = 1.5;
const SURVIVAL: &str = "const DELTA_SURVIVAL: f32 = 1.0 - 1.0 / 256.0;";
/// As though nothing ended paths that lose nothing.
const FOR_EVER: &str = "const DELTA_SURVIVAL: f32 = 1.0;";

fn glass() -> Material {
    Material {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        volume: true,
        ior: INDEX,
        ..Material::default()
    }
}

/// Pixels, and samples that a loop's bound cut off; no other fault. One sample a submission, for
/// drivers that count a thread's loops.
fn render(scene: &Scene, settings: &RenderSettings, survival: &str) -> (Vec<f64>, u64) {
    let mut tuning = Tuning { submit_samples: 1, ..Tuning::default() };
    let text = tuning.library.get_mut("path/path").unwrap();
    assert_eq!(text.matches(SURVIVAL).count(), 1, "path/path has changed");
    *text = text.replace(SURVIVAL, survival).into();
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        let mut faults = renderer.statistics().faults;
        let cut_off = std::mem::take(&mut faults[Fault::LoopBound as usize]);
        assert_eq!(faults, [0; 4]);
        (grey(renderer.film()), cut_off)
    })
}

/// From within a ball of glass under a white sky, near its surface and along it: nearly every
/// ray is beyond the critical angle, at which it meets the surface again and again.
#[test]
fn h6_light_caught_in_a_ball_of_glass_ends() {
    let eye = Vec3::X * 0.9;
    let mut stage = Stage::perspective(eye, eye + Vec3::Y, 0.5);
    stage.sphere(Vec3::ZERO, 1.0, glass());
    stage.sky(1.0);
    let (pixels, cut_off) = render(&stage.scene, &settings(16, 16, 8), SURVIVAL);
    let what = "2048 paths beyond the critical angle in a ball of glass";
    assert_at_most("H6", &format!("{what}: cut off"), cut_off as f64, 0.0);
    // What they bring is nothing: no light comes that way.
    let most = pixels.into_iter().fold(0.0, f64::max);
    assert_at_most("H6", &format!("{what}: brightest pixel"), most, 0.0);
    let (_, cut_off) = render(&stage.scene, &settings(16, 16, 8), FOR_EVER);
    let what = format!("{what}, without an end: cut off");
    assert_naive_fails("H6", &what, cut_off as f64, 2048.0);
}

/// A rod of square section 1 about the z axis, with faces of its own at both ends.
fn rod(length: f32) -> Mesh {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        Vec3::new(side(0), side(1), side(2) * length)
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

/// A rod of glass under a white sky, looked into at 45° through its end: light that went through
/// it was reflected by its sides 320 times, and is all there. So the mean of the paths is the sky's
/// radiance although some are ended on the way.
#[test]
fn h6_light_that_comes_out_late_keeps_its_mean() {
    const LENGTH: f32 = 600.0;
    let end = Vec3::Z * (0.5 * LENGTH);
    let mut stage = Stage::orthographic(end + Vec3::new(2.0, 0.0, 2.0), end, 0.25);
    let mesh = stage.mesh(rod(LENGTH), glass());
    stage.place(mesh, Affine3A::IDENTITY);
    stage.sky(1.0);
    let settings = RenderSettings { sampler: Sampler::Independent, ..settings(64, 64, 1) };
    let (pixels, cut_off) = render(&stage.scene, &settings, SURVIVAL);
    let what = "rod of glass, 320 reflections long";
    assert_at_most("H6", &format!("{what}: cut off"), cut_off as f64, 0.0);
    let estimate = Estimate::of(&pixels);
    let ended = pixels.iter().filter(|&&x| x == 0.0).count() as f64 / pixels.len() as f64;
    let deviation = estimate.standard_error * (pixels.len() as f64).sqrt();
    report("H6", &format!("{what}: deviation of a path"), deviation);
    assert_at_least("H6", &format!("{what}: share of paths that are ended"), ended, 0.1);
    report("H6", &format!("{what}: radiance less 1"), estimate.mean - 1.0);
    assert_truth(what, estimate, 1.0, 0.05);
}
