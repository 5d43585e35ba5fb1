//! Triangles without area, needles, and rays in the plane of a triangle: B4 to B6, on the
//! mirror.

use super::naive::moller_trumbore;
use super::slivers::truth;
use crate::closed_mesh::{Aim, ClosedMesh, Target, cube, needles};
use crate::common::{Random, assert_at_most, report};
use glam::Vec3;
use steradian::bvh::{TriangleHit, triangle_hit_as};

/// Inside the cube from -1 to 1.
const INSIDE: Aim = Aim { center: Vec3::ZERO, reach: 0.9, target: Target::Both };

fn hit<const FUSED: bool>(o: Vec3, d: Vec3, [a, b, c]: [Vec3; 3]) -> Option<TriangleHit> {
    triangle_hit_as::<FUSED>(o, d, a, b, c, f32::MAX)
}

/// Finite, and weights of a point of the triangle.
fn is_sound(hit: TriangleHit) -> bool {
    let weights = 0.0..=1.0;
    hit.t.is_finite() && weights.contains(&hit.u) && weights.contains(&hit.v)
}

/// Leaks of `count` rays; a hit that is not sound counts for nothing.
fn leaks<const FUSED: bool>(mesh: &ClosedMesh, count: u64, seed: u64) -> f64 {
    let hits = |o, d, v| hit::<FUSED>(o, d, v).is_some_and(is_sound);
    mesh.leaks(INSIDE, count, seed, hits) as f64
}

/// Hits of `count` aimed rays on any triangle that are not sound.
fn unsound<const FUSED: bool>(mesh: &ClosedMesh, count: u32) -> f64 {
    let mut random = Random(40);
    let mut unsound = 0;
    for _ in 0..count {
        let ray = mesh.ray(INSIDE, &mut random);
        let hits = |t: u32| hit::<FUSED>(ray.o, ray.d, mesh.corners(t));
        unsound +=
            (0..mesh.triangles.len() as u32).filter_map(hits).filter(|h| !is_sound(*h)).count();
    }
    unsound as f64
}

#[test]
fn b4_triangles_without_area_open_no_gap() {
    let mesh = cube(true);
    assert_at_most(
        "B4",
        "leaks of 1e6, flat triangles on edges, plain",
        leaks::<false>(&mesh, 1_000_000, 41),
        0.0,
    );
    assert_at_most(
        "B4",
        "leaks of 1e6, flat triangles on edges, fused",
        leaks::<true>(&mesh, 1_000_000, 42),
        0.0,
    );
    assert_at_most("B4", "unsound hits of 1e5 rays, plain", unsound::<false>(&mesh, 100_000), 0.0);
    assert_at_most("B4", "unsound hits of 1e5 rays, fused", unsound::<true>(&mesh, 100_000), 0.0);
}

/// Whatever its place: no normal could be given for a hit.
#[test]
fn b4_triangles_without_area_are_missed() {
    let mut random = Random(43);
    let mut hits = 0;
    for _ in 0..100_000 {
        let a = 10.0f32.powf(8.0 * random.unit() - 4.0) * random.in_cube();
        let b = a + 10.0f32.powf(8.0 * random.unit() - 4.0) * random.in_cube();
        let o = random.in_cube();
        for v in [[a, a, a], [a, a, b], [a, b, b], [b, a, b]] {
            for target in [a, b, a + random.unit() * (b - a)] {
                hits += u32::from(hit::<false>(o, target - o, v).is_some());
                hits += u32::from(hit::<true>(o, target - o, v).is_some());
            }
        }
    }
    assert_at_most("B4", "hits on 4e5 triangles with a repeated vertex", f64::from(hits), 0.0);
}

#[test]
fn b5_needles_do_not_leak() {
    let mesh = needles();
    assert_at_most(
        "B5",
        "leaks of 1e7, strips 1e6:1, plain",
        leaks::<false>(&mesh, 10_000_000, 50),
        0.0,
    );
    assert_at_most(
        "B5",
        "leaks of 1e6, strips 1e6:1, fused",
        leaks::<true>(&mesh, 1_000_000, 51),
        0.0,
    );
}

/// A needle without neighbours may be missed: nothing says to which side its width rounds.
#[test]
fn b5_an_isolated_needle() {
    let mut random = Random(52);
    let (mut rays, mut misses) = (0, [0; 3]);
    while rays < 100_000 {
        let a = random.in_cube();
        let b = a + random.direction();
        let c = b + 1e-6 * random.direction();
        let s = random.unit();
        let o = a.midpoint(b) + 2.0 * random.direction();
        let d = a + s * (b.midpoint(c) - a) - o;
        if !truth(o, d, [a, b, c]).is_hit {
            continue;
        }
        rays += 1;
        misses[0] += u32::from(hit::<false>(o, d, [a, b, c]).is_none());
        misses[1] += u32::from(hit::<true>(o, d, [a, b, c]).is_none());
        misses[2] += u32::from(!moller_trumbore::<false>(o, d, [a, b, c], 0.0));
    }
    for (misses, what) in misses.into_iter().zip(["plain", "fused", "by Möller-Trumbore"]) {
        let share = f64::from(misses) / f64::from(rays);
        report("B5", &format!("share of hits on an isolated needle 1e6:1 missed, {what}"), share);
    }
}

/// From inside the cube from -1 to 1: in a plane through its centre, in the plane of a face, in
/// a diagonal plane that holds two edges.
pub(super) fn rays_in_planes(count: usize) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(60);
    let ray = |i: usize| {
        let (a, b) = (2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
        match i % 3 {
            0 => (Vec3::new(0.0, 0.5 * a, 0.5 * b), Vec3::new(0.0, a + 0.01, b)),
            1 => (Vec3::new(1.0, 0.5 * a, 0.5 * b), Vec3::new(0.0, b + 0.01, a)),
            _ => (Vec3::new(0.5 * a, 0.5 * a, 0.5 * b), Vec3::new(b + 0.01, b + 0.01, a)),
        }
    };
    (0..count).map(ray).collect()
}

#[test]
fn b6_a_ray_in_the_plane_of_a_face_meets_another() {
    let mesh = cube(false);
    let rays = rays_in_planes(300_000);
    let figures = |hit: fn(Vec3, Vec3, [Vec3; 3]) -> Option<TriangleHit>| {
        let (mut leaks, mut unsound) = (0, 0);
        for &(o, d) in &rays {
            let hits: Vec<_> = (0..12).filter_map(|t| hit(o, d, mesh.corners(t))).collect();
            leaks += u32::from(hits.is_empty());
            unsound += u32::from(!hits.into_iter().all(is_sound));
        }
        (f64::from(leaks), f64::from(unsound))
    };
    for (name, (leaks, unsound)) in
        [("plain", figures(hit::<false>)), ("fused", figures(hit::<true>))]
    {
        assert_at_most("B6", &format!("leaks of 3e5 rays in faces' planes, {name}"), leaks, 0.0);
        assert_at_most("B6", &format!("hits of them that are not sound, {name}"), unsound, 0.0);
    }
}
