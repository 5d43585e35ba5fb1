//! D1: a floor that is a vast sphere with its top at the origin, seen from 1.7 above.

use super::{ANCHORED, PRODUCT, Query, device_hits, gems_hit, naive_hit};
use crate::common::{
    Estimate, Random, Stage, assert_at_most, assert_naive_fails, grey, lambert, quad_mesh, render,
    report, settings,
};
use crate::probe::{Probe, probe_tree};
use glam::{Affine3A, DVec3, Vec3};
use steradian::bvh::AnchoredSphere;
use steradian::scene::{LightKind, Material};

const RADII: [f32; 5] = [1e2, 1e4, 1e5, 1e6, 1e7];
const EYE: Vec3 = Vec3::new(0.0, 1.7, 0.0);
/// Bar: metres.
const LARGEST_ERROR: f64 = 2e-6;

/// Directions 1 to 80 degrees below the horizontal.
fn directions() -> Vec<Vec3> {
    let mut random = Random(11);
    let direction = |_| {
        let (angle, turn) = ((1.0 + 79.0 * random.unit()).to_radians(), random.unit());
        let turn = std::f32::consts::TAU * turn;
        Vec3::new(angle.cos() * turn.cos(), -angle.sin(), angle.cos() * turn.sin())
    };
    (0..1 << 15).map(direction).collect()
}

/// Height of a point over the floor of this radius.
fn height(p: DVec3, radius: f64) -> f64 {
    let side = p.x * p.x + p.z * p.z;
    p.y + side / (radius + (radius * radius - side).sqrt())
}

fn at(d: Vec3, t: f32) -> DVec3 {
    EYE.as_dvec3() + f64::from(t) * d.as_dvec3()
}

/// Whether the ray passes over the horizon, or so near to it that either class is right.
fn may_miss(d: Vec3, radius: f32) -> bool {
    let r = f64::from(radius);
    let horizon = (r / (r + f64::from(EYE.y))).acos();
    f64::from(-d.y).asin() < 1.001 * horizon
}

/// The largest height error of hits; no hit where one must be counts as infinite.
fn worst_height(radius: f32, hit: impl Fn(Vec3) -> Option<f32>) -> f64 {
    let error = |&d: &Vec3| match hit(d) {
        Some(t) => height(at(d, t), f64::from(radius)).abs(),
        None if may_miss(d, radius) => 0.0,
        None => f64::INFINITY,
    };
    directions().iter().map(error).fold(0.0, f64::max)
}

/// The floor in the anchored form: the curvature is rounded, so its radius is not quite `radius`.
fn anchored(radius: f32) -> AnchoredSphere {
    AnchoredSphere { point: Vec3::ZERO, normal: Vec3::Y, curvature: 1.0 / radius }
}

#[test]
fn d1_the_floor_is_level_for_any_radius() {
    for radius in RADII {
        for (name, test) in ANCHORED {
            let worst = worst_height(radius, |d| test(EYE, d, anchored(radius), f32::MAX));
            let what = format!("height error in m of 32768 hits, R = {radius:e}, anchored, {name}");
            assert_at_most("D1", &what, worst, LARGEST_ERROR);
        }
        let center = Vec3::Y * -radius;
        let (o, anchored) = (EYE, anchored(radius));
        let queries = directions().into_iter().map(|d| Query { o, d, center, radius, anchored });
        let queries: Vec<_> = queries.collect();
        let hits = device_hits(&queries);
        let found = queries.iter().zip(&hits).map(|(q, [_, t])| (q.d, *t));
        let error = |(d, t): (Vec3, Option<f32>)| match t {
            Some(t) => height(at(d, t), f64::from(radius)).abs(),
            None if may_miss(d, radius) => 0.0,
            None => f64::INFINITY,
        };
        let what = format!("height error in m of 32768 hits, R = {radius:e}, anchored, device");
        assert_at_most("D1", &what, found.map(error).fold(0.0, f64::max), LARGEST_ERROR);
    }
}

#[test]
fn d1_forms_by_centre_and_radius_are_not_level() {
    for (radius, naive_bound, gems_bound) in [
        (1e2, 4e-6, 4e-6),
        (1e4, 4e-4, 4e-4),
        (1e5, 4e-3, 4e-3),
        (1e6, 2e-2, 2e-3),
        (1e7, 0.2, 0.2),
    ] {
        let center = Vec3::Y * -radius;
        let naive = worst_height(radius, |d| naive_hit(EYE, d, center, radius, f32::MAX));
        let what = format!("height error in m of 32768 hits, R = {radius:e}, quadratic");
        assert_naive_fails("D1", &what, naive, naive_bound);
        let gems = worst_height(radius, |d| gems_hit(EYE, d, center, radius, f32::MAX));
        let what = format!("height error in m of 32768 hits, R = {radius:e}, Ray Tracing Gems 7");
        assert_naive_fails("D1", &what, gems, gems_bound);
        let (_, plain) = PRODUCT[0];
        let own = worst_height(radius, |d| plain(EYE, d, center, radius, f32::MAX));
        let what = format!("height error in m of 32768 hits, R = {radius:e}, not anchored");
        report("D1", &what, own);
    }
}

/// The whole way: the loader's choice of the form, the tree, the hit, the surface point.
#[test]
fn d1_surface_points_of_a_floor_are_level() {
    for radius in RADII {
        let mut stage = Stage::perspective(EYE, Vec3::ZERO, 1.0);
        stage.sphere(Vec3::Y * -radius, radius, lambert(0.5));
        let directions = directions();
        let probes: Vec<_> = directions.iter().map(|&d| Probe::new(EYE, d)).collect();
        let found = probe_tree(&stage.scene, &probes);
        let mut worst = 0.0_f64;
        for (d, f) in directions.iter().zip(&found) {
            let error = match f.t() {
                Some(_) => height(f.position.as_dvec3(), f64::from(radius)).abs(),
                None if may_miss(*d, radius) => 0.0,
                None => f64::INFINITY,
            };
            worst = worst.max(error);
        }
        let what = format!("height error in m of 32768 surface points, R = {radius:e}, device");
        assert_at_most("D1", &what, worst, LARGEST_ERROR);
    }
}

/// A board stands on the floor under a distant light. With the same random numbers, the
/// shadow on a sphere of 1e7 m is the one on a plane.
#[test]
fn d1_a_contact_shadow_is_that_on_a_plane() {
    let picture = |is_sphere: bool| {
        let mut stage = Stage::perspective(EYE, Vec3::new(4.0, 0.0, 0.0), 0.3);
        if is_sphere {
            stage.sphere(Vec3::Y * -1e7, 1e7, lambert(0.5));
        } else {
            // As small as the view allows: rays leave it by units of its largest coordinate.
            let plane = quad_mesh(Vec3::X * 4.0, Vec3::Z * 6.0, Vec3::X * 6.0);
            let plane = stage.mesh(plane, lambert(0.5));
            stage.place(plane, Affine3A::IDENTITY);
        }
        let center = Vec3::new(4.2, 0.25, 0.0);
        let wall = Material { double_sided: true, ..lambert(0.0) };
        stage.quad(center, Vec3::Y * 0.25, Vec3::Z * 0.3, wall);
        let direction = Vec3::new(-1.0, -1.0, 0.3).normalize();
        stage.light(LightKind::Directional { direction }, 1.0);
        grey(&render(&stage.scene, &settings(48, 48, 256)))
    };
    let (sphere, plane) = (picture(true), picture(false));
    let lit = plane.iter().copied().fold(0.0, f64::max);
    assert!(plane.iter().filter(|&&x| x < 0.5 * lit).count() > 200, "no shadow in the picture");
    let differences: Vec<f64> = sphere.iter().zip(&plane).map(|(a, b)| (a - b) / lit).collect();
    let d = Estimate::of(&differences);
    let what = "standard error of the picture's difference from a plane's, of the lit radiance";
    assert_at_most("D1", what, d.standard_error, 2.5e-5);
    let what = "mean difference from a plane's picture, R = 1e7, of the lit radiance";
    assert_at_most("D1", what, d.mean.abs(), 3.0 * d.standard_error + 1e-6);
}
