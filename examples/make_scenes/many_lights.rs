//! A hall at night, lit by strings of small coloured lamps between its columns, paper lanterns on
//! shelves, and lamps on the walls that shine upwards: thousands of emissive triangles whose powers
//! differ by a factor of several hundred, each of which matters only near it.

use crate::document::{Document, Lens, MaterialId, MeshId};
use crate::material::Material;
use crate::shapes::sphere;
use crate::shapes::{Ends, Mesh, horizontal_quad, lathe, parametric, quad, rounded_box, sharp_box};
use glam::{DQuat, DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// Half the width, the height, and half the length.
const HALL: DVec3 = dvec3(4.4, 5.0, 7.0);
/// Of the rows of columns from the middle, and of the columns along a row.
const ROW: f64 = 2.5;
const COLUMNS: [f64; 4] = [-5.0, -1.7, 1.6, 4.9];
/// Where the strings are tied.
const TIE: f64 = 3.75;
const LAMPS_ON_A_STRING: u32 = 16;
/// Of a lamp of scale 1.
const LAMP_RADIUS: f64 = 0.032;

/// Tints of luminance 1: warm, amber, rose, turquoise, blue, green.
const TINTS: [[f64; 3]; 6] = [
    [1.69, 0.87, 0.28],
    [2.06, 0.78, 0.06],
    [2.55, 0.47, 1.16],
    [0.30, 1.18, 1.30],
    [0.48, 0.78, 4.71],
    [0.63, 1.19, 0.22],
];
/// Radiance of dim, usual and bright lamps.
const LEVELS: [f64; 3] = [9.0, 50.0, 260.0];

/// Uniform in [0, 1), by the bits of an integer (T. Mueller's hash as in C. Wellons 2018).
fn random(n: u32) -> f64 {
    let mut x = n.wrapping_mul(0x9e37_79b9) ^ 0x51ed_270b;
    for _ in 0..2 {
        x = (x ^ (x >> 16)).wrapping_mul(0x45d9_f3b3);
    }
    f64::from(x ^ (x >> 16)) / 4_294_967_296.0
}

/// Builds the scene.
pub(crate) fn build(document: &mut Document) {
    add_hall(document);
    add_columns(document);
    add_strings(document);
    add_shelves(document);
    add_uplights(document);
    add_vessels(document);
    let yfov = 50.0_f64.to_radians();
    document.camera(
        dvec3(0.85, 1.62, 6.6),
        dvec3(-0.35, 1.72, 0.0),
        Lens::Perspective { yfov, aspect_ratio: 1.5 },
    );
}

fn moved(mut mesh: Mesh, by: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}

fn add(document: &mut Document, name: &str, mesh: &Mesh, material: MaterialId) {
    let mesh = document.mesh(name, mesh, material);
    document.place(name, mesh, DVec3::ZERO);
}

fn lambert(document: &mut Document, name: &'static str, base_color: [f64; 3]) -> MaterialId {
    document.material(Material { name, base_color, double_sided: true, ..Default::default() })
}

fn gloss(
    document: &mut Document,
    name: &'static str,
    base_color: [f64; 3],
    roughness: f64,
    metallic: f64,
) -> MaterialId {
    document.material(Material {
        name,
        base_color,
        roughness,
        metallic,
        specular: 1.0,
        double_sided: true,
        ..Default::default()
    })
}

fn add_hall(document: &mut Document) {
    let stone = gloss(document, "polished stone", [0.075, 0.07, 0.066], 0.30, 0.0);
    let plaster = lambert(document, "plaster", [0.56, 0.47, 0.40]);
    let red = lambert(document, "red plaster", [0.42, 0.13, 0.09]);
    let wood = lambert(document, "wood", [0.24, 0.14, 0.08]);
    let middle = dvec3(0.0, 0.5 * HALL.y, 0.0);
    let plane = DVec2::new(HALL.x, HALL.z);
    add(document, "floor", &horizontal_quad(DVec3::ZERO, plane, middle), stone);
    add(document, "ceiling", &horizontal_quad(DVec3::Y * HALL.y, plane, middle), wood);
    let at = |x: f64, y: f64, z: f64| dvec3(x, y, z) * HALL;
    let side = |x: f64| {
        quad([at(x, 0.0, 1.0), at(x, 1.0, 1.0), at(x, 1.0, -1.0), at(x, 0.0, -1.0)], middle)
    };
    let end = |z: f64| {
        quad([at(-1.0, 0.0, z), at(1.0, 0.0, z), at(1.0, 1.0, z), at(-1.0, 1.0, z)], middle)
    };
    let mut sides = side(-1.0);
    sides.append(side(1.0));
    add(document, "side walls", &sides, plaster);
    let mut ends = end(-1.0);
    ends.append(end(1.0));
    add(document, "end walls", &ends, red);
    let mut beams = Mesh::default();
    for z in COLUMNS {
        beams.append(moved(sharp_box(dvec3(HALL.x, 0.16, 0.13)), dvec3(0.0, HALL.y - 0.16, z)));
    }
    add(document, "beams", &beams, wood);
}

fn add_columns(document: &mut Document) {
    let marble = gloss(document, "marble", [0.72, 0.69, 0.63], 0.38, 0.0);
    // A square foot, a round base, a shaft that narrows, a capital under the beam.
    let profile = [
        (0.29, 0.14),
        (0.29, 0.20),
        (0.25, 0.25),
        (0.22, 0.30),
        (0.215, 1.6),
        (0.20, 3.0),
        (0.18, 4.15),
        (0.21, 4.2),
        (0.21, 4.26),
        (0.30, 4.5),
        (0.0, 4.5),
    ];
    let mut columns = Mesh::default();
    for z in COLUMNS {
        for x in [-ROW, ROW] {
            columns.append(moved(lathe(&profile, 40), dvec3(x, 0.0, z)));
            let foot = rounded_box(dvec3(0.32, 0.07, 0.32), 0.012);
            columns.append(moved(foot, dvec3(x, 0.07, z)));
            let plate = sharp_box(dvec3(0.31, 0.09, 0.31));
            columns.append(moved(plate, dvec3(x, HALL.y - 0.41, z)));
        }
    }
    add(document, "columns", &columns, marble);
}

/// A point on a string that hangs from `a` to `b` with this sag.
fn hanging(a: DVec3, b: DVec3, sag: f64, t: f64) -> DVec3 {
    a.lerp(b, t) - DVec3::Y * (4.0 * sag * t * (1.0 - t))
}

/// The strings as (ends, sag).
fn strings() -> Vec<(DVec3, DVec3, f64)> {
    let tie = |x: f64, z: f64| dvec3(x, TIE, z);
    let mut all = Vec::new();
    for pair in COLUMNS.windows(2) {
        let [near, far] = [pair[0] + 0.2, pair[1] - 0.2];
        for x in [-ROW, ROW] {
            all.push((tie(x, near), tie(x, far), 0.75));
        }
        all.push((tie(-ROW + 0.15, near), tie(ROW - 0.15, far), 0.95));
    }
    for z in COLUMNS {
        all.push((tie(-ROW + 0.2, z), tie(ROW - 0.2, z), 0.6));
    }
    all
}

fn add_strings(document: &mut Document) {
    let wire = lambert(document, "wire", [0.03, 0.03, 0.03]);
    let brass = gloss(document, "brass", [0.72, 0.52, 0.22], 0.4, 1.0);
    let names = ["warm", "amber", "rose", "turquoise", "blue", "green"];
    let globe = ball(LAMP_RADIUS, 0);
    let lamps: Vec<MeshId> = TINTS
        .iter()
        .zip(names)
        .flat_map(|(tint, name)| LEVELS.map(|level| (name, tint.map(|t| t * level))))
        .map(|(name, emission)| {
            let base_color = [0.5; 3];
            let material = Material { name, base_color, emission, ..Default::default() };
            let material = document.material(material);
            document.mesh("lamp", &globe, material)
        })
        .collect();
    let (mut wires, mut sockets) = (Mesh::default(), Mesh::default());
    let mut number = 0;
    for (string, (a, b, sag)) in strings().into_iter().enumerate() {
        let across = (b - a).cross(DVec3::Y).normalize();
        let tube = parametric([24, 4], [Ends::Open, Ends::Closed], |t, v| {
            let (s, c) = (TAU * v).sin_cos();
            hanging(a, b, sag, t) + (across * c - DVec3::Y * s) * 0.004
        });
        wires.append(tube);
        for k in 0..LAMPS_ON_A_STRING {
            let draw = |salt: u32| random(number * 8 + salt);
            let t = (f64::from(k) + 0.5 + 0.3 * (draw(0) - 0.5)) / f64::from(LAMPS_ON_A_STRING);
            let scale = 0.7 + 0.8 * draw(1);
            // A string has a tint of its own, and warm ones between; one lamp in five is bright.
            let tint = if draw(2) < 0.3 { 0 } else { string % TINTS.len() };
            let level = [0, 0, 1, 1, 2][(draw(3) * 5.0) as usize];
            let at = hanging(a, b, sag, t);
            let below = at - DVec3::Y * (0.03 + LAMP_RADIUS * scale);
            document.scatter(lamps[3 * tint + level], below, DQuat::IDENTITY, scale);
            let socket = lathe(&[(0.0, -0.034), (0.014, -0.034), (0.014, 0.004), (0.0, 0.004)], 8);
            sockets.append(moved(socket, at));
            number += 1;
        }
    }
    add(document, "wires", &wires, wire);
    add(document, "sockets", &sockets, brass);
}

/// Shelves on the end wall behind, with paper lanterns: large and dim.
fn add_shelves(document: &mut Document) {
    let oak = lambert(document, "oak", [0.33, 0.21, 0.12]);
    let mut boards = Mesh::default();
    let paper = |tint: [f64; 3], level: f64| Material {
        name: "paper",
        base_color: [0.75, 0.72, 0.66],
        emission: tint.map(|t| t * level),
        ..Default::default()
    };
    let globe = ball(0.13, 1);
    let lanterns = [(0, 2.2), (1, 1.4), (0, 4.0), (2, 1.2)].map(|(tint, level)| {
        let material = document.material(paper(TINTS[tint], level));
        document.mesh("lantern", &globe, material)
    });
    for (row, y) in [0.9, 1.7, 2.5].into_iter().enumerate() {
        let half = dvec3(1.75, 0.02, 0.17);
        boards.append(moved(rounded_box(half, 0.006), dvec3(0.0, y, -HALL.z + 0.17)));
        for k in 0..5_u32 {
            let draw = |salt: u32| random(10_000 + (row as u32 * 5 + k) * 8 + salt);
            let scale = 0.75 + 0.5 * draw(0);
            let x = (f64::from(k) - 2.0) * 0.7 + 0.25 * (draw(1) - 0.5);
            let at = dvec3(x, y + 0.02 + 0.13 * scale, -HALL.z + 0.18);
            let lantern = lanterns[(draw(2) * 4.0) as usize];
            document.scatter(lantern, at, DQuat::from_rotation_y(TAU * draw(3)), scale);
        }
    }
    add(document, "shelves", &boards, oak);
}

/// Boxes on the side walls, open above: the lamp on their bottom lights wall and ceiling.
fn add_uplights(document: &mut Document) {
    let iron = gloss(document, "iron", [0.25, 0.24, 0.23], 0.5, 1.0);
    let lamp = document.material(Material {
        name: "uplight",
        base_color: [0.5; 3],
        emission: TINTS[0].map(|t| 17.0 * t),
        ..Default::default()
    });
    let (mut boxes, mut lights) = (Mesh::default(), Mesh::default());
    let (half, y) = (0.11, 2.35);
    for z in [-3.35, -0.05, 3.25] {
        for x in [-1.0, 1.0] {
            let at = dvec3(x * (HALL.x - half - 0.01), y, z);
            boxes.append(moved(sharp_box(dvec3(half, 0.01, half)), at));
            for turn in 0..4 {
                let wall =
                    moved(sharp_box(dvec3(half, 0.1, 0.006)), dvec3(0.0, 0.09, half - 0.006));
                boxes.append(turned(wall, f64::from(turn) * 0.25 * TAU, at));
            }
            let plane = DVec2::splat(0.07);
            lights.append(horizontal_quad(at + DVec3::Y * 0.05, plane, at + DVec3::Y));
        }
    }
    add(document, "boxes", &boxes, iron);
    add(document, "uplights", &lights, lamp);
}

fn turned(mut mesh: Mesh, angle: f64, by: DVec3) -> Mesh {
    let rotation = DQuat::from_rotation_y(angle);
    mesh.positions.iter_mut().for_each(|p| *p = rotation * *p + by);
    mesh.normals.iter_mut().for_each(|n| *n = rotation * *n);
    mesh
}

/// Metal and glaze on plinths, which show the lamps again.
fn add_vessels(document: &mut Document) {
    let plinth = lambert(document, "plinth", [0.30, 0.29, 0.27]);
    let gold = gloss(document, "gold", [0.93, 0.67, 0.28], 0.32, 1.0);
    let copper = gloss(document, "copper", [0.91, 0.50, 0.36], 0.42, 1.0);
    let steel = gloss(document, "steel", [0.62, 0.63, 0.65], 0.22, 1.0);
    let glaze = gloss(document, "blue glaze", [0.03, 0.11, 0.30], 0.25, 0.0);
    let mut plinths = Mesh::default();
    let spots = [
        dvec3(-1.25, 0.0, 2.3),
        dvec3(0.35, 0.0, 0.1),
        dvec3(1.35, 0.0, 2.9),
        dvec3(-0.9, 0.0, -2.3),
    ];
    let heights = [0.55, 0.75, 0.45, 0.65];
    for (at, height) in spots.into_iter().zip(heights) {
        let half = dvec3(0.24, 0.5 * height, 0.24);
        plinths.append(moved(rounded_box(half, 0.012), at + DVec3::Y * half.y));
    }
    add(document, "plinths", &plinths, plinth);
    let top = |k: usize| spots[k] + DVec3::Y * heights[k];
    // Profiles as (radius, height) over the way from the foot to the rim.
    let vase = |t: f64| {
        let r = 0.10 + 0.17 * (0.5 * TAU * (0.92 * t).powf(0.8)).sin().powi(2) + 0.03 * t * t;
        (r * (1.0 - (-60.0 * t).exp()) + 0.001, 0.62 * t)
    };
    let bowl = |t: f64| (0.001 + 0.40 * (0.25 * TAU * t).sin(), 0.05 + 0.34 * t * t);
    add(document, "vase", &turning([48, 64], vase, top(0)), glaze);
    add(document, "bowl", &turning([40, 64], bowl, top(1)), gold);
    let ring = parametric([72, 20], [Ends::Closed, Ends::Closed], |u, v| {
        let ((s, c), (sv, cv)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let r = 0.26 + 0.065 * cv;
        dvec3(r * c, r * s, -0.065 * sv)
    });
    let ring = turned(ring, 0.5, top(2) + DVec3::Y * 0.32);
    add(document, "ring", &ring, copper);
    add(document, "ball", &moved(sphere(0.34), top(3) + DVec3::Y * 0.34), steel);
}

/// A surface of revolution about +Y with smooth normals, its front outside.
fn turning(cells: [u32; 2], profile: impl Fn(f64) -> (f64, f64), at: DVec3) -> Mesh {
    parametric(cells, [Ends::Open, Ends::Closed], |t, v| {
        let (r, y) = profile(t.max(0.0));
        let (s, c) = (TAU * v).sin_cos();
        at + dvec3(r * c, y, r * s)
    })
}

/// An icosahedron, its triangles divided in four so many times, around the origin.
fn ball(radius: f64, divisions: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let corner = |k: usize, s: f64, t: f64| {
        let mut p = DVec3::ZERO;
        (p[(k + 1) % 3], p[(k + 2) % 3]) = (s, t * g);
        p.normalize()
    };
    let corners: Vec<DVec3> = (0..3)
        .flat_map(|k| {
            [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(s, t)| corner(k, s, t))
        })
        .collect();
    let edge = corners[0].distance(corners[2]) * 1.01;
    let near = |a: usize, b: usize| corners[a].distance(corners[b]) < edge;
    let mut mesh =
        Mesh { positions: corners.clone(), normals: corners.clone(), triangles: Vec::new() };
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(a, c)) {
                let [p, q, r] = [corners[a], corners[b], corners[c]];
                let out = (q - p).cross(r - p).dot(p) > 0.0;
                let [a, b, c] = [a, b, c].map(|i| i as u32);
                mesh.triangles.push(if out { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    for _ in 0..divisions {
        let mut finer = Mesh::default();
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.normals[i as usize]);
            let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            let base = finer.positions.len() as u32;
            finer.positions.extend([a, b, c, ab, bc, ca]);
            finer.normals.extend([a, b, c, ab, bc, ca]);
            let cells = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
            finer.triangles.extend(cells.map(|t| t.map(|i| base + i)));
        }
        mesh = finer;
    }
    mesh.positions.iter_mut().for_each(|p| *p *= radius);
    mesh
}
