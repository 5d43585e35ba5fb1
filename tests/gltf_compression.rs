//! Compressed geometry.

mod gltf_fixture;

use glam::Vec3;
use gltf_fixture::*;
use serde_json::{Value, json};
use steradian::scene::Treatment;

/// A stream of mode ATTRIBUTES, version 0, with every byte in full: `elements` of `STRIDE`
/// bytes each, at most 16.
fn attributes<const STRIDE: usize>(elements: &[[u8; STRIDE]]) -> Vec<u8> {
    let mut stream = vec![0xA0];
    for k in 0..STRIDE {
        stream.push(3);
        let mut before = 0_u8;
        for i in 0..16 {
            let value = elements.get(i).map_or(before, |element| element[k]);
            let delta = value.wrapping_sub(before);
            stream.push((delta << 1) ^ (0_u8.wrapping_sub(delta >> 7)));
            before = value;
        }
    }
    stream.resize(stream.len() + STRIDE.max(32), 0);
    stream
}

/// A triangle whose positions are compressed by the extension; buffer 1 has no data.
fn compressed(extension: &str) -> Fixture {
    let mut fixture = Fixture::triangle();
    let corners: Vec<[u8; 12]> =
        CORNERS.chunks(3).map(|c| bytes_of(c).try_into().unwrap()).collect();
    let stream = attributes(&corners);
    let view = fixture.view(&stream);
    let offset = fixture.json["bufferViews"][view]["byteOffset"].clone();
    fixture.json["bufferViews"][0] = json!({
        "buffer": 1, "byteLength": 36, "byteStride": 12,
        "extensions": {extension: {
            "buffer": 0, "byteOffset": offset, "byteLength": stream.len(),
            "byteStride": 12, "count": 3, "mode": "ATTRIBUTES",
        }},
    });
    let length = fixture.bin_length();
    let fallback = json!({"byteLength": 36, "extensions": {extension: {"fallback": true}}});
    fixture.json["buffers"] = json!([{"byteLength": length}, fallback]);
    fixture.json["extensionsRequired"] = json!([extension]);
    fixture
}

fn object<'a>(fixture: &'a mut Fixture, extension: &str) -> &'a mut Value {
    &mut fixture.json["bufferViews"][0]["extensions"][extension]
}

#[test]
fn meshopt_compression_by_either_name() {
    for extension in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let scene = compressed(extension).scene();
        assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y]);
        assert!(has_notice(&scene, Treatment::Honoured, extension));
    }
}

#[test]
fn a_fallback_buffer_is_not_read() {
    let mut fixture = compressed("EXT_meshopt_compression");
    fixture.json["buffers"][1]["uri"] = json!("absent.bin");
    assert_eq!(fixture.scene().meshes.len(), 1);
    fixture.json["buffers"][1]["extensions"] = json!({});
    assert_contains(&fixture.refusal(), "absent.bin");
}

#[test]
fn broken_compression_is_refused() {
    let name = "EXT_meshopt_compression";
    let refusal = |change: &dyn Fn(&mut Fixture)| {
        let mut fixture = compressed(name);
        change(&mut fixture);
        fixture.refusal()
    };
    let with = |member: &str, value: Value| {
        refusal(&|fixture| object(fixture, name)[member] = value.clone())
    };
    assert_contains(&with("byteLength", json!(40)), "bufferView 0: the compressed stream");
    assert_contains(&with("byteLength", json!(4000)), "goes beyond");
    assert_contains(&with("buffer", json!(7)), "buffer 7, which does not exist");
    assert_contains(&with("buffer", json!(1)), "buffer 1 has no data");
    assert_contains(&with("mode", json!("LINES")), "unknown variant `LINES`");
    assert_contains(&with("count", json!(4)), "compressed elements have 48 bytes");
    assert_contains(&with("byteStride", json!(10)), "byteStride of 10");
    let bomb = refusal(&|fixture| {
        fixture.json["bufferViews"][0]["byteLength"] = json!(3_600_000_000_u32);
        object(fixture, name)["count"] = json!(300_000_000);
    });
    assert_contains(&bomb, "3600000000 bytes of decompressed data; the limit is 1073741824");
}
