//! What the loader makes of each extension of materials, slot by slot, and of hostile values.

mod gltf_fixture;

use glam::{Vec2, Vec3};
use gltf_fixture::*;
use serde_json::{Value, json};
use steradian::scene::gltf::LoadOptions;
use steradian::scene::{ColorSpace, Material, Scene, TextureRef, Treatment};

/// The scene of a triangle with this extension of its material; texture 0 is a PNG.
fn with_extension(name: &str, extension: Value) -> Fixture {
    let mut fixture = Fixture::with_material(json!({"extensions": {name: extension}}));
    let view = fixture.view(&png());
    fixture.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    fixture.push("textures", json!({"source": 0}));
    fixture
}

fn material(name: &str, extension: Value) -> Material {
    let scene = with_extension(name, extension).scene();
    assert!(has_notice(&scene, Treatment::Honoured, name), "{:?}", scene.notices);
    only_honoured(&scene);
    scene.materials[0].clone()
}

#[track_caller]
fn only_honoured(scene: &Scene) {
    let other = scene.notices.iter().find(|n| n.treatment != Treatment::Honoured);
    assert!(other.is_none(), "{other:?}");
}

/// A slot whose transform moves coordinates by (number, 0): a mark by which it is known.
fn slot(number: u32) -> Value {
    let transform = json!({"offset": [number, 0]});
    json!({"index": 0, "extensions": {"KHR_texture_transform": transform}})
}

/// That the slot is that of `number`, in this encoding.
#[track_caller]
fn assert_slot(texture: Option<TextureRef>, number: u32, color_space: ColorSpace) {
    let texture = texture.expect("a texture");
    let offset = texture.transform.transform_point2(Vec2::ZERO);
    assert_eq!((offset, texture.color_space), (Vec2::new(number as f32, 0.0), color_space));
}

use ColorSpace::{Linear, Srgb};

#[test]
fn specular() {
    let m = material(
        "KHR_materials_specular",
        json!({"specularFactor": 0.25, "specularTexture": slot(1),
               "specularColorFactor": [3, 0.5, 0], "specularColorTexture": slot(2)}),
    );
    assert_eq!((m.specular, m.specular_color), (0.25, Vec3::new(3.0, 0.5, 0.0)));
    assert_slot(m.specular_texture, 1, Linear);
    assert_slot(m.specular_color_texture, 2, Srgb);
    let m = material("KHR_materials_specular", json!({}));
    assert_eq!((m.specular, m.specular_color), (1.0, Vec3::ONE));
}

#[test]
fn ior() {
    assert_eq!(material("KHR_materials_ior", json!({"ior": 1.25})).ior, 1.25);
    assert_eq!(material("KHR_materials_ior", json!({})).ior, 1.5);
    // 0 means that everything is reflected.
    let n = material("KHR_materials_ior", json!({"ior": 0})).ior;
    assert_eq!(((n - 1.0) / (n + 1.0)).powi(2), 1.0);
    assert!((n * n).is_finite() && (1.0 / (n * n)).is_normal());
    for (ior, taken) in [(0.5, 1.0), (1e30, n)] {
        let scene = with_extension("KHR_materials_ior", json!({"ior": ior})).scene();
        assert!(has_notice(&scene, Treatment::Approximated, "ior"));
        assert_eq!(scene.materials[0].ior, taken);
    }
}

#[test]
fn clearcoat() {
    let mut normal = slot(3);
    normal["scale"] = json!(0.5);
    let coat = json!({"clearcoatFactor": 0.75, "clearcoatTexture": slot(1),
        "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": slot(2),
        "clearcoatNormalTexture": normal});
    let coat = material("KHR_materials_clearcoat", coat).clearcoat.unwrap();
    assert_eq!((coat.factor, coat.roughness, coat.normal_scale), (0.75, 0.25, 0.5));
    assert_slot(coat.texture, 1, Linear);
    assert_slot(coat.roughness_texture, 2, Linear);
    assert_slot(coat.normal_texture, 3, Linear);
    let off = material("KHR_materials_clearcoat", json!({"clearcoatRoughnessFactor": 0.5}));
    assert!(off.clearcoat.is_none());
}

#[test]
fn sheen() {
    let sheen = json!({"sheenColorFactor": [0.5, 0.25, 1], "sheenColorTexture": slot(1),
        "sheenRoughnessFactor": 0.125, "sheenRoughnessTexture": slot(2)});
    let sheen = material("KHR_materials_sheen", sheen).sheen.unwrap();
    assert_eq!((sheen.color, sheen.roughness), (Vec3::new(0.5, 0.25, 1.0), 0.125));
    assert_slot(sheen.color_texture, 1, Srgb);
    assert_slot(sheen.roughness_texture, 2, Linear);
    assert!(material("KHR_materials_sheen", json!({"sheenRoughnessFactor": 1})).sheen.is_none());
}

#[test]
fn transmission() {
    let extension = json!({"transmissionFactor": 0.5, "transmissionTexture": slot(1)});
    let m = material("KHR_materials_transmission", extension);
    assert_eq!(m.transmission, 0.5);
    assert_slot(m.transmission_texture, 1, Linear);
}

#[test]
fn volume() {
    let volume = |distance: Value, color: [f32; 3]| {
        let mut volume = json!({"thicknessFactor": 1, "attenuationColor": color});
        volume["attenuationDistance"] = distance;
        volume
    };
    // What is left of white light after the distance is the colour.
    let color = [0.5, 0.25, 1.0];
    let m = material("KHR_materials_volume", volume(json!(0.2), color));
    assert!(m.volume);
    let left = (m.absorption * -0.2).exp();
    assert!(left.distance(Vec3::from(color)) < 1e-6, "{left}");
    // Without a distance, and without a thickness, nothing is absorbed.
    let clear = material("KHR_materials_volume", json!({"thicknessFactor": 1}));
    assert_eq!((clear.volume, clear.absorption), (true, Vec3::ZERO));
    let thin = json!({"attenuationDistance": 1, "attenuationColor": [0, 0, 0]});
    let thin = material("KHR_materials_volume", thin);
    assert_eq!((thin.volume, thin.absorption), (false, Vec3::ZERO));

    // The coefficient of black is infinite: a finite one lets nothing through either.
    let scene = with_extension("KHR_materials_volume", volume(json!(1.0), [0.0, 1.0, 1.0])).scene();
    assert!(has_notice(&scene, Treatment::Approximated, "attenuationColor 0"));
    let absorption = scene.materials[0].absorption;
    assert!(absorption.is_finite() && absorption.y == 0.0);
    assert_eq!((absorption.x * -1e-12).exp(), 0.0);
    for distance in [0.0, -1.0] {
        let extension = volume(json!(distance), [0.5; 3]);
        let scene = with_extension("KHR_materials_volume", extension).scene();
        assert!(has_notice(&scene, Treatment::Ignored, "attenuationDistance"));
        assert_eq!(scene.materials[0].absorption, Vec3::ZERO);
    }
    let tiny = with_extension("KHR_materials_volume", volume(json!(1e-40), [0.5; 3])).scene();
    assert!(tiny.materials[0].absorption.is_finite());
    assert!(has_notice(&tiny, Treatment::Approximated, "absorption beyond"));
}

#[test]
fn dispersion() {
    let mut fixture = with_extension("KHR_materials_dispersion", json!({"dispersion": 0.5}));
    assert_eq!(fixture.scene().materials[0].dispersion, 0.0, "only volumes refract");
    fixture.json["materials"][0]["extensions"]["KHR_materials_volume"] =
        json!({"thicknessFactor": 1});
    assert_eq!(fixture.scene().materials[0].dispersion, 0.5);
    only_honoured(&fixture.scene());
}

#[test]
fn iridescence() {
    let film = json!({"iridescenceFactor": 0.5, "iridescenceTexture": slot(1),
        "iridescenceIor": 1.75, "iridescenceThicknessMinimum": 50,
        "iridescenceThicknessMaximum": 800, "iridescenceThicknessTexture": slot(2)});
    let film = material("KHR_materials_iridescence", film).iridescence.unwrap();
    assert_eq!((film.factor, film.ior), (0.5, 1.75));
    assert_eq!((film.thickness_minimum, film.thickness_maximum), (50.0, 800.0));
    assert_slot(film.texture, 1, Linear);
    assert_slot(film.thickness_texture, 2, Linear);
    let film = material("KHR_materials_iridescence", json!({"iridescenceFactor": 1}));
    let film = film.iridescence.unwrap();
    assert_eq!((film.ior, film.thickness_minimum, film.thickness_maximum), (1.3, 100.0, 400.0));
    assert!(material("KHR_materials_iridescence", json!({})).iridescence.is_none());
}

#[test]
fn anisotropy() {
    let lobe = json!({"anisotropyStrength": 0.5, "anisotropyRotation": -1.5,
        "anisotropyTexture": slot(1)});
    let lobe = material("KHR_materials_anisotropy", lobe).anisotropy.unwrap();
    assert_eq!((lobe.strength, lobe.rotation), (0.5, -1.5));
    assert_slot(lobe.texture, 1, Linear);
    assert!(material("KHR_materials_anisotropy", json!({})).anisotropy.is_none());
}

#[test]
fn diffuse_transmission() {
    let lobe = json!({"diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": slot(1),
        "diffuseTransmissionColorFactor": [0.5, 0, 1],
        "diffuseTransmissionColorTexture": slot(2)});
    let lobe = material("KHR_materials_diffuse_transmission", lobe).diffuse_transmission.unwrap();
    assert_eq!((lobe.factor, lobe.color), (0.5, Vec3::new(0.5, 0.0, 1.0)));
    assert_slot(lobe.texture, 1, Linear);
    assert_slot(lobe.color_texture, 2, Srgb);
    let off = material("KHR_materials_diffuse_transmission", json!({}));
    assert!(off.diffuse_transmission.is_none());
}

#[test]
fn specular_glossiness_replaces_the_core_model_and_excludes_others() {
    const NAME: &str = "KHR_materials_pbrSpecularGlossiness";
    let extension = json!({"diffuseFactor": [0.5, 0.25, 1, 0.75], "diffuseTexture": slot(1),
        "specularFactor": [0.25, 0.5, 0], "glossinessFactor": 0.5,
        "specularGlossinessTexture": slot(2)});
    let mut fixture = with_extension(NAME, extension);
    fixture.json["materials"][0]["pbrMetallicRoughness"] =
        json!({"metallicFactor": 1, "metallicRoughnessTexture": slot(9)});
    let scene = fixture.scene();
    only_honoured(&scene);
    let m = &scene.materials[0];
    assert_eq!((m.base_color, m.alpha), (Vec3::new(0.5, 0.25, 1.0), 0.75));
    assert_eq!((m.metallic, m.roughness, m.metallic_roughness_texture), (0.0, 1.0, None));
    assert_slot(m.base_color_texture, 1, Srgb);
    let model = m.specular_glossiness.as_ref().unwrap();
    assert_eq!((model.specular, model.glossiness), (Vec3::new(0.25, 0.5, 0.0), 0.5));
    assert_slot(model.texture, 2, Srgb);

    fixture.json["materials"][0]["extensions"]["KHR_materials_sheen"] =
        json!({"sheenColorFactor": [1, 1, 1]});
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Ignored, "KHR_materials_sheen beside"));
    assert!(scene.materials[0].sheen.is_none());
}

#[test]
fn unlit_wins_over_all_that_scatters_and_emits() {
    let mut fixture = with_extension("KHR_materials_unlit", json!({}));
    let material = &mut fixture.json["materials"][0];
    material["pbrMetallicRoughness"] = json!({"baseColorFactor": [0.5, 0, 1, 0.25],
        "baseColorTexture": slot(1), "roughnessFactor": 0});
    material["emissiveFactor"] = json!([1, 1, 1]);
    material["alphaMode"] = json!("BLEND");
    material["extensions"]["KHR_materials_clearcoat"] = json!({"clearcoatFactor": 1});
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Ignored, "KHR_materials_clearcoat of an unlit"));
    let m = &scene.materials[0];
    assert!(m.unlit && m.clearcoat.is_none());
    assert_eq!((m.base_color, m.alpha), (Vec3::new(0.5, 0.0, 1.0), 0.25));
    assert_eq!((m.emission, m.alpha_mode), (Vec3::ZERO, steradian::scene::AlphaMode::Blend));
    assert_slot(m.base_color_texture, 1, Srgb);
}

#[test]
fn a_variant_changes_the_materials_of_its_primitives() {
    let mut fixture = Fixture::with_material(json!({"name": "default"}));
    fixture.push("materials", json!({"name": "red"}));
    fixture.json["extensions"]["KHR_materials_variants"] =
        json!({"variants": [{"name": "Midnight"}, {"name": "Rust"}]});
    fixture.primitive()["extensions"]["KHR_materials_variants"] =
        json!({"mappings": [{"material": 1, "variants": [1]}]});
    let worn = |variant: Option<&str>| {
        let variant = variant.map(str::to_owned);
        let scene = fixture.load_with(&LoadOptions { variant, ..LoadOptions::default() });
        scene.map(|s| (s.materials[s.meshes[0].material as usize].name.clone(), s.variants))
    };
    let names = vec!["Midnight".to_owned(), "Rust".to_owned()];
    assert_eq!(worn(None).unwrap(), ("default".to_owned(), names.clone()));
    assert_eq!(worn(Some("Midnight")).unwrap().0, "default");
    assert_eq!(worn(Some("Rust")).unwrap(), ("red".to_owned(), names));
    let message = worn(Some("rust")).unwrap_err().to_string();
    assert_contains(&message, "no variant \"rust\"; there are: Midnight, Rust");
    let none = Fixture::triangle();
    let options = LoadOptions { variant: Some("a".into()), ..LoadOptions::default() };
    assert_contains(&none.load_with(&options).unwrap_err().to_string(), "it has none");

    for (mapping, expected) in [
        (json!({"material": 7, "variants": [1]}), "material 7, which does not exist"),
        (json!({"material": 1, "variants": [2]}), "variant 2, which does not exist"),
        (json!({"variants": [1]}), "mapping without a material"),
        (json!({"material": 1, "variants": ["a"]}), "must be an index, not \"a\""),
        (json!(3), "must be an object, not 3"),
    ] {
        fixture.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = json!([mapping]);
        let variant = Some("Rust".into());
        let error = fixture.load_with(&LoadOptions { variant, ..LoadOptions::default() });
        let message = error.unwrap_err().to_string();
        assert_contains(&message, "mesh 0, primitive 0");
        assert_contains(&message, expected);
    }
}

/// Every number of every extension, with wrong types and sizes.
#[test]
fn hostile_numbers_are_refused_with_their_place() {
    let numbers = [
        ("KHR_materials_anisotropy", "anisotropyStrength anisotropyRotation"),
        ("KHR_materials_clearcoat", "clearcoatFactor clearcoatRoughnessFactor"),
        ("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor"),
        ("KHR_materials_dispersion", "dispersion"),
        ("KHR_materials_emissive_strength", "emissiveStrength"),
        ("KHR_materials_ior", "ior"),
        (
            "KHR_materials_iridescence",
            "iridescenceFactor iridescenceIor iridescenceThicknessMinimum \
             iridescenceThicknessMaximum",
        ),
        ("KHR_materials_pbrSpecularGlossiness", "glossinessFactor"),
        ("KHR_materials_sheen", "sheenRoughnessFactor"),
        ("KHR_materials_specular", "specularFactor"),
        ("KHR_materials_transmission", "transmissionFactor"),
        ("KHR_materials_volume", "thicknessFactor attenuationDistance"),
    ];
    for (name, members) in numbers {
        for member in members.split_whitespace() {
            for (value, expected) in [
                (json!("1"), "must be a number, not \"1\""),
                (json!(null), "must be a number, not null"),
                (json!([1]), "must be a number, not [1]"),
                (json!(1e39), "is too large a number"),
                (json!(-1e300), "is too large a number"),
            ] {
                let refusal = with_extension(name, json!({member: value})).refusal();
                assert_contains(&refusal, "material 0: ");
                assert_contains(&refusal, &format!("{name}.{member}"));
                assert_contains(&refusal, expected);
            }
        }
    }
}

#[test]
fn hostile_colours_textures_and_extensions_are_refused_with_their_place() {
    let cases = [
        ("KHR_materials_sheen", json!({"sheenColorFactor": [1, 1]}), "must be 3 numbers"),
        ("KHR_materials_sheen", json!({"sheenColorFactor": {}}), "sheenColorFactor must be 3"),
        ("KHR_materials_specular", json!({"specularColorFactor": [1, "a", 1]}), "be a number"),
        ("KHR_materials_volume", json!({"attenuationColor": [1e40, 1, 1]}), "attenuationColor"),
        ("KHR_materials_clearcoat", json!({"clearcoatTexture": 3}), "clearcoatTexture: invalid"),
        ("KHR_materials_clearcoat", json!({"clearcoatTexture": {}}), "missing field `index`"),
        ("KHR_materials_sheen", json!({"sheenColorTexture": {"index": -1}}), "sheenColorTexture"),
        ("KHR_materials_sheen", json!({"sheenColorTexture": {"index": 5}}), "texture 5, which"),
        ("KHR_materials_sheen", json!("on"), "KHR_materials_sheen must be an object, not \"on\""),
        ("KHR_materials_unlit", json!(null), "material 0"),
    ];
    for (name, extension, expected) in cases {
        let refusal = with_extension(name, extension).refusal();
        assert_contains(&refusal, "material 0");
        assert_contains(&refusal, expected);
    }
    let hostile_transform = |transform: Value| {
        let mut slot = slot(0);
        slot["extensions"]["KHR_texture_transform"] = transform;
        with_extension("KHR_materials_sheen", json!({"sheenColorTexture": slot})).refusal()
    };
    assert_contains(&hostile_transform(json!({"offset": ["a", 0]})), "sheenColorTexture: invalid");
    assert_contains(&hostile_transform(json!({"scale": [1e300, 1]})), "overflows");
    assert_contains(&hostile_transform(json!({"texCoord": 1.5})), "sheenColorTexture: invalid");
}

/// Out of range but finite: brought into range, and said.
#[test]
fn numbers_out_of_range_are_clamped_with_a_notice() {
    let cases = [
        ("KHR_materials_clearcoat", "clearcoatFactor", 2.0),
        ("KHR_materials_transmission", "transmissionFactor", -1.0),
        ("KHR_materials_anisotropy", "anisotropyStrength", 1e30),
        ("KHR_materials_emissive_strength", "emissiveStrength", -1.0),
        ("KHR_materials_iridescence", "iridescenceIor", 0.5),
        ("KHR_materials_iridescence", "iridescenceThicknessMaximum", -3.0),
    ];
    for (name, member, value) in cases {
        let scene = with_extension(name, json!({member: value})).scene();
        assert!(has_notice(&scene, Treatment::Approximated, member), "{member}");
    }
}
