//! Parts of the reference against numbers computed in another way.

use super::environment::Sky;
use super::light::incident;
use super::random::Random;
use super::*;
use crate::scene::{Environment, Instance, LightKind, Mesh, PunctualLight, Sphere};
use glam::{Affine3A, DMat3, Mat3, Quat, Vec3};
use std::f64::consts::{PI, TAU};

fn direction(random: &mut Random) -> DVec3 {
    let z = 2.0 * random.uniform() - 1.0;
    let (radius, angle) = ((1.0 - z * z).sqrt(), TAU * random.uniform());
    DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
}

fn place(random: &mut Random) -> DVec3 {
    DVec3::new(random.uniform(), random.uniform(), random.uniform()) * 2.0 - 1.0
}

fn scene_of(meshes: Vec<Mesh>, instances: Vec<Instance>, spheres: Vec<Sphere>) -> Scene {
    let cameras = vec![crate::scene::Camera::framing((Vec3::ZERO, Vec3::ONE))];
    let materials = vec![crate::scene::Material::default()];
    Scene { meshes, instances, spheres, cameras, materials, ..Scene::default() }
}

/// A mesh of 60 random triangles, flat ones among them, placed twice, and 12 spheres, in
/// a cube of half side `size` around `center`.
fn soup(random: &mut Random, size: f32, center: Vec3) -> Scene {
    let mut positions: Vec<Vec3> = Vec::new();
    for _ in 0..60 {
        let corner = place(random);
        let corners = [0; 3].map(|_| corner + 0.8 * place(random));
        // Every fourth lies in a plane of constant height, where boxes have no thickness.
        let flatten = positions.len().is_multiple_of(12);
        positions.extend(corners.map(|c| if flatten { c.with_y(0.25) } else { c }.as_vec3()));
    }
    let triangles = (0..60).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    let scale = |v: Vec3| Affine3A::from_scale(v * size);
    let turn = Affine3A::from_quat(Quat::from_rotation_z(0.7));
    let moved = Affine3A::from_translation(center);
    let instances = [scale(Vec3::ONE), turn * scale(Vec3::new(-1.0, 0.5, 1.0))].map(|m| Instance {
        name: String::new(),
        mesh: 0,
        world_from_object: moved * m,
    });
    let sphere = |_| Sphere {
        name: String::new(),
        center: center + size * place(random).as_vec3(),
        radius: size * 0.1 * (0.5 + random.uniform() as f32),
        material: 0,
    };
    let spheres = (0..12).map(sphere).collect();
    scene_of(vec![mesh], instances.to_vec(), spheres)
}

#[test]
fn the_tree_finds_what_testing_everything_finds() {
    let mut random = Random::new(1, (0, 0), 0);
    let far = Vec3::new(1e5, -3e4, 2e4);
    for (size, center) in
        [(1.0_f32, Vec3::ZERO), (1e-5, Vec3::ZERO), (1e6, Vec3::ZERO), (50.0, far)]
    {
        let scene = soup(&mut random, size, center);
        let tree = Reference::new(&scene, &RenderSettings::default()).unwrap();
        let all = Reference::brute_force(&scene, &RenderSettings::default()).unwrap();
        let mut hits = 0;
        for k in 0..4000 {
            let origin = center.as_dvec3() + f64::from(size) * 1.5 * place(&mut random);
            let direction = match k % 4 {
                // Along an axis: no place where slabs are entered.
                0 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][k / 4 % 3],
                // In the plane of the flat triangles.
                1 => direction(&mut random).with_y(0.0).normalize(),
                _ => direction(&mut random),
            };
            let ray = Ray { origin, direction };
            let (a, b) = (tree.geometry.nearest(&ray, None), all.geometry.nearest(&ray, None));
            assert_eq!(a, b, "size {size}: {ray:?}");
            // And again from there, into the scene.
            let Some(hit) = a else { continue };
            hits += 1;
            let position = tree.geometry.position(&ray, &hit);
            let towards = self::direction(&mut random);
            let on = Ray { origin: position, direction: towards };
            let left = Some(hit.primitive);
            assert_eq!(tree.geometry.nearest(&on, left), all.geometry.nearest(&on, left));
        }
        assert!(hits > 1000, "{hits} of 4000 rays hit");
    }
}

/// Rays that are aimed at the inner edges of a fan of triangles around a point.
#[test]
fn no_ray_passes_between_triangles_that_share_an_edge() {
    let mut random = Random::new(2, (0, 0), 0);
    let spokes = 7;
    let rim = |k: u32| {
        let angle = TAU * f64::from(k) / f64::from(spokes);
        DVec3::new(angle.cos(), 0.3 * f64::from(k % 2), angle.sin()).as_vec3()
    };
    let positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain((0..spokes).map(rim)).collect();
    let triangles = (0..spokes).map(|k| [0, 1 + (k + 1) % spokes, 1 + k]).collect();
    let mesh = Mesh { positions: positions.clone(), triangles, ..Mesh::default() };
    let instance = Instance { name: String::new(), mesh: 0, world_from_object: Affine3A::IDENTITY };
    let scene = scene_of(vec![mesh], vec![instance], vec![]);
    let reference = Reference::new(&scene, &RenderSettings::default()).unwrap();
    for k in 0..100_000 {
        let spoke = positions[1 + k % spokes as usize].as_dvec3();
        let origin = DVec3::Y * 3.0 + place(&mut random);
        let ray = Ray { origin, direction: (spoke * random.uniform() - origin).normalize() };
        assert!(reference.intersect(&ray).is_some(), "{ray:?}");
    }
}

/// A tangent plane is farther from a vast sphere than this test allows only by curvature, x²/2R.
#[test]
fn a_vast_sphere_is_exact() {
    let radius = 1e6_f32;
    let sphere =
        Sphere { name: String::new(), center: Vec3::new(0.0, -radius, 0.0), radius, material: 0 };
    let scene = scene_of(vec![], vec![], vec![sphere]);
    let reference = Reference::new(&scene, &RenderSettings::default()).unwrap();
    for x in [0.0, 1e-3, 1.0, 30.0] {
        let ray = Ray { origin: DVec3::new(x, 2.0, 0.0), direction: DVec3::NEG_Y };
        let hit = reference.intersect(&ray).unwrap();
        let expected = 2.0 + x * x / (2.0 * f64::from(radius));
        assert!((hit.t - expected).abs() < 1e-9, "{x}: {}", hit.t);
        assert!((hit.ng.y - 1.0).abs() < 1e-9);
    }
}

/// The far root from the surface itself: a chord of 2 R cos.
#[test]
fn a_ray_crosses_the_sphere_on_which_it_begins() {
    let sphere = Sphere { name: String::new(), center: Vec3::ONE, radius: 0.25, material: 0 };
    let scene = scene_of(vec![], vec![], vec![sphere]);
    let geometry = Geometry::new(&scene, true);
    let mut random = Random::new(3, (0, 0), 0);
    for _ in 0..1000 {
        let (normal, wi) = (direction(&mut random), direction(&mut random));
        let ray = Ray { origin: DVec3::ONE + normal * 0.25, direction: wi };
        let chord = -0.5 * normal.dot(wi);
        match geometry.nearest(&ray, Some(0)) {
            Some(hit) => assert!((hit.t - chord).abs() < 1e-14 && chord > 0.0),
            None => assert!(chord <= 1e-15),
        }
    }
}

/// Midpoints over the hemisphere of `normal`, uniform in height and azimuth.
pub(super) fn hemisphere(mut value: impl FnMut(DVec3) -> DVec3, normal: DVec3) -> DVec3 {
    let (x, y) = normal.any_orthonormal_pair();
    let (rings, sectors) = (600, 600);
    let mut sum = DVec3::ZERO;
    for i in 0..rings {
        let z = (f64::from(i) + 0.5) / f64::from(rings);
        let radius = (1.0 - z * z).sqrt();
        for j in 0..sectors {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(sectors);
            sum += value(x * (radius * phi.cos()) + y * (radius * phi.sin()) + normal * z);
        }
    }
    sum * TAU / f64::from(rings * sectors)
}

/// Drawn directions have the density that goes with them, and its integral is 1.
#[test]
fn the_sky_is_drawn_by_its_density() {
    let (width, height) = (6, 3);
    let radiance = (0..width * height)
        .map(|k| Vec3::new(0.1, 0.2, 0.3) * if k == 7 { 50.0 } else { k as f32 % 4.0 })
        .collect();
    let map = Environment {
        width,
        height,
        radiance,
        environment_from_world: Mat3::from_rotation_x(0.8),
        intensity: 2.0,
        ..Environment::constant(Vec3::ZERO)
    };
    let sky = Sky::new(&map);
    let mut random = Random::new(6, (0, 0), 0);
    let whole = |value: &mut dyn FnMut(DVec3) -> DVec3| {
        hemisphere(&mut *value, DVec3::Y) + hemisphere(value, DVec3::NEG_Y)
    };
    let one = whole(&mut |w| DVec3::splat(sky.pdf(w))).x;
    assert!((one - 1.0).abs() < 1e-3, "{one}");
    let expected = whole(&mut |w| sky.radiance(w));
    let (mut sum, mut squares, n) = (DVec3::ZERO, DVec3::ZERO, 100_000);
    for _ in 0..n {
        let (wi, pdf) = sky.sample(&mut random).unwrap();
        assert!((pdf - sky.pdf(wi)).abs() < 1e-9 * pdf, "{wi}: {pdf} {}", sky.pdf(wi));
        let weight = sky.radiance(wi) / pdf;
        sum += weight;
        squares += weight * weight;
    }
    let n = f64::from(n);
    let mean = sum / n;
    let s = ((squares / n - mean * mean) / n).map(f64::sqrt);
    assert!(((mean - expected).abs() - 3.9 * s).max_element() < 0.0, "{mean} {expected} {s}");
    // The direction of a texel's centre has its radiance: e = R d, so that d = Rᵀ e.
    let (x, y) = (1.5 / f64::from(width), 1.5 / f64::from(height));
    let (phi, theta) = (TAU * (x - 0.5), PI * y);
    let e = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
    let direction = DMat3::from_rotation_x(f64::from(0.8_f32)).transpose() * e;
    let error = sky.radiance(direction) - DVec3::new(0.1, 0.2, 0.3) * 100.0;
    assert!(error.abs().max_element() < 1e-4, "{error}");
}

/// KHR_lights_punctual by hand: I = 8 at 2 m, half of its range, 30 degrees off the axis.
#[test]
fn a_spot_has_a_window_and_a_cone() {
    let direction = Vec3::NEG_Y;
    let (cos_inner, cos_outer, range) = (0.95_f32, 0.5_f32, 4.0);
    let position = Vec3::new(1.0, f32::sqrt(3.0), 0.0);
    let kind = LightKind::Spot { position, direction, cos_inner, cos_outer, range };
    let light = PunctualLight { name: String::new(), kind, intensity: Vec3::splat(8.0) };
    let found = incident(&light, DVec3::ZERO).unwrap();
    let cone = (30.0_f64.to_radians().cos() - 0.5) / (f64::from(cos_inner) - 0.5);
    let expected = 8.0 / 4.0 * (1.0 - 1.0 / 16.0) * cone * cone;
    assert!((found.irradiance.x - expected).abs() < 1e-6, "{found:?} {expected}");
    assert!(incident(&light, DVec3::Y * 5.0).is_none(), "behind it is dark");
}
