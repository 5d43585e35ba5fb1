//! Distance and weights against f64.

use super::*;
use crate::bvh::random::Random;

/// Exact to about 2^-50 of the products: the three weights in f64.
fn weights(o: Vec3, d: Vec3, v: [Vec3; 3]) -> [f64; 3] {
    let [p0, p1, p2] = v.map(|v| (v - o).as_dvec3());
    let d = d.as_dvec3();
    [d.dot(p1.cross(p2)), d.dot(p2.cross(p0)), d.dot(p0.cross(p1))]
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
