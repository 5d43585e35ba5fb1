//! The renderer against the reference, on a scene for each part of the material model, and on
//! one with all of them.

use crate::agreement::{Visible, compare};
use crate::common::{Stage, emitter, lambert, quad_mesh, settings, with_uvs};
use crate::forms::{bowl, closed_box, normal_map, picture, sky, texture};
use glam::{Affine2, Affine3A, Mat3A, Quat, Vec2, Vec3};
use steradian::RenderSettings;
use steradian::scene::{
    AlphaMode, ColorSpace, LightKind, Material, Mesh, Projection, TextureRef, Wrap,
};

fn small() -> RenderSettings {
    settings(8, 8, 2048)
}

const VISIBLE: Visible = Visible { mean: 0.03, tile: 0.12 };

/// A camera that looks down at the origin from the front.
pub(crate) fn stage() -> Stage {
    let mut stage = Stage::perspective(Vec3::new(0.4, 2.2, 3.1), Vec3::new(0.0, 0.1, 0.0), 0.75);
    upright(&mut stage);
    stage
}

/// Turns the camera until its picture is upright, so that tiles are where one expects them.
fn upright(stage: &mut Stage) {
    let camera = &mut stage.scene.cameras[0].world_from_camera;
    let back = Vec3::from(camera.matrix3.z_axis);
    let right = Vec3::Y.cross(back).normalize();
    camera.matrix3 = Mat3A::from_cols(right.into(), back.cross(right).into(), back.into());
}

/// A bowl that lies on its back, open upwards, with its bumps `placed`.
fn lying() -> Affine3A {
    Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
}

/// A lamp above that is large enough to leave little noise.
pub(crate) fn lamp(stage: &mut Stage) {
    stage.ceiling(Vec3::new(-0.7, 2.6, 0.5), 0.9, emitter(2.0));
}

pub(crate) fn paint() -> Material {
    Material { metallic: 0.0, roughness: 0.5, ..Material::default() }
}

pub(crate) fn pictures(stage: &mut Stage) {
    stage.scene.images = vec![picture(5, 4, 40), normal_map(6, 3), picture(3, 7, 90)];
}

pub(crate) fn srgb(uv_set: u32) -> TextureRef {
    TextureRef { uv_set, ..texture(0, ColorSpace::Srgb) }
}

fn normals() -> TextureRef {
    texture(1, ColorSpace::Linear)
}

/// Rotated, scaled and moved.
fn transform() -> Affine2 {
    Affine2::from_scale_angle_translation(Vec2::new(1.7, 0.6), 0.5, Vec2::new(0.3, -0.4))
}

/// Three placements of one bowl: as it is, mirrored and stretched, and on its back.
pub(crate) fn three_bowls(stage: &mut Stage, mesh: Mesh, material: Material) {
    let mesh = stage.mesh(mesh, material);
    let size = Affine3A::from_scale(Vec3::new(0.45, 0.45, 0.45));
    let place = |x: f32, z: f32| Affine3A::from_translation(Vec3::new(x, 0.0, z));
    stage.place(mesh, place(-0.6, 0.4) * lying() * size);
    let mirror = Affine3A::from_scale(Vec3::new(-0.5, 0.9, 0.4));
    let tilt = Affine3A::from_quat(Quat::from_rotation_y(0.4));
    stage.place(mesh, place(0.55, 0.4) * tilt * lying() * mirror);
    let over = Affine3A::from_rotation_x(std::f32::consts::FRAC_PI_2);
    stage.place(mesh, place(0.1, -0.7) * over * size);
}

#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn textures() {
    let mut stage = stage();
    pictures(&mut stage);
    let base = TextureRef { transform: transform(), ..srgb(0) };
    let wrap = [Wrap::MirroredRepeat, Wrap::ClampToEdge];
    let rough = TextureRef { wrap, uv_set: 1, ..texture(2, ColorSpace::Linear) };
    let material = Material {
        base_color_texture: Some(base),
        metallic: 0.9,
        roughness: 0.8,
        metallic_roughness_texture: Some(rough),
        ..Material::default()
    };
    three_bowls(&mut stage, Mesh { tangents: vec![], ..bowl(6, 0.3) }, material);
    lamp(&mut stage);
    stage.sky(0.3);
    compare("textures", &stage.scene, &small(), VISIBLE);
}

/// With tangents of the mesh.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn normal_maps() {
    let mut stage = stage();
    pictures(&mut stage);
    let normal_texture = Some(TextureRef { transform: transform(), ..normals() });
    let material = Material { normal_texture, normal_scale: 1.4, ..paint() };
    three_bowls(&mut stage, bowl(5, 0.4), material);
    lamp(&mut stage);
    compare("normal maps", &stage.scene, &small(), VISIBLE);
}

/// With tangents from texture coordinates.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn normal_maps_without_tangents() {
    let mut stage = stage();
    pictures(&mut stage);
    let material = Material { normal_texture: Some(normals()), ..paint() };
    three_bowls(&mut stage, Mesh { tangents: vec![], ..bowl(5, 0.4) }, material);
    lamp(&mut stage);
    compare("normal maps without tangents", &stage.scene, &small(), VISIBLE);
}

/// Copies in object space: 3 times 4,608 triangles are shared.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn shared_meshes() {
    let mut stage = stage();
    pictures(&mut stage);
    let material = Material {
        base_color_texture: Some(srgb(1)),
        normal_texture: Some(normals()),
        double_sided: true,
        ..paint()
    };
    three_bowls(&mut stage, bowl(48, 0.5), material);
    assert_eq!(stage.scene.shared_meshes(), [true]);
    lamp(&mut stage);
    compare("shared meshes", &stage.scene, &small(), Visible { mean: 0.05, tile: 0.15 });
}

#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn alpha() {
    let mut stage = stage();
    pictures(&mut stage);
    stage.floor(Vec3::new(0.1, -0.6, 0.1), 1.5, lambert(0.8));
    let cut = Material {
        base_color_texture: Some(TextureRef { nearest: true, ..srgb(0) }),
        alpha_mode: AlphaMode::Mask(0.45),
        alpha: 0.9,
        ..paint()
    };
    three_bowls(&mut stage, Mesh { colors: vec![], ..bowl(6, 0.3) }, cut);
    let veil = Material { alpha_mode: AlphaMode::Blend, alpha: 0.8, ..lambert(0.3) };
    let veil = stage.mesh(bowl(2, 0.1), veil);
    stage.place(veil, Affine3A::from_translation(Vec3::new(0.0, 0.7, 0.1)) * lying());
    // A lamp that is there in part.
    let ghost = Material { alpha_mode: AlphaMode::Blend, alpha: 0.6, ..emitter(3.0) };
    stage.ceiling(Vec3::new(0.8, 2.4, 0.3), 0.6, ghost);
    compare("alpha", &stage.scene, &small(), VISIBLE);
}

#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn specular() {
    let mut stage = stage();
    stage.floor(Vec3::new(0.1, -0.35, 0.1), 1.5, Material { specular: 0.4, ..paint() });
    let tinted = Material {
        base_color: Vec3::new(0.2, 0.5, 0.7),
        roughness: 0.3,
        ior: 2.0,
        specular_color: Vec3::new(1.0, 0.4, 0.1),
        ..paint()
    };
    stage.sphere(Vec3::new(-0.6, 0.0, 0.3), 0.35, tinted.clone());
    let half_metal = Material { metallic: 0.5, specular: 0.7, ..tinted.clone() };
    stage.sphere(Vec3::new(0.3, 0.0, 0.6), 0.35, half_metal);
    stage.sphere(Vec3::new(0.5, 0.0, -0.5), 0.35, Material { roughness: 0.0, ..tinted });
    stage.ceiling(Vec3::new(-0.7, 2.6, 0.5), 0.9, emitter(2.0));
    stage.sky(0.2);
    compare("specular", &stage.scene, &small(), VISIBLE);
}

#[test]
fn transmission() {
    let mut stage = stage();
    stage.floor(Vec3::new(0.1, -0.5, 0.1), 1.5, lambert(0.7));
    let glass = Material {
        base_color: Vec3::new(0.9, 0.95, 0.8),
        transmission: 1.0,
        volume: true,
        ..paint()
    };
    stage.sphere(Vec3::new(-0.6, 0.0, 0.3), 0.4, glass.clone());
    let dense = Material { metallic: 0.2, ior: 1.8, ..glass.clone() };
    let solid = stage.mesh(closed_box(Vec3::splat(-0.3), Vec3::splat(0.3)), dense.clone());
    let turned = Affine3A::from_quat(Quat::from_rotation_y(0.6));
    stage.place(solid, Affine3A::from_translation(Vec3::new(0.6, 0.0, 0.0)) * turned);
    let pane = Material { volume: false, transmission: 0.6, ..dense };
    let pane = stage.mesh(bowl(4, 0.2), pane);
    let placed = Affine3A::from_translation(Vec3::new(0.0, 0.5, 0.6)) * lying();
    stage.place(pane, placed * Affine3A::from_scale(Vec3::splat(0.5)));
    stage.scene.environment = Some(sky());
    compare("transmission", &stage.scene, &small(), VISIBLE);
}

#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn emitters() {
    let mut stage = stage();
    pictures(&mut stage);
    stage.floor(Vec3::new(0.1, -0.3, 0.1), 1.5, paint());
    let screen = Material { emission_texture: Some(srgb(0)), ..emitter(3.0) };
    let corners = [[-0.4, 1.3], [1.2, 1.1], [1.4, -0.2], [0.1, 0.0]].map(Vec2::from);
    let screen_mesh = quad_mesh(Vec3::new(0.0, 0.4, -1.0), Vec3::X, Vec3::Y * 0.6);
    let screen = stage.mesh(with_uvs(screen_mesh, corners), screen);
    stage.place(screen, Affine3A::IDENTITY);
    stage.place(screen, Affine3A::from_scale(Vec3::new(0.4, 0.4, -1.0)));
    let both = Material { double_sided: true, ..emitter(1.0) };
    stage.quad(Vec3::new(-0.8, 0.2, 0.3), Vec3::Y * 0.3, Vec3::Z * 0.4, both.clone());
    // Seen from outside, and one around everything that shines inwards only if double-sided.
    stage.sphere(Vec3::new(0.5, 0.1, 0.5), 0.2, Material { base_color: Vec3::ONE, ..both });
    stage.sphere(Vec3::ZERO, 9.0, emitter(5.0));
    let dim = Material { double_sided: true, ..emitter(0.1) };
    stage.sphere(Vec3::ZERO, 8.0, dim);
    compare("emitters", &stage.scene, &small(), VISIBLE);
}

/// Point, spot and directional lights; and a lens.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn punctual_lights() {
    let mut stage = stage();
    stage.floor(Vec3::new(0.1, -0.3, 0.1), 1.5, paint());
    stage.sphere(Vec3::new(0.2, 0.0, 0.1), 0.3, lambert(0.6));
    punctual(&mut stage);
    compare("punctual lights", &stage.scene, &small(), Visible { mean: 0.04, tile: 0.15 });
}

fn punctual(stage: &mut Stage) {
    stage.light(LightKind::Point { position: Vec3::new(-1.0, 1.2, 0.4), range: 3.0 }, 2.0);
    let direction = Vec3::new(-0.3, -1.0, -0.2).normalize();
    let position = Vec3::new(0.7, 1.5, 0.8);
    let (cos_inner, cos_outer, range) = (0.95, 0.8, 2.5);
    stage.light(LightKind::Spot { position, direction, cos_inner, cos_outer, range }, 6.0);
    let direction = Vec3::new(0.5, -0.6, -0.4).normalize();
    stage.light(LightKind::Directional { direction }, 0.5);
}

#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn environment_and_lens() {
    let mut stage = stage();
    stage.scene.environment = Some(sky());
    stage.floor(Vec3::new(0.1, -0.3, 0.1), 1.0, lambert(0.6));
    stage.sphere(Vec3::new(0.2, 0.1, 0.3), 0.4, Material { roughness: 0.4, ..Material::default() });
    let camera = &mut stage.scene.cameras[0];
    (camera.aperture_radius, camera.focus_distance) = (0.15, 2.5);
    compare("environment and lens", &stage.scene, &small(), VISIBLE);
}

/// Every part of the material model, every light, an oblique sky, shared and mirrored copies,
/// and a lens.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn all_of_it() {
    let mut stage = stage();
    pictures(&mut stage);
    let wrap = [Wrap::MirroredRepeat, Wrap::ClampToEdge];
    let worn = Material {
        base_color_texture: Some(TextureRef { transform: transform(), ..srgb(0) }),
        metallic: 0.6,
        roughness: 0.9,
        metallic_roughness_texture: Some(TextureRef {
            wrap,
            uv_set: 1,
            ..texture(2, ColorSpace::Linear)
        }),
        normal_texture: Some(normals()),
        normal_scale: 0.8,
        specular: 0.8,
        specular_color: Vec3::new(0.9, 0.7, 1.0),
        ior: 1.7,
        ..Material::default()
    };
    three_bowls(&mut stage, bowl(48, 0.3), worn.clone());
    let floor = stage.mesh(Mesh { tangents: vec![], ..bowl(2, 0.0) }, worn);
    let wide = Affine3A::from_scale(Vec3::new(1.6, 1.6, 1.0));
    stage.place(floor, Affine3A::from_translation(Vec3::new(0.1, -0.4, 0.1)) * lying() * wide);
    let cut = Material {
        base_color_texture: Some(TextureRef { nearest: true, ..srgb(1) }),
        alpha_mode: AlphaMode::Mask(0.45),
        double_sided: true,
        emission: Vec3::new(0.2, 0.1, 0.3),
        ..paint()
    };
    let cut = stage.mesh(bowl(3, 0.2), cut);
    let small = Affine3A::from_scale(Vec3::splat(0.3));
    stage.place(cut, Affine3A::from_translation(Vec3::new(-0.2, 0.4, 0.3)) * small);
    let veil = Material { alpha_mode: AlphaMode::Blend, alpha: 0.7, ..lambert(0.4) };
    let veil = stage.mesh(bowl(2, 0.1), veil);
    stage.place(veil, Affine3A::from_translation(Vec3::new(0.3, 0.8, 0.1)) * lying() * small);
    let glass = Material { transmission: 1.0, volume: true, ..paint() };
    stage.sphere(Vec3::new(0.0, 0.1, 0.6), 0.25, glass.clone());
    let pane = Material { volume: false, transmission: 0.7, ..glass };
    stage.quad(Vec3::new(0.6, 0.3, 0.5), Vec3::X * 0.2, Vec3::Y * 0.3, pane);
    stage.sphere(
        Vec3::new(-0.9, 0.0, 0.7),
        0.15,
        Material { roughness: 0.0, ..Material::default() },
    );
    let screen = Material { emission_texture: Some(srgb(0)), ..emitter(2.0) };
    let corners = [[-0.4, 1.3], [1.2, 1.1], [1.4, -0.2], [0.1, 0.0]].map(Vec2::from);
    let screen_mesh = quad_mesh(Vec3::new(0.0, 0.6, -1.3), Vec3::X, Vec3::Y * 0.6);
    let screen = stage.mesh(with_uvs(screen_mesh, corners), screen);
    stage.place(screen, Affine3A::IDENTITY);
    stage.sphere(Vec3::new(1.2, 0.9, 0.6), 0.3, emitter(1.5));
    punctual(&mut stage);
    stage.scene.environment = Some(sky());
    let camera = &mut stage.scene.cameras[0];
    (camera.aperture_radius, camera.focus_distance) = (0.05, 3.0);
    compare("all of it", &stage.scene, &settings(8, 8, 2048), VISIBLE);
}

#[test]
fn a_lens_on_an_orthographic_camera() {
    let mut stage = stage();
    stage.scene.cameras[0].projection = Projection::Orthographic { ymag: 1.2 };
    stage.quad(Vec3::new(0.1, 0.0, 0.2), Vec3::X * 0.5, Vec3::Y * 0.4, emitter(1.0));
    let camera = &mut stage.scene.cameras[0];
    (camera.aperture_radius, camera.focus_distance) = (0.3, 2.5);
    let settings = RenderSettings { max_bounces: Some(0), ..small() };
    compare("orthographic lens", &stage.scene, &settings, Visible { mean: 0.05, tile: 0.12 });
}

/// A lamp whose alpha is ½ shines half as bright, whether light samples or paths find it.
#[test]
fn a_lamp_that_is_there_in_part() {
    let mut stage = stage();
    stage.floor(Vec3::new(0.1, -0.2, 0.2), 1.5, lambert(0.7));
    let ghost = Material { alpha_mode: AlphaMode::Blend, alpha: 0.5, ..emitter(3.0) };
    stage.ceiling(Vec3::new(0.4, 1.0, 0.3), 0.6, ghost);
    let cut = Material { alpha_mode: AlphaMode::Mask(0.6), alpha: 0.5, ..emitter(9.0) };
    stage.ceiling(Vec3::new(-0.4, 1.2, 0.3), 0.6, cut);
    let visible = Visible { mean: 0.07, tile: 0.25 };
    compare("lamp in part", &stage.scene, &small(), visible);
}

/// Lamps that a tree chooses among, of which candidates are drawn; a screen, the sun, a spot.
#[test]
fn many_lights() {
    let mut stage = stage();
    pictures(&mut stage);
    stage.floor(Vec3::new(0.1, -0.3, 0.1), 1.5, paint());
    stage.sphere(Vec3::new(-0.3, 0.1, 0.2), 0.35, Material { metallic: 1.0, ..paint() });
    for k in 0..24_u8 {
        let (s, c) = (f32::from(k) * 2.399_963).sin_cos();
        let at = Vec3::new(0.9 * s, 0.5 + 0.04 * f32::from(k % 13), 0.9 * c);
        let size = 0.08 + 0.01 * f32::from(k % 5);
        let radiance = 1.0 + 0.7 * f32::from(k % 6);
        let lamp = Material { double_sided: k % 3 == 0, ..emitter(radiance) };
        stage.quad(at, Vec3::new(c, 0.2, s) * size, Vec3::new(s, 0.3, -c) * size, lamp);
    }
    let screen = Material { emission_texture: Some(srgb(0)), ..emitter(2.0) };
    let corners = [[-0.4, 1.3], [1.2, 1.1], [1.4, -0.2], [0.1, 0.0]].map(Vec2::from);
    let screen_mesh = quad_mesh(Vec3::new(0.0, 0.6, -1.3), Vec3::X, Vec3::Y * 0.6);
    let screen = stage.mesh(with_uvs(screen_mesh, corners), screen);
    stage.place(screen, Affine3A::IDENTITY);
    punctual(&mut stage);
    compare("many lights", &stage.scene, &small(), Visible { mean: 0.04, tile: 0.15 });
}
