//! Five objects on a round stage under a procedural sky, and no other light.

use crate::document::{Document, Lens};
use crate::material::Material;
use crate::shapes::{Ends, lathe, parametric, rounded_box};
use glam::{DQuat, DVec3, dvec3};
use serde_json::json;
use std::f64::consts::{PI, TAU};

/// Columns and rows of the sky.
pub(crate) const SKY_SIZE: [usize; 2] = [256, 128];

/// Towards the sun, from the left and before the stage; it is normalised in use.
const SUN: DVec3 = dvec3(-0.62, 0.62, 0.48);
/// Much larger than the true one (0.27 degrees), so that it covers several texels.
const SUN_RADIUS: f64 = 5.0;
const SUN_RADIANCE: [f64; 3] = [165.0, 136.0, 94.0];

/// Soft boxes: direction of the middle, half angles (degrees) across and up, radiance.
const SOFT_BOXES: [(DVec3, [f64; 2], [f64; 3]); 2] = [
    (dvec3(0.92, 0.35, 0.25), [11.0, 26.0], [3.6, 4.2, 5.0]),
    (dvec3(0.15, 0.55, -1.0), [30.0, 6.0], [3.8, 3.2, 2.6]),
];

/// Radiance of the sky, row by row from the top. The direction of a texel is that
/// of `scene::Environment`: column atan2(z, x) / 2π + ½, row acos(y) / π.
pub(crate) fn sky() -> Vec<[f64; 3]> {
    let [width, height] = SKY_SIZE;
    let mut texels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            // 4x4 points to a texel: the sun and the soft boxes get soft edges.
            let mut sum = DVec3::ZERO;
            for k in 0..16 {
                let u = (column as f64 + (f64::from(k % 4) + 0.5) / 4.0) / width as f64;
                let v = (row as f64 + (f64::from(k / 4) + 0.5) / 4.0) / height as f64;
                let (sin_theta, cos_theta) = (PI * v).sin_cos();
                let (sin_phi, cos_phi) = (TAU * (u - 0.5)).sin_cos();
                sum += sky_radiance(dvec3(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi));
            }
            texels.push((sum / 16.0).to_array());
        }
    }
    texels
}

fn sky_radiance(direction: DVec3) -> DVec3 {
    let zenith = dvec3(0.055, 0.12, 0.28);
    let horizon = dvec3(0.27, 0.32, 0.39);
    let earth = dvec3(0.10, 0.09, 0.08);
    let mut radiance = if direction.y > 0.0 {
        horizon.lerp(zenith, direction.y.powf(0.55))
    } else {
        horizon.lerp(earth, (-direction.y * 6.0).min(1.0))
    };
    let from_sun = direction.angle_between(SUN.normalize()).to_degrees();
    radiance += dvec3(1.0, 0.85, 0.6) * (1.0 * (-from_sun / 11.0).exp());
    if from_sun < SUN_RADIUS {
        radiance += DVec3::from(SUN_RADIANCE);
    }
    for (middle, half, light) in SOFT_BOXES {
        let forward = middle.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let depth = direction.dot(forward);
        let across = direction.dot(right).atan2(depth).to_degrees();
        let above = direction.dot(up).atan2(depth).to_degrees();
        if depth > 0.0 && across.abs() < half[0] && above.abs() < half[1] {
            radiance = DVec3::from(light);
        }
    }
    radiance
}

/// Builds the scene; its sky is the file `sky.hdr` beside it.
pub(crate) fn build(document: &mut Document) {
    add_stage(document);
    add_objects(document);
    document.extra("environment", json!({ "uri": "sky.hdr", "rotation": 0.0, "intensity": 1.0 }));
    document.camera(
        dvec3(0.0, 1.55, 5.2),
        dvec3(0.0, 0.36, 0.0),
        Lens::Perspective { yfov: 27.0_f64.to_radians(), aspect_ratio: 1.5 },
    );
}

fn add_stage(document: &mut Document) {
    let stone = document.material(Material {
        name: "stone",
        base_color: [0.17, 0.165, 0.165],
        ..Default::default()
    });
    let wood = document.material(Material {
        name: "stage",
        base_color: [0.36, 0.33, 0.30],
        roughness: 0.4,
        specular: 1.0,
        ..Default::default()
    });
    let ground = document.mesh("ground", &lathe(&[(30.0, -0.16), (0.0, -0.16)], 128), stone);
    document.place("ground", ground, DVec3::ZERO);
    let rim = [(1.90, -0.16), (1.90, -0.03), (1.888, -0.01), (1.86, 0.0), (0.0, 0.0)];
    let stage = document.mesh("stage", &lathe(&rim, 192), wood);
    document.place("stage", stage, DVec3::ZERO);
}

fn add_objects(document: &mut Document) {
    let solid = |name, base_color, roughness| Material {
        name,
        base_color,
        roughness,
        specular: 1.0,
        ..Default::default()
    };
    let gold = document
        .material(Material { metallic: 1.0, ..solid("rough gold", [1.0, 0.71, 0.29], 0.32) });
    let steel = document
        .material(Material { metallic: 1.0, ..solid("polished steel", [0.66, 0.65, 0.63], 0.14) });
    let plastic = document.material(solid("glossy plastic", [0.62, 0.028, 0.02], 0.18));
    let glass = document
        .material(Material { glass_thickness: Some(0.76), ..solid("glass", [1.0; 3], 0.0) });
    let clay = document.material(Material {
        name: "clay",
        base_color: [0.13, 0.30, 0.36],
        ..Default::default()
    });

    let sphere = document.sphere("gold sphere", 0.46, gold);
    document.place("gold sphere", sphere, dvec3(-0.98, 0.46, -0.28));
    let sphere = document.sphere("glass sphere", 0.38, glass);
    document.place("glass sphere", sphere, dvec3(-0.24, 0.38, 0.72));
    let sphere = document.sphere("steel sphere", 0.2, steel);
    document.place("steel sphere", sphere, dvec3(0.62, 0.2, 0.92));

    // A plastic ring that stands in the middle, turned towards the sun.
    let turn = DQuat::from_rotation_y(0.5);
    let ring = parametric([128, 48], [Ends::Closed, Ends::Closed], |u, v| {
        let (sin_u, cos_u) = (TAU * u).sin_cos();
        let (sin_v, cos_v) = (TAU * v).sin_cos();
        let radius = 0.42 + 0.17 * cos_v;
        turn * dvec3(radius * cos_u, radius * sin_u, 0.17 * sin_v)
    });
    let ring = document.mesh("plastic ring", &ring, plastic);
    document.place("plastic ring", ring, dvec3(0.06, 0.59, -0.45));

    let turn = DQuat::from_rotation_y(0.62);
    let mut block = rounded_box(dvec3(0.33, 0.36, 0.33), 0.03);
    block.positions.iter_mut().for_each(|p| *p = turn * *p);
    block.normals.iter_mut().for_each(|n| *n = turn * *n);
    let block = document.mesh("clay block", &block, clay);
    document.place("clay block", block, dvec3(1.05, 0.36, -0.12));
}
