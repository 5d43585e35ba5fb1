//! Materials that each show one lobe, and some that show many.

use glam::Vec3;
use steradian::scene::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, Sheen, SpecularGlossiness,
};

/// A white dielectric.
pub(super) fn paint(roughness: f32) -> Material {
    Material { metallic: 0.0, roughness, ..Material::default() }
}

pub(super) fn metal(roughness: f32) -> Material {
    Material { roughness, ..Material::default() }
}

/// Clear, solid.
pub(super) fn glass(roughness: f32, ior: f32) -> Material {
    Material { transmission: 1.0, volume: true, ior, ..paint(roughness) }
}

pub(super) fn coat(factor: f32, roughness: f32) -> Option<Clearcoat> {
    Some(Clearcoat {
        factor,
        texture: None,
        roughness,
        roughness_texture: None,
        normal_texture: None,
        normal_scale: 1.0,
    })
}

pub(super) fn sheen(color: Vec3, roughness: f32) -> Option<Sheen> {
    Some(Sheen { color, color_texture: None, roughness, roughness_texture: None })
}

pub(super) fn film(factor: f32, ior: f32, thickness: f32) -> Option<Iridescence> {
    Some(Iridescence {
        factor,
        texture: None,
        ior,
        thickness_minimum: 100.0,
        thickness_maximum: thickness,
        thickness_texture: None,
    })
}

pub(super) fn stretched(strength: f32, rotation: f32) -> Option<Anisotropy> {
    Some(Anisotropy { strength, rotation, texture: None })
}

pub(super) fn leaf(factor: f32, color: Vec3) -> Option<DiffuseTransmission> {
    Some(DiffuseTransmission { factor, texture: None, color, color_texture: None })
}

/// Name, material, and whether it has no Lambert lobe under a dielectric: glTF's mix of the two
/// makes light near grazing, because each takes Fresnel's factor at another angle.
pub(super) fn all() -> Vec<(&'static str, Material, bool)> {
    let black = Material { base_color: Vec3::ZERO, specular: 0.0, ..paint(1.0) };
    let tinted = Vec3::new(0.9, 0.5, 0.2);
    vec![
        ("rough glass", glass(0.55, 1.5), true),
        ("rough water", glass(0.75, 1.33), true),
        ("rough diamond", glass(0.4, 2.4), true),
        ("rough pane", Material { volume: false, ..glass(0.55, 1.5) }, true),
        ("stretched glass", Material { anisotropy: stretched(0.7, 0.4), ..glass(0.5, 1.5) }, true),
        (
            "half rough glass",
            Material { transmission: 0.5, base_color: tinted, ..glass(0.6, 1.5) },
            false,
        ),
        (
            "glass with coloured reflection",
            Material { specular: 0.8, specular_color: tinted, ..glass(0.5, 1.6) },
            true,
        ),
        ("clear glass, half white", Material { transmission: 0.5, ..glass(0.0, 1.5) }, false),
        ("leaf", Material { diffuse_transmission: leaf(0.6, tinted), ..paint(0.5) }, false),
        (
            "leaf without reflection",
            Material { specular: 0.0, diffuse_transmission: leaf(0.6, Vec3::ONE), ..paint(0.5) },
            true,
        ),
        (
            "leaf and rough pane",
            Material {
                transmission: 0.5,
                volume: true,
                diffuse_transmission: leaf(0.5, tinted),
                ..paint(0.6)
            },
            false,
        ),
        ("stretched metal", Material { anisotropy: stretched(0.8, 0.7), ..metal(0.4) }, true),
        ("stretched mirror", Material { anisotropy: stretched(1.0, 0.0), ..metal(0.32) }, true),
        ("film on metal", Material { iridescence: film(1.0, 1.3, 400.0), ..metal(0.5) }, true),
        (
            "film on a pane",
            Material { volume: false, iridescence: film(0.8, 1.8, 550.0), ..glass(0.5, 1.5) },
            true,
        ),
        ("velvet", Material { sheen: sheen(Vec3::ONE, 0.3), ..black.clone() }, true),
        ("fine velvet", Material { sheen: sheen(Vec3::ONE, 0.1), ..black.clone() }, true),
        ("felt on metal", Material { sheen: sheen(tinted, 0.7), ..metal(0.6) }, true),
        ("coat on metal", Material { clearcoat: coat(1.0, 0.4), ..metal(0.6) }, true),
        ("clear coat on metal", Material { clearcoat: coat(0.8, 0.0), ..metal(0.5) }, true),
        ("coat on a mirror", Material { clearcoat: coat(1.0, 0.5), ..metal(0.0) }, true),
        (
            "specular and glossiness",
            Material {
                base_color: tinted,
                specular_glossiness: Some(SpecularGlossiness {
                    specular: Vec3::new(0.3, 0.4, 0.5),
                    glossiness: 0.4,
                    texture: None,
                }),
                ..paint(1.0)
            },
            false,
        ),
        (
            "everything",
            Material {
                metallic: 0.3,
                base_color: tinted,
                transmission: 0.5,
                volume: true,
                diffuse_transmission: leaf(0.4, Vec3::ONE),
                anisotropy: stretched(0.5, 0.3),
                iridescence: film(0.5, 1.4, 300.0),
                sheen: sheen(Vec3::splat(0.4), 0.5),
                clearcoat: coat(0.7, 0.3),
                ..paint(0.5)
            },
            false,
        ),
    ]
}

pub(super) fn materials() -> Vec<Material> {
    all().into_iter().map(|(_, m, _)| m).collect()
}
