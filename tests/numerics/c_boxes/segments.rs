//! Any hit against closest hit: C9, on the mirror.

use crate::common::{Primitive, Random, World, assert_at_least, assert_at_most};
use rayon::prelude::*;
use steradian::bvh::Ray;

/// Triangles and spheres of which segments between points of the cube from -1 to 1 meet some.
pub(super) fn large(triangles: usize, spheres: usize, random: &mut Random) -> Vec<Primitive> {
    let primitive = |i: usize| {
        let center = random.in_cube();
        if i >= triangles {
            Primitive::Sphere(center, 0.1 + 0.2 * random.unit())
        } else {
            Primitive::Triangle([0; 3].map(|_| center + 0.6 * random.in_cube()))
        }
    };
    (0..triangles + spheres).map(primitive).collect()
}

/// Of `count` segments, how many are blocked, and how often the two queries disagree. Half of the
/// segments end where a ray hits something, or one unit in the last place before or behind.
fn tally<const FUSED: bool>(count: u64) -> [u32; 2] {
    const CHUNK: u64 = 5000;
    let mut random = Random(900);
    let world = &World::each("mixture", &large(12, 4, &mut random))[0];
    let chunk = |chunk: u64| {
        let mut random = Random(Random(901 << 32 | chunk).bits());
        let (mut blocked, mut disagreements) = (0, 0);
        for i in 0..CHUNK {
            let o = 1.5 * random.in_cube();
            let ray = Ray { o, d: random.in_cube() - o, t_max: f32::MAX };
            let closest = world.closest::<FUSED>(&ray).map_or(f32::MAX, |h| h.t);
            let t_max = if i % 2 == 0 || closest == f32::MAX {
                1.0
            } else {
                [closest.next_down(), closest, closest.next_up()][(i / 2 % 3) as usize]
            };
            let is_blocked = world.is_blocked::<FUSED>(&Ray { t_max, ..ray });
            blocked += u32::from(is_blocked);
            disagreements += u32::from(is_blocked != (closest < t_max));
        }
        [blocked, disagreements]
    };
    let sum = |a: [u32; 2], b: [u32; 2]| [a[0] + b[0], a[1] + b[1]];
    (0..count / CHUNK).into_par_iter().map(chunk).reduce(|| [0; 2], sum)
}

#[test]
fn c9_shadow_rays_agree_with_closest_hits() {
    let [blocked, disagreements] = tally::<false>(10_000_000);
    let what = "of 1e7 segments, any hit against closest hit, disagreements, plain";
    assert_at_most("C9", what, f64::from(disagreements), 0.0);
    assert_at_least("C9", "of them, blocked", f64::from(blocked), 1e6);
    let [_, disagreements] = tally::<true>(1_000_000);
    let what = "of 1e6 segments, any hit against closest hit, disagreements, fused";
    assert_at_most("C9", what, f64::from(disagreements), 0.0);
}
