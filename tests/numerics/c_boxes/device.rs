//! C1, C2, C9 and C10 on the device, and its box test against the mirror's.

use super::grid::{Kind, grid_cube};
use super::segments::large;
use crate::common::{Call, Random, assert_at_least, assert_at_most, harness, scene_of};
use crate::traced::{Query, Walk, trace};
use glam::{UVec4, Vec3, Vec4};
use steradian::bvh::{Bvh, BvhChild, GridRay, UPPER_PLANE_SHIFT};

/// Closest and any hit, over the trees, are what brute force finds, to the bit.
#[test]
fn c1_c2_rays_in_box_planes_lose_no_hit_on_the_device() {
    let triangles = grid_cube();
    let scene = scene_of(&triangles);
    let mut random = Random(110);
    let kinds = Kind::IN_PLANES.into_iter().chain([Kind::Edge]);
    let queries: Vec<Query> = kinds
        .flat_map(|kind| vec![kind; 1 << 12])
        .map(|kind| {
            let ray = kind.ray(&triangles, &mut random);
            Query::new(ray.o, ray.d)
        })
        .collect();
    let expected = trace(&scene, Walk::BruteForce, &queries);
    for walk in Walk::over_trees() {
        let answers = trace(&scene, walk, &queries);
        let differ = answers.iter().zip(&expected).filter(|(a, b)| a != b).count();
        let what = format!("of 6 x 4096 rays of all kinds, not as brute force, device, {walk:?}");
        assert_at_most("C1", &what, differ as f64, 0.0);
    }
    let hits = expected.iter().filter(|a| a.source().is_some()).count();
    assert_at_least("C1", "of them, hits", hits as f64, 1.5e4);
}

/// Half of the segments end at a hit, or a unit in the last place before or behind it.
#[test]
fn c9_shadow_rays_agree_with_closest_hits_on_the_device() {
    const SEGMENTS: usize = 1 << 19;
    let mut random = Random(910);
    let scene = scene_of(&large(30, 10, &mut random));
    let endless: Vec<Query> = (0..SEGMENTS)
        .map(|_| {
            let o = 1.5 * random.in_cube();
            Query { any_t_max: 1.0, ..Query::new(o, random.in_cube() - o) }
        })
        .collect();
    for walk in Walk::over_trees() {
        let first = trace(&scene, walk, &endless);
        let ends = |(i, t): (usize, f32)| match i % 3 {
            0 => t.next_down(),
            1 => t,
            _ => t.next_up(),
        };
        let to_hits: Vec<Query> = endless
            .iter()
            .zip(&first)
            .enumerate()
            .filter(|(_, (_, a))| a.source().is_some())
            .map(|(i, (q, a))| Query { any_t_max: ends((i, a.t)), ..*q })
            .collect();
        let mut disagreements = 0;
        let mut blocked = 0;
        let second = trace(&scene, walk, &to_hits);
        let all = endless.iter().zip(&first).chain(to_hits.iter().zip(&second));
        let mut segments = 0;
        for (query, answer) in all {
            segments += 1;
            blocked += u32::from(answer.is_blocked());
            disagreements += u32::from(answer.is_blocked() != (answer.t < query.any_t_max));
        }
        let what =
            format!("of {segments} segments, disagreements of any and closest, device, {walk:?}");
        assert_at_most("C9", &what, f64::from(disagreements), 0.0);
        assert_at_least("C9", "of them, blocked", f64::from(blocked), 1e5);
    }
}

/// The boxes that the device's walk enters are those that the mirror's does.
#[test]
fn c1_the_device_enters_the_boxes_that_the_mirror_does() {
    /// Units in the last place by which distances may differ where both divide: WGSL allows
    /// 2.5 for a quotient.
    const ULPS: f32 = 8.0 * f32::EPSILON;
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
    let outputs: Vec<[i32; 2]> = Call::new(harness!("slab"), &[]).run(&inputs, 1);
    let (mut entered, mut differ) = (0, 0);
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
        let ray = GridRay::new(&bvh, float(0).truncate(), float(1).truncate());
        let same = match ray.entry(&BvhChild { x, y, z, link }, float(1).w) {
            None => near > far,
            Some(t) => {
                entered += 1;
                near <= far && (f32::from_bits(near as u32) - t).abs() <= ULPS * t
            }
        };
        differ += u32::from(!same);
    }
    assert_at_most("C1", "of 65536 boxes, entered other than the mirror's", f64::from(differ), 0.0);
    assert_at_least("C1", "of them, entered", f64::from(entered), 1e3);
}
