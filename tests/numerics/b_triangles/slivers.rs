//! Slivers of any size against f64: B7, on the mirror.

use super::naive::moller_trumbore;
use crate::common::{Random, assert_at_least, assert_at_most, assert_naive_fails};
use glam::Vec3;
use rayon::prelude::*;
use steradian::bvh::triangle_hit_as;

/// A sliver from a production scene that pbrt-v4's tests record as a wrong hit (triangle
/// tests, "BadCases"): its vertices are on one line.
#[test]
fn b7_the_published_sliver_is_missed() {
    let o = Vec3::new(-1_081.479_2, 99.999_954, 87.770_11);
    let d = Vec3::new(-32.107_3, -183.355_87, -144.607_64);
    let vertex = |y: f32| Vec3::new(-1_113.454_6, y, -56.243_19);
    let [a, b, c] = [-79.049_614, -87.092_27, -79.209_015].map(vertex);
    let hits = u32::from(triangle_hit_as::<false>(o, d, a, b, c, 0.9999).is_some())
        + u32::from(triangle_hit_as::<true>(o, d, a, b, c, 0.9999).is_some());
    assert_at_most("B7", "hits on the published sliver, plain and fused", f64::from(hits), 0.0);
}

struct Sliver {
    o: Vec3,
    d: Vec3,
    v: [Vec3; 3],
}

/// A triangle with edges of any length from 1e-8 to 1e8, as far from the origin as that, and a
/// ray at its neighbourhood; of four rays, one goes anywhere. Of a triangle that is far away for
/// its size, f32 tells no two vertices apart.
fn sliver(random: &mut Random) -> Sliver {
    let length = |random: &mut Random| 10.0f32.powf(16.0 * random.unit() - 8.0);
    let a = length(random) * random.in_cube();
    let b = a + length(random) * random.in_cube();
    let c = a + length(random) * random.in_cube();
    let o = length(random) * random.in_cube();
    let (u, v) = (1.4 * random.unit() - 0.2, 1.4 * random.unit() - 0.2);
    let d = a + u * (b - a) + v * (c - a) - o;
    let is_aimed = d != Vec3::ZERO && !random.bits().is_multiple_of(4);
    let d = if is_aimed { d / d.abs().max_element() } else { random.direction() };
    Sliver { o, d, v: [a, b, c] }
}

/// What f64 says.
pub(super) struct Truth {
    pub(super) is_hit: bool,
    /// Least distance of the line from an edge's line, in units in the last place of the largest
    /// coordinate relative to the origin; or of the hit from the origin, if that is less.
    margin: f64,
}

/// A weight is `d . (a x b)` with both ends relative to the origin; taken from one end and the
/// edge, it does not cancel where the edge is short.
pub(super) fn truth(o: Vec3, d: Vec3, v: [Vec3; 3]) -> Truth {
    let d = d.as_dvec3();
    let v = v.map(|v| v.as_dvec3());
    let p = v.map(|v| v - o.as_dvec3());
    let size = p.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let ulp = 2.0f64.powi(size.log2().floor() as i32 - 23);
    let edge = |i: usize| {
        let along = v[(i + 1) % 3] - v[i];
        let weight = d.dot(p[i].cross(along));
        (weight, weight.abs() / d.cross(along).length().max(f64::MIN_POSITIVE))
    };
    let edges = [edge(0), edge(1), edge(2)];
    let on_one_side = edges.iter().all(|e| e.0 > 0.0) || edges.iter().all(|e| e.0 < 0.0);
    let from_edges = edges.iter().map(|e| e.1).fold(f64::MAX, f64::min);
    let normal = (v[1] - v[0]).cross(v[2] - v[0]);
    let t = normal.dot(p[0]) / normal.dot(d);
    let from_origin = if on_one_side { (t * d).length() } else { f64::MAX };
    Truth { is_hit: on_one_side && t > 0.0, margin: from_edges.min(from_origin) / ulp }
}

struct Count {
    hits: u64,
    misses: u64,
    /// Greatest margin of a wrong decision.
    worst: f64,
}

fn judge(count: u64, is_hit: impl Fn(&Sliver) -> bool + Sync) -> Count {
    let chunk = |chunk: u64| {
        let mut random = Random(Random(70 << 32 | chunk).bits());
        let mut c = Count { hits: 0, misses: 0, worst: 0.0 };
        for _ in 0..1000 {
            let s = sliver(&mut random);
            let truth = truth(s.o, s.d, s.v);
            // Farther from every edge than the bar: the decision must be right.
            if truth.margin > 4.0 {
                c.hits += u64::from(truth.is_hit);
                c.misses += u64::from(!truth.is_hit);
            }
            if is_hit(&s) != truth.is_hit {
                c.worst = c.worst.max(truth.margin);
            }
        }
        c
    };
    let sum = |a: Count, b: Count| Count {
        hits: a.hits + b.hits,
        misses: a.misses + b.misses,
        worst: a.worst.max(b.worst),
    };
    let none = || Count { hits: 0, misses: 0, worst: 0.0 };
    (0..count / 1000).into_par_iter().map(chunk).reduce(none, sum)
}

#[test]
fn b7_slivers_agree_with_double_precision() {
    let product =
        |s: &Sliver| triangle_hit_as::<false>(s.o, s.d, s.v[0], s.v[1], s.v[2], f32::MAX).is_some();
    let fused =
        |s: &Sliver| triangle_hit_as::<true>(s.o, s.d, s.v[0], s.v[1], s.v[2], f32::MAX).is_some();
    let plain = judge(1_000_000, product);
    assert_at_most(
        "B7",
        "ulp from an edge, worst wrong decision of 1e6 slivers, plain",
        plain.worst,
        4.0,
    );
    let fused = judge(1_000_000, fused);
    assert_at_most(
        "B7",
        "ulp from an edge, worst wrong decision of 1e6 slivers, fused",
        fused.worst,
        4.0,
    );
    assert_at_least("B7", "slivers clearly hit", plain.hits as f64, 5e4);
    assert_at_least("B7", "slivers clearly missed", plain.misses as f64, 5e4);
    let naive = judge(100_000, |s| moller_trumbore::<false>(s.o, s.d, s.v, 1e-7));
    assert_naive_fails(
        "B7",
        "Möller-Trumbore cut 1e-7, ulp from an edge, worst of 1e5",
        naive.worst,
        1e3,
    );
}
