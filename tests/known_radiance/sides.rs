//! What is seen from behind, and surfaces without shading.

use crate::common::{
    Estimate, Stage, assert_constant, assert_truth, emitter, lambert, quad_mesh, render, settings,
};
use glam::{Affine3A, Quat, Vec3, Vec4};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{LightKind, Material, Mesh};

/// A wall of radiance 1 behind a black sheet, seen from the sheet's back.
fn behind(sheet: Material, placement: Affine3A) -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y * 2.0, Vec3::ZERO, 0.1);
    stage.floor(Vec3::ZERO, 1.0, emitter(1.0));
    let mesh = stage.mesh(quad_mesh(Vec3::ZERO, Vec3::X, Vec3::Z), sheet);
    stage.place(mesh, Affine3A::from_translation(Vec3::Y) * placement);
    stage
}

#[test]
fn the_camera_sees_through_the_backs_of_single_sided_sheets() {
    let double = Material { double_sided: true, ..lambert(0.0) };
    let mirrored = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    let turned = Affine3A::from_quat(Quat::from_rotation_x(std::f32::consts::PI));
    let cases = [
        ("back", lambert(0.0), Affine3A::IDENTITY, 1.0),
        ("both sides", double, Affine3A::IDENTITY, 0.0),
        // A mirror keeps the front of the surface on the side that it shows.
        ("mirrored", lambert(0.0), mirrored, 0.0),
        ("turned round", lambert(0.0), turned, 0.0),
        ("turned and mirrored", lambert(0.0), turned * mirrored, 1.0),
    ];
    for (name, sheet, placement, seen) in cases {
        let stage = behind(sheet, placement);
        assert_constant(name, &render(&stage.scene, &settings(8, 8, 4)), seen);
    }
}

/// Instances that share a tree are traced in object space.
#[test]
fn shared_meshes_are_culled_alike() {
    let mirrored = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    for (placement, seen) in [(Affine3A::IDENTITY, 1.0), (mirrored, 0.0)] {
        let mut stage = behind(lambert(0.0), placement);
        let mesh = &mut stage.scene.meshes[1];
        mesh.triangles = mesh.triangles.repeat(2049);
        stage.place(1, Affine3A::from_translation(Vec3::Y * 50.0));
        assert!(stage.scene.shared_meshes()[1]);
        assert_constant("shared", &render(&stage.scene, &settings(8, 8, 4)), seen);
    }
}

/// The back of a closed mesh is seen from inside it.
#[test]
fn solids_are_not_culled() {
    let corners: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0)
        .collect();
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let cube = Mesh {
        positions: corners,
        triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    };
    assert!(cube.is_closed());
    let mut stage = Stage::perspective(Vec3::ZERO, Vec3::X, 1.0);
    let mesh = stage.mesh(cube, lambert(0.0));
    stage.place(mesh, Affine3A::IDENTITY);
    stage.sky(1.0);
    assert_constant("inside a cube", &render(&stage.scene, &settings(8, 8, 4)), 0.0);
}

/// Light does not come through what the camera looks through: the sheet's shadow on the floor.
#[test]
fn a_culled_sheet_keeps_its_shadow() {
    let mut stage = Stage::orthographic(Vec3::Y * 2.0, Vec3::ZERO, 0.1);
    stage.floor(Vec3::ZERO, 1.0, lambert(1.0));
    stage.light(LightKind::Directional { direction: Vec3::NEG_Y }, PI as f32);
    let settings = RenderSettings { max_bounces: Some(1), ..settings(8, 8, 4) };
    assert_constant("lit", &render(&stage.scene, &settings), 1.0);
    stage.ceiling(Vec3::Y, 1.0, lambert(0.0));
    assert_constant("in the sheet's shadow", &render(&stage.scene, &settings), 0.0);
}

fn unlit(color: Vec3) -> Material {
    Material { base_color: color, unlit: true, ..Material::default() }
}

/// An unlit surface shows its base colour times its vertex colour, whatever shines on it.
#[test]
fn unlit_surfaces_show_their_color_on_both_sides() {
    for normal in [Vec3::Y, Vec3::NEG_Y] {
        let mut stage = Stage::orthographic(normal * 2.0, Vec3::ZERO, 0.1);
        let quad =
            Mesh { colors: vec![Vec4::splat(0.5); 4], ..quad_mesh(Vec3::ZERO, Vec3::Z, Vec3::X) };
        let mesh = stage.mesh(quad, unlit(Vec3::splat(0.25)));
        stage.place(mesh, Affine3A::IDENTITY);
        stage.sky(3.0);
        assert_constant("unlit", &render(&stage.scene, &settings(8, 8, 4)), 0.125);
    }
}

/// And it lights what is near, found by light samples and by scattered rays: under a large unlit
/// ceiling of radiance ¼ whose vertex colours halve it a white floor reflects nearly 1/8.
#[test]
fn unlit_surfaces_are_lights() {
    let half = 100.0;
    let mut stage = Stage::orthographic(Vec3::Y * 0.5, Vec3::ZERO, 0.01);
    stage.floor(Vec3::ZERO, half, lambert(1.0));
    let ceiling = Mesh {
        colors: vec![Vec4::splat(0.5); 4],
        ..quad_mesh(Vec3::Y, Vec3::X * half, Vec3::Z * half)
    };
    let mesh = stage.mesh(ceiling, unlit(Vec3::splat(0.25)));
    stage.place(mesh, Affine3A::IDENTITY);
    let settings = RenderSettings { max_bounces: Some(1), ..settings(16, 16, 256) };
    // The form factor of a square of half side a at distance 1: 4 times that of a quarter seen
    // from its corner, a/sqrt(1+a²) atan(a/sqrt(1+a²)) / π · 2/2.
    let s = f64::from(half) / (1.0 + f64::from(half).powi(2)).sqrt();
    let truth = 0.125 * 4.0 * s * s.atan() / PI;
    assert_truth(
        "lit by an unlit ceiling",
        Estimate::of_pixels(&render(&stage.scene, &settings)),
        truth,
        0.01,
    );
}
