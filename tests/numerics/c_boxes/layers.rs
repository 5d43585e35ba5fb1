//! Layers so close that the order of hits is a matter of rounding: C10, on the mirror.

use super::naive::{ExactTree, without_pad};
use crate::common::{
    Primitive, Random, World, assert_at_least, assert_at_most, assert_naive_fails,
};
use glam::Vec3;
use steradian::bvh::Ray;

const LAYERS: usize = 64;

/// Squares in parallel planes, each a few units in the last place above the one before, cut in
/// cells so that the tree is deep.
fn layers(tilt: f32) -> Vec<Primitive> {
    const CELLS: usize = 4;
    let mut triangles = Vec::new();
    for layer in 0..LAYERS {
        let height = 3.7 + layer as f32 * 4.0 * f32::EPSILON;
        let point = |i: usize, j: usize| {
            let (x, y) = (i as f32 * 0.3 - 0.5, j as f32 * 0.3 - 0.5);
            Vec3::new(x, y, height + tilt * (x - 0.7 * y))
        };
        for (i, j) in (0..CELLS * CELLS).map(|k| (k / CELLS, k % CELLS)) {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]].map(Primitive::Triangle));
        }
    }
    triangles
}

#[test]
fn c10_the_first_of_close_layers_is_found() {
    const RAYS: u32 = 4000;
    let mut random = Random(100);
    let mut naive = 0;
    for (name, tilt) in [("flat layers", 0.0), ("tilted layers", 0.1)] {
        for world in World::each(name, &layers(tilt)) {
            let exact = ExactTree::new(&world);
            let (mut hits, mut plain, mut fused) = (0, 0, 0);
            for _ in 0..RAYS {
                let target = Vec3::new(0.5 * random.unit(), 0.5 * random.unit(), 3.7);
                let distance = 10.0f32.powf(4.0 * random.unit() - 1.0);
                let o = target + distance * random.direction();
                let ray = Ray { o, d: target - o, t_max: f32::MAX };
                let expected = world.brute_force::<false>(&ray);
                hits += u32::from(expected.is_some());
                plain += u32::from(!world.is_right::<false>(&ray, expected));
                fused += u32::from(!world.is_right::<true>(&ray, world.brute_force::<true>(&ray)));
                naive += u32::from(exact.closest(&ray, without_pad) != expected);
            }
            let what = |how| format!("of 4000 rays, {}, first hits not found, {how}", world.name);
            assert_at_most("C10", &what("plain"), f64::from(plain), 0.0);
            assert_at_most("C10", &what("fused"), f64::from(fused), 0.0);
            assert_at_least("C10", "of them, hits", f64::from(hits), 3000.0);
        }
    }
    assert_naive_fails(
        "C10",
        "no pad, of 16000 rays, first hits not found",
        f64::from(naive),
        10.0,
    );
}
