//! A scene of a single triangle, written by the tests.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::path::Path;

/// One grey triangle and two cameras in front of it, named "near" and "far". The
/// triangle covers the middle of the picture and leaves its corners free.
pub(crate) fn triangle() -> Value {
    let corners = [[-1.0_f32, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes));
    let camera = json!({
        "type": "perspective",
        "perspective": { "yfov": 1.0, "znear": 0.1, "aspectRatio": 2.0 }
    });
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [
            { "mesh": 0 },
            { "name": "near", "camera": 0, "translation": [0.0, 0.0, 4.0] },
            { "name": "far", "camera": 0, "translation": [0.0, 0.0, 400.0] }
        ],
        "cameras": [camera],
        "materials": [{ "name": "grey" }],
        "meshes": [{
            "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }]
        }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [-1.0, -1.0, 0.0], "max": [1.0, 1.0, 0.0]
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": uri }]
    })
}

/// As [`triangle`], with an extension that Steradian does not know.
pub(crate) fn triangle_with_unknown_extension() -> Value {
    let mut scene = triangle();
    scene["extensionsUsed"] = json!(["KHR_materials_glitter"]);
    scene["materials"][0]["extensions"] =
        json!({ "KHR_materials_glitter": { "glitterFactor": 1.0 } });
    scene
}

pub(crate) fn write(path: &Path, scene: &Value) {
    std::fs::write(path, scene.to_string()).unwrap();
}
