//! Triangle meshes as the scenes need them.
//!
//! Everything is computed in f64 and rounded to f32 once, on writing, so that a
//! libm that differs in the last bit still gives the same bytes.

use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::{PI, TAU};

/// An indexed triangle mesh; triangles are counter-clockwise seen from outside.
#[derive(Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<DVec3>,
    /// Unit, one for each position.
    pub(crate) normals: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Adds all of `other`.
    pub(crate) fn append(&mut self, other: Mesh) {
        let base = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
    }

    /// The same surface with its other side in front.
    pub(crate) fn inside_out(mut self) -> Self {
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    fn push_flat_triangle(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let base = self.positions.len() as u32;
        self.positions.extend(corners);
        self.normals.extend([(b - a).cross(c - a).normalize(); 3]);
        self.triangles.push([base, base + 1, base + 2]);
    }
}

/// Two flat triangles over four corners in order around the edge, with the front
/// towards the point `seen_from`. The corners need not lie in one plane: each
/// triangle has its own normal.
pub(crate) fn quad(corners: [DVec3; 4], seen_from: DVec3) -> Mesh {
    let [a, mut b, c, mut d] = corners;
    if (b - a).cross(c - a).dot(seen_from - a) < 0.0 {
        std::mem::swap(&mut b, &mut d);
    }
    let mut mesh = Mesh::default();
    mesh.push_flat_triangle([a, b, c]);
    mesh.push_flat_triangle([a, c, d]);
    mesh
}

/// A horizontal rectangle around `center` with half extents (x, z).
pub(crate) fn horizontal_quad(center: DVec3, half: DVec2, seen_from: DVec3) -> Mesh {
    let at = |x: f64, z: f64| center + dvec3(x * half.x, 0.0, z * half.y);
    quad([at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)], seen_from)
}

/// A box with sharp edges around the origin.
pub(crate) fn sharp_box(half: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut normal = DVec3::ZERO;
            normal[axis] = side;
            let (s, t) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
            let at = |a: f64, b: f64| (normal + s * a + t * b) * half;
            let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
            mesh.append(quad(corners, normal * half.length() * 2.0));
        }
    }
    mesh
}

/// A box around the origin whose edges are rounded with radius `bevel`, so that
/// they catch the light.
pub(crate) fn rounded_box(half: DVec3, bevel: f64) -> Mesh {
    const ARC: i32 = 4;
    let inner = half - bevel;
    // Offsets in units of the bevel at which the outer box is cut; their angles
    // around the edge are equally far apart over the 45 degrees of one face.
    let cuts: Vec<f64> =
        (0..=ARC).map(|i| (f64::from(i) / f64::from(ARC) * PI / 4.0).tan()).collect();
    let line = |extent: f64| -> Vec<f64> {
        let low = cuts.iter().rev().map(|c| -extent - c * bevel);
        low.chain(cuts.iter().map(|c| extent + c * bevel)).collect()
    };
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (s, t) = ((axis + 1) % 3, (axis + 2) % 3);
            let (along_s, along_t) = (line(inner[s]), line(inner[t]));
            let base = mesh.positions.len() as u32;
            for &a in &along_s {
                for &b in &along_t {
                    let mut outer = DVec3::ZERO;
                    outer[axis] = side * half[axis];
                    outer[s] = a;
                    outer[t] = b;
                    let core = outer.clamp(-inner, inner);
                    let normal = (outer - core).normalize();
                    mesh.positions.push(core + normal * bevel);
                    mesh.normals.push(normal);
                }
            }
            let columns = along_t.len() as u32;
            for i in 0..along_s.len() as u32 - 1 {
                for j in 0..columns - 1 {
                    let a = base + i * columns + j;
                    let (b, c, d) = (a + columns, a + columns + 1, a + 1);
                    let cells =
                        if side > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                    mesh.triangles.extend(cells);
                }
            }
        }
    }
    mesh
}

/// A sphere around the origin with its vertices on the radius: 2,208 triangles.
pub(crate) fn sphere(radius: f64) -> Mesh {
    const SEGMENTS: u32 = 48;
    const RINGS: u32 = 24;
    let mut mesh = Mesh::default();
    let mut push = |normal: DVec3| {
        mesh.positions.push(normal * radius);
        mesh.normals.push(normal);
    };
    push(DVec3::Y);
    for ring in 1..RINGS {
        let (sin, cos) = (PI * f64::from(ring) / f64::from(RINGS)).sin_cos();
        for segment in 0..SEGMENTS {
            let (s, c) = (TAU * f64::from(segment) / f64::from(SEGMENTS)).sin_cos();
            push(dvec3(sin * c, cos, sin * s));
        }
    }
    push(DVec3::NEG_Y);
    let vertex = |ring: u32, segment: u32| match ring {
        0 => 0,
        RINGS => 1 + (RINGS - 1) * SEGMENTS,
        _ => 1 + (ring - 1) * SEGMENTS + segment % SEGMENTS,
    };
    for ring in 0..RINGS {
        for segment in 0..SEGMENTS {
            let (a, b) = (vertex(ring, segment), vertex(ring, segment + 1));
            let (c, d) = (vertex(ring + 1, segment + 1), vertex(ring + 1, segment));
            if ring > 0 {
                mesh.triangles.push([a, b, c]);
            }
            if ring < RINGS - 1 {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    mesh
}

/// How a parameter of [`parametric`] ends.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ends {
    /// At 0 and 1, both with vertices.
    Open,
    /// 1 is 0 again: the last cells use the first vertices.
    Closed,
}

/// The surface `at(u, v)` over the unit square with `cells` cells each way. Its
/// front is where `∂u × ∂v` points, and normals are from central differences.
pub(crate) fn parametric(cells: [u32; 2], ends: [Ends; 2], at: impl Fn(f64, f64) -> DVec3) -> Mesh {
    // The error of the normals is about STEP² times the third derivative, and
    // 1e-16 / STEP from rounding: both far below an f32's.
    const STEP: f64 = 1e-5;
    let count = |k: usize| cells[k] + u32::from(ends[k] == Ends::Open);
    let mut mesh = Mesh::default();
    for i in 0..count(0) {
        let u = f64::from(i) / f64::from(cells[0]);
        for j in 0..count(1) {
            let v = f64::from(j) / f64::from(cells[1]);
            let along_u = at(u + STEP, v) - at(u - STEP, v);
            let along_v = at(u, v + STEP) - at(u, v - STEP);
            mesh.positions.push(at(u, v));
            mesh.normals.push(along_u.cross(along_v).normalize());
        }
    }
    let vertex = |i: u32, j: u32| (i % count(0)) * count(1) + j % count(1);
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            let (a, b) = (vertex(i, j), vertex(i + 1, j));
            let (c, d) = (vertex(i + 1, j + 1), vertex(i, j + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A surface of revolution around +Y with sharp rings: each piece of the profile,
/// (radius, height) from below to above on the outside, is a band of its own.
/// A radius of 0 closes the surface.
pub(crate) fn lathe(profile: &[(f64, f64)], segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for pair in profile.windows(2) {
        let [(r0, y0), (r1, y1)] = [pair[0], pair[1]];
        // Outwards in the plane of the profile.
        let normal = DVec2::new(y1 - y0, r0 - r1).normalize();
        let base = mesh.positions.len() as u32;
        for segment in 0..segments {
            let (s, c) = (TAU * f64::from(segment) / f64::from(segments)).sin_cos();
            for (r, y) in [(r0, y0), (r1, y1)] {
                mesh.positions.push(dvec3(r * c, y, r * s));
                mesh.normals.push(dvec3(normal.x * c, normal.y, normal.x * s));
            }
        }
        for segment in 0..segments {
            let a = base + 2 * segment;
            let b = base + 2 * ((segment + 1) % segments);
            if r1 > 0.0 {
                mesh.triangles.push([a, a + 1, b + 1]);
            }
            if r0 > 0.0 {
                mesh.triangles.push([a, b + 1, b]);
            }
        }
    }
    mesh
}
