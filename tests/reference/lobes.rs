//! The renderer against the reference, on scenes for the parts of the material model that glTF's
//! extensions add.

use crate::agreement::{Visible, compare};
use crate::common::{Stage, emitter, lambert, settings};
use crate::everything::{lamp, paint, pictures, srgb, stage, three_bowls};
use crate::forms::{bowl, closed_box, sky, texture};
use glam::{Affine3A, Quat, Vec3};
use steradian::RenderSettings;
use steradian::scene::{
    Anisotropy, Clearcoat, ColorSpace, DiffuseTransmission, Iridescence, LightKind, Material, Mesh,
    Sheen, SpecularGlossiness, TextureRef,
};

fn small() -> RenderSettings {
    settings(8, 8, 2048)
}

const VISIBLE: Visible = Visible { mean: 0.04, tile: 0.16 };

/// Light that samples of lights and scattered rays both find: a wide lamp near by and a dim sky.
fn lights(stage: &mut Stage) {
    lamp(stage);
    stage.sky(0.3);
}

/// Any value of a texture: image `image` of [`pictures`] by set 0.
fn values(image: u32) -> Option<TextureRef> {
    Some(texture(image, ColorSpace::Linear))
}

fn coat(roughness: f32) -> Clearcoat {
    Clearcoat {
        factor: 1.0,
        texture: None,
        roughness,
        roughness_texture: None,
        normal_texture: None,
        normal_scale: 1.0,
    }
}

fn film(thickness: f32) -> Iridescence {
    Iridescence {
        factor: 1.0,
        texture: None,
        ior: 1.8,
        thickness_minimum: 100.0,
        thickness_maximum: thickness,
        thickness_texture: None,
    }
}

fn cloth(roughness: f32) -> Sheen {
    Sheen {
        color: Vec3::new(0.9, 0.6, 0.8),
        color_texture: None,
        roughness,
        roughness_texture: None,
    }
}

/// A coat with its own normals over the base's, rough and smooth; films on metal and dielectric.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn coats_and_films() {
    let mut stage = stage();
    pictures(&mut stage);
    let coated = Material {
        base_color_texture: Some(srgb(0)),
        normal_texture: values(1),
        clearcoat: Some(Clearcoat {
            texture: values(0),
            roughness: 0.7,
            roughness_texture: values(2),
            normal_texture: Some(TextureRef { uv_set: 1, ..texture(1, ColorSpace::Linear) }),
            normal_scale: 0.6,
            ..coat(0.5)
        }),
        iridescence: Some(Iridescence {
            factor: 0.9,
            texture: values(2),
            thickness_texture: values(0),
            ..film(500.0)
        }),
        ..paint()
    };
    three_bowls(&mut stage, bowl(5, 0.3), coated);
    let copper = Material {
        base_color: Vec3::new(0.9, 0.6, 0.4),
        roughness: 0.5,
        iridescence: Some(film(350.0)),
        ..Material::default()
    };
    stage.sphere(Vec3::new(0.0, 0.3, 0.7), 0.25, copper);
    let lacquer = Material { clearcoat: Some(coat(0.0)), roughness: 0.8, ..paint() };
    stage.sphere(Vec3::new(-0.3, 0.5, -0.2), 0.25, lacquer);
    lights(&mut stage);
    compare("coats and films", &stage.scene, &small(), VISIBLE);
}

/// Sheen of several roughnesses, and sheets that light goes through without a direction.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn cloth_and_leaves() {
    let mut stage = stage();
    pictures(&mut stage);
    let velvet = Material {
        sheen: Some(Sheen {
            color_texture: Some(srgb(1)),
            roughness: 0.9,
            roughness_texture: values(0),
            ..cloth(0.9)
        }),
        roughness: 0.9,
        ..paint()
    };
    three_bowls(&mut stage, Mesh { tangents: vec![], ..bowl(5, 0.3) }, velvet);
    let silk = Material { sheen: Some(cloth(0.35)), base_color: Vec3::splat(0.3), ..paint() };
    stage.sphere(Vec3::new(0.0, 0.25, 0.7), 0.25, silk);
    let leaf = Material {
        base_color: Vec3::new(0.3, 0.6, 0.2),
        double_sided: true,
        diffuse_transmission: Some(DiffuseTransmission {
            factor: 0.8,
            texture: values(2),
            color: Vec3::new(0.7, 0.9, 0.3),
            color_texture: Some(srgb(0)),
        }),
        ..paint()
    };
    let leaf = stage.mesh(bowl(3, 0.2), leaf);
    let size = Affine3A::from_scale(Vec3::splat(0.4));
    let turned = Affine3A::from_quat(Quat::from_rotation_x(-0.6));
    stage.place(leaf, Affine3A::from_translation(Vec3::new(0.5, 0.7, -0.2)) * turned * size);
    lights(&mut stage);
    // From behind the leaf.
    let direction = Vec3::new(-0.2, -0.5, 0.9).normalize();
    stage.light(LightKind::Directional { direction }, 0.8);
    compare("cloth and leaves", &stage.scene, &small(), VISIBLE);
}

/// Rough refraction into absorbing and dispersive volumes, one within another, a lamp inside of
/// one, and a rough thin pane.
#[test]
fn rough_glass() {
    let mut stage = stage();
    stage.floor(Vec3::new(0.1, -0.5, 0.1), 1.5, lambert(0.7));
    let glass = Material {
        base_color: Vec3::new(0.95, 0.9, 1.0),
        transmission: 1.0,
        volume: true,
        roughness: 0.4,
        absorption: Vec3::new(0.2, 0.8, 1.6),
        ..paint()
    };
    stage.sphere(Vec3::new(-0.6, 0.0, 0.3), 0.4, Material { dispersion: 4.0, ..glass.clone() });
    let solid = Material { ior: 1.33, roughness: 0.25, ..glass.clone() };
    let solid = stage.mesh(closed_box(Vec3::splat(-0.35), Vec3::splat(0.35)), solid);
    let turned = Affine3A::from_quat(Quat::from_rotation_y(0.6));
    stage.place(solid, Affine3A::from_translation(Vec3::new(0.6, 0.0, 0.0)) * turned);
    // Within it one of higher index that passes part of the light only, and a lamp.
    let core = Material { ior: 1.7, transmission: 0.7, roughness: 0.5, ..glass.clone() };
    stage.sphere(Vec3::new(0.6, 0.05, 0.0), 0.18, core);
    stage.sphere(Vec3::new(0.75, -0.2, 0.1), 0.07, emitter(2.0));
    let pane =
        Material { volume: false, transmission: 0.8, roughness: 0.5, double_sided: true, ..glass };
    let pane = stage.mesh(bowl(4, 0.2), pane);
    let placed = Affine3A::from_translation(Vec3::new(0.0, 0.5, 0.6));
    stage.place(pane, placed * Affine3A::from_scale(Vec3::splat(0.4)));
    stage.scene.environment = Some(sky());
    compare("rough glass", &stage.scene, &small(), Visible { mean: 0.05, tile: 0.2 });
}

/// Specular-glossiness, highlights along tangents of the mesh, of texture coordinates and of a
/// texture, stretched glass, and an unlit sheet that lights them.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn stretched_and_glossy() {
    let mut stage = stage();
    pictures(&mut stage);
    let stretch = Anisotropy { strength: 0.8, rotation: 0.7, texture: None };
    let brushed = Material {
        base_color: Vec3::new(0.8, 0.7, 0.9),
        roughness: 0.35,
        anisotropy: Some(stretch.clone()),
        ..Material::default()
    };
    three_bowls(&mut stage, bowl(5, 0.4), brushed.clone());
    let textured = Anisotropy { texture: values(0), ..stretch };
    let by_texture = Material {
        metallic: 0.4,
        normal_texture: values(1),
        anisotropy: Some(textured.clone()),
        ..brushed
    };
    let mesh = stage.mesh(Mesh { tangents: vec![], ..bowl(4, 0.2) }, by_texture);
    let size = Affine3A::from_scale(Vec3::splat(0.35));
    stage.place(mesh, Affine3A::from_translation(Vec3::new(0.0, 0.6, 0.2)) * size);
    let glossy = Material {
        base_color: Vec3::new(0.3, 0.5, 0.8),
        specular_glossiness: Some(SpecularGlossiness {
            specular: Vec3::new(0.8, 0.5, 0.3),
            glossiness: 0.7,
            texture: Some(srgb(1)),
        }),
        roughness: 1.0,
        ..paint()
    };
    let mesh = stage.mesh(Mesh { tangents: vec![], ..bowl(3, 0.1) }, glossy);
    let floor = Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let below = Affine3A::from_translation(Vec3::new(0.1, -0.4, 0.1));
    stage.place(mesh, below * floor * Affine3A::from_scale(Vec3::new(1.6, 1.6, 1.0)));
    let unlit = Material { unlit: true, base_color_texture: Some(srgb(0)), ..Material::default() };
    let mesh = stage.mesh(bowl(2, 0.1), unlit);
    stage.place(mesh, Affine3A::from_translation(Vec3::new(-0.2, 0.7, -1.2)) * size);
    lights(&mut stage);
    compare("stretched and glossy", &stage.scene, &small(), VISIBLE);
}

/// Rough metal and dielectric with what single scattering loses given back, on both sides.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn energy_compensation() {
    let mut stage = stage();
    let metal = Material { base_color: Vec3::new(1.0, 0.8, 0.5), ..Material::default() };
    three_bowls(&mut stage, Mesh { colors: vec![], ..bowl(5, 0.4) }, metal);
    stage.floor(Vec3::new(0.1, -0.6, 0.1), 1.5, Material { roughness: 0.8, ior: 2.2, ..paint() });
    lights(&mut stage);
    let settings = RenderSettings { energy_compensation: true, ..small() };
    compare("energy compensation", &stage.scene, &settings, VISIBLE);
}

/// Everything at once on one material, coat over cloth over film over a stretched leaf.
#[test]
#[ignore = "tier N: about a minute with the rest of this file, most of it the driver's compiler"]
fn every_lobe_on_one_surface() {
    let mut stage = stage();
    pictures(&mut stage);
    let all = Material {
        base_color_texture: Some(srgb(0)),
        metallic: 0.4,
        roughness: 0.5,
        normal_texture: values(1),
        normal_scale: 0.7,
        transmission: 0.3,
        transmission_texture: values(0),
        specular: 0.9,
        specular_texture: values(2),
        specular_color: Vec3::new(1.5, 0.9, 1.2),
        specular_color_texture: Some(srgb(1)),
        double_sided: true,
        diffuse_transmission: Some(DiffuseTransmission {
            factor: 0.5,
            texture: None,
            color: Vec3::new(0.7, 0.9, 0.3),
            color_texture: None,
        }),
        anisotropy: Some(Anisotropy { strength: 0.6, rotation: -0.4, texture: None }),
        iridescence: Some(film(420.0)),
        sheen: Some(cloth(0.6)),
        clearcoat: Some(Clearcoat { factor: 0.7, ..coat(0.3) }),
        ..Material::default()
    };
    three_bowls(&mut stage, bowl(5, 0.3), all);
    lights(&mut stage);
    compare("every lobe", &stage.scene, &small(), VISIBLE);
}
