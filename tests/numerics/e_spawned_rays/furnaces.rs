//! E1: closed rooms in which emission and albedo are ½ everywhere, so the radiance is 1.

use super::cube;
use crate::common::{Estimate, Stage, assert_at_least, assert_at_most, lambert, render, settings};
use crate::gltf_fixture::{Fixture, has_notice};
use glam::Vec3;
use serde_json::json;
use steradian::RenderSettings;
use steradian::scene::{Material, Scene, Treatment};
use steradian::settings::{Sampler, Strategy};

/// Bars of the error, the same at size 1, and of the standard error.
const LARGEST_ERROR: f64 = 1e-3;
const LARGEST_ERROR_AT_ONE: f64 = 2e-4;
const LARGEST_STANDARD_ERROR: f64 = 2.5e-4;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Room {
    Cube,
    Sphere,
}

/// A room of this size whose centre is `offset` from the origin on every axis.
fn furnace(room: Room, size: f32, offset: f32) -> Scene {
    let center = Vec3::splat(offset);
    let eye = center + size * Vec3::new(0.11, -0.07, 0.19);
    let mut stage = Stage::perspective(eye, eye + size * Vec3::new(0.3, 0.2, -0.9), 1.5);
    let half = Material { emission: Vec3::splat(0.5), double_sided: true, ..lambert(0.5) };
    match room {
        Room::Cube => cube(&mut stage, center, size, half),
        Room::Sphere => stage.sphere(center, 0.5 * size, half),
    }
    stage.scene
}

/// Every path adds up 24 bounces without chance: only rays that leak can change it.
fn by_paths(scene: &Scene, spp: u32) -> Estimate {
    let settings = RenderSettings {
        strategy: Strategy::Bsdf,
        max_bounces: Some(24),
        roulette: false,
        sampler: Sampler::Independent,
        ..settings(16, 16, spp)
    };
    Estimate::of_pixels(&render(scene, &settings))
}

/// As pictures are made: light samples and roulette too.
fn by_light_samples(scene: &Scene, spp: u32) -> Estimate {
    Estimate::of_pixels(&render(scene, &settings(32, 32, spp)))
}

fn judge(what: &str, estimate: Estimate, largest_error: f64) {
    let what = |figure: &str| format!("{figure}, {what}");
    let error = (estimate.mean - 1.0).abs();
    // A wider bar needs no finer estimate than a quarter of it.
    let finest = LARGEST_STANDARD_ERROR.max(largest_error / 4.0);
    assert_at_most("E1", &what("standard error"), estimate.standard_error, finest);
    assert_at_most("E1", &what("|L - 1|"), error, largest_error);
}

fn check_paths(room: Room, size: f32, offset: f32, spp: u32, largest_error: f64) {
    let what = format!("furnace {room:?}, size {size:e} at {offset:e}, scattered rays");
    judge(&what, by_paths(&furnace(room, size, offset), spp), largest_error);
}

fn check_light_samples(room: Room, size: f32, offset: f32, spp: u32, largest_error: f64) {
    let what = format!("furnace {room:?}, size {size:e} at {offset:e}, light samples too");
    judge(&what, by_light_samples(&furnace(room, size, offset), spp), largest_error);
}

/// Sizes and offsets at which single precision holds the room well.
fn places() -> Vec<(f32, f32)> {
    let sizes = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
    let near = sizes.map(|size| (size, 0.0));
    let far = [(1.0, 1e3), (1e2, 1e3), (1e6, 1e3), (1e2, 1e5), (1e4, 1e5), (1e6, 1e5)];
    near.into_iter().chain(far).collect()
}

#[test]
fn e1_scattered_rays_do_not_leak_at_any_scale() {
    for room in [Room::Cube, Room::Sphere] {
        for (size, offset) in places() {
            let bar = if size == 1.0 { LARGEST_ERROR_AT_ONE } else { LARGEST_ERROR };
            check_paths(room, size, offset, 16, bar);
        }
    }
}

#[test]
fn e1_light_samples_agree_at_the_ends_of_the_scale() {
    for room in [Room::Cube, Room::Sphere] {
        for (size, offset) in [(1e-5, 0.0), (1e2, 1e5)] {
            check_light_samples(room, size, offset, 512, LARGEST_ERROR);
        }
    }
}

#[test]
fn e1_at_size_one() {
    for room in [Room::Cube, Room::Sphere] {
        check_light_samples(room, 1.0, 0.0, 1024, LARGEST_ERROR_AT_ONE);
    }
}

/// A room of 1 m at 1e5 m on every axis: coordinates are multiples of 1/128 m.
#[test]
fn e1_too_far_from_the_origin_is_said() {
    for room in [Room::Cube, Room::Sphere] {
        let scene = furnace(room, 1.0, 1e5);
        assert_at_least("E1", "warnings of precision", scene.precision_notices().len() as f64, 1.0);
        check_paths(room, 1.0, 1e5, 64, 3e-2);
        check_light_samples(room, 1.0, 1e5, 64, 3e-2);
    }
    for (size, offset) in places() {
        for room in [Room::Cube, Room::Sphere] {
            let count = furnace(room, size, offset).precision_notices().len();
            assert_at_most("E1", "needless warnings", count as f64, 0.0);
        }
    }
}

/// The loader says so of the meshes of a file.
#[test]
fn e1_a_mesh_too_far_from_the_origin_is_noted() {
    let mut wrong = 0.0;
    for (size, offset, is_noted) in [
        (1.0, 1e5, true),
        (1e-3, 1e3, true),
        (1.0, 1e3, false),
        (1e2, 1e5, false),
        (1e-5, 0.0, false),
    ] {
        let mut fixture = Fixture::triangle();
        fixture.json["nodes"][0]["translation"] = json!([0.0, offset, 0.0]);
        // The triangle is 2 wide.
        fixture.json["nodes"][0]["scale"] = json!([0.5 * size, 0.5 * size, 0.5 * size]);
        let is_said = has_notice(&fixture.scene(), Treatment::Approximated, "mesh too small");
        wrong += f64::from(u8::from(is_said != is_noted));
    }
    assert_at_most("E1", "meshes of 5 with a wrong message or none", wrong, 0.0);
}

#[test]
#[ignore = "tier N: about 3 minutes"]
fn e1_light_samples_at_every_scale() {
    for room in [Room::Cube, Room::Sphere] {
        for (size, offset) in places() {
            check_light_samples(room, size, offset, 1024, LARGEST_ERROR_AT_ONE);
        }
    }
}
