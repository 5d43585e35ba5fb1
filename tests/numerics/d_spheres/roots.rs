//! D3 to D5: tangency, origins inside, and which root is taken.

use super::{ANCHORED, Exact, PRODUCT, Query, device_hits};
use crate::common::{Random, Stage, assert_at_most, lambert, report};
use crate::probe::{Probe, probe_tree};
use glam::Vec3;
use steradian::bvh::{AnchoredSphere, SpawnPoint};

const NO_ANCHOR: AnchoredSphere =
    AnchoredSphere { point: Vec3::ZERO, normal: Vec3::Y, curvature: 1.0 };

/// Hits of all arithmetics on the same query.
fn all_hits(queries: &[Query]) -> Vec<[Option<f32>; 3]> {
    let device = device_hits(queries);
    let hosts = |q: &Query| PRODUCT.map(|(_, hit)| hit(q.o, q.d, q.center, q.radius, f32::MAX));
    queries.iter().zip(device).map(|(q, [t, _])| [hosts(q)[0], hosts(q)[1], t]).collect()
}

/// Lines at r (1 ± 10^-k) from the centre of a unit sphere, from 10 away.
#[test]
fn d3_rays_along_the_outline_are_classified() {
    let mut random = Random(13);
    let mut queries = Vec::new();
    let mut exponents = Vec::new();
    for k in 1..=7 {
        for i in 0..4096 {
            let sign = if i % 2 == 0 { -1.0 } else { 1.0 };
            let impact = 1.0 + sign * 10f64.powi(-k);
            let d = random.direction();
            let side = d.any_orthonormal_vector().as_dvec3();
            // Along d from a point 10 before the nearest one.
            let o = (impact * side - 10.0 * d.as_dvec3()).as_vec3();
            queries.push(Query { o, d, center: Vec3::ZERO, radius: 1.0, anchored: NO_ANCHOR });
            exponents.push(k);
        }
    }
    let (mut wrong, mut not_a_number, mut facing_away) = (0.0, 0.0, f64::NEG_INFINITY);
    let mut hits = 0;
    for ((q, k), found) in queries.iter().zip(&exponents).zip(all_hits(&queries)) {
        let exact = Exact::new(q.o, q.d, q.center, q.radius);
        let is_decided = (exact.impact - 1.0).abs() > 0.5e-5;
        for t in found {
            if *k <= 5 && is_decided && t.is_some() != (exact.impact < 1.0) {
                wrong += 1.0;
            }
            let Some(t) = t else { continue };
            hits += 1;
            let point = SpawnPoint::on_sphere::<false>((q.o, q.d, t), q.center, q.radius);
            if !(t.is_finite() && point.normal.is_finite()) {
                not_a_number += 1.0;
            }
            facing_away = f64::max(facing_away, f64::from(point.normal.dot(q.d)));
        }
    }
    assert!(hits > 30_000, "{hits}");
    assert_at_most("D3", "wrong classes of 61440 at 1 ± 1e-1..1e-5", wrong, 0.0);
    assert_at_most("D3", "hits that are not finite at 1 ± 1e-1..1e-7", not_a_number, 0.0);
    assert_at_most("D3", "greatest cosine of normal and ray", facing_away, 1e-3);
}

/// 1e6 origins in all within spheres of three sizes.
#[test]
fn d4_from_inside_there_is_one_hit() {
    for radius in [1e-3_f32, 1.0, 1e3] {
        let mut random = Random(14);
        let query = |_| loop {
            let o = radius * random.in_cube();
            if o.length() < radius * 0.9 {
                let d = random.direction();
                break Query { o, d, center: Vec3::ZERO, radius, anchored: NO_ANCHOR };
            }
        };
        let queries: Vec<_> = (0..333_376).map(query).collect();
        let (mut lost, mut error, mut near_error) = (0.0, 0.0_f64, 0.0_f64);
        for (q, found) in queries.iter().zip(all_hits(&queries)) {
            let exact = Exact::new(q.o, q.d, q.center, q.radius).roots[1];
            for t in found {
                let Some(t) = t else {
                    lost += 1.0;
                    continue;
                };
                let difference = (f64::from(t) - exact).abs();
                error = error.max(difference / exact.max(f64::from(radius)));
                near_error = near_error.max(difference / exact);
            }
        }
        let with = |what: &str| format!("{what}, 333376 origins in R = {radius:e}, x3");
        assert_at_most("D4", &with("rays without a hit"), lost, 0.0);
        assert_at_most("D4", &with("error of t over max(t, R)"), error, 1e-6);
        report("D4", &with("error of t over t, of 0.1 R and more"), near_error);
    }
}

#[test]
fn d4_from_the_centre_the_distance_is_the_radius() {
    let mut random = Random(15);
    let mut queries = Vec::new();
    for radius in [1e-3_f32, 1.0, 1e3] {
        for center in [Vec3::ZERO, Vec3::new(3.0, -7.0, 0.1)] {
            let d = |_| random.direction();
            let directions: Vec<_> = (0..1024).map(d).collect();
            let query = |d| Query { o: center, d, center, radius, anchored: NO_ANCHOR };
            queries.extend(directions.into_iter().map(query));
        }
    }
    let mut worst = 0.0_f64;
    for (q, found) in queries.iter().zip(all_hits(&queries)) {
        for t in found {
            let t = f64::from(t.expect("a hit from the centre")) * q.d.as_dvec3().length();
            let ulp = q.radius.next_up() - q.radius;
            worst = worst.max((t - f64::from(q.radius)).abs() / f64::from(ulp));
        }
    }
    assert_at_most("D4", "distance from the centre less the radius, ulp of 6144 x3", worst, 2.0);
}

/// A unit sphere around z = 2 with the roots at 1 and 3 from the origin: the start, the end of
/// the interval, and the root.
const CASES: [(f32, f32, Option<f32>); 9] = [
    (0.0, 9.0, Some(1.0)),
    (0.0, 2.0, Some(1.0)),
    (0.0, 1.0, None),
    (0.0, 0.5, None),
    (2.0, 9.0, Some(1.0)),
    (2.0, 0.5, None),
    (4.0, 9.0, None),
    (1.0, 9.0, Some(2.0)),
    (3.0, 9.0, None),
];

#[test]
fn d5_the_nearest_root_in_the_interval_is_taken() {
    let center = 2.0 * Vec3::Z;
    let anchor = AnchoredSphere { point: Vec3::Z, normal: -Vec3::Z, curvature: 1.0 };
    let mut stage = Stage::perspective(Vec3::ZERO, center, 1.0);
    stage.sphere(center, 1.0, lambert(0.5));
    let probe = |(z, t_max, _): (f32, f32, _)| Probe { t_max, ..Probe::new(z * Vec3::Z, Vec3::Z) };
    let found = probe_tree(&stage.scene, &CASES.map(probe));
    let mut wrong = 0.0;
    for ((z, t_max, expected), found) in CASES.into_iter().zip(found) {
        let o = z * Vec3::Z;
        let mut results = vec![found.t()];
        results.extend(PRODUCT.map(|(_, hit)| hit(o, Vec3::Z, center, 1.0, t_max)));
        results.extend(ANCHORED.map(|(_, hit)| hit(o, Vec3::Z, anchor, t_max)));
        wrong += results.iter().filter(|&&t| t != expected).count() as f64;
    }
    assert_at_most("D5", "wrong roots of 9 positions, x5 forms", wrong, 0.0);
}
