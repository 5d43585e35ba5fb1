//! Four plates of growing roughness reflect four lights of growing size and equal
//! power: Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation",
//! figure 9.2. Sampling lights fails at the upper right of the highlights (smooth
//! plate, large light), sampling the BSDF at the lower left (rough plate, small
//! light); only both together do well everywhere.

use crate::document::{Document, Lens};
use crate::material::Material;
use crate::shapes::{quad, rounded_box};
use glam::{DMat3, DQuat, DVec3, dvec3};

const EYE: DVec3 = dvec3(0.0, 2.0, 15.0);
const TARGET: DVec3 = dvec3(0.0, -1.82, 2.5);

/// Radiance times radius² of every light, and so the power of all four.
const POWER: f64 = 0.5;
/// (x, radius, tint). Tints have luminance 1.
const LIGHTS: [(f64, f64, [f64; 3]); 4] = [
    (-3.75, 1.0 / 30.0, [1.90, 0.80, 0.35]),
    (-1.25, 0.1, [1.35, 0.98, 0.20]),
    (1.25, 0.3, [0.55, 1.13, 1.05]),
    (3.75, 0.9, [0.62, 0.94, 2.72]),
];

/// Centre (y, z) and GGX alpha of the plates from far to near.
const PLATES: [(f64, f64, f64); 4] =
    [(-2.40, -0.14, 0.005), (-3.06, 0.92, 0.02), (-3.58, 2.22, 0.05), (-3.91, 3.57, 0.1)];

const FLOOR_HEIGHT: f64 = -4.15;
const WALL_DEPTH: f64 = -2.2;

/// Builds the scene.
pub(crate) fn build(document: &mut Document) {
    let room = document.material(Material {
        name: "room",
        base_color: [0.42, 0.42, 0.42],
        ..Default::default()
    });
    let above = dvec3(0.0, 0.0, 8.0);
    let at = |x: f64, y: f64, z: f64| dvec3(x * 14.0, y, z);
    let floor = quad(
        [
            at(-1.0, FLOOR_HEIGHT, 16.0),
            at(1.0, FLOOR_HEIGHT, 16.0),
            at(1.0, FLOOR_HEIGHT, WALL_DEPTH),
            at(-1.0, FLOOR_HEIGHT, WALL_DEPTH),
        ],
        above,
    );
    let wall = quad(
        [
            at(-1.0, FLOOR_HEIGHT, WALL_DEPTH),
            at(1.0, FLOOR_HEIGHT, WALL_DEPTH),
            at(1.0, 10.0, WALL_DEPTH),
            at(-1.0, 10.0, WALL_DEPTH),
        ],
        above,
    );
    for (name, mesh) in [("floor", floor), ("back wall", wall)] {
        let mesh = document.mesh(name, &mesh, room);
        document.place(name, mesh, DVec3::ZERO);
    }
    for (k, &(y, z, alpha)) in PLATES.iter().enumerate() {
        add_plate(document, k + 1, dvec3(0.0, y, z), alpha);
    }
    for (k, &(x, radius, tint)) in LIGHTS.iter().enumerate() {
        let name = format!("light {}", k + 1);
        add_light(
            document,
            &name,
            dvec3(x, 0.0, 0.0),
            radius,
            tint.map(|t| POWER * t / (radius * radius)),
        );
    }
    // Veach's picture has a lamp outside the view that lights the room itself.
    add_light(document, "room light", dvec3(10.0, 10.0, 4.0), 0.5, [470.0; 3]);
    let yfov = 28.0_f64.to_radians();
    document.camera(EYE, TARGET, Lens::Perspective { yfov, aspect_ratio: 1.5 });
}

/// A plate whose middle reflects the row of lights to the camera: its normal is
/// half way between the two directions.
fn add_plate(document: &mut Document, number: usize, center: DVec3, alpha: f64) {
    let normal = ((EYE - center).normalize() + (-center).normalize()).normalize();
    let frame = DMat3::from_cols(DVec3::X, normal, DVec3::X.cross(normal));
    let rotation = DQuat::from_mat3(&frame);
    let name = ["smooth plate", "glossy plate", "satin plate", "rough plate"][number - 1];
    let material = document.material(Material {
        name,
        base_color: [0.78, 0.79, 0.80],
        metallic: 1.0,
        // glTF: alpha is the square of the roughness.
        roughness: (alpha.sqrt() * 1e6).round() / 1e6,
        specular: 1.0,
        ..Default::default()
    });
    let mut mesh = rounded_box(dvec3(4.0, 0.04, 0.5), 0.012);
    mesh.positions.iter_mut().for_each(|p| *p = rotation * *p);
    mesh.normals.iter_mut().for_each(|n| *n = rotation * *n);
    let mesh = document.mesh(name, &mesh, material);
    document.place(name, mesh, center);
}

fn add_light(document: &mut Document, name: &str, at: DVec3, radius: f64, radiance: [f64; 3]) {
    let material = document.material(Material {
        name: "light",
        base_color: [0.0; 3],
        emission: radiance,
        ..Default::default()
    });
    let sphere = document.sphere(name, radius, material);
    document.place(name, sphere, at);
}
