//! The same triangles on the device, through the renderer's traversals.

use super::degenerate::rays_in_planes;
use super::edges::{PLACEMENTS, SIZES, aim};
use crate::closed_mesh::{Aim, ClosedMesh, Target, cube, needles, star};
use crate::common::{Call, Random, assert_at_least, assert_at_most, harness};
use crate::traced::{Answer, Query, Walk, trace};
use glam::{Vec3, Vec4};
use steradian::bvh::triangle_hit;
use steradian::shader::Feature;

fn queries(mesh: &ClosedMesh, aim: Aim, count: usize, seed: u64) -> Vec<Query> {
    let mut random = Random(seed);
    let query = |_| {
        let ray = mesh.ray(aim, &mut random);
        Query::new(ray.o, ray.d)
    };
    (0..count).map(query).collect()
}

/// Rays that the device lets out, or gives a hit that is no place on a triangle, or takes to be
/// free of any occluder.
fn leaks(answers: &[Answer]) -> usize {
    let weights = 0.0..=1.0;
    let is_sound = |a: &Answer| {
        let is_inside = weights.contains(&a.u) && weights.contains(&a.v);
        a.source().is_some() && a.t > 0.0 && a.t < f32::MAX && is_inside && a.is_blocked()
    };
    answers.iter().filter(|a| !is_sound(a)).count()
}

/// Leaks of `count` rays, as many for each placement.
fn leaks_of_placements(walk: Walk, count: usize) -> f64 {
    let of_placement = |(i, place): (usize, (Vec3, f32))| {
        let mesh = star(place.0, place.1, 10 + i as u64);
        let scene = mesh.scene();
        let mut leaked = 0;
        // In parts, so that no array is large.
        for part in 0..(count / 4).div_ceil(1 << 20) {
            let rays = (count / 4 - (part << 20)).min(1 << 20);
            let seed = 100 + 1000 * part as u64 + i as u64;
            let queries = queries(&mesh, aim(place, Target::Both), rays, seed);
            leaked += leaks(&trace(&scene, walk, &queries));
        }
        leaked
    };
    PLACEMENTS.into_iter().enumerate().map(of_placement).sum::<usize>() as f64
}

#[test]
fn b1_edges_do_not_leak_on_the_device() {
    for walk in Walk::over_trees() {
        let what = format!("leaks of 8e5 edge and vertex rays, 4 placements, device, {walk:?}");
        assert_at_most("B1", &what, leaks_of_placements(walk, 800_000), 0.0);
    }
    let leaks = leaks_of_placements(Walk::BruteForce, 20_000);
    assert_at_most("B1", "leaks of 2e4 such rays, device, BruteForce", leaks, 0.0);
}

#[test]
#[ignore = "tier N: about 2 minutes"]
fn b1_ten_million_edge_rays_do_not_leak_on_the_device() {
    for walk in Walk::over_trees() {
        let what = format!("leaks of 1e7 edge and vertex rays, 4 placements, device, {walk:?}");
        assert_at_most("B1", &what, leaks_of_placements(walk, 10_000_000), 0.0);
    }
}

/// Away from edges, where no rounding decides.
#[test]
fn b1_the_device_computes_what_the_mirror_does() {
    /// Units in the last place by which they may differ where both divide: WGSL allows 2.5
    /// for a quotient.
    const ULPS: f32 = 8.0 * f32::EPSILON;
    let mut random = Random(3);
    let input = |_| {
        let v = [random.in_cube(), random.in_cube(), random.in_cube()];
        let o = random.in_cube() * 2.0;
        // Aimed at a parallelogram about the triangle: some miss.
        let aim = random.in_cube();
        let target = v[0] + (v[1] - v[0]) * aim.x.abs() + (v[2] - v[0]) * aim.y.abs();
        let d = (target - o) * (0.1 + aim.z.abs());
        [o, d, v[0], v[1], v[2]].map(|v| v.extend(0.0))
    };
    let inputs: Vec<[Vec4; 5]> = (0..1 << 16).map(input).collect();
    let hits: Vec<Vec4> = Call::new(harness!("triangle"), &[Feature::Triangles]).run(&inputs, 1);
    let (mut hit_count, mut differ) = (0, 0);
    for (input, device) in inputs.iter().zip(hits) {
        let [o, d, a, b, c] = input.map(Vec4::truncate);
        let same = match triangle_hit(o, d, a, b, c, f32::MAX) {
            None => device.x <= 0.0,
            Some(h) => {
                hit_count += 1;
                let weights = (device.y - h.u).abs().max((device.z - h.v).abs());
                (device.x - h.t).abs() <= ULPS * h.t && weights <= ULPS
            }
        };
        differ += u32::from(!same);
    }
    assert_at_most("B1", "of 65536 rays, hits other than the mirror's", f64::from(differ), 0.0);
    assert_at_least("B1", "of them, hits", f64::from(hit_count), 1e4);
}

/// Scaling by a power of two changes no bit of what is hit, and where on it.
#[test]
fn b3_size_changes_no_decision_on_the_device() {
    let unit = star(Vec3::ZERO, 1.0, 30);
    let queries = queries(&unit, aim(PLACEMENTS[0], Target::Both), 1 << 16, 90);
    for walk in Walk::over_trees() {
        let at_size = |s: f32| {
            let positions = unit.positions.iter().map(|&p| s * p).collect();
            let scene = ClosedMesh::new(positions, unit.triangles.clone()).scene();
            let scaled = |q: &Query| Query::new(s * q.o, s * q.d);
            trace(&scene, walk, &queries.iter().map(scaled).collect::<Vec<_>>())
        };
        let expected = at_size(1.0);
        assert_at_most("B3", &format!("leaks of 65536, {walk:?}"), leaks(&expected) as f64, 0.0);
        for size in SIZES.into_iter().filter(|&s| s != 1.0) {
            let changed = at_size(size).iter().zip(&expected).filter(|(a, b)| a != b).count();
            let what = format!("of 65536 rays, hits that size {size} changes, device, {walk:?}");
            assert_at_most("B3", &what, changed as f64, 0.0);
        }
    }
}

#[test]
fn b4_b5_b6_degenerate_triangles_do_not_leak_on_the_device() {
    const INSIDE: Aim = Aim { center: Vec3::ZERO, reach: 0.9, target: Target::Both };
    let (flat, needles, cube) = (cube(true), needles(), cube(false));
    let in_planes: Vec<_> =
        rays_in_planes(1 << 16).into_iter().map(|(o, d)| Query::new(o, d)).collect();
    for (case, mesh, queries) in [
        ("B4", &flat, queries(&flat, INSIDE, 1 << 17, 110)),
        ("B5", &needles, queries(&needles, INSIDE, 1 << 17, 111)),
        ("B6", &cube, in_planes),
    ] {
        let scene = mesh.scene();
        for walk in Walk::each() {
            let leaks = leaks(&trace(&scene, walk, &queries)) as f64;
            let what = format!("leaks of {} rays, device, {walk:?}", queries.len());
            assert_at_most(case, &what, leaks, 0.0);
        }
    }
}
