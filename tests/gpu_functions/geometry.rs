//! Rays against triangles and boxes.

use crate::{Random, harness, run};
use glam::{UVec4, Vec3, Vec4};
use steradian::bvh::{Bvh, BvhChild, GridRay, UPPER_PLANE_SHIFT, triangle_hit};
use steradian::shader::Feature;

/// Units in the last place by which device and host may differ where both divide:
/// WGSL allows 2.5 for a quotient.
const ULPS: f32 = 8.0 * f32::EPSILON;

/// A closed surface around the origin: 16 by 32 patches, radius 1 to 6 at random.
struct StarShape {
    points: Vec<Vec3>,
    triangles: Vec<[usize; 3]>,
}

fn star_shape(random: &mut Random) -> StarShape {
    const ROWS: usize = 16;
    const COLUMNS: usize = 32;
    let mut points = vec![Vec3::Y * 3.0, Vec3::Y * -2.0];
    for i in 1..ROWS {
        for j in 0..COLUMNS {
            let theta = std::f32::consts::PI * i as f32 / ROWS as f32;
            let phi = std::f32::consts::TAU * j as f32 / COLUMNS as f32;
            let (s, c) = theta.sin_cos();
            let direction = Vec3::new(s * phi.cos(), c, s * phi.sin());
            points.push(direction * (1.0 + 5.0 * random.unit()));
        }
    }
    let at = |i: usize, j: usize| match i {
        0 => 0,
        ROWS => 1,
        _ => 2 + (i - 1) * COLUMNS + j % COLUMNS,
    };
    let mut triangles = Vec::new();
    for i in 0..ROWS {
        for j in 0..COLUMNS {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend(
                [[a, b, c], [a, c, d]]
                    .iter()
                    .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
            );
        }
    }
    StarShape { points, triangles }
}

type TriangleInput = [Vec4; 5];

fn triangle_input(o: Vec3, d: Vec3, v: [Vec3; 3]) -> TriangleInput {
    [o.extend(0.0), d.extend(0.0), v[0].extend(0.0), v[1].extend(0.0), v[2].extend(0.0)]
}

fn device_triangle_hits(inputs: &[TriangleInput]) -> Vec<Vec4> {
    run(harness!("triangle"), &[Feature::Triangles], inputs, 1)
}

/// Asserts that the device's hit is the host's: the same class, and the same place.
fn assert_same_hit(input: &TriangleInput, device: Vec4) {
    let [o, d, a, b, c] = input.map(Vec4::truncate);
    let host = triangle_hit(o, d, a, b, c, f32::INFINITY);
    assert_eq!(device.x > 0.0, host.is_some(), "{input:?}: {device} {host:?}");
    if let Some(h) = host {
        let error = (device.x - h.t).abs();
        assert!(error <= ULPS * h.t, "{input:?}: {device} {h:?}");
        assert!((device.y - h.u).abs() <= ULPS && (device.z - h.v).abs() <= ULPS, "{device} {h:?}");
    }
}

#[test]
fn triangles_as_on_the_host() {
    let mut random = Random(3);
    let inputs: Vec<_> = (0..1 << 16)
        .map(|_| {
            let mut point = || random.in_cube();
            let v = [point(), point(), point()];
            let o = point() * 2.0;
            // Aimed at a parallelogram about the triangle: some miss.
            let aim = point();
            let target = v[0] + (v[1] - v[0]) * aim.x.abs() + (v[2] - v[0]) * aim.y.abs();
            triangle_input(o, (target - o) * (0.1 + aim.z.abs()), v)
        })
        .collect();
    let hits = device_triangle_hits(&inputs);
    assert!(hits.iter().filter(|h| h.x > 0.0).count() > 1000);
    inputs.iter().zip(hits).for_each(|(input, hit)| assert_same_hit(input, hit));
}

/// Which of the rays meet no triangle of those that each is tested against.
fn rays_without_hit(tests: &[Vec<TriangleInput>]) -> Vec<usize> {
    let mut inputs = tests.concat();
    inputs.resize(inputs.len().next_multiple_of(64), tests[0][0]);
    let hits = device_triangle_hits(&inputs);
    // The class of every test, edge or not, is the host's.
    for (input, hit) in inputs.iter().zip(&hits) {
        let [o, d, a, b, c] = input.map(Vec4::truncate);
        let host = triangle_hit(o, d, a, b, c, f32::INFINITY);
        assert_eq!(hit.x > 0.0, host.is_some(), "{input:?}: {hit} {host:?}");
    }
    let mut rest = &hits[..];
    let mut misses = Vec::new();
    for (i, test) in tests.iter().enumerate() {
        let (of_ray, others) = rest.split_at(test.len());
        rest = others;
        if of_ray.iter().all(|h| h.x <= 0.0) {
            misses.push(i);
        }
    }
    misses
}

/// No ray from inside a closed mesh gets out, aimed at its edges and vertices. Most are met
/// by a triangle that touches the edge; one that only grazes it is tested against all.
#[test]
fn no_ray_leaves_through_an_edge() {
    const RAYS: usize = 1 << 17;
    for scale in [1.0, 1e-4] {
        let mut random = Random(4);
        let shape = star_shape(&mut random);
        let all: Vec<usize> = (0..shape.triangles.len()).collect();
        let touching: Vec<Vec<usize>> = (0..shape.points.len())
            .map(|p| all.iter().copied().filter(|&t| shape.triangles[t].contains(&p)).collect())
            .collect();
        let against = |(o, d): (Vec3, Vec3), triangles: &mut dyn Iterator<Item = usize>| {
            let corners = |t: usize| shape.triangles[t].map(|k| shape.points[k] * scale);
            triangles.map(|t| triangle_input(o, d, corners(t))).collect::<Vec<_>>()
        };
        let mut rays = Vec::new();
        let mut local = Vec::new();
        for _ in 0..RAYS {
            let triangle = shape.triangles[random.bits() as usize % shape.triangles.len()];
            let (p, q) = (triangle[0], triangle[1]);
            // One ray in four goes to a vertex.
            let share = if random.bits().is_multiple_of(4) { 0.0 } else { random.unit() };
            let o = random.in_cube() * 0.2;
            let d = shape.points[p].lerp(shape.points[q], share) - o;
            let ray = (o * scale, d);
            let others = touching[q].iter().filter(|t| !touching[p].contains(t));
            local.push(against(ray, &mut touching[p].iter().chain(others).copied()));
            rays.push(ray);
        }
        let grazing = rays_without_hit(&local);
        assert!(grazing.len() < RAYS / 50, "{} rays graze", grazing.len());
        let global: Vec<_> =
            grazing.iter().map(|&i| against(rays[i], &mut all.iter().copied())).collect();
        let leaks = if global.is_empty() { Vec::new() } else { rays_without_hit(&global) };
        assert_eq!(leaks.len(), 0, "of {RAYS} at scale {scale}");
    }
}

/// The boxes that the device's walk enters are those that the host's does.
#[test]
fn boxes_as_on_the_host() {
    let mut random = Random(6);
    let inputs: Vec<[UVec4; 5]> = (0..1 << 16)
        .map(|i| {
            let words = |v: Vec3, w: f32| UVec4::from(v.extend(w).to_array().map(f32::to_bits));
            let (mut o, mut d) = (random.in_cube() * 2.0, random.in_cube());
            // Some rays run along an axis or in a box plane.
            if i % 4 == 1 {
                d[i / 4 % 3] = [0.0, -0.0, 1e-30][i / 16 % 3];
            }
            if i % 8 == 1 {
                o[i / 4 % 3] = -1.0;
            }
            let mut planes = || {
                let (a, b) = (random.bits() as u32 & 0xffff, random.bits() as u32 & 0xffff);
                a.min(b) | a.max(b) << UPPER_PLANE_SHIFT
            };
            let child = UVec4::new(planes(), planes(), planes(), 7);
            let t_max = [0.5, 3.0, f32::MAX][i % 3];
            let scale = Vec3::splat(2.0 / 65535.0);
            [words(o, 0.0), words(d, t_max), words(Vec3::NEG_ONE, 0.0), words(scale, 0.0), child]
        })
        .collect();
    let outputs: Vec<[i32; 2]> = run(harness!("slab"), &[], &inputs, 1);
    let mut hit_count = 0;
    for (input, [near, far]) in inputs.iter().zip(outputs) {
        let float = |k: usize| Vec4::from(input[k].to_array().map(f32::from_bits));
        let bvh = Bvh {
            nodes: Vec::new(),
            order: Vec::new(),
            grid_min: float(2).truncate(),
            grid_scale: float(3).truncate(),
            depth: 1,
        };
        let [x, y, z, link] = input[4].to_array();
        let child = BvhChild { x, y, z, link };
        let ray = GridRay::new(&bvh, float(0).truncate(), float(1).truncate());
        let host = ray.entry(&child, float(1).w);
        assert_eq!(near <= far, host.is_some(), "{input:?}: {near} {far} {host:?}");
        let Some(host) = host else { continue };
        hit_count += 1;
        let device = f32::from_bits(near as u32);
        assert!((device - host).abs() <= ULPS * host, "{input:?}: {device} {host}");
    }
    assert!(hit_count > 1000);
}
