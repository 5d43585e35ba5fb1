//! `--layers`, and what an EXR says beside its pixels.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, scene, talk};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use steradian::image::{Attribute, ChannelData, ExrImage, read_exr};
use steradian::layers::{float_of_hash, murmur3};

const INVALID: u32 = u32::MAX;

fn exr(program: &Program, name: &str) -> ExrImage {
    read_exr(&program.path(name)).unwrap()
}

fn floats<'a>(image: &'a ExrImage, layer: &str, channel: &str) -> &'a [f32] {
    match image.channel(layer, channel) {
        Some(ChannelData::F32(values)) => values,
        other => panic!("{layer}.{channel}: {other:?}"),
    }
}

fn whole(image: &ExrImage, layer: &str, channel: &str) -> Vec<u32> {
    match image.channel(layer, channel) {
        Some(ChannelData::U32(values)) => values.clone(),
        other => panic!("{layer}.{channel}: {other:?}"),
    }
}

fn matrix(image: &ExrImage, name: &str) -> [f32; 16] {
    match image.metadata[name] {
        Attribute::Matrix(values) => values,
        ref other => panic!("{name}: {other:?}"),
    }
}

/// The triangle with the corners (-1, -1, 0), (1, -1, 0) and (0, 1, 0), from 4 m away on the axis.
fn triangle(program: &Program, flags: &[&str]) -> ExrImage {
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let call = ["render", "triangle.gltf", "-o", "a.exr", "--resolution", "32x16", "--spp", "8"];
    program.succeed(&[&call[..], flags].concat());
    exr(program, "a.exr")
}

#[test]
fn every_layer_of_a_triangle_is_what_geometry_says() {
    let program = Program::new();
    let image = triangle(&program, &["--layers", "all"]);
    let layer = |layer, channel| floats(&image, layer, channel);
    let (coverage, z) = (layer("coverage", "A"), layer("", "Z"));
    let (object, material) = (whole(&image, "id", "object"), whole(&image, "id", "material"));
    let crypto = |channel| layer("CryptoObject00", channel);
    let name = float_of_hash(murmur3(b"node 0"));
    // Half the vertical angle of 1 radian is 8 rows.
    let row_height = 4.0 * 0.5_f32.tan() / 8.0;
    let (mut inside, mut edges) = (0, 0);
    for i in 0..32 * 16 {
        let place = [(i % 32) as f32 - 15.5, 7.5 - (i / 32) as f32].map(|v| v * row_height);
        assert_eq!(layer("uv", "U")[i], 0.0);
        assert_eq!([crypto("g")[i], crypto("a")[i]], [coverage[i], 0.0]);
        if coverage[i] == 0.0 {
            assert_eq!(
                (z[i], layer("P", "X")[i], layer("albedo", "R")[i]),
                (f32::INFINITY, 0.0, 0.0)
            );
            assert_eq!((object[i], material[i], crypto("r")[i]), (INVALID, INVALID, 0.0));
            continue;
        }
        assert_eq!(crypto("r")[i].to_bits(), name.to_bits());
        assert!((z[i] - 4.0).abs() < 1e-5, "pixel {i}: Z {}", z[i]);
        assert_eq!([layer("N", "Z")[i], layer("Ng", "Z")[i], layer("N", "X")[i]], [1.0, 1.0, 0.0]);
        assert_eq!(layer("albedo", "G")[i], 1.0);
        // No mean of a pixel's rays is farther from its centre than half the pixel.
        for (axis, centre) in [("X", place[0]), ("Y", place[1])] {
            let distance = (layer("P", axis)[i] - centre).abs();
            assert!(distance <= 0.5 * row_height + 1e-5, "pixel {i} P.{axis} is {distance} m off");
        }
        inside += usize::from(coverage[i] == 1.0 && object[i] == 0 && material[i] == 0);
        edges += usize::from(coverage[i] < 1.0);
    }
    assert!(inside > 10 && edges > 10, "{inside} pixels inside, {edges} on the edge");
    // 2 m² of the triangle, by the pixels' shares; each of 16 rays may be on the wrong side.
    let area: f32 = coverage.iter().sum::<f32>() * row_height * row_height;
    assert!((area - 2.0).abs() < edges as f32 * row_height * row_height / 16.0, "{area} m²");
}

#[test]
fn variance_is_the_square_of_the_standard_error() {
    let program = Program::new();
    let call = ["render", FURNACE_BOX, "-o", "a.exr", "--resolution", "8x8", "--spp", "16"];
    program.succeed(&[&call[..], &["--layers", "variance"]].concat());
    let image = exr(&program, "a.exr");
    let errors = floats(&image, "noise", "standard_error");
    assert!(errors.iter().all(|e| *e > 0.0));
    let squares: Vec<f32> = errors.iter().map(|e| e * e).collect();
    assert_eq!(floats(&image, "variance", "Y"), squares);
    assert!(image.channel("albedo", "R").is_none());
}

#[test]
fn the_matrices_lead_from_positions_to_pixels() {
    let program = Program::new();
    let image = triangle(&program, &["--layers", "P,Z,id", "--layer-rays", "1"]);
    let times = |p: [f32; 4], m: &[f32; 16]| -> [f32; 4] {
        std::array::from_fn(|c| (0..4).map(|r| p[r] * m[4 * r + c]).sum())
    };
    let (ndc, camera) = (matrix(&image, "worldToNDC"), matrix(&image, "worldToCamera"));
    let mut count = 0;
    for (i, z) in floats(&image, "", "Z").iter().enumerate().filter(|(_, z)| z.is_finite()) {
        let p = ["X", "Y", "Z"].map(|c| floats(&image, "P", c)[i]);
        let point = [p[0], p[1], p[2], 1.0];
        let [x, y, _, w] = times(point, &ndc);
        // In the pixel that it was met in, which is one of 32 by 16.
        assert_eq!([(x / w * 32.0) as usize, (y / w * 16.0) as usize], [i % 32, i / 32]);
        assert!((times(point, &camera)[2] - z).abs() < 1e-5);
        count += 1;
    }
    assert!(count > 20, "{count} pixels");
}

/// Bands, tiles and crops have nothing to do with what is in a pixel. Both the layers that are
/// traced and the file are made in bands of 128 rows of this picture.
#[test]
fn a_crop_has_the_layers_of_the_whole() {
    let program = Program::new();
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let render = |name: &str, flags: &[&str]| {
        let call = ["render", "triangle.gltf", "-o", name, "--resolution", "2048x290"];
        let base = ["--spp", "2", "--block", "1", "--layers", "all", "--layer-rays", "2"];
        program.succeed(&[&call[..], &base, flags].concat());
        exr(&program, name)
    };
    let all = render("whole.exr", &[]);
    let crop = render("crop.exr", &["--crop", "980,120,130,16"]);
    assert_eq!((crop.resolution, crop.window.x, crop.window.y), ((2048, 290), 980, 120));
    let mut count = 0;
    for layer in &crop.layers {
        for (name, data) in &layer.channels {
            let bits = |data: &ChannelData| match data {
                ChannelData::F32(v) => v.iter().map(|v| v.to_bits()).collect(),
                ChannelData::U32(v) => v.clone(),
            };
            let (part, of_all) = (bits(data), bits(all.channel(&layer.name, name).unwrap()));
            for (i, value) in part.iter().enumerate() {
                let same = of_all[(i / 130 + 120) * 2048 + i % 130 + 980];
                assert_eq!(*value, same, "{}.{name} {i}", layer.name);
            }
            count += 1;
        }
    }
    // RGBZ; noise; albedo, N, Ng, P; uv, id; coverage, variance; six levels of four.
    assert_eq!(count, 4 + 2 + 12 + 4 + 2 + 24);
    assert!(floats(&crop, "coverage", "A").contains(&1.0));
}

#[test]
fn the_manifest_names_every_object_and_material() {
    let program = Program::new();
    let image = triangle(&program, &["--layers", "crypto-object,crypto-material"]);
    let mattes = image.metadata.iter().filter(|(name, _)| name.ends_with("/name"));
    let mut names = Vec::new();
    for (attribute, name) in mattes {
        let (key, name) = (attribute.trim_end_matches("name"), name.to_string());
        assert_eq!(
            key,
            format!("cryptomatte/{}/", &format!("{:08x}", murmur3(name.as_bytes()))[..7])
        );
        let of = |what: &str| image.metadata[&format!("{key}{what}")].to_string();
        assert_eq!(
            (of("hash"), of("conversion")),
            ("MurmurHash3_32".into(), "uint32_to_float32".into())
        );
        let manifest: Value = serde_json::from_str(&of("manifest")).unwrap();
        for (thing, hash) in manifest.as_object().unwrap() {
            let bits = float_of_hash(murmur3(thing.as_bytes())).to_bits();
            assert_eq!(hash.as_str().unwrap(), format!("{bits:08x}"));
            names.push(thing.clone());
        }
    }
    assert_eq!(names, ["node 0", "grey"]);
}

#[test]
fn the_same_render_gives_the_same_bytes_unless_times_are_asked_for() {
    let program = Program::new();
    let bytes = |flags: &[&str]| {
        triangle(&program, &[&["--layers", "all"], flags].concat());
        std::fs::read(program.path("a.exr")).unwrap()
    };
    assert!(bytes(&[]) == bytes(&[]));
    let image = triangle(&program, &["--exr-times"]);
    assert!(matches!(image.metadata["renderTimeSeconds"], Attribute::Single(s) if s > 0.0));
    let meta = exr::meta::MetaData::read_from_file(program.path("a.exr"), true).unwrap();
    let date = meta.headers[0].own_attributes.capture_date.clone().unwrap().to_string();
    assert!(date.starts_with("20") && date.len() == "YYYY:MM:DD hh:mm:ss".len(), "{date}");
    let plain = triangle(&program, &[]);
    assert!(!plain.metadata.contains_key("renderTimeSeconds"));
    assert_eq!(plain.metadata["samplesPerPixel"], Attribute::Integer(8));
    assert_eq!(plain.metadata["colorInteropID"].to_string(), "lin_rec709_scene");
    for hash in ["scene_hash", "settings_hash"] {
        assert_eq!(plain.metadata[&format!("steradian.{hash}")].to_string().len(), 16);
    }
}

#[test]
fn half_precision_is_for_the_picture_alone() {
    let program = Program::new();
    let flags = ["--layers", "P", "--environment-radiance", "0.3"];
    let (float, half) = (
        triangle(&program, &flags),
        triangle(&program, &[&flags[..], &["--exr-precision", "half"]].concat()),
    );
    assert_eq!(floats(&half, "P", "Y"), floats(&float, "P", "Y"));
    // Background: 0.3 = 1.2 × 2^-2; 1.2 × 2^10 = 1228.8 rounds to 1229.
    assert_eq!(floats(&half, "", "R")[0], 1229.0 / 4096.0);
    assert_eq!(floats(&float, "", "R")[0], 0.3);
    // What has no 16 bits keeps 32, and this is told.
    let bright = ["-o", "bright.exr", "--exr-precision", "half", "--environment-radiance", "1e5"];
    let small = ["--resolution", "4x4", "--spp", "1"];
    let call = [&["render", "triangle.gltf"], &bright[..], &small].concat();
    let output = program.run(&call);
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    assert!(talk(&output).contains("more than 16 bits can: stored with 32"), "{}", talk(&output));
    let stored = exr(&program, "bright.exr");
    assert_eq!(floats(&stored, "", "R")[0], 1e5);
}

#[test]
fn standard_output_has_the_files_bytes_and_nothing_else() {
    let program = Program::new();
    let small = ["--resolution", "8x8", "--spp", "4"];
    for format in ["png", "exr"] {
        let name = format!("a.{format}");
        program.succeed(&[&["render", QUAD_LIGHT, "-o", &name], &small[..]].concat());
        let piped = ["render", QUAD_LIGHT, "-o", "-", "--format", format];
        let output = program.run(&[&piped[..], &small].concat());
        assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
        assert!(output.stdout == std::fs::read(program.path(&name)).unwrap(), "{format} differs");
    }
    assert_eq!(program.files(), ["a.exr", "a.png"]);
}

#[test]
fn flags_that_make_no_sense_are_refused_before_rendering() {
    let program = Program::new();
    let cases: &[(&[&str], &str)] = &[
        (&["-o", "a.png", "--layers", "N"], "--layers: for an EXR"),
        (&["-o", "a.png", "--exr-precision", "half"], "--exr-precision: for an EXR"),
        (&["-o", "a.exr", "--layers", "normals"], "crypto-material"),
        (&["-o", "a.exr", "--layers", "N", "--reference"], "--reference"),
        (&["-o", "a.exr", "--layers", "N", "--layer-rays", "0"], "--layer-rays"),
        (&["-o", "-"], "--format"),
        (&["-o", "a.exr", "--format", "exr"], "--format"),
        (&["-o", "a.exr", "--layers", "motion"], "--frame-time"),
        (&["-o", "a.exr", "--layers", "N", "--view", "depth"], "--view"),
    ];
    for (flags, word) in cases {
        let output = program.run(&[&["render", QUAD_LIGHT], *flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", talk(&output));
        assert!(talk(&output).contains(word), "{flags:?}: {}", talk(&output));
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}

/// Without the library, whatever is installed: before anything is rendered, with the remedy.
#[test]
fn a_denoiser_that_is_not_there_is_told_of() {
    let program = Program::new();
    for name in ["a.png", "a.exr"] {
        let call = ["render", "missing.gltf", "-o", name, "--denoise", "oidn"];
        let mut command = program.command(&call);
        let output =
            command.env("STERADIAN_OIDN", "/nowhere/libOpenImageDenoise.so").output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", talk(&output));
        let said = talk(&output);
        assert!(said.contains("/nowhere/lib") && said.contains("pyoidn"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    assert!(program.files().is_empty());
}

/// The triangle's scene with an animation of one second that moves `node` by `path`, evenly.
fn moving(node: usize, path: [f32; 3], from: [f32; 3]) -> Value {
    let to: [f32; 3] = std::array::from_fn(|k| from[k] + path[k]);
    let numbers = [&[0.0, 1.0][..], &from, &to].concat();
    let bytes: Vec<u8> = numbers.iter().flat_map(|v: &f32| v.to_le_bytes()).collect();
    let mut scene = scene::triangle();
    let mut push = |member: &str, value: Value| scene[member].as_array_mut().unwrap().push(value);
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes));
    push("buffers", json!({ "byteLength": 32, "uri": uri }));
    push("bufferViews", json!({ "buffer": 1, "byteLength": 8 }));
    push("bufferViews", json!({ "buffer": 1, "byteOffset": 8, "byteLength": 24 }));
    push(
        "accessors",
        json!({
            "bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0.0], "max": [1.0]
        }),
    );
    push(
        "accessors",
        json!({ "bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3" }),
    );
    scene["animations"] = json!([{
        "channels": [{ "sampler": 0, "target": { "node": node, "path": "translation" } }],
        "samplers": [{ "input": 1, "output": 2 }]
    }]);
    scene
}

/// Things and the camera move by known ways between the two times.
#[test]
fn motion_is_what_moves_in_the_picture() {
    let program = Program::new();
    // A pixel's height 4 m away, and a step of a quarter of a second.
    let row_height = 4.0 * 0.5_f32.tan() / 8.0;
    let cases = [
        // The triangle: 0.3 m to the right, 0.6 m down.
        (moving(0, [1.2, -2.4, 0.0], [0.0; 3]), [0.3 / row_height, 0.6 / row_height], [0.0, 0.0]),
        // The camera, by as much: things go the other way, and what is far away stays.
        (
            moving(1, [1.2, -2.4, 0.0], [0.0, 0.0, 4.0]),
            [-0.3 / row_height, -0.6 / row_height],
            [0.0, 0.0],
        ),
    ];
    for (scene, of_hits, of_background) in cases {
        scene::write(&program.path("moving.gltf"), &scene);
        let call = ["render", "moving.gltf", "-o", "a.exr", "--resolution", "32x16", "--spp", "4"];
        let layers = ["--layers", "motion,id", "--frame-time", "0.5", "--motion-step", "0.25"];
        program.succeed(&[&call[..], &layers].concat());
        let image = exr(&program, "a.exr");
        let mut hits = 0;
        for (i, object) in whole(&image, "id", "object").iter().enumerate() {
            let expected = if *object == 0 { of_hits } else { of_background };
            let moved = ["X", "Y"].map(|axis| floats(&image, "motion", axis)[i]);
            let error = (moved[0] - expected[0]).abs().max((moved[1] - expected[1]).abs());
            assert!(error < 1e-4, "pixel {i}, object {object}: {moved:?}, not {expected:?}");
            hits += usize::from(*object == 0);
        }
        assert!(hits > 5, "{hits}");
    }
}
