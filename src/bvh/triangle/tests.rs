//! Leaks, scale, slivers and agreement with f64, in plain and in fused arithmetic.

use super::*;
use crate::bvh::random::Random;
use glam::DVec3;

type Intersector = fn(Vec3, Vec3, Vec3, Vec3, Vec3, f32) -> Option<TriangleHit>;

const PLAIN: Intersector = triangle_hit_as::<false>;
const FUSED: Intersector = triangle_hit_as::<true>;

/// Möller-Trumbore without the second look: what leaks.
fn moller_trumbore(
    o: Vec3,
    d: Vec3,
    v0: Vec3,
    v1: Vec3,
    v2: Vec3,
    t_max: f32,
) -> Option<TriangleHit> {
    let (e1, e2, s) = (v1 - v0, v2 - v0, o - v0);
    let (h, q) = (d.cross(e2), s.cross(e1));
    let det = e1.dot(h);
    let (u, v, t) = (s.dot(h) / det, d.dot(q) / det, e2.dot(q) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < t_max).then_some(TriangleHit {
        t,
        u,
        v,
    })
}

struct ClosedMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    triangles_of_vertex: Vec<Vec<u32>>,
}

impl ClosedMesh {
    fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let mut triangles_of_vertex = vec![Vec::new(); positions.len()];
        for (i, t) in triangles.iter().enumerate() {
            t.iter().for_each(|&v| triangles_of_vertex[v as usize].push(i as u32));
        }
        Self { positions, triangles, triangles_of_vertex }
    }

    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Whether the ray hits anything; the triangles at vertices a and b come first.
    fn is_hit(&self, intersect: Intersector, o: Vec3, d: Vec3, a: u32, b: u32) -> bool {
        let hits = |t: u32| {
            let [v0, v1, v2] = self.corners(t);
            intersect(o, d, v0, v1, v2, f32::MAX).is_some()
        };
        let near = |v: u32| self.triangles_of_vertex[v as usize].iter().any(|&t| hits(t));
        near(a) || near(b) || (0..self.triangles.len() as u32).any(hits)
    }

    /// Rays from within `reach` of `center` at random points of edges (4 of 5) and
    /// at vertices; returns how many hit nothing.
    fn leaks(&self, intersect: Intersector, center: Vec3, reach: f32, rays: u32, seed: u64) -> u32 {
        let mut random = Random::new(seed);
        let mut leaks = 0;
        for i in 0..rays {
            let o = center + reach * random.in_cube();
            let triangle = self.triangles[random.below(self.triangles.len() as u32) as usize];
            let corner = random.below(3) as usize;
            let (a, b) = (triangle[corner], triangle[(corner + 1) % 3]);
            let (pa, pb) = (self.positions[a as usize], self.positions[b as usize]);
            let target = if i % 5 == 0 { pa } else { pa + random.unit() * (pb - pa) };
            let mut d = target - o;
            if i % 2 == 0 {
                d = d.normalize();
            }
            leaks += u32::from(!self.is_hit(intersect, o, d, a, b));
        }
        leaks
    }
}

/// A star-shaped sphere of 16 by 32 quads with radii from 1 to 6 times `size`,
/// random diagonals and random first corners.
fn star(center: Vec3, size: f32, seed: u64) -> ClosedMesh {
    const ROWS: u32 = 16;
    const COLUMNS: u32 = 32;
    let mut random = Random::new(seed);
    let mut positions = Vec::new();
    for row in 1..ROWS {
        for column in 0..COLUMNS {
            let (st, ct) = (std::f32::consts::PI * row as f32 / ROWS as f32).sin_cos();
            let (sp, cp) = (std::f32::consts::TAU * column as f32 / COLUMNS as f32).sin_cos();
            let radius = size * (1.0 + 5.0 * random.unit());
            positions.push(center + radius * Vec3::new(st * cp, ct, st * sp));
        }
    }
    let north = positions.len() as u32;
    positions.push(center + size * Vec3::Y * (1.0 + 5.0 * random.unit()));
    positions.push(center - size * Vec3::Y * (1.0 + 5.0 * random.unit()));
    let at = |row: u32, column: u32| (row - 1) * COLUMNS + column % COLUMNS;
    let mut triangles = Vec::new();
    for c in 0..COLUMNS {
        triangles.push([north, at(1, c), at(1, c + 1)]);
        triangles.push([north + 1, at(ROWS - 1, c + 1), at(ROWS - 1, c)]);
        for r in 1..ROWS - 1 {
            let [p, q, s, t] = [at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)];
            if random.below(2) == 0 {
                triangles.extend([[p, q, s], [p, s, t]]);
            } else {
                triangles.extend([[p, q, t], [q, s, t]]);
            }
        }
    }
    for t in &mut triangles {
        t.rotate_left(random.below(3) as usize);
    }
    ClosedMesh::new(positions, triangles)
}

const PLACEMENTS: [(Vec3, f32); 4] = [
    (Vec3::ZERO, 1.0),
    (Vec3::new(148_376.0, 1234.0, -223_423.0), 0.5),
    (Vec3::ZERO, 1e-4),
    (Vec3::new(-3e5, 2e6, 1e4), 1e6),
];

#[test]
fn rays_at_edges_and_vertices_of_a_closed_mesh_never_leak() {
    for (i, (center, size)) in PLACEMENTS.into_iter().enumerate() {
        let mesh = star(center, size, 10 + i as u64);
        for (name, intersect) in [("plain", PLAIN), ("fused", FUSED)] {
            let leaks = mesh.leaks(intersect, center, 0.4 * size, 1_000_000, 20 + i as u64);
            assert_eq!(leaks, 0, "{name} arithmetic, size {size} at {center}");
        }
    }
}

/// The test above can fail: the same rays with plain Möller-Trumbore.
#[test]
fn plain_moller_trumbore_leaks() {
    let leaks = star(Vec3::ZERO, 1.0, 10).leaks(moller_trumbore, Vec3::ZERO, 0.4, 100_000, 20);
    assert!(leaks > 1000, "{leaks} of 100000 rays");
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mesh = star(Vec3::ZERO, 1.0, 30);
    let mut random = Random::new(31);
    let mut hits = 0;
    for _ in 0..20_000 {
        let o = 0.4 * random.in_cube();
        let [v0, v1, v2] = mesh.corners(random.below(mesh.triangles.len() as u32));
        let d = v0 + random.unit() * (v1 - v0) - o;
        let expected = triangle_hit(o, d, v0, v1, v2, f32::MAX);
        hits += u32::from(expected.is_some());
        for exponent in [-20, -13, 13, 20] {
            let s = 2.0f32.powi(exponent);
            let scaled = triangle_hit(s * o, d, s * v0, s * v1, s * v2, f32::MAX);
            assert_eq!(scaled, expected.map(|h| TriangleHit { t: s * h.t, ..h }));
        }
    }
    assert!((5_000..20_000).contains(&hits), "{hits} hits: about half expected");
}

/// The 12 triangles of the cube from -1 to 1; `with_flat_triangles` also one without
/// area on each edge, of its ends and its middle.
fn cube(with_flat_triangles: bool) -> ClosedMesh {
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

#[test]
fn triangles_without_area_are_missed_and_open_no_gap() {
    let mesh = cube(true);
    for intersect in [PLAIN, FUSED] {
        assert_eq!(mesh.leaks(intersect, Vec3::ZERO, 0.9, 200_000, 40), 0);
    }
    let (a, b) = (Vec3::new(0.3, -0.7, 1.1), Vec3::new(-2.0, 0.1, 1.9));
    let flat = [[a, a, a], [a, a, b], [a, b, b], [b, a, b]];
    let mut random = Random::new(41);
    for [v0, v1, v2] in flat {
        for target in [a, b, a + 0.25 * (b - a)] {
            let o = random.in_cube();
            assert_eq!(triangle_hit(o, target - o, v0, v1, v2, f32::MAX), None);
        }
    }
}

/// Strips of a million to one: each face of a box has ten of them beside one wide
/// remainder.
#[test]
fn needles_of_a_closed_box_never_leak() {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    // A prism along x whose cross-section is a polygon with ten tiny steps on each side.
    let mut outline = Vec::new();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0f32)];
    for i in 0..4 {
        let ((ay, az), (by, bz)) = (corners[i], corners[(i + 1) % 4]);
        for step in 0..=10 {
            let s = 2e-6 * step as f32;
            outline.push((ay + s * (by - ay), az + s * (bz - az)));
        }
    }
    for &(y, z) in &outline {
        positions.extend([Vec3::new(-1.0, y, z), Vec3::new(1.0, y, z)]);
    }
    let count = outline.len() as u32;
    for i in 0..count {
        let (a, b) = (2 * i, 2 * ((i + 1) % count));
        triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
    let hub = positions.len() as u32;
    positions.extend([Vec3::NEG_X, Vec3::X]);
    for i in 0..count {
        let (a, b) = (2 * i, 2 * ((i + 1) % count));
        triangles.extend([[hub, a, b], [hub + 1, b + 1, a + 1]]);
    }
    let mesh = ClosedMesh::new(positions, triangles);
    for intersect in [PLAIN, FUSED] {
        assert_eq!(mesh.leaks(intersect, Vec3::ZERO, 0.9, 500_000, 50), 0);
    }
}

#[test]
fn a_ray_in_the_plane_of_faces_leaves_a_cube_through_another_face() {
    let mesh = cube(false);
    let mut random = Random::new(60);
    for i in 0..20_000 {
        // In a coordinate plane of the cube's centre, in the plane of a face, or
        // in a diagonal plane that holds two shared edges.
        let (a, b) = (2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
        let (o, d) = match i % 3 {
            0 => (Vec3::new(0.0, 0.5 * a, 0.5 * b), Vec3::new(0.0, a + 0.01, b)),
            1 => (Vec3::new(1.0, 0.5 * a, 0.5 * b), Vec3::new(0.0, b + 0.01, a)),
            _ => (Vec3::new(0.5 * a, 0.5 * a, 0.5 * b), Vec3::new(b + 0.01, b + 0.01, a)),
        };
        assert!(mesh.is_hit(PLAIN, o, d, 0, 7), "from {o} along {d}");
        for t in 0..12 {
            let [v0, v1, v2] = mesh.corners(t);
            if let Some(h) = triangle_hit(o, d, v0, v1, v2, f32::MAX) {
                assert!(
                    h.t.is_finite() && (0.0..=1.0).contains(&h.u) && (0.0..=1.0).contains(&h.v)
                );
            }
        }
    }
}

/// A sliver from a production scene that pbrt-v4's tests record as a wrong hit
/// (triangle tests, "BadCases"): its vertices are on one line.
#[test]
fn the_published_sliver_is_missed() {
    let o = Vec3::new(-1_081.479_2, 99.999_954, 87.770_11);
    let d = Vec3::new(-32.107_3, -183.355_87, -144.607_64);
    let vertex = |y: f32| Vec3::new(-1_113.454_6, y, -56.243_19);
    let (v0, v1, v2) = (vertex(-79.049_614), vertex(-87.092_27), vertex(-79.209_015));
    assert_eq!(triangle_hit(o, d, v0, v1, v2, 0.9999), None);
}

/// Exact to about 2^-50 of the products: the three weights in f64.
fn weights(o: Vec3, d: Vec3, v: [Vec3; 3]) -> [f64; 3] {
    let [p0, p1, p2] = v.map(|v| (v - o).as_dvec3());
    let d = d.as_dvec3();
    [d.dot(p1.cross(p2)), d.dot(p2.cross(p0)), d.dot(p0.cross(p1))]
}

/// Triangles with edges from 1e-8 to 1e8 long and any angles agree with f64
/// wherever no weight is within the documented bound of zero.
#[test]
fn slivers_agree_with_double_precision() {
    let mut random = Random::new(70);
    let (mut hits, mut misses, mut doubtful) = (0, 0, 0);
    for _ in 0..1_000_000 {
        let length = |random: &mut Random| 10.0f32.powf(16.0 * random.unit() - 8.0);
        let v0 = length(&mut random) * random.in_cube();
        let v1 = v0 + length(&mut random) * random.in_cube();
        let v2 = v0 + length(&mut random) * random.in_cube();
        let o = length(&mut random) * random.in_cube();
        let (u, v) = (1.4 * random.unit() - 0.2, 1.4 * random.unit() - 0.2);
        let d = (v0 + u * (v1 - v0) + v * (v2 - v0) - o).normalize();
        if !d.is_finite() {
            continue;
        }
        let w = weights(o, d, [v0, v1, v2]);
        let p = [v0 - o, v1 - o, v2 - o].map(|p| p.as_dvec3());
        let size = p.iter().map(|p| p.length()).fold(0.0, f64::max);
        let edge = (p[1] - p[0]).length().max((p[2] - p[0]).length());
        let bound = 256.0 / 16_777_216.0 * 3.0 * size * (3.0 * edge + size / 174_763.0);
        if w.iter().any(|w| w.abs() <= bound) {
            doubtful += 1;
            continue;
        }
        let sum: f64 = w.iter().sum();
        let point: DVec3 = (0..3).map(|i| w[i] / sum * p[i]).sum();
        let inside = w.iter().all(|&w| w > 0.0) || w.iter().all(|&w| w < 0.0);
        let expected = inside && point.dot(d.as_dvec3()) > 0.0;
        let found = triangle_hit(o, d, v0, v1, v2, f32::MAX);
        assert_eq!(found.is_some(), expected, "{o} {d} {v0} {v1} {v2}");
        if expected {
            hits += 1;
        } else {
            misses += 1;
        }
    }
    assert!(hits > 5_000 && misses > 5_000, "{hits} hits, {misses} misses, {doubtful} in doubt");
}

/// Distance and barycentrics of well-shaped triangles, against f64: the errors are
/// a few units of 2^-24 of the largest relative coordinate.
#[test]
fn distance_and_barycentrics_agree_with_double_precision() {
    let mut random = Random::new(80);
    let mut hits = 0;
    for _ in 0..200_000 {
        let center = 10.0f32.powf(4.0 * random.unit()) * random.in_cube();
        let [v0, v1, v2] = [0, 1, 2].map(|_| center + random.in_cube());
        let o = 2.0 * random.in_cube();
        let d = (center + 0.5 * random.in_cube() - o).normalize();
        let p = [v0 - o, v1 - o, v2 - o].map(|p| p.as_dvec3());
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        if normal.dot(d.as_dvec3()).abs() < 0.3 {
            continue;
        }
        let Some(hit) = triangle_hit(o, d, v0, v1, v2, f32::MAX) else { continue };
        hits += 1;
        let w = weights(o, d, [v0, v1, v2]);
        let sum: f64 = w.iter().sum();
        let t = normal.dot(p[0]) / normal.dot(d.as_dvec3()) / d.as_dvec3().length_squared().sqrt();
        let size = p.iter().map(|p| p.length()).fold(0.0, f64::max);
        // 37 u D E |d| is the bound of a weight, E < 3.5, the sum at least 0.3.
        let bound = 37.0 / 16_777_216.0 * size * 3.5 / 0.3;
        assert!((f64::from(hit.u) - w[1] / sum).abs() < bound);
        assert!((f64::from(hit.v) - w[2] / sum).abs() < bound);
        assert!((f64::from(hit.t) - t).abs() < 7.0 * bound, "{} {t}", hit.t);
    }
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn the_interval_is_open() {
    let [v0, v1, v2] =
        [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, -1.0, 2.0), Vec3::new(0.0, 1.0, 2.0)];
    let at = |o, t_max| triangle_hit(o, Vec3::Z, v0, v1, v2, t_max).map(|h| h.t);
    assert_eq!(at(Vec3::ZERO, 2.0), None);
    assert_eq!(at(Vec3::ZERO, 2.0f32.next_up()), Some(2.0));
    assert_eq!(at(Vec3::new(0.0, 0.0, 2.0), 9.0), None, "t = 0");
    assert_eq!(at(Vec3::new(0.0, 0.0, 3.0), 9.0), None, "behind");
    assert_eq!(triangle_hit(Vec3::ZERO, 2.0 * Vec3::Z, v0, v2, v1, 9.0).map(|h| h.t), Some(1.0));
}

/// A floor of 2e5 m seen from eye height: t is right to a few units in the last place,
/// though the vertices are known to 1e-2 m only.
#[test]
fn distance_to_a_huge_floor_is_exact() {
    let corner = |x: f32, z: f32| Vec3::new(1e5 * x, -0.3, 1e5 * z);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut random = Random::new(90);
    for _ in 0..100_000 {
        let o = Vec3::new(3.0 * random.unit(), 1.7 * random.unit(), 3.0 * random.unit());
        let direction = (random.in_cube() - Vec3::Y * 1.01).normalize();
        let hit = |v0, v1, v2| triangle_hit(o, direction, v0, v1, v2, f32::MAX);
        let hit = hit(a, b, c).or(hit(a, c, d)).expect("a floor below");
        let exact = (f64::from(a.y) - f64::from(o.y)) / f64::from(direction.y);
        assert!((f64::from(hit.t) / exact - 1.0).abs() < 8.0 / 16_777_216.0, "{} {exact}", hit.t);
    }
}
