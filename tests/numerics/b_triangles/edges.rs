//! Shared edges and vertices: B1 to B3, on the mirror.

use super::naive::{moller_trumbore, woop_fused};
use crate::closed_mesh::{Aim, ClosedMesh, Target, star};
use crate::common::{Random, assert_at_most, assert_naive_fails};
use glam::Vec3;
use steradian::bvh::{TriangleHit, triangle_hit_as};

/// Centre and size: at the origin, far from it, small, and large.
pub(super) const PLACEMENTS: [(Vec3, f32); 4] = [
    (Vec3::ZERO, 1.0),
    (Vec3::new(148_376.0, 1234.0, -223_423.0), 2.0),
    (Vec3::ZERO, 1e-4),
    (Vec3::new(-3e5, 2e6, 1e4), 1e6),
];

pub(super) fn aim((center, size): (Vec3, f32), target: Target) -> Aim {
    Aim { center, reach: 0.4 * size, target }
}

fn product<const FUSED: bool>(o: Vec3, d: Vec3, [v0, v1, v2]: [Vec3; 3]) -> bool {
    triangle_hit_as::<FUSED>(o, d, v0, v1, v2, f32::MAX).is_some_and(|h| h.t.is_finite())
}

/// Leaks of `count` rays, as many for each placement.
fn leaks<const FUSED: bool>(target: Target, count: u64, seed: u64) -> f64 {
    let of_placement = |(i, place): (usize, (Vec3, f32))| {
        let mesh = star(place.0, place.1, 10 + i as u64);
        mesh.leaks(aim(place, target), count / 4, seed + i as u64, product::<FUSED>)
    };
    PLACEMENTS.into_iter().enumerate().map(of_placement).sum::<u64>() as f64
}

#[test]
fn b1_shared_edges_and_vertices_do_not_leak() {
    let leaks = leaks::<false>(Target::Both, 10_000_000, 20);
    assert_at_most("B1", "leaks of 1e7 edge and vertex rays, 4 placements, plain", leaks, 0.0);
}

/// A share of leaks of rays at the star of the first placements.
fn naive_share(
    placement: usize,
    target: Target,
    hits: impl Fn(Vec3, Vec3, [Vec3; 3]) -> bool + Sync,
) -> f64 {
    const RAYS: u64 = 20_000;
    let place = PLACEMENTS[placement];
    let mesh = star(place.0, place.1, 10 + placement as u64);
    mesh.leaks(aim(place, target), RAYS, 30, hits) as f64 / RAYS as f64
}

#[test]
fn b1_usual_tests_leak() {
    let cut = |o, d, v| moller_trumbore::<false>(o, d, v, 1e-7);
    let plain = |o, d, v| moller_trumbore::<false>(o, d, v, 0.0);
    let fused = |o, d, v| moller_trumbore::<true>(o, d, v, 0.0);
    let fails = |what: &str, share: f64, least: f64| {
        assert_naive_fails("B1", &format!("Möller-Trumbore {what}, share of leaks"), share, least);
    };
    fails("cut 1e-7, unit mesh, edges", naive_share(0, Target::Edges, cut), 1e-2);
    fails("cut 1e-7, unit mesh, vertices", naive_share(0, Target::Vertices, cut), 1e-2);
    fails("cut 1e-7, size 1e-4, edges", naive_share(2, Target::Edges, cut), 1.0);
    fails("no cut, unit mesh, edges", naive_share(0, Target::Edges, plain), 1e-2);
    fails("no cut, far mesh, vertices", naive_share(1, Target::Vertices, plain), 1e-3);
    fails("fused, unit mesh, edges", naive_share(0, Target::Edges, fused), 1e-2);
    fails("fused, unit mesh, vertices", naive_share(0, Target::Vertices, fused), 1e-2);
}

#[test]
fn b2_contraction_does_not_leak() {
    let leaks = leaks::<true>(Target::Both, 10_000_000, 40);
    assert_at_most("B2", "leaks of 1e7 edge and vertex rays, 4 placements, fused", leaks, 0.0);
    let share = naive_share(0, Target::Edges, woop_fused);
    assert_naive_fails("B2", "Woop fused, ends as they come, share of leaks", share, 1e-3);
}

#[test]
#[ignore = "tier N: about 4 minutes"]
fn b1_a_billion_edge_rays_do_not_leak() {
    let edges = leaks::<false>(Target::Edges, 1_000_000_000, 50);
    assert_at_most("B1", "leaks of 1e9 edge rays, 4 placements, plain", edges, 0.0);
    let vertices = leaks::<false>(Target::Vertices, 250_000_000, 60);
    assert_at_most("B1", "leaks of 2.5e8 vertex rays, 4 placements, plain", vertices, 0.0);
}

#[test]
#[ignore = "tier N: about 10 minutes"]
fn b2_a_billion_contracted_edge_rays_do_not_leak() {
    let edges = leaks::<true>(Target::Edges, 1_000_000_000, 70);
    assert_at_most("B2", "leaks of 1e9 edge rays, 4 placements, fused", edges, 0.0);
    let vertices = leaks::<true>(Target::Vertices, 100_000_000, 80);
    assert_at_most("B2", "leaks of 1e8 vertex rays, 4 placements, fused", vertices, 0.0);
}

/// About 1e-6, 1e-4, 1, 1e4 and 1e6, as powers of two: scaling rounds nothing.
pub(super) const SIZES: [f32; 5] = [1.0 / 1_048_576.0, 1.0 / 8192.0, 1.0, 8192.0, 1_048_576.0];

/// Rays whose hits on the triangles around their edge differ in a bit between two sizes, of
/// `count`.
fn changed_by_size<const FUSED: bool>(mesh: &ClosedMesh, count: u32) -> f64 {
    let mut random = Random(90);
    let mut changed = 0;
    for _ in 0..count {
        let ray = mesh.ray(aim(PLACEMENTS[0], Target::Both), &mut random);
        let hits = |s: f32| {
            let hit = |t: u32| {
                let [a, b, c] = mesh.corners(t).map(|v| s * v);
                let hit = triangle_hit_as::<FUSED>(s * ray.o, s * ray.d, a, b, c, f32::MAX);
                hit.map(|TriangleHit { t, u, v }| [t, u, v].map(f32::to_bits))
            };
            mesh.around(&ray).map(hit).collect::<Vec<_>>()
        };
        let unit = hits(1.0);
        changed += u32::from(SIZES.iter().any(|&s| hits(s) != unit));
    }
    f64::from(changed)
}

#[test]
fn b3_size_changes_no_decision() {
    let mesh = star(Vec3::ZERO, 1.0, 30);
    let plain = changed_by_size::<false>(&mesh, 20_000);
    assert_at_most("B3", "of 2e4 rays, hits that 2^±13, 2^±20 change, plain", plain, 0.0);
    let fused = changed_by_size::<true>(&mesh, 20_000);
    assert_at_most("B3", "of 2e4 rays, hits that 2^±13, 2^±20 change, fused", fused, 0.0);
    for size in SIZES {
        let mesh = star(Vec3::ZERO, size, 31);
        let aim = aim((Vec3::ZERO, size), Target::Both);
        let leaks = |f: fn(Vec3, Vec3, [Vec3; 3]) -> bool| mesh.leaks(aim, 200_000, 32, f) as f64;
        assert_at_most("B3", &format!("leaks of 2e5, size {size}"), leaks(product::<false>), 0.0);
        assert_at_most(
            "B3",
            &format!("leaks of 2e5, fused, size {size}"),
            leaks(product::<true>),
            0.0,
        );
    }
}
