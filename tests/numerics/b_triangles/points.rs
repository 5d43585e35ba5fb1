//! Points of hits, and rays that leave them: B8 and B10, on the device.

use crate::common::{Call, Random, Stage, assert_at_least, assert_at_most, assert_naive_fails};
use crate::common::{harness, lambert, quad_mesh, settings};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, DVec3, Vec3, Vec4};
use steradian::scene::{Mesh, Scene};

/// A ray, and the direction of one that leaves where it hits. W is not used.
type Input = [Vec4; 3];

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Output {
    position: Vec3,
    source: u32,
    t: f32,
    is_blocked: u32,
    faults: u32,
    padding: u32,
}

fn leave(scene: &Scene, rays: &[(Vec3, Vec3, Vec3)]) -> Vec<Output> {
    let input = |&(o, d, leaving): &(Vec3, Vec3, Vec3)| [o, d, leaving].map(|v| v.extend(0.0));
    let inputs: Vec<Input> = rays.iter().map(input).collect();
    let settings = settings(1, 1, 1);
    let outputs: Vec<Output> =
        Call::new(harness!("leave"), &[]).on(scene, &settings).run(&inputs, 1);
    assert!(outputs.iter().all(|o| o.faults == 0));
    outputs
}

#[test]
fn b8_the_hit_point_lies_in_the_triangle() {
    const RAYS: usize = 1 << 20;
    let mut random = Random(80);
    let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0);
    let positions: Vec<Vec3> = (0..300).map(|_| random.in_cube()).collect();
    let triangles: Vec<[u32; 3]> = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let corners = |source: u32| triangles[source as usize].map(|v| positions[v as usize]);
    let rays: Vec<_> = (0..RAYS)
        .map(|i| {
            let [a, b, c] = corners(i as u32 % 100);
            let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
            let o = 1e5 * random.direction();
            let d = (a + u * (b - a) + v * (c - a) - o).normalize();
            (o, d, d)
        })
        .collect();
    let mesh =
        Mesh { positions: positions.clone(), triangles: triangles.clone(), ..Mesh::default() };
    let mesh = stage.mesh(mesh, lambert(0.5));
    stage.place(mesh, Affine3A::IDENTITY);
    let outputs = leave(&stage.scene, &rays);

    // In units in the last place of the largest coordinate.
    let distance = |p: DVec3, v: [Vec3; 3]| {
        let [a, b, c] = v.map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        let size = v.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
        (p - a).dot(normal).abs() / f64::from(size.next_up() - size)
    };
    let (mut hits, mut worst, mut naive) = (0, 0.0f64, 0.0f64);
    for ((o, d, _), out) in rays.iter().zip(&outputs).filter(|(_, o)| o.source != u32::MAX) {
        hits += 1;
        let v = corners(out.source);
        worst = worst.max(distance(out.position.as_dvec3(), v));
        naive = naive.max(distance((*o + out.t * *d).as_dvec3(), v));
    }
    assert_at_most("B8", "ulp from the plane, worst of 1e6 hits from 1e5 away", worst, 8.0);
    assert_naive_fails("B8", "o + t d, ulp from the plane, worst of 1e6", naive, 1e3);
    assert_at_least("B8", "hits of 1048576 rays", f64::from(hits), 8e5);
}

/// Nothing but flat quads across an axis, far along it: whatever blocks a ray that leaves one is
/// the quad itself.
#[test]
fn b10_flat_quads_far_away_do_not_block_themselves() {
    const RAYS: usize = 1 << 18;
    let mut random = Random(100);
    for offset in [1e3, 1e5] {
        let (mut blocked, mut hits) = (0, 0);
        for axis in 0..3 {
            let turn = |v: Vec3| Vec3::new(v[axis], v[(axis + 1) % 3], v[(axis + 2) % 3]);
            let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0);
            let center = turn(Vec3::new(0.7, -0.3, 1.0) * offset);
            let quad = quad_mesh(center, turn(Vec3::X * 3.0), turn(Vec3::Y * 3.0));
            let mesh = stage.mesh(quad, lambert(0.5));
            stage.place(mesh, Affine3A::IDENTITY);
            let rays: Vec<_> = (0..RAYS)
                .map(|_| {
                    let target = center + turn(random.in_cube() * Vec3::new(2.9, 2.9, 0.0));
                    let o = target + turn(random.direction()) * 5.0;
                    (o, target - o, random.direction())
                })
                .collect();
            for out in leave(&stage.scene, &rays) {
                hits += u32::from(out.source != u32::MAX);
                blocked += out.is_blocked;
            }
        }
        let what = format!("self-hits of 786432 rays from flat quads at {offset:e}");
        assert_at_most("B10", &what, f64::from(blocked), 0.0);
        assert_at_least("B10", "hits of 786432 rays", f64::from(hits), 7e5);
    }
}
