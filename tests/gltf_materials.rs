//! What the loader makes of materials, textures and extensions.

mod gltf_fixture;

use glam::{Vec2, Vec3};
use gltf_fixture::*;
use serde_json::json;
use std::f32::consts::FRAC_PI_2;
use steradian::scene::{AlphaMode, Treatment, Wrap};

#[test]
fn a_material_with_all_that_is_rendered() {
    let mut fixture = Fixture::with_material(json!({
        "name": "everything", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "emissiveFactor": [1.0, 0.5, 0.0],
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.0,
            "baseColorTexture": {"index": 0},
        },
        "normalTexture": {"index": 0, "scale": 0.5, "extensions": {
            "KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2.0, 3.0]},
        }},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 10.0},
            "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2.0, 1.0, 0.0]},
            "KHR_materials_transmission": {"transmissionFactor": 0.75},
            "KHR_materials_volume": {"thicknessFactor": 0.01},
        },
    }));
    let view = fixture.view(&png());
    fixture.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    fixture.push("samplers", json!({"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}));
    fixture.push("textures", json!({"source": 0, "sampler": 0}));
    let scene = fixture.scene();

    let material = &scene.materials[0];
    assert_eq!(material.name, "everything");
    assert_eq!(material.base_color, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!((material.metallic, material.roughness, material.alpha), (0.5, 0.0, 0.4));
    assert_eq!(material.alpha_mode, AlphaMode::Mask(0.25));
    assert!(material.double_sided && material.volume);
    assert_eq!(material.emission, Vec3::new(10.0, 5.0, 0.0));
    assert_eq!((material.ior, material.specular, material.transmission), (1.33, 0.5, 0.75));
    assert_eq!(material.specular_color, Vec3::new(2.0, 1.0, 0.0));

    let base_color = material.base_color_texture.unwrap();
    assert!(base_color.nearest);
    assert_eq!(base_color.wrap, [Wrap::ClampToEdge, Wrap::MirroredRepeat]);
    let normal = material.normal_texture.unwrap();
    assert_eq!(normal.transform.transform_point2(Vec2::ONE), Vec2::new(2.25, 3.5));
    assert_ne!(normal.color_space, base_color.color_space);
    assert_eq!(material.normal_scale, 0.5);
    // Both slots use the one decoded image.
    assert_eq!(scene.images.len(), 1);
    assert_eq!(scene.images[0].rgba, [[255, 0, 0, 255], [0, 0, 255, 128]]);
    assert!(
        scene.notices.iter().all(|n| n.treatment == Treatment::Honoured),
        "{:?}",
        scene.notices
    );
}

#[test]
fn texture_coordinates_turn_against_the_image() {
    // As in Khronos' TextureTransformTest: a turn by r takes (0, 1) to (sin r, cos r).
    let transform = json!({"rotation": FRAC_PI_2, "texCoord": 1});
    let texture = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let mut fixture = Fixture::with_material(json!({"emissiveTexture": texture}));
    fixture.write("red blue.png", &png());
    fixture.push("images", json!({"uri": "red%20blue.png"}));
    fixture.push("textures", json!({"source": 0}));
    let scene = fixture.scene();
    let texture = scene.materials[0].emission_texture.unwrap();
    assert!(texture.transform.transform_point2(Vec2::Y).distance(Vec2::X) < 1e-6);
    assert_eq!(texture.uv_set, 1);
    assert!(has_notice(&scene, Treatment::Approximated, "without its texture coordinates"));
}

#[test]
fn extensions_have_one_notice_each_and_strict_loading_refuses_them() {
    let mut fixture = Fixture::with_material(json!({
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_ior": {"ior": 1.4}},
    }));
    fixture.push("materials", json!({"extensions": {"KHR_materials_other": {}}}));
    fixture.push("materials", json!({"extensions": {"KHR_materials_other": {}}}));
    let scene = fixture.scene();
    let lines: Vec<_> = scene.notices.iter().map(|n| (n.treatment, n.message.as_str())).collect();
    let expected = [
        (Treatment::Honoured, "KHR_materials_ior (materials[0])"),
        (Treatment::Honoured, "KHR_materials_unlit (materials[0])"),
        (Treatment::Ignored, "KHR_materials_ior of an unlit material (material 0)"),
        (Treatment::Ignored, "extension KHR_materials_other (2 times, first in materials[1])"),
    ];
    assert_eq!(lines, expected);
    let message = fixture.load_strict().unwrap_err().to_string();
    assert_contains(&message, "strict loading refuses");
    assert_contains(&message, "KHR_materials_other");

    fixture.json["materials"] = json!([{"extensions": {"KHR_materials_ior": {"ior": 1.4}}}]);
    fixture.load_strict().unwrap();
}
