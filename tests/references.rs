//! Our pictures against those of an independent renderer. How the references were made
//! stands in `tests/references/README.md`.

mod common;

use common::{bundled, render, settings};
use glam::Vec3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use steradian::RenderSettings;
use steradian::image::compare::{ComparisonSettings, NoisyPicture, PictureComparison};
use steradian::image::{Attribute, ChannelData, ExrImage, Picture, read_exr};
use steradian::scene::Scene;
use steradian::statistics::{FALSE_ALARM, Verdict};

/// Runs with seeds of their own, which give the variance.
const RUNS: u32 = 16;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references")
}

/// The entry of a scene in `scenes.json`.
fn entry(name: &str) -> Value {
    let text = std::fs::read_to_string(folder().join("scenes.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let mut entries = json["scenes"].as_array().unwrap().iter();
    entries.find(|entry| entry["name"] == name).expect(name).clone()
}

/// Replaces the materials that the other renderer has no equal of, as the entry says.
fn change_materials(scene: &mut Scene, entry: &Value) {
    let listed = |key: &str, name: &str| {
        entry[key].as_array().is_some_and(|names| names.iter().any(|listed| listed == name))
    };
    for material in &mut scene.materials {
        if listed("matte", &material.name) {
            material.metallic = 0.0;
            material.specular = 0.0;
            material.transmission = 0.0;
        }
        if listed("white", &material.name) {
            material.base_color = Vec3::ONE;
        }
    }
}

/// 64-bit FNV-1a of the scene's files and its entry: a reference is of this scene only.
fn scene_hash(name: &str, entry: &Value) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}/{name}.gltf"));
    let mut bytes = std::fs::read(&path).unwrap();
    let root: Value = serde_json::from_slice(&bytes).unwrap();
    let buffers = root["buffers"].as_array().into_iter().flatten().map(|buffer| &buffer["uri"]);
    let environment = &root["scenes"][0]["extras"]["steradian"]["environment"]["uri"];
    for uri in buffers.chain([environment]).filter_map(Value::as_str) {
        bytes.extend(std::fs::read(path.with_file_name(uri)).unwrap());
    }
    bytes.extend(serde_json::to_string(entry).unwrap().bytes());
    let hash = bytes.iter().fold(0xCBF2_9CE4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    });
    format!("{hash:016x}")
}

/// The stored picture of the other renderer.
///
/// # Panics
/// If it is missing, or of another version of the scene.
fn reference(name: &str, entry: &Value) -> NoisyPicture {
    let path = folder().join(format!("{name}.exr"));
    let file = read_exr(&path).unwrap_or_else(|error| panic!("no reference: {error}"));
    let text = |key: &str| match file.metadata.get(key) {
        Some(Attribute::Text(text)) => text.clone(),
        other => panic!("{name}: attribute {key} is {other:?}"),
    };
    assert_eq!(
        text("scene_hash"),
        scene_hash(name, entry),
        "{name} has changed: render its reference again with tools/make_references.py"
    );
    let variance = layer(&file, "variance");
    NoisyPicture::from_moments(&file.picture().unwrap(), &variance, text("runs").parse().unwrap())
}

fn layer(file: &ExrImage, layer: &str) -> Picture {
    let [r, g, b] = ["R", "G", "B"].map(|name| match file.channel(layer, name) {
        Some(ChannelData::F32(values)) => values,
        other => panic!("channel {layer}.{name} is {other:?}"),
    });
    let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
    Picture::new(file.window.width, file.window.height, rgb)
}

/// Renders the scene with independent seeds and compares it with its reference.
fn compare(name: &str, spp: u32, visible_bias: f64, visible_tile_bias: f64) -> PictureComparison {
    let entry = entry(name);
    let reference = reference(name, &entry);
    let mut scene = bundled(name);
    change_materials(&mut scene, &entry);
    let base = settings(reference.width, reference.height, spp);
    let run = |seed| render(&scene, &RenderSettings { seed, ..base.clone() }).picture();
    let picture = NoisyPicture::of_runs(&(1..=RUNS).map(run).collect::<Vec<_>>());
    let settings = ComparisonSettings {
        level: FALSE_ALARM,
        tiles: (8, 8),
        visible_bias,
        visible_tile_bias,
        rounding: 1e-5,
    };
    let comparison = PictureComparison::of(&picture, &reference, &settings);
    println!("{name}: {comparison}");
    comparison
}

/// Asserts that the scene is its reference, and that relative biases of the whole and of
/// tiles as large as these would show.
#[track_caller]
fn check(name: &str, spp: u32, visible_bias: f64, visible_tile_bias: f64) {
    let comparison = compare(name, spp, visible_bias, visible_tile_bias);
    assert_eq!(comparison.verdict(), Verdict::Agrees, "{name}: {comparison}");
}

#[test]
fn cornell_box() {
    check("cornell-box", 32, 0.015, 0.05);
}

#[test]
fn cornell_spheres_diffuse() {
    check("cornell-spheres-diffuse", 32, 0.015, 0.05);
}

/// Light that mirror and glass focus is found by chance, in a pixel once in some thousand
/// paths. With few paths a pixel without such a find looks certain of too small a
/// mean, and only the mean of the picture can be tested.
#[test]
fn cornell_spheres_mean() {
    let comparison = compare("cornell-spheres", 32, 0.02, 1.0);
    for channel in &comparison.channels {
        assert!(!channel.alarms(&comparison.settings).contains(&"mean"), "{comparison}");
        assert!(channel.visible_bias(&comparison.settings) <= 0.02, "{comparison}");
    }
}

#[test]
#[ignore = "tier N: about 2 minutes"]
fn cornell_spheres() {
    check("cornell-spheres", 1024, 0.01, 0.05);
}

#[test]
fn statue() {
    check("statue", 32, 0.015, 0.1);
}

#[test]
fn environment() {
    check("environment", 32, 0.015, 0.1);
}

#[test]
fn instances() {
    check("instances", 32, 0.015, 0.1);
}
