//! Huge, tiny, distant and touched spheres, against f64.

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

/// The floor of a scene as a sphere with its top at the origin, seen from 1.7 above.
/// The hit must be as near to it as rounding the point itself allows.
#[test]
fn an_anchored_floor_is_exact_for_any_radius() {
    let o = Vec3::new(0.0, 1.7, 0.0);
    for radius in [1e2, 1e4, 1e5, 1e6, 1e7] {
        let mut random = Random::new(1);
        for _ in 0..20_000 {
            let angle = (1.0 + 79.0 * random.unit()).to_radians();
            let turn = std::f32::consts::TAU * random.unit();
            let d = Vec3::new(angle.cos() * turn.cos(), -angle.sin(), angle.cos() * turn.sin());
            let k = 1.0 / radius;
            let Some(t) = sphere_hit_anchored(o, d, Vec3::ZERO, Vec3::Y, k, f32::MAX) else {
                // A ray this flat passes over the horizon.
                let horizon = (f64::from(radius) / (f64::from(radius) + 1.7)).acos();
                assert!(f64::from(angle) < 1.001 * horizon, "radius {radius}: {angle}");
                continue;
            };
            let p = o.as_dvec3() + f64::from(t) * d.as_dvec3();
            let side = p.x * p.x + p.z * p.z;
            let r = 1.0 / f64::from(k);
            let height = p.y + side / (r + (r * r - side).sqrt());
            assert!(height.abs() < 2e-6, "radius {radius}: {height}");
        }
    }
}

#[test]
fn an_anchored_plane_is_hit_from_both_sides() {
    let hit = |y: f32, dy: f32| {
        let (o, d) = (Vec3::new(3.0, y, 1.0), Vec3::new(0.5, dy, 0.0));
        sphere_hit_anchored(o, d, Vec3::ZERO, Vec3::Y, 0.0, f32::MAX)
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
        let (anchor, k) = (center + radius * normal, 1.0 / radius);
        let Some([near, far]) = roots(o, d, center, radius) else { continue };
        let distance = (far - near) * f64::from(d.length());
        let beyond = [near, far].into_iter().any(|t| t.abs() < 1e-3);
        if distance < 0.2 * f64::from(radius) || beyond {
            continue;
        }
        let expected = [near, far].into_iter().find(|&t| t > 0.0);
        for found in [
            sphere_hit(o, d, center, radius, f32::MAX),
            sphere_hit_anchored(o, d, anchor, normal, k, f32::MAX),
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

/// On a unit sphere at a distance D, t errs by the rounding of `c / q` (under 8 units of
/// 2^-24 of D) and of the ray's distance from the centre (one of D, times the slope of
/// the surface). No hit is lost or invented beyond 1 % of the outline.
#[test]
fn distant_spheres_are_neither_lost_nor_invented() {
    for distance in [1e1, 1e2, 1e3, 1e4, 1e5] {
        let mut random = Random::new(3);
        for i in 0..50_000 {
            let o = -distance * direction(&mut random);
            let side = o.any_orthogonal_vector().normalize();
            let is_inside = i % 2 == 0;
            let unit = random.unit();
            let offset = if is_inside { 0.99 * unit } else { 1.01 + 0.19 * unit };
            let d = (offset * side - o).normalize();
            let hit = sphere_hit(o, d, Vec3::ZERO, 1.0, f32::MAX);
            assert_eq!(hit.is_some(), is_inside, "distance {distance}, offset {offset}");
            if let (Some(t), Some([near, far])) = (hit, roots(o, d, Vec3::ZERO, 1.0)) {
                let half_chord = 0.5 * (far - near);
                let error = (f64::from(t) - near).abs();
                let bound = EPSILON * f64::from(distance) * (8.0 + 2.0 / half_chord);
                assert!(error < bound, "distance {distance}, offset {offset}: {error}");
            }
        }
    }
}

#[test]
fn rays_along_the_outline_are_classified() {
    let mut hits = 0;
    for k in 1..=7 {
        for sign in [-1.0f64, 1.0] {
            let offset = (1.0 + sign * 10f64.powi(-k)) as f32;
            let hit = sphere_hit(Vec3::new(offset, 0.0, -10.0), Vec3::Z, Vec3::ZERO, 1.0, 1e9);
            if k <= 5 {
                assert_eq!(hit.is_some(), sign < 0.0, "{offset}");
            }
            if let Some(t) = hit {
                hits += 1;
                let z = -10.0 + t;
                let half_chord = (1.0 - offset * offset).max(0.0).sqrt();
                assert!((z + half_chord).abs() < 1e-3, "{offset}: {z}");
            }
        }
    }
    assert!(hits >= 5);
}

#[test]
fn from_inside_there_is_one_hit() {
    let mut random = Random::new(4);
    for radius in [1e-3, 1.0, 1e3] {
        for _ in 0..100_000 {
            let center = radius * random.in_cube();
            let o = center + 0.99 * radius * random.unit() * direction(&mut random);
            let d = direction(&mut random);
            let t = sphere_hit(o, d, center, radius, f32::MAX).expect("inside");
            let [near, far] = roots(o, d, center, radius).expect("inside");
            assert!(near < 0.0);
            // Of the diameter: as t goes to 0 only that is a meaningful scale.
            let error = (f64::from(t) - far).abs() / f64::from(2.0 * radius);
            assert!(error < 16.0 * EPSILON, "radius {radius}: {t} {far}");
        }
        let d = direction(&mut random);
        let t = sphere_hit(Vec3::ONE, d, Vec3::ONE, radius, f32::MAX).expect("centre");
        let exact = radius / d.length();
        assert!((t - exact).abs() <= 2.0 * (exact.next_up() - exact), "{t} {exact}");
    }
}

/// All positions of the two roots 1 and 3 about the interval, for a sphere
/// of radius 1 around z = 2.
#[test]
fn the_nearest_root_in_the_interval_is_chosen() {
    let at = |z: f32, t_max: f32| {
        let sphere = sphere_hit(Vec3::new(0.0, 0.0, z), Vec3::Z, 2.0 * Vec3::Z, 1.0, t_max);
        let anchored =
            sphere_hit_anchored(Vec3::new(0.0, 0.0, z), Vec3::Z, Vec3::Z, -Vec3::Z, 1.0, t_max);
        assert_eq!(sphere, anchored);
        sphere
    };
    assert_eq!(at(0.0, 9.0), Some(1.0), "both inside: the first");
    assert_eq!(at(0.0, 2.0), Some(1.0), "the second is beyond");
    assert_eq!(at(0.0, 1.0), None, "the end is not in the interval");
    assert_eq!(at(0.0, 0.5), None, "both are beyond");
    assert_eq!(at(2.0, 9.0), Some(1.0), "from inside: the second");
    assert_eq!(at(2.0, 0.5), None, "from inside, the second is beyond");
    assert_eq!(at(4.0, 9.0), None, "both are behind");
    assert_eq!(at(1.0, 9.0), Some(2.0), "on the surface: t = 0 is not a hit");
    assert_eq!(at(3.0, 9.0), None, "on the surface, leaving");
}
