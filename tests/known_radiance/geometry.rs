//! The same geometry held in other ways gives the same picture.

use crate::common::{
    Estimate, Stage, assert_truth, bundled, emitter, grey, lambert, quad_mesh, render, settings,
    with_device,
};
use glam::{Affine3A, Mat3, Quat, Vec3};
use std::sync::Arc;
use steradian::bvh::{KeptTrees, TreeSources};
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::scene::{Instance, Mesh, Scene};
use steradian::settings::Accel;
use steradian::{RenderSettings, Renderer};

/// A closed surface of 2 × 24 × 24 triangles about the origin, about 1 in radius, with
/// shading normals.
fn bumpy_ball() -> Mesh {
    const N: u32 = 24;
    let point = |i: u32, j: u32| {
        let theta = std::f32::consts::PI * i as f32 / N as f32;
        let phi = std::f32::consts::TAU * (j % N) as f32 / N as f32;
        let direction = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        direction * (1.0 + 0.1 * (3.0 * phi).sin() * theta.sin())
    };
    let mut mesh = Mesh::default();
    for i in 0..=N {
        for j in 0..=N {
            mesh.positions.push(point(i, j));
            mesh.normals.push(point(i, j).normalize());
        }
    }
    let index = |i: u32, j: u32| i * (N + 1) + j;
    for i in 0..N {
        for j in 0..N {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    mesh
}

/// Six balls, turned, stretched and mirrored, on a floor under a lamp. Smooth balls are
/// stretched evenly: only then do transforming normals and interpolating them commute.
fn many_balls(is_smooth: bool) -> Scene {
    let mut stage = Stage::perspective(Vec3::new(0.0, 4.0, 7.0), Vec3::ZERO, 0.9);
    let mut ball = bumpy_ball();
    if !is_smooth {
        ball.normals.clear();
    }
    let mesh = stage.mesh(ball, lambert(0.7));
    for k in 0..6 {
        let f = k as f32;
        let mirror = if k % 2 == 0 { 1.0 } else { -1.0 };
        let turn = Mat3::from_quat(Quat::from_euler(glam::EulerRot::XYZ, f, 0.7 * f, 0.3));
        let size = 0.5 + 0.1 * f;
        let across = if is_smooth { Vec3::splat(size) } else { Vec3::new(size, 0.8, 0.6) };
        let stretch = Mat3::from_diagonal(across * Vec3::new(mirror, 1.0, 1.0));
        let at = Vec3::new(2.0 * (k % 3) as f32 - 2.0, 0.2, 2.0 * (k / 3) as f32 - 1.0);
        stage.place(mesh, Affine3A::from_mat3_translation(turn * stretch, at));
    }
    stage.floor(Vec3::new(0.1, -1.0, 0.2), 5.0, lambert(0.5));
    stage.ceiling(Vec3::new(0.0, 5.0, 0.0), 2.0, emitter(3.0));
    stage.scene
}

/// Every placement with a mesh of its own: nothing is shared.
fn unshared(mut scene: Scene) -> Scene {
    let meshes: Vec<_> =
        scene.instances.iter().map(|i| scene.meshes[i.mesh as usize].clone()).collect();
    scene.meshes = meshes;
    for (k, instance) in scene.instances.iter_mut().enumerate() {
        *instance = Instance { mesh: k as u32, ..instance.clone() };
    }
    scene
}

/// With the same random numbers, hits that differ by rounding lead to the same radiance
/// except where a decision falls the other way.
#[track_caller]
fn assert_same_but_for_rounding(what: &str, a: &[f64], b: &[f64]) {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mean = a.iter().sum::<f64>() / a.len() as f64;
    let changed = differences.iter().filter(|d| d.abs() > 1e-4 * mean).count();
    assert!(changed * 10 <= a.len(), "{what}: {changed} of {} pixels differ", a.len());
    let d = Estimate::of(&differences);
    assert!(d.mean.abs() <= 3.9 * d.standard_error + 1e-6 * mean, "{what}: {d:?}");
    assert!(d.standard_error <= 1e-3 * mean, "{what}: {d:?}");
}

#[test]
fn shared_meshes_are_the_same_as_copies() {
    for is_smooth in [true, false] {
        check_sharing(&many_balls(is_smooth));
    }
}

fn check_sharing(scene: &Scene) {
    assert!(scene.shared_meshes().contains(&true));
    let copies = unshared(scene.clone());
    assert!(!copies.shared_meshes().contains(&true));
    // Every bounce off a curved surface multiplies a difference: one is enough.
    let settings = RenderSettings { max_bounces: Some(1), ..settings(32, 32, 16) };
    let shared = grey(&render(scene, &settings));
    assert_same_but_for_rounding("copies", &shared, &grey(&render(&copies, &settings)));

    if scene.meshes[0].normals.is_empty() {
        check_without_tree(scene, &copies, settings);
    }
}

/// Brute force has no instances either: the copies' bits. One sample is three rays, and
/// Mesa 22 ends a thread's loops after 65,535 triangles.
fn check_without_tree(scene: &Scene, copies: &Scene, settings: RenderSettings) {
    let few = RenderSettings { resolution: (16, 16), spp: 1, ..settings };
    let brute = RenderSettings { accel: Accel::None, ..few.clone() };
    assert_eq!(render(copies, &few).picture().rgb, render(scene, &brute).picture().rgb);
}

/// Triangles and spheres, and two triangles in one place.
fn mixed() -> Scene {
    let mut stage = Stage::perspective(Vec3::new(0.5, 2.0, 4.0), Vec3::ZERO, 0.9);
    let ball = stage.mesh(bumpy_ball(), lambert(0.6));
    stage.place(ball, Affine3A::from_translation(Vec3::new(-0.9, 0.0, 0.0)));
    stage.sphere(Vec3::new(1.2, 0.0, 0.3), 0.9, lambert(0.4));
    stage.sphere(Vec3::new(0.3, -0.6, 1.3), 0.3, lambert(0.9));
    stage.floor(Vec3::new(0.1, -1.0, 0.2), 5.0, lambert(0.5));
    // Coincident with a part of the floor, of another colour: the floor came first.
    stage.floor(Vec3::new(0.6, -1.0, 0.7), 4.0, lambert(0.1));
    stage.ceiling(Vec3::new(0.0, 4.0, 0.0), 1.0, emitter(3.0));
    stage.scene
}

#[test]
fn every_acceleration_structure_finds_the_same_hits() {
    let scene = mixed();
    let bits = |accel| {
        let settings = RenderSettings { accel, max_bounces: Some(3), ..settings(16, 16, 8) };
        render(&scene, &settings).picture().rgb
    };
    let expected = bits(Accel::None);
    assert!(expected.iter().any(|c| c[0] > 0.0));
    assert_eq!(bits(Accel::Bvh), expected);
    assert_eq!(bits(Accel::Median), expected);
}

/// A tree that was built for another frame, and fitted to this one.
#[test]
fn a_refitted_tree_finds_the_same_hits() {
    let scene = mixed();
    let mut before = mixed();
    before.instances[0].world_from_object = Affine3A::from_translation(Vec3::new(0.7, 0.9, -2.0));
    before.spheres.iter_mut().for_each(|sphere| sphere.center.x -= 1.0);
    let settings = RenderSettings { max_bounces: Some(3), ..settings(16, 16, 8) };
    // However bad it is.
    let trees = KeptTrees::default();
    trees.traced_for(0.0);
    let picture = with_device(|device| {
        let mut frames = [&before, &scene].map(|scene| {
            let prepared =
                PreparedScene::with_trees(device.clone(), scene, &settings, Some(&trees));
            let (prepared, tuning) = (Arc::new(prepared.unwrap()), Tuning::default());
            Renderer::of_prepared(prepared, scene, &settings, &tuning).unwrap()
        });
        let sources = |frame: &Renderer| {
            let TreeSources { built, kept, refitted } = frame.statistics().trees;
            [built, kept, refitted]
        };
        assert_eq!(frames.each_ref().map(sources), [[1, 0, 0], [0, 0, 1]]);
        while frames[1].step().unwrap() {}
        frames[1].finish().unwrap();
        frames[1].film().picture()
    });
    assert!(picture == render(&scene, &settings).picture());
}

/// A floor that is a sphere of radius 1e6 m is as good as a plane: the square light's form
/// factor, by light samples and by chance.
#[test]
fn a_vast_sphere_is_a_plane() {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.sphere(Vec3::Y * -1e6, 1e6, lambert(0.5));
    stage.ceiling(Vec3::Y, 0.5, emitter(1.0));
    assert!(stage.scene.anchor_of(&stage.scene.spheres[0]).is_some());
    let estimate = Estimate::of_pixels(&render(&stage.scene, &settings(16, 16, 256)));
    assert_truth("vast sphere", estimate, 0.5 * 0.239_456, 0.001);
}

/// The anchored form is for spheres that dwarf all that is near them. A lone camera has no
/// extent, but a distance.
#[test]
fn only_vast_spheres_are_anchored() {
    let is_anchored = |eye: f32, center: f32, radius: f32| {
        let mut stage = Stage::perspective(Vec3::Y * eye, Vec3::Y * (eye + 1.0), 1.0);
        stage.sphere(Vec3::Y * center, radius, lambert(0.5));
        stage.scene.anchor_of(&stage.scene.spheres[0]).is_some()
    };
    assert!(!is_anchored(0.4, 0.0, 1.0));
    assert!(!is_anchored(3.0, 0.0, 1.0));
    assert!(!is_anchored(0.0, 1e6, 1e3));
    assert!(is_anchored(1.7, -1e6, 1e6));
}

/// Seen from far and at a low angle, the same floor is where a plane would be.
#[test]
fn a_vast_sphere_lies_level() {
    let picture = |is_sphere: bool| {
        let mut stage = Stage::perspective(Vec3::new(0.0, 1.7, 0.0), Vec3::new(5.0, 0.0, 0.0), 0.5);
        if is_sphere {
            stage.sphere(Vec3::Y * -1e6, 1e6, lambert(0.5));
        } else {
            let mesh =
                stage.mesh(quad_mesh(Vec3::ZERO, Vec3::Z * 900.0, Vec3::X * 900.0), lambert(0.5));
            stage.place(mesh, Affine3A::IDENTITY);
        }
        stage.ceiling(Vec3::new(5.0, 0.5, 0.0), 0.5, emitter(1.0));
        grey(&render(&stage.scene, &settings(16, 16, 64)))
    };
    let (sphere, plane) = (picture(true), picture(false));
    let differences: Vec<f64> = sphere.iter().zip(&plane).map(|(a, b)| a - b).collect();
    let d = Estimate::of(&differences);
    let mean = plane.iter().sum::<f64>() / plane.len() as f64;
    // At 5 m the sphere is 1.25e-5 m below the plane, for a lamp half a metre above it.
    assert!(d.mean.abs() <= 3.9 * d.standard_error + 1e-4 * mean, "{d:?} of {mean}");
    assert!(d.standard_error <= 1e-4 * mean, "{d:?} of {mean}");
}

/// A bundled scene of thousands of placements renders without a fault.
#[test]
fn thousands_of_instances() {
    let film = render(&bundled("instances"), &settings(16, 16, 4));
    assert!(grey(&film).iter().sum::<f64>() > 0.0);
}
