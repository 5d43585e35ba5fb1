//! The two forms of a sphere against f64, and a plane. Hard cases are in tests/numerics.

use super::*;
use crate::bvh::random::Random;

const EPSILON: f64 = 1.0 / 16_777_216.0;

/// Roots in f64 of the exact f32 inputs, in order; `None` if the line misses.
fn roots(o: Vec3, d: Vec3, center: Vec3, radius: f32) -> Option<[f64; 2]> {
    let (f, d) = (o.as_dvec3() - center.as_dvec3(), d.as_dvec3());
    let (a, b) = (d.dot(d), -f.dot(d));
    let off = f + b / a * d;
    let discriminant = f64::from(radius).powi(2) - off.dot(off);
    (discriminant >= 0.0).then(|| {
        let root = (a * discriminant).sqrt();
        [(b - root) / a, (b + root) / a]
    })
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = random.in_cube();
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

#[test]
fn an_anchored_plane_is_hit_from_both_sides() {
    let hit = |y: f32, dy: f32| {
        let (o, d) = (Vec3::new(3.0, y, 1.0), Vec3::new(0.5, dy, 0.0));
        let plane = AnchoredSphere { point: Vec3::ZERO, normal: Vec3::Y, curvature: 0.0 };
        assert_eq!(
            sphere_hit_anchored::<false>(o, d, plane, f32::MAX),
            sphere_hit_anchored::<true>(o, d, plane, f32::MAX)
        );
        sphere_hit_anchored::<false>(o, d, plane, f32::MAX)
    };
    assert_eq!(hit(2.0, -1.0), Some(2.0));
    assert_eq!(hit(-2.0, 1.0), Some(2.0));
    assert_eq!(hit(2.0, 1.0), None);
    assert_eq!(hit(2.0, 0.0), None);
}

#[test]
fn both_forms_agree_with_double_precision() {
    let mut random = Random::new(2);
    let mut hits = 0;
    for _ in 0..200_000 {
        let center = random.in_cube();
        let radius = 0.1 + random.unit();
        let o = 2.0 * random.in_cube();
        let d = (1.0 + random.unit()) * (center + random.in_cube() - o).normalize();
        let normal = direction(&mut random);
        let point = center + radius * normal;
        let anchored = AnchoredSphere { point, normal, curvature: 1.0 / radius };
        let Some([near, far]) = roots(o, d, center, radius) else { continue };
        let distance = (far - near) * f64::from(d.length());
        let beyond = [near, far].into_iter().any(|t| t.abs() < 1e-3);
        if distance < 0.2 * f64::from(radius) || beyond {
            continue;
        }
        let expected = [near, far].into_iter().find(|&t| t > 0.0);
        for found in [
            sphere_hit::<false>(o, d, center, radius, f32::MAX),
            sphere_hit::<true>(o, d, center, radius, f32::MAX),
            sphere_hit_anchored::<false>(o, d, anchored, f32::MAX),
            sphere_hit_anchored::<true>(o, d, anchored, f32::MAX),
        ] {
            match (expected, found) {
                (Some(e), Some(f)) => {
                    // Coefficients err by units of the squared distance (at most 8 of them
                    // squared); the root by that over the half chord.
                    let bound = 20.0 * EPSILON * 64.0 / (0.1 * f64::from(radius));
                    assert!((e - f64::from(f)).abs() < bound, "{e} {f}");
                    hits += 1;
                }
                (e, f) => assert!(e.is_none() && f.is_none(), "{e:?} {f:?}"),
            }
        }
    }
    assert!(hits > 20_000, "{hits}");
}
