//! D6: the point of a hit lies on the sphere.

use super::{Exact, PRODUCT};
use crate::common::{Random, Stage, assert_at_most, assert_naive_fails, lambert};
use crate::probe::{Probe, probe_primitives};
use glam::Vec3;
use steradian::bvh::SpawnPoint;
use steradian::scene::Scene;

/// Spheres of a scene, and rays at each.
const SPHERES: usize = 256;
const RAYS: usize = 128;

/// Spheres whose radius is about `radius` and whose centre is about `distance` from the origin.
fn spheres(radius: f32, distance: f32) -> Scene {
    let mut random = Random(16);
    // A camera beside a sphere would make that a floor, in the anchored form.
    let mut stage = Stage::perspective(10.0 * (radius + distance) * Vec3::Z, Vec3::ZERO, 1.0);
    for _ in 0..SPHERES {
        let center = distance * (0.5 + random.unit()) * random.direction();
        stage.sphere(center, radius * (0.5 + random.unit()), lambert(0.5));
    }
    stage.scene
}

/// Rays from inside, from near and from far.
fn rays(scene: &Scene) -> Vec<(usize, Vec3, Vec3)> {
    let mut random = Random(17);
    let mut rays = Vec::new();
    for (i, s) in scene.spheres.iter().enumerate() {
        for k in 0..RAYS {
            let away = [0.5, 2.0, 30.0, 1000.0][k % 4] * s.radius;
            let o = s.center + away * random.direction();
            let target = s.center + 0.9 * s.radius * random.direction();
            rays.push((i, o, (target - o).normalize()));
        }
    }
    rays
}

/// Distance of a point from the sphere in units of 2^-23 of the larger of its radius and its
/// centre's distance, in which offsets are measured too: one to two units in the last place.
fn residual(scene: &Scene, sphere: usize, p: Vec3) -> f64 {
    let s = &scene.spheres[sphere];
    let size = s.center.length().max(s.radius);
    let distance = (p.as_dvec3() - s.center.as_dvec3()).length() - f64::from(s.radius);
    distance.abs() / f64::from(f32::EPSILON * size)
}

#[test]
fn d6_surface_points_lie_on_their_sphere() {
    for (radius, distance, naive) in [
        (1.0, 1e-3, 1000.0),
        (1.0, 1.0, 1000.0),
        (1.0, 1e3, 2.5),
        (1e-4, 1e-4, 1000.0),
        (1e4, 1e5, 50.0),
    ] {
        let scene = spheres(radius, distance);
        let rays = rays(&scene);
        let with = |form: &str| {
            format!(
                "2^-23 of the size off the sphere of 32768 points, R = {radius:e}, |C| = {distance:e}, {form}"
            )
        };
        let host = |fused: bool, reprojected: bool| {
            let hit = PRODUCT[usize::from(fused)].1;
            let point = |&(i, o, d): &(usize, Vec3, Vec3)| {
                let (c, r) = (scene.spheres[i].center, scene.spheres[i].radius);
                let Some(t) = hit(o, d, c, r, f32::MAX) else { return 0.0 };
                let position = match (reprojected, fused) {
                    (false, _) => o + t * d,
                    (true, false) => SpawnPoint::on_sphere::<false>((o, d, t), c, r).position,
                    (true, true) => SpawnPoint::on_sphere::<true>((o, d, t), c, r).position,
                };
                residual(&scene, i, position)
            };
            rays.iter().map(point).fold(0.0, f64::max)
        };
        assert_at_most("D6", &with("plain"), host(false, true), 2.0);
        assert_at_most("D6", &with("fused"), host(true, true), 2.0);
        assert_naive_fails("D6", &with("o + t d"), host(false, false), naive);

        let probe = |&(i, o, d): &(usize, Vec3, Vec3)| Probe::new(o, d).of_primitives(i as u32, 1);
        let probes: Vec<_> = rays.iter().map(probe).collect();
        let (mut worst, mut hits, mut expected) = (0.0_f64, 0, 0);
        for (&(i, o, d), found) in rays.iter().zip(probe_primitives(&scene, &probes)) {
            let s = &scene.spheres[i];
            expected += usize::from(Exact::new(o, d, s.center, s.radius).first().is_some());
            if found.t().is_some() {
                hits += 1;
                worst = worst.max(residual(&scene, i, found.position));
            }
        }
        assert!(hits * 1000 > expected * 999 && hits > rays.len() / 2, "{hits} of {expected}");
        assert_at_most("D6", &with("device"), worst, 2.0);
    }
}
