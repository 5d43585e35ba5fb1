//! Closed meshes, and rays from inside aimed at their edges and vertices. Such a ray hits
//! something whatever the rounding: one that does not has leaked.

use crate::common::{Random, Stage, lambert};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};
use steradian::bvh::{Aabb, BuildItem, Bvh, PrimitiveKind, Ray, any_hit, build_sah};
use steradian::scene::{Mesh, Scene};

/// Rays that one thread takes at a time.
const CHUNK: u64 = 1 << 15;

/// A triangle mesh without border.
pub(crate) struct ClosedMesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The triangles at each vertex.
    fans: Vec<Vec<u32>>,
    bvh: Bvh,
}

/// What rays are aimed at.
#[derive(Clone, Copy)]
pub(crate) enum Target {
    Edges,
    Vertices,
    /// Four of five at edges.
    Both,
}

/// Where rays begin, and what at.
#[derive(Clone, Copy)]
pub(crate) struct Aim {
    pub(crate) center: Vec3,
    /// Origins lie in a cube of twice this side.
    pub(crate) reach: f32,
    pub(crate) target: Target,
}

/// A ray, a triangle of the edge that it is aimed at, and the edge's ends.
#[derive(Clone, Copy)]
pub(crate) struct AimedRay {
    pub(crate) o: Vec3,
    pub(crate) d: Vec3,
    triangle: u32,
    ends: [u32; 2],
}

/// Index below `n`.
pub(crate) fn pick(random: &mut Random, n: usize) -> usize {
    (random.bits() % n as u64) as usize
}

impl ClosedMesh {
    pub(crate) fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let mut fans = vec![Vec::new(); positions.len()];
        for (i, t) in triangles.iter().enumerate() {
            t.iter().for_each(|&v| fans[v as usize].push(i as u32));
        }
        let item = |t: &[u32; 3]| {
            let bounds = Aabb::of_points(&t.map(|v| positions[v as usize]));
            BuildItem { bounds, kind: PrimitiveKind::Triangle }
        };
        let bvh = build_sah(&triangles.iter().map(item).collect::<Vec<_>>());
        Self { positions, triangles, fans, bvh }
    }

    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// The triangles at both ends of the edge that a ray is aimed at, some more than once; the
    /// likeliest first.
    pub(crate) fn around(&self, ray: &AimedRay) -> impl Iterator<Item = u32> {
        let fans = ray.ends.into_iter().flat_map(|v| &self.fans[v as usize]);
        std::iter::once(ray.triangle).chain(fans.copied())
    }

    pub(crate) fn ray(&self, aim: Aim, random: &mut Random) -> AimedRay {
        let triangle = pick(random, self.triangles.len());
        let corners = self.triangles[triangle];
        let corner = pick(random, 3);
        let ends = [corners[corner], corners[(corner + 1) % 3]];
        let [a, b] = ends.map(|v| self.positions[v as usize]);
        let at_vertex = match aim.target {
            Target::Edges => false,
            Target::Vertices => true,
            Target::Both => pick(random, 5) == 0,
        };
        let o = aim.center + aim.reach * random.in_cube();
        let d = if at_vertex { a } else { a + random.unit() * (b - a) } - o;
        let is_unit = pick(random, 2) == 0;
        AimedRay { o, d: if is_unit { d.normalize() } else { d }, triangle: triangle as u32, ends }
    }

    /// How many of `count` rays `hits` finds no triangle for. Those around the edge come
    /// first: nearly every ray meets one of them. A ray for which the tree finds none either
    /// is held against all.
    pub(crate) fn leaks(
        &self,
        aim: Aim,
        count: u64,
        seed: u64,
        hits: impl Fn(Vec3, Vec3, [Vec3; 3]) -> bool + Sync,
    ) -> u64 {
        let leaks_of_chunk = |chunk: u64| {
            let mut random = Random(Random(seed << 32 | chunk).bits());
            let rays = CHUNK.min(count - chunk * CHUNK);
            let is_leak = |_: &u64| {
                let ray = self.ray(aim, &mut random);
                let (o, d) = (ray.o, ray.d);
                let hits = |t: u32| hits(o, d, self.corners(t));
                let ray_of_tree = Ray { o, d, t_max: f32::MAX };
                !(self.around(&ray).any(hits)
                    || any_hit(&self.bvh, &ray_of_tree, |_, t, _| hits(t).then_some(1.0))
                    || (0..self.triangles.len() as u32).any(hits))
            };
            (0..rays).filter(is_leak).count() as u64
        };
        (0..count.div_ceil(CHUNK)).into_par_iter().map(leaks_of_chunk).sum()
    }

    /// A scene of this mesh alone.
    pub(crate) fn scene(&self) -> Scene {
        let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0);
        let (positions, triangles) = (self.positions.clone(), self.triangles.clone());
        let mesh = stage.mesh(Mesh { positions, triangles, ..Mesh::default() }, lambert(0.5));
        stage.place(mesh, Affine3A::IDENTITY);
        stage.scene
    }
}

/// A star-shaped sphere of 16 by 32 quads with radii from 1 to 6 times `size`, random
/// diagonals and random first corners.
pub(crate) fn star(center: Vec3, size: f32, seed: u64) -> ClosedMesh {
    const ROWS: u32 = 16;
    const COLUMNS: u32 = 32;
    let mut random = Random(seed);
    let mut radius = || size * (1.0 + 5.0 * random.unit());
    let mut positions = Vec::new();
    for row in 1..ROWS {
        for column in 0..COLUMNS {
            let (st, ct) = (PI * row as f32 / ROWS as f32).sin_cos();
            let (sp, cp) = (TAU * column as f32 / COLUMNS as f32).sin_cos();
            positions.push(center + radius() * Vec3::new(st * cp, ct, st * sp));
        }
    }
    let north = positions.len() as u32;
    positions.extend([center + radius() * Vec3::Y, center - radius() * Vec3::Y]);
    let at = |row: u32, column: u32| (row - 1) * COLUMNS + column % COLUMNS;
    let mut triangles = Vec::new();
    for c in 0..COLUMNS {
        triangles.push([north, at(1, c), at(1, c + 1)]);
        triangles.push([north + 1, at(ROWS - 1, c + 1), at(ROWS - 1, c)]);
        for r in 1..ROWS - 1 {
            let [p, q, s, t] = [at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)];
            if pick(&mut random, 2) == 0 {
                triangles.extend([[p, q, s], [p, s, t]]);
            } else {
                triangles.extend([[p, q, t], [q, s, t]]);
            }
        }
    }
    triangles.iter_mut().for_each(|t| t.rotate_left(pick(&mut random, 3)));
    ClosedMesh::new(positions, triangles)
}

/// The 12 triangles of the cube from -1 to 1; `with_flat_triangles` also one without
/// area on each edge, of its ends and its exact middle.
pub(crate) fn cube(with_flat_triangles: bool) -> ClosedMesh {
    let mut positions: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0)
        .collect();
    let mut triangles = Vec::new();
    for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    {
        let [a, b, c, d]: [u32; 4] = quad;
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    if with_flat_triangles {
        for a in 0..8u32 {
            for b in [a | 1, a | 2, a | 4].into_iter().filter(|&b| b != a) {
                let middle = 0.5 * (positions[a as usize] + positions[b as usize]);
                triangles.push([a, positions.len() as u32, b]);
                positions.push(middle);
            }
        }
    }
    ClosedMesh::new(positions, triangles)
}

/// The cube from -1 to 1 as a prism along x: each of four faces has ten strips 2 long and 2e-6
/// wide beside one wide rest, and the end faces have needles to match.
pub(crate) fn needles() -> ClosedMesh {
    let mut outline = Vec::new();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0f32)];
    for i in 0..4 {
        let ((ay, az), (by, bz)) = (corners[i], corners[(i + 1) % 4]);
        for step in 0..=10 {
            let s = 1e-6 * step as f32;
            outline.push((ay + s * (by - ay), az + s * (bz - az)));
        }
    }
    let side = |x: f32| outline.iter().map(move |&(y, z)| Vec3::new(x, y, z));
    let mut positions: Vec<Vec3> = side(-1.0).chain(side(1.0)).collect();
    let count = outline.len() as u32;
    let hub = positions.len() as u32;
    positions.extend([Vec3::NEG_X, Vec3::X]);
    let mut triangles = Vec::new();
    for a in 0..count {
        let b = (a + 1) % count;
        triangles.extend([[a, a + count, b + count], [a, b + count, b]]);
        triangles.extend([[hub, a, b], [hub + 1, b + count, a + count]]);
    }
    ClosedMesh::new(positions, triangles)
}
