//! D2: a unit sphere far away, or the same in any other unit.

use super::{Exact, PRODUCT, SphereTest, gems_hit, naive_hit};
use crate::common::{Random, Stage, assert_at_most, assert_naive_fails, lambert, report};
use crate::probe::{Probe, probe_tree};
use glam::{DVec3, Vec3};
use steradian::bvh::SpawnPoint;

/// What a set of rays finds: shares of rays, and the largest error of a normal's components.
#[derive(Default)]
struct Score {
    missed: f64,
    invented: f64,
    normal_error: f64,
}

/// Rays from a distance at the sphere around the origin, half of them inside 0.99 of the
/// outline and half outside 1.01 to 1.2.
fn rays(distance: f32) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(12);
    let ray = |i| {
        let o = -distance * random.direction();
        let side = o.any_orthogonal_vector().normalize().as_dvec3();
        let unit = f64::from(random.unit());
        let impact = if i % 2 == 0 { 0.99 * unit } else { 1.01 + 0.19 * unit };
        let toward = impact * side - o.as_dvec3();
        (o, toward.normalize().as_vec3())
    };
    (0..1 << 15).map(ray).collect()
}

/// `normals[i]` is what ray i found.
fn score(rays: &[(Vec3, Vec3)], normals: impl Iterator<Item = Option<Vec3>>) -> Score {
    let mut score = Score::default();
    let mut classes = [0.0, 0.0];
    for (&(o, d), normal) in rays.iter().zip(normals) {
        let exact = Exact::new(o, d, Vec3::ZERO, 1.0);
        // By the rounded ray: its rounding is no fault of the test.
        let (is_inside, is_outside) = (exact.impact < 0.99, exact.impact > 1.01);
        classes[0] += f64::from(u8::from(is_inside));
        classes[1] += f64::from(u8::from(is_outside));
        match normal {
            None if is_inside => score.missed += 1.0,
            Some(_) if is_outside => score.invented += 1.0,
            Some(n) if is_inside => {
                let error: DVec3 = n.as_dvec3() - exact.near_normal();
                score.normal_error = score.normal_error.max(error.length());
            }
            _ => {}
        }
    }
    score.missed /= classes[0];
    score.invented /= classes[1];
    score
}

fn score_of(test: SphereTest, rays: &[(Vec3, Vec3)]) -> Score {
    let normal = |&(o, d): &(Vec3, Vec3)| {
        test(o, d, Vec3::ZERO, 1.0, f32::MAX).map(|t| (o + t * d).normalize())
    };
    score(rays, rays.iter().map(normal))
}

#[test]
fn d2_distant_spheres_are_neither_lost_nor_invented() {
    for distance in [1e2_f32, 1e3, 1e4, 1e5] {
        let rays = rays(distance);
        let gems = score_of(gems_hit, &rays);
        let with = |what: &str, form: &str| format!("{what}, D/r = {distance:e}, {form}");
        report("D2", &with("normal error", "Ray Tracing Gems 7"), gems.normal_error);
        let judge = |form: &str, score: Score| {
            assert_at_most("D2", &with("share missed of 16384 rays", form), score.missed, 0.0);
            assert_at_most("D2", &with("share invented of 16384 rays", form), score.invented, 0.0);
            let bound = 2.0 * gems.normal_error;
            assert_at_most("D2", &with("normal error", form), score.normal_error, bound);
        };
        for (name, test) in PRODUCT {
            judge(name, score_of(test, &rays));
        }
        let fused = |&(o, d): &(Vec3, Vec3)| {
            let t = PRODUCT[1].1(o, d, Vec3::ZERO, 1.0, f32::MAX)?;
            Some(SpawnPoint::on_sphere::<true>((o, d, t), Vec3::ZERO, 1.0).normal)
        };
        judge("fused surface", score(&rays, rays.iter().map(fused)));
        // The whole way on the device: the tree, the hit, the surface.
        let mut stage = Stage::perspective(Vec3::Z * 3.0, Vec3::ZERO, 1.0);
        stage.sphere(Vec3::ZERO, 1.0, lambert(0.5));
        let probes: Vec<_> = rays.iter().map(|&(o, d)| Probe::new(o, d)).collect();
        let found = probe_tree(&stage.scene, &probes);
        judge("device", score(&rays, found.iter().map(|f| f.t().map(|_| f.ng))));
    }
}

#[test]
fn d2_the_quadratic_loses_and_invents() {
    for (distance, missed, invented, error) in
        [(1e2_f32, 0.0, 0.0, 1e-4), (1e3, 5e-3, 2e-2, 1e-2), (1e4, 0.2, 0.3, 0.3)]
    {
        let score = score_of(naive_hit, &rays(distance));
        let with = |what: &str| format!("{what}, D/r = {distance:e}, quadratic");
        assert_naive_fails("D2", &with("share missed"), score.missed, missed);
        assert_naive_fails("D2", &with("share invented"), score.invented, invented);
        assert_naive_fails("D2", &with("normal error"), score.normal_error, error);
    }
}
