//! A fluted trefoil knot on a plinth, in a room with a warm and a cool wall.
//!
//! The knot is a tube around the torus knot (2, 3) whose cross-section has lobes
//! that wind along it. It is closed both ways, so every edge has two triangles.

use crate::document::{Document, Lens};
use crate::material::Material;
use crate::shapes::{Ends, Mesh, horizontal_quad, lathe, parametric, quad, rounded_box};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// Cells along and around the tube: 144,000 triangles.
pub(crate) const CELLS: [u32; 2] = [1_200, 60];
/// The same at 1,020,000 triangles.
pub(crate) const LARGE_CELLS: [u32; 2] = [3_400, 150];

/// Radii of the torus that carries the knot, in metres.
const TORUS_RADII: DVec2 = DVec2::new(0.40, 0.185);
const TUBE_RADIUS: f64 = 0.122;
const LOBES: f64 = 6.0;
/// Depth of the flutes as a share of the tube's radius.
const FLUTE_DEPTH: f64 = 0.12;
/// Lobes passed on one way along the tube; a whole number closes the pattern.
const WINDING: f64 = 40.0;

const ROOM: DVec3 = dvec3(1.25, 2.4, 1.3);
const PLINTH_TOP: f64 = 0.58;
const LIGHT_HALF: DVec2 = DVec2::new(0.50, 0.34);

/// The knot around the origin, standing in the xy plane.
fn knot(cells: [u32; 2]) -> Mesh {
    parametric(cells, [Ends::Closed, Ends::Closed], |u, v| {
        let (t, around) = (TAU * u, TAU * v);
        // A quarter turn puts one of the three lobes of the trefoil on top.
        let (sin_p, cos_p) = (2.0 * t + TAU / 4.0).sin_cos();
        let (sin_q, cos_q) = (3.0 * t).sin_cos();
        let radial = dvec3(cos_p, sin_p, 0.0);
        let tangential = dvec3(-sin_p, cos_p, 0.0);
        let (big, small) = TORUS_RADII.into();
        let center = radial * (big + small * cos_q) + DVec3::Z * (small * sin_q);
        let along = (tangential * (2.0 * (big + small * cos_q))
            + (DVec3::Z * cos_q - radial * sin_q) * (3.0 * small))
            .normalize();
        // The torus' own normal is at right angles to a curve on the torus, and
        // closes with it: a frame without a seam.
        let out = radial * cos_q + DVec3::Z * sin_q;
        let side = out.cross(along);
        let lobe = (LOBES * around - WINDING * t).cos();
        let radius = TUBE_RADIUS * (1.0 + FLUTE_DEPTH * lobe);
        let (s, c) = around.sin_cos();
        center + (out * c + side * s) * radius
    })
}

/// The scene, its knot of so many cells along and around the tube, two triangles each.
pub(crate) fn build(document: &mut Document, cells: [u32; 2]) {
    add_room(document);
    let plinth = document.material(Material {
        name: "plinth",
        base_color: [0.17, 0.165, 0.16],
        roughness: 0.35,
        specular: 1.0,
        ..Default::default()
    });
    let marble = document.material(Material {
        name: "marble",
        base_color: [0.86, 0.84, 0.80],
        roughness: 0.42,
        specular: 1.0,
        ..Default::default()
    });
    let half = dvec3(0.30, 0.5 * PLINTH_TOP, 0.30);
    let block = document.mesh("plinth", &rounded_box(half, 0.012), plinth);
    document.place("plinth", block, dvec3(0.0, half.y, 0.0));
    let foot = lathe(&[(0.20, 0.0), (0.20, 0.016), (0.19, 0.024), (0.17, 0.03), (0.0, 0.03)], 96);
    let foot = document.mesh("foot", &foot, plinth);
    document.place("foot", foot, dvec3(0.0, PLINTH_TOP, 0.0));

    let mesh = knot(cells);
    let lowest = mesh.positions.iter().fold(f64::INFINITY, |low, p| low.min(p.y));
    let mesh = document.mesh("knot", &mesh, marble);
    // Set a little into the foot, as a pinned stone is.
    document.place("knot", mesh, dvec3(0.0, PLINTH_TOP + 0.03 - 0.012 - lowest, 0.0));

    let yfov = 36.0_f64.to_radians();
    document.camera(
        dvec3(0.0, 1.22, 4.35),
        dvec3(0.0, 1.13, 0.0),
        Lens::Perspective { yfov, aspect_ratio: 1.0 },
    );
}

fn add_room(document: &mut Document) {
    let mut lambert = |name: &'static str, base_color: [f64; 3]| {
        document.material(Material { name, base_color, ..Default::default() })
    };
    let plaster = lambert("plaster", [0.72, 0.70, 0.67]);
    let warm = lambert("warm", [0.72, 0.22, 0.075]);
    let cool = lambert("cool", [0.07, 0.27, 0.42]);
    let light = document.material(Material {
        name: "light",
        base_color: [0.7; 3],
        emission: [16.0, 14.2, 12.0],
        ..Default::default()
    });
    let inside = dvec3(0.0, 0.5 * ROOM.y, 0.0);
    let at = |x: f64, y: f64, z: f64| dvec3(x, y, z) * ROOM;
    let (floor, ceiling) = (0.0, 1.0);
    let horizontal = |y: f64| {
        let corners = [at(-1.0, y, 1.0), at(1.0, y, 1.0), at(1.0, y, -1.0), at(-1.0, y, -1.0)];
        quad(corners, inside)
    };
    let side = |x: f64| {
        let corners = [at(x, 0.0, 1.0), at(x, 1.0, 1.0), at(x, 1.0, -1.0), at(x, 0.0, -1.0)];
        quad(corners, inside)
    };
    let back = quad(
        [at(-1.0, 0.0, -1.0), at(1.0, 0.0, -1.0), at(1.0, 1.0, -1.0), at(-1.0, 1.0, -1.0)],
        inside,
    );
    let panel = horizontal_quad(dvec3(0.0, ROOM.y - 0.004, 0.62), LIGHT_HALF, inside);
    for (name, mesh, material) in [
        ("floor", horizontal(floor), plaster),
        ("ceiling", horizontal(ceiling), plaster),
        ("back wall", back, plaster),
        ("warm wall", side(-1.0), warm),
        ("cool wall", side(1.0), cool),
        ("light", panel, light),
    ] {
        let mesh = document.mesh(name, &mesh, material);
        document.place(name, mesh, DVec3::ZERO);
    }
}
