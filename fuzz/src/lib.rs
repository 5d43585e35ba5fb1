//! What the fuzz targets share: how bytes become a scene, and what must hold of every
//! scene that the loader accepts.

pub mod edit;
// The library's own sources, without what stands on a device.
#[path = "../../src/error.rs"]
pub mod error;
#[path = "../../src/scene/mod.rs"]
pub mod scene;
#[path = "../../src/image/srgb.rs"]
mod srgb;

/// Of the module of this name, what reading scenes needs.
mod image {
    pub(crate) use super::srgb::*;
}

pub use error::{Error, Result};

use scene::gltf::{LoadOptions, load_bytes};
use scene::{Mesh, Scene};
use serde_json::Value;
use std::path::Path;

/// Loads a scene as the program does. Whatever is in the bytes, this returns, and what it
/// accepts makes sense.
pub fn load(bytes: &[u8]) {
    match load_bytes(Path::new("fuzz.glb"), None, bytes, &LoadOptions::default()) {
        Ok(scene) => check(&scene),
        Err(error) => assert_eq!(error.exit_code(), 3, "{error}"),
    }
}

/// Asserts what later stages rely on.
pub fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        check_mesh(mesh);
        assert!((mesh.material as usize) < scene.materials.len());
    }
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
        assert!(instance.world_from_object.is_finite());
    }
    for sphere in &scene.spheres {
        assert!(sphere.center.is_finite() && sphere.radius > 0.0 && sphere.radius.is_finite());
        assert!((sphere.material as usize) < scene.materials.len());
    }
    for image in &scene.images {
        assert_eq!(image.rgba.len() as u64, u64::from(image.width) * u64::from(image.height));
    }
    for material in &scene.materials {
        assert!(material.textures().all(|t| (t.image as usize) < scene.images.len()));
        let mut material = material.clone();
        material.name.clear();
        let numbers = format!("{material:?}");
        assert!(!numbers.contains("NaN"), "{numbers}");
        assert!(material.emission.is_finite() && material.base_color.is_finite());
    }
    for light in &scene.lights {
        assert!(light.intensity.is_finite() && light.intensity.min_element() >= 0.0);
        let numbers = format!("{:?}", light.kind);
        assert!(!numbers.contains("NaN"), "{numbers}");
    }
    for camera in &scene.cameras {
        assert!(camera.world_from_camera.is_finite(), "{camera:?}");
        assert!(camera.focus_distance > 0.0 && camera.focus_distance.is_finite(), "{camera:?}");
    }
    assert!(!scene.cameras.is_empty());
    let (low, high) = scene.bounds().expect("an accepted scene has something to draw");
    assert!(low.is_finite() && high.is_finite());
}

fn check_mesh(mesh: &Mesh) {
    let count = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < count));
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    let is_optional = |length: usize| length == 0 || length == count;
    assert!(is_optional(mesh.normals.len()) && is_optional(mesh.tangents.len()));
    assert!(is_optional(mesh.colors.len()) && mesh.uvs.iter().all(|set| is_optional(set.len())));
    assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    assert!(mesh.uvs.iter().flatten().all(|uv| uv.is_finite()));
    assert!(mesh.colors.iter().all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0));
}

/// The bytes of a GLB.
pub fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let padded = bin.len().next_multiple_of(4);
    let mut bytes = b"glTF".to_vec();
    for word in [2, 12 + 8 + text.len() + 8 + padded, text.len()] {
        bytes.extend((word as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((padded as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(bin);
    bytes.resize(bytes.len() + padded - bin.len(), 0);
    bytes
}

/// The JSON and the binary chunk of a GLB or of a JSON text, as far as they can be told.
pub fn split(bytes: &[u8]) -> Option<(Value, Vec<u8>)> {
    if !bytes.starts_with(b"glTF") {
        return Some((serde_json::from_slice(bytes).ok()?, Vec::new()));
    }
    let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
    let end = length.checked_add(20)?;
    let json = serde_json::from_slice(bytes.get(20..end)?).ok()?;
    Some((json, bytes.get(end.checked_add(8)?..).unwrap_or_default().to_vec()))
}
