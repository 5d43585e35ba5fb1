//! A Lambertian receiver under lights with extent: albedo Le F, F being the form
//! factors of the radiation heat transfer tables.

use crate::common::{Estimate, Stage, assert_truth, emitter, lambert, render, settings};
use glam::Vec3;
use std::f64::consts::PI;
use steradian::scene::{Mesh, Scene};

const ALBEDO: f32 = 0.5;

/// A small receiver about the origin that faces up, seen over a field so small that
/// light does not vary over it. The camera is close, so that no light is in between.
fn receiver() -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(ALBEDO));
    stage
}

/// Towards a light at this angle from the receiver's normal.
fn direction(degrees: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin as f32, cos as f32, 0.0)
}

/// Asserts the radiance of the receiver under lights of radiance 1 for form factor `f`.
fn check(what: &str, scene: &Scene, f: f64, spp: u32, visible_bias: f64) {
    let film = render(scene, &settings(16, 16, spp));
    assert_truth(what, Estimate::of_pixels(&film), f64::from(ALBEDO) * f, visible_bias);
}

/// Form factor of a sphere at `distance` radii, its centre at `angle` from the
/// normal. The second form is for a sphere that the horizon cuts.
fn sphere_form_factor(distance: f64, angle: f64) -> f64 {
    let (h, cos) = (distance, angle.cos());
    if h * cos >= 1.0 {
        return cos / (h * h);
    }
    let x = (h * h - 1.0).sqrt();
    let y = -x / angle.tan();
    let s = angle.sin() * (1.0 - y * y).sqrt();
    (cos * y.acos() - x * s) / (PI * h * h) + (s / x).atan() / PI
}

#[test]
fn spheres_above_and_across_the_horizon() {
    // Distance in radii, angle in degrees, form factor.
    let cases = [
        (2.0, 30.0, 0.216_506),
        (2.0, 75.0, 0.070_410),
        (2.0, 90.0, 0.028_834),
        (2.0, 105.0, 0.005_706),
        (1.05, 80.0, 0.390_499),
        (1.05, 100.0, 0.232_995),
    ];
    for (h, degrees, printed) in cases {
        let f = sphere_form_factor(h, f64::to_radians(degrees));
        assert!((f - printed).abs() < 1e-6, "{f} {printed}");
        let mut stage = receiver();
        stage.sphere(direction(degrees) * h as f32, 1.0, emitter(1.0));
        // Few directions towards a sphere below the horizon lead up.
        let spp = if f < 0.03 { 1024 } else { 256 };
        check(&format!("sphere, {h} radii, {degrees}°"), &stage.scene, f, spp, 0.01);
    }
}

#[test]
fn squares_overhead() {
    for (distance, f) in [(1.0, 0.239_456), (2.0, 0.073_478)] {
        let mut stage = receiver();
        stage.ceiling(Vec3::Y * distance, 0.5, emitter(1.0));
        check(&format!("square at {distance}"), &stage.scene, f, 256, 0.001);
    }
}

/// The light's own surface must not be what stands between it and a far receiver.
#[test]
fn a_small_square_far_away() {
    for side in [1e-1_f32, 1e-2, 1e-3] {
        let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
        // The receiver is at the origin and the light at (0, 100, 0), then the reverse.
        stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(ALBEDO));
        stage.ceiling(Vec3::Y * 100.0, 0.5 * side, emitter(1e4 / (side * side)));
        check(&format!("side {side} above"), &stage.scene, 1.0 / PI, 64, 0.001);

        let eye = Vec3::Y * -99.99;
        let mut stage = Stage::orthographic(eye, Vec3::Y * -100.0, 1e-5);
        stage.floor(Vec3::new(0.002, -100.0, 0.001), 0.01, lambert(ALBEDO));
        stage.ceiling(Vec3::ZERO, 0.5 * side, emitter(1e4 / (side * side)));
        check(&format!("side {side} at the origin"), &stage.scene, 1.0 / PI, 64, 0.001);
    }
}

/// Lambert's formula for a polygon: the sum over its edges of their angle times the cosine
/// between the receiver's normal and the edge's plane, over 2π.
#[test]
fn a_slanted_triangle() {
    // In coordinates with z up; the receiver's normal is +y here.
    let corners = [[0.2, 0.1, 1.0], [1.4, -0.3, 0.8], [0.3, 1.2, 1.5]];
    let corners = corners.map(|[x, y, z]: [f32; 3]| Vec3::new(y, z, x));
    let mut stage = receiver();
    let mut triangle = Mesh { positions: corners.into(), ..Mesh::default() };
    let faces_up = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[0]) > 0.0;
    triangle.triangles = vec![if faces_up { [0, 2, 1] } else { [0, 1, 2] }];
    let mesh = stage.mesh(triangle, emitter(1.0));
    stage.place(mesh, glam::Affine3A::IDENTITY);
    check("triangle", &stage.scene, 0.072_551, 256, 0.002);
}

/// Disk of radius r parallel to the receiver, at height h and lateral distance a.
fn disk_form_factor(a: f64, h: f64, r: f64) -> f64 {
    let (a2, h2, r2) = (a * a, h * h, r * r);
    (1.0 - (a2 + h2 - r2) / ((a2 + h2 + r2).powi(2) - 4.0 * a2 * r2).sqrt()) / 2.0
}

/// A disk of 256 triangles. Its area is (2π/256)²/6 = 1e-4 less than the true disk's, and
/// a part of that of its light: far below the bias that is looked for.
#[test]
fn disks() {
    const SIDES: u32 = 256;
    for (a, h, r, printed) in
        [(0.0, 1.0, 1.0, 0.5), (1.5, 1.0, 1.0, 0.126_295), (0.3, 2.0, 0.5, 0.056_543)]
    {
        let f = disk_form_factor(a, h, r);
        assert!((f - printed).abs() < 1e-6, "{f} {printed}");
        let mut stage = receiver();
        let center = Vec3::new(a as f32, h as f32, 0.0);
        let rim = |i: u32| {
            let (sin, cos) = (f64::from(i) * 2.0 * PI / f64::from(SIDES)).sin_cos();
            center + Vec3::new(cos as f32, 0.0, sin as f32) * r as f32
        };
        let mut disk = Mesh { positions: vec![center], ..Mesh::default() };
        disk.positions.extend((0..SIDES).map(rim));
        disk.triangles = (0..SIDES).map(|i| [0, 1 + i, 1 + (i + 1) % SIDES]).collect();
        let mesh = stage.mesh(disk, emitter(1.0));
        stage.place(mesh, glam::Affine3A::IDENTITY);
        check(&format!("disk at {a}, {h}"), &stage.scene, f, 256, 0.015);
    }
}
