//! Volumes that absorb, volumes in volumes, and dispersion.

use crate::common::{
    Estimate, Stage, assert_constant, assert_truth, box_mesh, emitter, lambert, render, settings,
};
use glam::{Affine3A, DVec3, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::scene::{LightKind, Material};

/// A clear dielectric with this index and these absorption coefficients, 1/m.
fn glass(ior: f32, absorption: Vec3) -> Material {
    Material {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        volume: true,
        ior,
        absorption,
        ..Material::default()
    }
}

/// Adds a box and gives it the material.
fn add_box(stage: &mut Stage, center: Vec3, half: Vec3, material: Material) {
    let mesh = stage.mesh(box_mesh(center, half), material);
    stage.place(mesh, Affine3A::IDENTITY);
}

/// An emitter of radiance 1 at y = 0, seen along the direction from `eye` to the origin.
fn above_a_lamp(eye: Vec3) -> Stage {
    let mut stage = Stage::orthographic(eye, Vec3::new(0.01, 0.0, 0.02), 1e-2);
    stage.floor(Vec3::ZERO, 50.0, emitter(1.0));
    stage
}

/// Means of the three channels over the picture, each with its error.
fn channels(film: &Film) -> [Estimate; 3] {
    let picture = film.picture();
    [0, 1, 2].map(|c| {
        let values: Vec<f64> = picture.rgb.iter().map(|p| f64::from(p[c])).collect();
        Estimate::of(&values)
    })
}

const ABSORPTION: Vec3 = Vec3::new(0.5, 1.0, 3.0);

/// Without a change of index all light goes straight on: exp(-σ d) is what is left, also along
/// a slanted ray, and from a camera inside.
#[test]
fn absorption_follows_beer_and_lambert() {
    let slanted = Vec3::new(3.0, 4.0, 0.0);
    let slope = f64::from(slanted.length() / slanted.y);
    for (eye, path) in [(Vec3::Y * 4.0, 0.5), (slanted, 0.5 * slope), (Vec3::Y, 0.25)] {
        let mut stage = above_a_lamp(eye);
        let (low, high) = (0.75, 1.25);
        let center = Vec3::Y * (low + high) / 2.0;
        add_box(
            &mut stage,
            center,
            Vec3::new(20.0, (high - low) / 2.0, 20.0),
            glass(1.0, ABSORPTION),
        );
        let film = render(&stage.scene, &settings(8, 8, 4));
        for (channel, &sigma) in ABSORPTION.to_array().iter().enumerate() {
            // The origin of the view is a little off the axis.
            let truth = (-f64::from(sigma) * path).exp();
            let seen = channels(&film)[channel].mean;
            assert!((seen / truth - 1.0).abs() < 0.03, "{eye}: {seen} for {truth}");
            if eye.x == 0.0 && eye.y > 2.0 {
                assert!((seen / truth - 1.0).abs() < 3e-4, "{eye}: {seen} for {truth}");
            }
        }
    }
}

/// Share of light that a slab lets through at normal incidence, all reflections inside counted.
fn slab_transmittance(reflectance: f64, depth: f64) -> f64 {
    let a = (-depth).exp();
    (1.0 - reflectance).powi(2) * a / (1.0 - (reflectance * a).powi(2))
}

fn normal_reflectance(ior: f64) -> f64 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

#[test]
fn an_absorbing_slab_of_glass() {
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 50.0, emitter(1.0));
    add_box(
        &mut stage,
        Vec3::new(0.1, 1.0, 0.2),
        Vec3::new(20.0, 0.25, 20.0),
        glass(1.5, ABSORPTION),
    );
    let film = render(&stage.scene, &settings(32, 32, 256));
    for (estimate, sigma) in channels(&film).into_iter().zip(ABSORPTION.to_array()) {
        // What the slab reflects of its own floor's light comes back from a black surface.
        let truth = slab_transmittance(normal_reflectance(1.5), f64::from(sigma) * 0.5);
        assert_truth("slab", estimate, truth, 0.02);
    }
}

/// A box in a box of the same index: no light is reflected between them, and each absorbs its part.
#[test]
fn a_volume_in_a_volume() {
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 50.0, emitter(1.0));
    let center = Vec3::new(0.1, 1.0, 0.2);
    add_box(&mut stage, center, Vec3::new(20.0, 0.5, 20.0), glass(1.5, Vec3::splat(0.5)));
    add_box(&mut stage, center, Vec3::new(10.0, 0.125, 10.0), glass(1.5, ABSORPTION));
    let film = render(&stage.scene, &settings(32, 32, 256));
    for (estimate, sigma) in channels(&film).into_iter().zip(ABSORPTION.to_array()) {
        let depth = 0.5 * 0.75 + f64::from(sigma) * 0.25;
        assert_truth("nested", estimate, slab_transmittance(normal_reflectance(1.5), depth), 0.02);
    }
}

/// Clear water (1.33) under clear glass (1.5), without air between them.
#[test]
fn the_index_between_two_volumes_is_relative() {
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 50.0, emitter(1.0));
    let center = Vec3::new(0.1, 1.0, 0.2);
    add_box(&mut stage, center, Vec3::new(20.0, 0.5, 20.0), glass(1.5, Vec3::ZERO));
    add_box(&mut stage, center, Vec3::new(10.0, 0.25, 10.0), glass(1.33, Vec3::ZERO));
    let film = render(&stage.scene, &settings(32, 32, 256));
    // A stack of interfaces without interference: (1-R)/R adds up, R / (1-R) of each.
    let (outer, inner) = (normal_reflectance(1.5), normal_reflectance(1.5 / 1.33));
    let ratio = 2.0 * (outer / (1.0 - outer) + inner / (1.0 - inner));
    let truth = 1.0 / (1.0 + ratio);
    let air_between = {
        let water = normal_reflectance(1.33);
        1.0 / (1.0 + 2.0 * (outer / (1.0 - outer) + water / (1.0 - water)))
    };
    assert!((air_between / truth - 1.0).abs() > 0.025, "the case tells nothing");
    assert_truth("water in glass", Estimate::of_pixels(&film), truth, 0.01);
}

/// Light samples are dimmed on their way through the volume that they start in.
#[test]
fn lamps_inside_a_volume() {
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 5.0, lambert(1.0));
    let center = Vec3::new(0.1, 1.0, 0.2);
    add_box(&mut stage, center, Vec3::new(20.0, 1.5, 20.0), glass(1.0, ABSORPTION));
    let position = Vec3::new(0.0, 1.0, 0.0);
    stage.light(LightKind::Point { position, range: f32::INFINITY }, PI as f32);
    let settings = RenderSettings { max_bounces: Some(2), ..settings(8, 8, 16) };
    let film = render(&stage.scene, &settings);
    for (estimate, sigma) in channels(&film).into_iter().zip(ABSORPTION.to_array()) {
        // One metre from the lamp to the floor, two and a half from the box's top to the floor.
        let truth = (-f64::from(sigma) * 3.5).exp();
        assert!((estimate.mean / truth - 1.0).abs() < 1e-3, "{} for {truth}", estimate.mean);
    }
}

/// A clear sphere of another index per channel: what a slab lets through follows from the three.
#[test]
fn dispersion_gives_each_channel_its_index() {
    let (ior, dispersion) = (1.5_f32, 20.0_f32);
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 50.0, emitter(1.0));
    let material = Material { dispersion, ..glass(ior, Vec3::ZERO) };
    add_box(&mut stage, Vec3::new(0.1, 1.0, 0.2), Vec3::new(20.0, 0.25, 20.0), material);
    let film = render(&stage.scene, &settings(32, 32, 1024));
    let half = f64::from((ior - 1.0) * 0.025 * dispersion);
    let indices = DVec3::splat(f64::from(ior)) + DVec3::new(-half, 0.0, half);
    for (estimate, index) in channels(&film).into_iter().zip(indices.to_array()) {
        let truth = slab_transmittance(normal_reflectance(index), 0.0);
        assert_truth("dispersive slab", estimate, truth, 0.02);
    }
}

/// An absorbing volume through whose far side nothing can be seen is black where it absorbs.
#[test]
fn an_endless_volume_absorbs_all() {
    let mut stage = Stage::orthographic(Vec3::Y * 4.0, Vec3::ZERO, 1e-3);
    stage.sky(1.0);
    // The lower half of space: a floor that light enters, and nothing below.
    let material = glass(1.0, Vec3::new(0.0, 1.0, 1.0));
    stage.floor(Vec3::new(0.1, 0.0, 0.2), 1.0, material);
    let picture = render(&stage.scene, &settings(8, 8, 4));
    for pixel in &picture.picture().rgb {
        assert_eq!(*pixel, [1.0, 0.0, 0.0]);
    }
    let clear = glass(1.0, Vec3::ZERO);
    stage.scene.materials[0] = clear;
    assert_constant("clear", &render(&stage.scene, &settings(8, 8, 4)), 1.0);
}
