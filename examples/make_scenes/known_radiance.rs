//! Tiny scenes whose radiance is known on paper, and the same in every pixel.

use crate::document::{Document, Lens, Light, MaterialId};
use crate::material::Material;
use crate::shapes::{horizontal_quad, quad, sharp_box};
use glam::{DVec2, DVec3, dvec3};
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI};

/// Half height of a picture so small that light does not vary over it. The steepest
/// is [`sphere_light`]: 3 x / d² = 1.5 per metre of its value, 1.5e-6 at the edge.
const POINT_YMAG: f64 = 1e-6;
/// Quads and boxes are moved by this, so that no ray meets the edge between their
/// triangles.
const OFF_CENTER: DVec3 = dvec3(0.22, 0.0, 0.09);

/// Writes the truth into the scene. `formula` says where the number comes from.
fn truth(document: &mut Document, radiance: f64, formula: &str) {
    let value = json!({ "radiance": ([radiance; 3]), "where": "every pixel", "formula": formula });
    document.extra("truth", value);
}

fn lambert(document: &mut Document, albedo: f64) -> MaterialId {
    document.material(Material { base_color: [albedo; 3], ..Default::default() })
}

/// A surface that emits `radiance` and reflects nothing.
fn emitter(document: &mut Document, radiance: f64) -> MaterialId {
    document.material(Material {
        name: "emitter",
        base_color: [0.0; 3],
        emission: [radiance; 3],
        ..Default::default()
    })
}

/// The same Lambertian inside that emits and reflects.
fn furnace_wall(document: &mut Document, double_sided: bool) -> MaterialId {
    document.material(Material {
        name: "furnace",
        base_color: [0.5; 3],
        emission: [0.5; 3],
        double_sided,
        ..Default::default()
    })
}

fn wide_camera(document: &mut Document, eye: DVec3, target: DVec3) {
    let lens = Lens::Perspective { yfov: FRAC_PI_2, aspect_ratio: 1.0 };
    document.camera(eye, target, lens);
}

/// A Lambertian quad at height 0, and a camera half a metre above the origin.
fn receiver(document: &mut Document, albedo: f64) {
    let material = lambert(document, albedo);
    let mesh = horizontal_quad(OFF_CENTER, DVec2::splat(1.0), DVec3::Y);
    let mesh = document.mesh("receiver", &mesh, material);
    document.place("receiver", mesh, DVec3::ZERO);
    document.camera(dvec3(0.0, 0.5, 0.0), DVec3::ZERO, Lens::Orthographic { ymag: POINT_YMAG });
}

const FURNACE: &str = "E / (1 - albedo); after k bounces E (1 - albedo^(k+1)) / (1 - albedo)";

pub(crate) fn furnace_box(document: &mut Document) {
    let wall = furnace_wall(document, false);
    let mesh = document.mesh("cube", &sharp_box(DVec3::ONE).inside_out(), wall);
    document.place("cube", mesh, DVec3::ZERO);
    wide_camera(document, dvec3(0.3, -0.2, 0.4), dvec3(-0.6, 0.5, -1.0));
    truth(document, 1.0, FURNACE);
}

pub(crate) fn furnace_sphere(document: &mut Document) {
    let wall = furnace_wall(document, true);
    let mesh = document.sphere("sphere", 1.0, wall);
    document.place("sphere", mesh, DVec3::ZERO);
    wide_camera(document, dvec3(0.2, 0.1, 0.3), dvec3(0.0, 0.2, -1.0));
    truth(document, 1.0, FURNACE);
}

const LOSSLESS: &str = "objects that absorb nothing, in light that is the same from everywhere";

fn white_environment(document: &mut Document) {
    document.extra("environment", json!({ "radiance": [1.0, 1.0, 1.0] }));
    let lens = Lens::Perspective { yfov: 40.0_f64.to_radians(), aspect_ratio: 1.0 };
    document.camera(dvec3(0.0, 0.8, 4.0), DVec3::ZERO, lens);
    truth(document, 1.0, LOSSLESS);
}

pub(crate) fn white_furnace(document: &mut Document) {
    let white = lambert(document, 1.0);
    let mesh = document.sphere("sphere", 1.0, white);
    document.place("sphere", mesh, DVec3::ZERO);
    white_environment(document);
}

pub(crate) fn white_furnace_mixed(document: &mut Document) {
    const RADIUS: f64 = 0.42;
    let white = lambert(document, 1.0);
    let mirror = document.material(Material {
        name: "mirror",
        metallic: 1.0,
        roughness: 0.0,
        specular: 1.0,
        ..Default::default()
    });
    let glass = document.material(Material {
        name: "glass",
        roughness: 0.0,
        specular: 1.0,
        glass_thickness: Some(2.0 * RADIUS),
        ..Default::default()
    });
    for (name, material, x) in
        [("white", white, -0.9), ("mirror", mirror, 0.0), ("glass", glass, 0.9)]
    {
        let mesh = document.sphere(name, RADIUS, material);
        document.place(name, mesh, dvec3(x, 0.0, 0.0));
    }
    white_environment(document);
}

pub(crate) fn point_light(document: &mut Document) {
    receiver(document, 0.5);
    document.light("lamp", Light::Point { intensity: PI }, DVec3::Y, DVec3::NEG_Y);
    truth(document, 0.5, "albedo I / (π d²), albedo ½, I = π W/sr, d = 1 m");
}

pub(crate) fn spot_light(document: &mut Document) {
    receiver(document, 0.5);
    let light = Light::Spot { intensity: 4.0 * PI, inner_angle: 0.2, outer_angle: 0.4 };
    document.light("lamp", light, dvec3(0.0, 2.0, 0.0), DVec3::NEG_Y);
    truth(document, 0.5, "albedo I / (π d²) inside the inner cone, albedo ½, I = 4π W/sr, d = 2 m");
}

pub(crate) fn directional_light(document: &mut Document) {
    receiver(document, 0.5);
    // 60 degrees from the normal.
    let direction = dvec3(3.0_f64.sqrt(), -1.0, 0.0);
    let light = Light::Directional { color: [1.0; 3], irradiance: 2.0 * PI };
    document.light("sun", light, DVec3::Y, direction);
    truth(document, 0.5, "albedo E cos θ / π, albedo ½, E = 2π W/m², θ = 60°");
}

pub(crate) fn sphere_light(document: &mut Document) {
    receiver(document, 0.5);
    let lamp = emitter(document, 4.0);
    let mesh = document.sphere("lamp", 0.5, lamp);
    // One metre away, 30 degrees from the normal.
    document.place("lamp", mesh, dvec3(0.5, 0.75_f64.sqrt(), 0.0));
    let form_factor = 0.75_f64.sqrt() / 4.0;
    truth(
        document,
        0.5 * 4.0 * form_factor,
        "albedo Le cos θ (r/d)², albedo ½, Le = 4, θ = 30°, r/d = ½",
    );
}

pub(crate) fn quad_light(document: &mut Document) {
    receiver(document, 0.5);
    let lamp = emitter(document, 4.0);
    let mesh = horizontal_quad(DVec3::ZERO, DVec2::splat(0.5), DVec3::NEG_Y);
    let mesh = document.mesh("lamp", &mesh, lamp);
    document.place("lamp", mesh, DVec3::Y);
    // Four rectangles with a corner above the point, each ½ by ½.
    let a: f64 = 0.5;
    let s = (1.0 + a * a).sqrt();
    let form_factor = 4.0 * (2.0 * a / s * (a / s).atan()) / (2.0 * PI);
    let formula = "albedo Le 4 (2 a/A) atan(a/A) / (2π), A = √(1+a²), a = ½, albedo ½, Le = 4";
    truth(document, 0.5 * 4.0 * form_factor, formula);
}

pub(crate) fn point_in_sphere(document: &mut Document) {
    let wall = lambert(document, 0.5);
    let mesh = document.sphere("sphere", 1.0, wall);
    document.place("sphere", mesh, DVec3::ZERO);
    document.light("lamp", Light::Point { intensity: PI }, DVec3::ZERO, DVec3::NEG_Z);
    wide_camera(document, dvec3(0.2, 0.1, 0.3), dvec3(0.0, 0.2, -1.0));
    let formula =
        "albedo I / (π R² (1 - albedo)), albedo ½, I = π W/sr, R = 1 m; bounce k alone is 2^-k";
    truth(document, 1.0, formula);
}

pub(crate) fn sphere_in_sphere(document: &mut Document) {
    let wall = lambert(document, 0.8);
    let lamp = emitter(document, 1.0);
    let outer = document.sphere("sphere", 1.0, wall);
    document.place("sphere", outer, DVec3::ZERO);
    let inner = document.sphere("lamp", 0.2, lamp);
    document.place("lamp", inner, DVec3::ZERO);
    // With the lamp behind it.
    wide_camera(document, dvec3(0.0, 0.0, -0.4), dvec3(0.1, 0.2, -1.0));
    let share = 0.2_f64.powi(2);
    let formula = "a s Le / (1 - a (1 - s)), albedo a = 0.8, s = (r/R)² = 0.04, Le = 1";
    truth(document, 0.8 * share / (1.0 - 0.8 * (1.0 - share)), formula);
}

pub(crate) fn glass_slab(document: &mut Document) {
    let lamp = emitter(document, 1.0);
    let glass = document.material(Material {
        name: "glass",
        roughness: 0.0,
        specular: 1.0,
        glass_thickness: Some(0.2),
        ..Default::default()
    });
    let slab = document.mesh("slab", &sharp_box(dvec3(1.0, 0.1, 1.0)), glass);
    document.place("slab", slab, OFF_CENTER + DVec3::Y * 0.25);
    let mesh = horizontal_quad(OFF_CENTER, DVec2::splat(0.5), DVec3::Y);
    let mesh = document.mesh("lamp", &mesh, lamp);
    document.place("lamp", mesh, DVec3::ZERO);
    document.camera(DVec3::Y, DVec3::ZERO, Lens::Orthographic { ymag: POINT_YMAG });
    let reflectance = ((1.5 - 1.0) / (1.5 + 1.0_f64)).powi(2);
    let formula = "Le (1 - R) / (1 + R), R = ((n-1)/(n+1))² = 0.04, Le = 1";
    truth(document, (1.0 - reflectance) / (1.0 + reflectance), formula);
}

pub(crate) fn metal_fresnel(document: &mut Document) {
    let lamp = emitter(document, 2.0);
    let mirror = document.material(Material {
        name: "mirror",
        base_color: [0.5; 3],
        metallic: 1.0,
        roughness: 0.0,
        specular: 1.0,
        ..Default::default()
    });
    let mesh = horizontal_quad(OFF_CENTER, DVec2::splat(0.5), DVec3::Y);
    let mesh = document.mesh("mirror", &mesh, mirror);
    document.place("mirror", mesh, DVec3::ZERO);
    // 60 degrees from the normal, and the same on the other side.
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    let towards_lamp = dvec3(sin, cos, 0.0);
    let (along, across) = (dvec3(-cos, sin, 0.0) * 0.3, DVec3::Z * 0.3);
    let corners = [-along - across, along - across, along + across, across - along];
    let mesh = quad(corners.map(|c| towards_lamp + 0.2 * along + c), DVec3::ZERO);
    let mesh = document.mesh("lamp", &mesh, lamp);
    document.place("lamp", mesh, DVec3::ZERO);
    let eye = dvec3(-sin, cos, 0.0);
    document.camera(eye, DVec3::ZERO, Lens::Orthographic { ymag: POINT_YMAG });
    let fresnel = 0.5 + (1.0 - 0.5) * (1.0 - 0.5_f64).powi(5);
    let formula = "Le (f0 + (1 - f0) (1 - cos θ)^5), f0 = ½, θ = 60°, Le = 2";
    truth(document, 2.0 * fresnel, formula);
}
