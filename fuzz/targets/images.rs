//! The images of a material: any bytes, in a scene that is otherwise sound.

#![no_main]

use libfuzzer_sys::fuzz_target;
use serde_json::json;
use steradian_fuzz::{glb, load};

fuzz_target!(|bytes: &[u8]| {
    const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bin: Vec<u8> = TRIANGLE.iter().flat_map(|value| value.to_le_bytes()).collect();
    bin.extend(bytes);
    let scene = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1}, "material": 0}
        ]}],
        "materials": [{
            "alphaMode": "BLEND",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
            "normalTexture": {"index": 0}, "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
        }],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 1}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": bytes.len()},
        ],
        "buffers": [{"byteLength": bin.len()}],
    });
    load(&glb(&scene, &bin));
});
