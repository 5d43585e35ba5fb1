//! E3, E7, E8: surfaces close to each other.

use super::cube;
use crate::common::{
    Random, Stage, assert_at_most, assert_naive_fails, emitter, grey, lambert, render, report,
    settings, with_device,
};
use crate::probe::{Probe, probe_tree};
use glam::{Quat, Vec3};
use steradian::passes::Tuning;
use steradian::scene::{LightKind, Scene};
use steradian::settings::Strategy;
use steradian::{RenderSettings, Renderer};

/// Brightest pixel of the room, seen from inside.
fn brightest(picture: &[f64]) -> f64 {
    picture.iter().copied().fold(0.0, f64::max)
}

/// The picture with rays whose hits begin at a fixed distance.
fn render_with_least_t(scene: &Scene, settings: &RenderSettings, least_t: f32) -> Vec<f64> {
    let mut tuning = Tuning::default();
    let text = tuning.library["geometry/leaf"].to_string();
    let product = "if hit.t > 0.0 &&";
    assert!(text.contains(product));
    let changed = text.replace(product, &format!("if hit.t > {least_t:e} &&"));
    tuning.library.insert("geometry/leaf", changed.into());
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        grey(renderer.film())
    })
}

/// A room in a room; the gap between their walls is 1e-4 of its size. Outside it is bright.
fn sealed_room(size: f32) -> Scene {
    let eye = size * Vec3::new(0.11, -0.07, 0.19);
    let mut stage = Stage::perspective(eye, size * Vec3::new(0.4, 0.3, -0.4), 1.6);
    cube(&mut stage, Vec3::ZERO, size, lambert(0.9));
    cube(&mut stage, Vec3::ZERO, size * 1.0002, lambert(0.9));
    stage.sky(1e4);
    let direction = Vec3::new(0.3, -0.8, 0.5).normalize();
    stage.light(LightKind::Directional { direction }, 1e4);
    stage.scene
}

#[test]
fn e3_no_light_gets_through_a_thin_wall() {
    let settings = RenderSettings { max_bounces: Some(8), ..settings(32, 32, 32) };
    for size in [1e-4, 1.0, 1e4] {
        let picture = grey(&render(&sealed_room(size), &settings));
        let what = format!("brightest pixel in a sealed room of {size:e}");
        assert_at_most("E3", &what, brightest(&picture), 0.0);
    }
    let leaking = render_with_least_t(&sealed_room(1.0), &settings, 1e-3);
    let what = "brightest pixel in a sealed room of 1, t > 1e-3";
    assert_naive_fails("E3", what, brightest(&leaking), 1.0);
}

/// Two parallel squares in a random pose, fronts to the same side as seen: the nearer is met
/// on its front, the other on its back. Shares of rays that meet the wrong one, by the gap.
#[test]
fn e7_the_nearer_of_two_close_sheets_is_met() {
    let mut random = Random(27);
    for ulps in [1, 4, 32, 1024] {
        let (mut wrong, mut rays) = (0.0, 0.0);
        for _ in 0..4 {
            let turn = Quat::from_axis_angle(random.direction(), 6.0 * random.unit());
            let (u, v, n) = (turn * Vec3::X, turn * Vec3::Y, turn * Vec3::Z);
            let center = random.direction();
            // |P| is up to 2.5 here, where an ulp is 2^-22.
            let gap = ulps as f32 / 4_194_304.0;
            let mut stage = Stage::perspective(center + 3.0 * n, center, 1.0);
            stage.quad(center, v, u, lambert(0.1));
            stage.quad(center + gap * n, u, v, lambert(0.9));
            let probe = |_| {
                let target = center + 0.9 * (random.in_cube().x * u + random.in_cube().x * v);
                let o = target + n + random.in_cube();
                Probe::new(o, (target - o).normalize())
            };
            let probes: Vec<_> = (0..8192).map(probe).collect();
            for (p, found) in probes.iter().zip(probe_tree(&stage.scene, &probes)) {
                if p.direction.dot(n) < -0.1 && found.t().is_some() {
                    rays += 1.0;
                    wrong += f64::from(1 - found.is_front);
                }
            }
        }
        let what = format!("share of rays that meet the farther of two sheets, gap {ulps} ulp");
        match ulps >= 32 {
            true => assert_at_most("E7", &what, wrong / rays, 0.0),
            false => report("E7", &what, wrong / rays),
        }
    }
}

/// A lamp over a floor at 1e-5 of their size, seen from between them: every ray that leaves the
/// floor must meet it.
#[test]
fn e8_a_surface_just_in_front_is_met() {
    let gap = |size: f32| 1e-5 * size;
    let between = |size: f32| {
        let eye = Vec3::Y * 0.5 * gap(size);
        let mut stage = Stage::orthographic(eye, Vec3::ZERO, 0.1 * size);
        stage.floor(Vec3::ZERO, 0.5 * size, lambert(0.5));
        stage.ceiling(Vec3::Y * gap(size), 0.5 * size, emitter(1.0));
        stage.scene
    };
    let settings =
        RenderSettings { strategy: Strategy::Bsdf, max_bounces: Some(1), ..settings(16, 16, 64) };
    for size in [1e-4, 1.0, 1e4] {
        let scene = between(size);
        let darkest = grey(&render(&scene, &settings)).into_iter().fold(f64::MAX, f64::min);
        let what = format!("missing share of a lamp 1e-5 over a floor of {size:e}, darkest pixel");
        assert_at_most("E8", &what, 1.0 - darkest / 0.5, 1e-6);
    }
    let blind = render_with_least_t(&between(1.0), &settings, 1e-4);
    let what = "missing share of a lamp 1e-5 over a floor of 1, brightest pixel, t > 1e-4";
    assert_naive_fails("E8", what, 1.0 - brightest(&blind) / 0.5, 0.99);
}
