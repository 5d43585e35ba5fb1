//! The Cornell box: with its two blocks, and with two spheres.
//!
//! Corners are those of the published measurements (Cornell University Program of
//! Computer Graphics, "Cornell Box Data"), in millimetres, in the published frame:
//! the camera looks along +z with +y up, so +x is left in the picture.

use crate::document::{Document, Lens, MaterialId};
use crate::material::Material;
use crate::shapes::{Mesh, quad};
use glam::{DVec3, dvec3};

/// Linear sRGB values in common use for the measured spectra (as in the Cornell
/// box of Bitterli's rendering resources).
const WHITE: [f64; 3] = [0.725, 0.71, 0.68];
const RED: [f64; 3] = [0.63, 0.065, 0.05];
const GREEN: [f64; 3] = [0.14, 0.45, 0.091];
const LIGHT_RADIANCE: [f64; 3] = [17.0, 12.0, 4.0];
/// The published reflectance of the light source itself.
const LIGHT_REFLECTANCE: f64 = 0.78;
/// Published: film 25 mm wide, focal length 35 mm, hence 2 atan(12.5 / 35).
const HALF_FILM_OVER_FOCAL_LENGTH: f64 = 12.5 / 35.0;

const FLOOR: [[f64; 3]; 4] =
    [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]];
const CEILING: [[f64; 3]; 4] =
    [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]];
const BACK_WALL: [[f64; 3]; 4] =
    [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]];
const GREEN_WALL: [[f64; 3]; 4] =
    [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]];
const RED_WALL: [[f64; 3]; 4] =
    [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]];
/// Half a millimetre below the published plane, which is the ceiling's.
const LIGHT_QUAD: [[f64; 3]; 4] =
    [[343.0, 548.3, 227.0], [343.0, 548.3, 332.0], [213.0, 548.3, 332.0], [213.0, 548.3, 227.0]];
/// Corners (x, z) around the blocks.
const SHORT_BLOCK: [[f64; 2]; 4] = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
const SHORT_HEIGHT: f64 = 165.0;
const TALL_BLOCK: [[f64; 2]; 4] = [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]];
const TALL_HEIGHT: f64 = 330.0;

/// From the published frame to glTF's, in metres: half a turn about +y, so that
/// the camera looks along -Z, with the camera's x at 0.
fn metres([x, y, z]: [f64; 3]) -> DVec3 {
    dvec3(278.0 - x, y, -z) / 1000.0
}

fn wall(corners: [[f64; 3]; 4]) -> Mesh {
    quad(corners.map(metres), metres([278.0, 273.0, 280.0]))
}

/// The five faces that can be seen; the bottom stands on the floor.
fn block(base: [[f64; 2]; 4], height: f64) -> Mesh {
    let at = |k: usize, y: f64| metres([base[k % 4][0], y, base[k % 4][1]]);
    let center = (0..4).map(|k| at(k, 0.5 * height)).sum::<DVec3>() / 4.0;
    // Twice as far from the centre as the face: certainly outside.
    let face = |corners: [DVec3; 4]| {
        let middle = corners.iter().sum::<DVec3>() / 4.0;
        quad(corners, 2.0 * middle - center)
    };
    let mut mesh = face([0, 1, 2, 3].map(|k| at(k, height)));
    for k in 0..4 {
        mesh.append(face([at(k, 0.0), at(k, height), at(k + 1, height), at(k + 1, 0.0)]));
    }
    mesh
}

/// Walls, camera and the usual light, `light_scale` times as bright; returns the material of the
/// white surfaces.
fn empty_box(document: &mut Document, light_scale: f64) -> MaterialId {
    let ceiling_lamp = wall(LIGHT_QUAD);
    box_with_light(document, light_scale, &ceiling_lamp)
}

/// Walls, camera, and a light of that shape.
fn box_with_light(document: &mut Document, light_scale: f64, lamp: &Mesh) -> MaterialId {
    let white =
        document.material(Material { name: "white", base_color: WHITE, ..Default::default() });
    let red = document.material(Material { name: "red", base_color: RED, ..Default::default() });
    let green =
        document.material(Material { name: "green", base_color: GREEN, ..Default::default() });
    let light = document.material(Material {
        name: "light",
        base_color: [LIGHT_REFLECTANCE; 3],
        emission: LIGHT_RADIANCE.map(|x| x * light_scale),
        ..Default::default()
    });
    for (name, corners, material) in [
        ("floor", FLOOR, white),
        ("ceiling", CEILING, white),
        ("back wall", BACK_WALL, white),
        ("green wall", GREEN_WALL, green),
        ("red wall", RED_WALL, red),
    ] {
        let mesh = document.mesh(name, &wall(corners), material);
        document.place(name, mesh, DVec3::ZERO);
    }
    let mesh = document.mesh("light", lamp, light);
    document.place("light", mesh, DVec3::ZERO);
    let eye = metres([278.0, 273.0, -800.0]);
    let yfov = 2.0 * HALF_FILM_OVER_FOCAL_LENGTH.atan();
    document.camera(eye, eye + DVec3::NEG_Z, Lens::Perspective { yfov, aspect_ratio: 1.0 });
    white
}

/// The published box with its short and its tall block.
pub(crate) fn with_blocks(document: &mut Document) {
    let white = empty_box(document, 1.0);
    blocks(document, white);
}

fn blocks(document: &mut Document, white: MaterialId) {
    for (name, base, height) in
        [("short block", SHORT_BLOCK, SHORT_HEIGHT), ("tall block", TALL_BLOCK, TALL_HEIGHT)]
    {
        let mesh = document.mesh(name, &block(base, height), white);
        document.place(name, mesh, DVec3::ZERO);
    }
}

/// How far below the ceiling the lamp hangs that shines at it, in millimetres.
const UPLIGHT_DROP: f64 = 120.0;

/// The published blocks under a lamp that shines at the ceiling: all light but the lamp's own
/// comes in two steps or more.
pub(crate) fn with_uplight(document: &mut Document) {
    let corners = LIGHT_QUAD.map(|[x, y, z]| metres([x, y - UPLIGHT_DROP, z]));
    let middle = corners.iter().sum::<DVec3>() / 4.0;
    // Seen from above.
    let lamp = quad(corners, middle + DVec3::Y);
    let white = box_with_light(document, BRIGHTER, &lamp);
    blocks(document, white);
}

/// The usual light makes a dim picture without exposure.
const BRIGHTER: f64 = 2.0;
const SPHERE_RADIUS: f64 = 0.105;
const BACK_LEFT: DVec3 = dvec3(-0.12, SPHERE_RADIUS, -0.375);
const FRONT_RIGHT: DVec3 = dvec3(0.13, SPHERE_RADIUS, -0.2);

/// The box with two Lambertian spheres.
pub(crate) fn with_diffuse_spheres(document: &mut Document) {
    let white = empty_box(document, BRIGHTER);
    let sphere = document.sphere("sphere", SPHERE_RADIUS, white);
    document.place("left sphere", sphere, BACK_LEFT);
    document.place("right sphere", sphere, FRONT_RIGHT);
}

/// The box with a mirror at the back and clear glass in front.
pub(crate) fn with_mirror_and_glass(document: &mut Document) {
    empty_box(document, BRIGHTER);
    let mirror = document.material(Material {
        name: "mirror",
        base_color: [0.96; 3],
        metallic: 1.0,
        roughness: 0.0,
        specular: 1.0,
        ..Default::default()
    });
    let glass = document.material(Material {
        name: "glass",
        roughness: 0.0,
        specular: 1.0,
        glass_thickness: Some(2.0 * SPHERE_RADIUS),
        ..Default::default()
    });
    let mirror = document.sphere("mirror sphere", SPHERE_RADIUS, mirror);
    let glass = document.sphere("glass sphere", SPHERE_RADIUS, glass);
    document.place("mirror sphere", mirror, BACK_LEFT);
    document.place("glass sphere", glass, FRONT_RIGHT);
}
