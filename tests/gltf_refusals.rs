//! What the loader refuses, and that the message names the object at fault.

mod gltf_fixture;

use gltf_fixture::*;
use serde_json::{Value, json};
use std::path::Path;
use steradian::scene::Environment;
use steradian::scene::gltf::{LoadOptions, load, load_bytes, load_with};

#[test]
fn a_missing_file_a_folder_and_an_empty_file() {
    let fixture = Fixture::empty();
    let missing = load(&fixture.folder.path().join("absent.glb")).unwrap_err();
    assert_contains(&missing.to_string(), "absent.glb: cannot be read");
    assert_eq!(missing.exit_code(), 3);
    assert_contains(&load(fixture.folder.path()).unwrap_err().to_string(), "is not a file");
    let empty = fixture.write("empty.gltf", b"");
    assert_contains(&load(&empty).unwrap_err().to_string(), "empty.gltf: the file is empty");
}

#[test]
fn every_truncation_of_a_glb() {
    let fixture = Fixture::triangle();
    let glb = fixture.glb();
    for length in 0..glb.len() {
        let path = fixture.write("cut.glb", &glb[..length]);
        assert!(load(&path).is_err(), "accepted with {length} of {} bytes", glb.len());
    }
    load(&fixture.write("whole.glb", &glb)).unwrap();
}

#[test]
fn text_that_is_no_gltf_2() {
    let fixture = Fixture::empty();
    let message =
        |text: &str| load(&fixture.write("x.gltf", text.as_bytes())).unwrap_err().to_string();
    assert_contains(&message("{\"asset\""), "not glTF 2.0: EOF while parsing");
    assert_contains(&message("{}"), "no asset object");
    assert_contains(&message(r#"{"asset": {"version": "1.0"}}"#), "asset.version is \"1.0\"");
    let newer = r#"{"asset": {"version": "2.1", "minVersion": "2.1"}}"#;
    assert_contains(&message(newer), "needs glTF \"2.1\"");
    let wide = r#"{"asset": {"version": "2.0"}, "scene": 4294967296}"#;
    assert_contains(&message(wide), "4294967296 does not fit 32 bits");
    let deep = format!("{{\"asset\": {}1{}}}", "[".repeat(5000), "]".repeat(5000));
    assert_contains(&message(&deep), "recursion limit");
}

#[test]
fn nothing_to_render() {
    assert_contains(&Fixture::empty().refusal(), "nothing to render");
    let mut fixture = Fixture::triangle();
    fixture.json["scenes"][0]["nodes"] = json!([]);
    assert_contains(&fixture.refusal(), "nothing to render");
    let mut fixture = Fixture::triangle();
    fixture.json["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 0});
    assert_contains(&fixture.refusal(), "nothing to render");
}

#[test]
fn a_vertex_index_out_of_range() {
    let mut fixture = Fixture::triangle();
    fixture.json["meshes"][0]["name"] = json!("Chair");
    fixture.indices(&[0, 1, 3]);
    assert_contains(
        &fixture.refusal(),
        "scene.glb: mesh 0 \"Chair\", primitive 0: index 3 exceeds the 3 vertices",
    );
}

#[test]
fn positions_that_are_not_finite_or_too_far_away() {
    for value in [f32::NAN, f32::INFINITY] {
        let mut fixture = Fixture::triangle();
        let positions = fixture.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, value, 0.0, 0.0, 1.0, 0.0]);
        fixture.attribute("POSITION", positions);
        let message = fixture.refusal();
        assert_contains(&message, "mesh 0, primitive 0, POSITION: element 1 is [1.0, ");
    }
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["scale"] = json!([1e15, 1.0, 1.0]);
    assert_contains(&fixture.refusal(), "node 0: its geometry reaches");
}

#[test]
fn accessors_that_do_not_fit() {
    let broken = |member: &str, value: Value| {
        let mut fixture = Fixture::triangle();
        fixture.json["accessors"][0][member] = value;
        fixture.refusal()
    };
    assert_contains(&broken("count", json!(4)), "go beyond the 36 bytes of the bufferView");
    assert_contains(&broken("byteOffset", json!(4)), "from byte 4 go beyond");
    assert_contains(&broken("byteOffset", json!(u32::MAX)), "go beyond");
    assert_contains(&broken("bufferView", json!(7)), "bufferView 7, which does not exist");
    assert_contains(&broken("type", json!("VEC2")), "its type Vec2 must be one of [Vec3]");
    assert_contains(&broken("type", json!("VEC9")), "unknown componentType or type");
    let bomb = broken("count", json!(4_000_000_000_u32));
    assert_contains(&bomb, "the limit is 16777216");

    let mut fixture = Fixture::triangle();
    fixture.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    fixture.json["accessors"][0]["count"] = json!(10_000_000);
    assert_contains(&fixture.refusal(), "attributes without data; the limit is 4194304");
}

#[test]
fn an_accessor_that_does_not_exist() {
    let mut fixture = Fixture::triangle();
    fixture.attribute("POSITION", 9);
    assert_contains(&fixture.refusal(), "POSITION refers to accessor 9, which does not exist");
}

#[test]
fn attributes_of_different_lengths() {
    for (name, kind) in [("NORMAL", "VEC3"), ("TEXCOORD_1", "VEC2"), ("TANGENT", "VEC4")] {
        let mut fixture = Fixture::triangle();
        let accessor = fixture.floats(kind, &[1.0; 12]);
        fixture.json["accessors"][accessor]["count"] = json!(2);
        fixture.attribute(name, accessor);
        assert_contains(&fixture.refusal(), &format!("{name} has 2 elements for 3 vertices"));
    }
}

#[test]
fn strides_views_and_buffers_that_do_not_fit() {
    let mut fixture = Fixture::triangle();
    fixture.json["bufferViews"][0]["byteStride"] = json!(8);
    assert_contains(&fixture.refusal(), "byteStride 8 is less than the 12 bytes");

    let mut fixture = Fixture::triangle();
    fixture.json["bufferViews"][0]["byteStride"] = json!(u32::MAX);
    assert_contains(&fixture.refusal(), "go beyond the 36 bytes");

    let mut fixture = Fixture::triangle();
    fixture.json["bufferViews"][0]["byteLength"] = json!(40);
    assert_contains(&fixture.refusal(), "goes beyond the 36 bytes of buffer 0");

    let mut fixture = Fixture::triangle();
    fixture.json["buffers"] = json!([{"byteLength": 37}]);
    assert_contains(&fixture.refusal(), "buffer 0 should have 37 bytes, its data has 36");
    fixture.json["buffers"] = json!([{"byteLength": 32}]);
    assert_contains(&fixture.refusal(), "goes beyond the 32 bytes of buffer 0");
}

#[test]
fn sparse_indices_out_of_range_or_order() {
    for (indices, expected) in [([1, 3], "index 3 exceeds"), ([2, 2], "they must rise")] {
        let mut fixture = Fixture::triangle();
        let indices = fixture.view(&indices);
        let values = fixture.view(&bytes_of(&[1.0; 6]));
        fixture.json["accessors"][0]["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE},
            "values": {"bufferView": values},
        });
        assert_contains(&fixture.refusal(), expected);
        fixture.json["accessors"][0]["sparse"]["count"] = json!(4);
        assert_contains(&fixture.refusal(), "replaces 4 of 3 elements");
    }
}

#[test]
fn node_cycles_and_second_parents() {
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["children"] = json!([0]);
    assert_contains(&fixture.refusal(), "node 0 refers to node 0, which is already in the scene");

    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["children"] = json!([1]);
    fixture.push("nodes", json!({"children": [0]}));
    assert_contains(&fixture.refusal(), "nodes must form trees");

    let mut fixture = Fixture::triangle();
    fixture.node(json!({"children": [0]}));
    assert_contains(&fixture.refusal(), "nodes must form trees");

    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["children"] = json!([5]);
    assert_contains(&fixture.refusal(), "node 0 refers to node 5, which does not exist");
}

#[test]
fn a_very_deep_tree_is_walked_without_a_stack() {
    let mut fixture = Fixture::empty();
    let positions = fixture.floats("VEC3", &CORNERS);
    fixture.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}}]}));
    let depth = 100_000;
    let chain = (0..depth).map(|i| json!({"children": [i + 1], "translation": [1.0, 0.0, 0.0]}));
    fixture.json["nodes"] = chain.chain([json!({"mesh": 0})]).collect();
    fixture.json["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(fixture.scene().instances[0].world_from_object.translation.x, depth as f32);
}

#[test]
fn transforms_that_are_none() {
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["rotation"] = json!([0.0, 0.0, 0.0, 0.0]);
    assert_contains(&fixture.refusal(), "node 0: its rotation");
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["matrix"] = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    assert_contains(&fixture.refusal(), "the last row of its matrix");
}

#[test]
fn buffers_outside_the_scene_folder() {
    let refusal = |uri: &str| {
        let mut fixture = Fixture::triangle();
        fixture.json["buffers"] = json!([{"byteLength": 36, "uri": uri}]);
        fixture.refusal()
    };
    assert_contains(&refusal("../scene.bin"), "buffer 0: the URI \"../scene.bin\" leaves");
    assert_contains(&refusal("file:///etc/passwd"), "only relative paths and data: URIs");
    assert_contains(&refusal("%FF.bin"), "does not decode to UTF-8");
    assert_contains(&refusal("absent.bin"), "the file \"absent.bin\" cannot be read");
}

#[test]
fn images_that_are_missing_damaged_or_out_of_the_buffer() {
    let with_image = |image: Value| {
        let texture = json!({"baseColorTexture": {"index": 0}});
        let mut fixture = Fixture::with_material(json!({"pbrMetallicRoughness": texture}));
        fixture.push("images", image);
        fixture.push("textures", json!({"source": 0}));
        fixture
    };
    let missing = with_image(json!({"uri": "wood.png"}));
    assert_contains(&missing.refusal(), "image 0: the file \"wood.png\" cannot be read");

    let mut beyond = with_image(json!({"bufferView": 2, "mimeType": "image/png"}));
    beyond.push(
        "bufferViews",
        json!({"buffer": 0, "byteOffset": 4_000_000_000_u32, "byteLength": 8}),
    );
    assert_contains(
        &beyond.refusal(),
        "image 0: bufferView 2 (offset 4000000000, length 8) goes beyond",
    );

    let no_picture = with_image(json!({"uri": "data:image/png;base64,AAAA"}));
    assert_contains(&no_picture.refusal(), "image 0: it is none of PNG, JPEG, WebP and KTX2");

    let cut = with_image(json!({"uri": "cut.png"}));
    cut.write("cut.png", &png()[..40]);
    assert_contains(&cut.refusal(), "image 0: ");

    // A header that claims 30000 × 30000 pixels is refused before anything is decoded.
    let bomb = with_image(json!({"uri": "bomb.png"}));
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x75\x30\0\0\x75\x30\x08\x06\0\0\0".to_vec();
    bytes.extend(b"\x66\x27\xf8\xba\0\0\0\0IDAT\x35\xaf\x06\x1e");
    bomb.write("bomb.png", &bytes);
    assert_contains(&bomb.refusal(), "has 900000000 pixels of images; the limit is 268435456");

    let mut fixture = missing;
    fixture.json["textures"][0]["source"] = json!(3);
    assert_contains(&fixture.refusal(), "image 3, which does not exist");
}

#[test]
fn an_extension_that_is_required_and_not_supported() {
    let mut fixture = Fixture::triangle();
    fixture.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    fixture.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_contains(&fixture.refusal(), "requires the extension \"KHR_draco_mesh_compression\"");
}

#[test]
fn spheres_that_are_none() {
    let sphere = |radius: Value, node: Value| {
        let mut fixture = Fixture::triangle();
        let extras = json!({"steradian": {"sphere": {"radius": radius}}});
        fixture.json["meshes"][0]["extras"] = extras;
        fixture.json["nodes"][0] = node;
        fixture
    };
    let node = json!({"mesh": 0, "name": "ball"});
    for radius in [json!(0.0), json!(-1.0), json!(1e39)] {
        assert_contains(&sphere(radius, node.clone()).refusal(), "mesh 0: the sphere's radius is");
    }
    let text = sphere(json!("large"), node.clone()).refusal();
    assert_contains(&text, "mesh 0: extras.steradian cannot be read");

    let stretched = json!({"mesh": 0, "name": "ball", "scale": [1.0, 1.0, 1.0001]});
    let message = sphere(json!(1.0), stretched).refusal();
    assert_contains(&message, "node 0 \"ball\": an analytic sphere cannot be scaled");
    assert_contains(&message, "use the same scale on all axes");
    let sheared = [1.0, 0.0, 0.0, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let sheared = json!({"mesh": 0, "matrix": sheared});
    assert_contains(&sphere(json!(1.0), sheared).refusal(), "or sheared");
    // Differences of rounding are not an ellipsoid.
    let rounded = json!({"mesh": 0, "scale": [1.0, 1.0, 1.000001]});
    sphere(json!(1.0), rounded).load().unwrap();
}

#[test]
fn cameras_that_cannot_see() {
    let camera = |camera: Value| {
        let mut fixture = Fixture::triangle();
        fixture.push("cameras", camera);
        fixture.node(json!({"camera": 0}));
        fixture.refusal()
    };
    let perspective = |yfov: f32| {
        camera(json!({"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.1}}))
    };
    assert_contains(&perspective(0.0), "camera 0: yfov is 0");
    assert_contains(&perspective(4.0), "camera 0: yfov is 4");
    assert_contains(&camera(json!({"type": "perspective"})), "needs an object perspective");
    let flat = json!({"xmag": 1.0, "ymag": 0.0, "znear": 0.1, "zfar": 1.0});
    let flat = json!({"type": "orthographic", "orthographic": flat});
    assert_contains(&camera(flat), "xmag and ymag must be above 0");
    let lens = json!({
        "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1},
        "extras": {"steradian": {"apertureRadius": -1.0}},
    });
    assert_contains(&camera(lens), "apertureRadius must not be negative");
}

#[test]
fn environments_that_cannot_be_used() {
    let environment = |environment: Value| {
        let mut fixture = Fixture::triangle();
        fixture.json["scenes"][0]["extras"] = json!({"steradian": {"environment": environment}});
        fixture
    };
    assert_contains(
        &environment(json!({"uri": "../sky.hdr"})).refusal(),
        "leaves the scene's folder",
    );
    assert_contains(&environment(json!({})).refusal(), "needs either uri or radiance");
    let negative = json!({"radiance": [-1.0, 0.0, 0.0]});
    assert_contains(&environment(negative).refusal(), "must be finite and not negative");
    let misspelt = environment(json!({"radiance": [1.0, 1.0, 1.0], "rotatoin": 3.0}));
    assert_contains(&misspelt.refusal(), "unknown field `rotatoin`");
    let no_map = environment(json!({"uri": "sky.hdr"}));
    no_map.write("sky.hdr", b"not a picture");
    assert_contains(&no_map.refusal(), "sky.hdr: is neither a Radiance .hdr nor an OpenEXR file");
}

#[test]
fn a_file_named_without_a_folder_is_found() {
    // Its folder is the working directory, where the package's own files are.
    let message = load(Path::new("Cargo.toml")).unwrap_err().to_string();
    assert_contains(&message, "Cargo.toml: not glTF 2.0");
}

/// What f32 arithmetic cannot trace is refused with the limit, and what it can is not.
#[test]
fn a_scene_too_large_or_too_small() {
    let scaled = |factor: f32| {
        let mut fixture = Fixture::triangle();
        fixture.json["nodes"][0]["scale"] = json!([factor, factor, factor]);
        fixture
    };
    assert_contains(&scaled(1e12).refusal(), "m from the origin; the limit is");
    assert_contains(&scaled(2e-13).refusal(), "m large; the least is");
    for factor in [1e-11, 1.0, 1e11] {
        assert!(scaled(factor).load().is_ok(), "{factor}");
    }
}

/// What fuzzing started from and what it found: the corpus and the findings in `fuzz/`.
#[test]
fn inputs_of_the_fuzz_targets_end_well() {
    let files = |folder: &str| -> Vec<_> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz").join(folder);
        let entries = std::fs::read_dir(&folder).into_iter().flatten();
        entries.map(|entry| entry.unwrap().path()).collect()
    };
    let mut count = 0;
    for path in [files("corpus/gltf"), files("findings/gltf")].concat() {
        let bytes = std::fs::read(&path).unwrap();
        if let Err(error) = load_bytes(&path, None, &bytes, &LoadOptions::default()) {
            assert_eq!(error.exit_code(), 3, "{error}");
        }
        count += 1;
    }
    for path in [files("corpus/images"), files("findings/images")].concat() {
        let mut fixture = Fixture::with_material(json!({
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}
        }));
        let view = fixture.view(&std::fs::read(&path).unwrap());
        fixture.push("images", json!({"bufferView": view}));
        fixture.push("textures", json!({"source": 0}));
        if let Err(error) = fixture.load() {
            assert_eq!(error.exit_code(), 3, "{error}");
        }
        count += 1;
    }
    for path in [files("corpus/environments"), files("findings/environments")].concat() {
        let bytes = std::fs::read(&path).unwrap();
        if let Err(error) = Environment::from_bytes(&path, &bytes) {
            assert_eq!(error.exit_code(), 3, "{error}");
        }
        count += 1;
    }
    assert!(count >= 40, "{count} files");
}

#[test]
fn nodes_that_go_round_in_a_circle_without_a_scene() {
    let mut fixture = Fixture::triangle();
    fixture.json.as_object_mut().unwrap().remove("scenes");
    fixture.json.as_object_mut().unwrap().remove("scene");
    assert!(fixture.load().is_ok());
    for child in [2, 1] {
        fixture.push("nodes", json!({"children": [child]}));
    }
    assert_contains(&fixture.refusal(), "no root leads to node 1; nodes must form trees");
}

#[test]
fn text_of_the_file_does_nothing_to_a_terminal() {
    let mut fixture = Fixture::triangle();
    fixture.json["materials"] = json!([{"alphaMode": "\u{1b}[31m\nred"}]);
    let sphere = json!({"steradian": {"\u{1b}[2J": 1}});
    fixture.json["meshes"][0]["extras"] = sphere;
    assert!(!fixture.refusal().contains(char::is_control));
    fixture.json["extensionsRequired"] = json!(["\u{1b}[31m".repeat(10_000)]);
    let message = fixture.refusal();
    assert!(!message.contains(char::is_control) && message.len() < 10_000, "{}", message.len());
}

#[test]
fn numbers_that_f32_does_not_hold() {
    let node = |member: &str, value: Value| {
        let mut fixture = Fixture::triangle();
        fixture.json["nodes"][0][member] = value;
        fixture.refusal()
    };
    assert_contains(&node("translation", json!([1e39, 0, 0])), "node 0: its transform overflows");
    assert_contains(&node("scale", json!([1, 1, 1e39])), "node 0: its transform overflows");
    assert_contains(&node("rotation", json!([0, 0, 0, 1e39])), "node 0: its rotation");
    let matrix = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1e39, 0, 0, 1]);
    assert_contains(&node("matrix", matrix), "node 0: its transform overflows");
    for name in ["TEXCOORD_0", "COLOR_0"] {
        let mut fixture = Fixture::triangle();
        let kind = if name == "COLOR_0" { "VEC3" } else { "VEC2" };
        let width = if name == "COLOR_0" { 3 } else { 2 };
        let values = [&vec![0.0; 2 * width][..], &vec![f32::NAN; width]].concat();
        let accessor = fixture.floats(kind, &values);
        fixture.attribute(name, accessor);
        assert_contains(&fixture.refusal(), "element 2 is [NaN");
    }
}

#[test]
fn a_folder_that_the_user_allows() {
    let mut fixture = Fixture::triangle();
    let other = tempfile::tempdir().unwrap();
    std::fs::write(other.path().join("x.bin"), bytes_of(&CORNERS)).unwrap();
    let uri = other.path().join("x.bin").to_str().unwrap().replace(' ', "%20");
    fixture.json["buffers"] = json!([{"byteLength": 36, "uri": uri}]);
    assert_contains(&fixture.refusal(), "absolute path");
    let path = fixture.write("scene.glb", &fixture.glb());
    let options =
        LoadOptions { allow_external: vec![other.path().into()], ..LoadOptions::default() };
    load_with(&path, &options).unwrap();
    let absent = LoadOptions { allow_external: vec!["/nowhere".into()], ..LoadOptions::default() };
    assert_contains(&load_with(&path, &absent).unwrap_err().to_string(), "/nowhere");
}
