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

/// As [`triangle`], moving: within a second by 1 along x. The camera "near" moves with it for the
/// second second.
pub(crate) fn moving_triangle() -> Value {
    let mut scene = triangle();
    let times = [0.0_f32, 1.0, 2.0];
    let triangle = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let camera = [[0.0_f32, 0.0, 4.0], [0.0, 0.0, 4.0], [1.0, 0.0, 4.0]];
    let floats = times.into_iter().chain(triangle.into_iter().chain(camera).flatten());
    let bytes: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes));
    let list = |name: &str| scene[name].as_array().unwrap().clone();
    let mut buffers = list("buffers");
    buffers.push(json!({ "byteLength": bytes.len(), "uri": uri }));
    let mut views = list("bufferViews");
    let mut accessors = list("accessors");
    for (view, (offset, size)) in [(0, 12), (12, 36), (48, 36)].into_iter().enumerate() {
        views.push(json!({ "buffer": 1, "byteOffset": offset, "byteLength": size }));
        let kind = if view == 0 { "SCALAR" } else { "VEC3" };
        accessors.push(json!({
            "bufferView": 1 + view, "componentType": 5126, "count": 3, "type": kind
        }));
    }
    accessors[1]["min"] = json!([0.0]);
    accessors[1]["max"] = json!([2.0]);
    scene["buffers"] = json!(buffers);
    scene["bufferViews"] = json!(views);
    scene["accessors"] = json!(accessors);
    scene["animations"] = json!([{
        "samplers": [{ "input": 1, "output": 2 }, { "input": 1, "output": 3 }],
        "channels": [
            { "sampler": 0, "target": { "node": 0, "path": "translation" } },
            { "sampler": 1, "target": { "node": 1, "path": "translation" } }
        ]
    }]);
    scene
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
