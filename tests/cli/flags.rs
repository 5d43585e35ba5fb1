//! That flags arrive where they have an effect.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, scene};
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use steradian::image::{ExrImage, Picture, Precision, write_exr};

fn features(stats: &Value) -> Vec<&str> {
    stats["features"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect()
}

/// Radiance of a pixel as printed.
fn radiance(program: &Program, scene: &str, flags: &[&str]) -> [f32; 3] {
    let printed = program.succeed(&[&["render", scene, "-q"], flags].concat());
    let line = printed.lines().find_map(|line| line.strip_prefix("radiance ")).unwrap();
    let values: Vec<f32> = line.split(' ').map(|v| v.parse().unwrap()).collect();
    values.try_into().unwrap()
}

#[test]
fn settings_decide_what_is_compiled() {
    let program = Program::new();
    let small = ["--resolution", "8x8", "--spp", "2"];
    let plain = program.stats(QUAD_LIGHT, &small);
    let plain = features(&plain);
    for feature in ["NEE", "MIS", "ROULETTE", "SOBOL"] {
        assert!(plain.contains(&feature), "{feature} not in {plain:?}");
    }
    assert!(!plain.contains(&"TRANSMISSION"));

    let other = ["--strategy", "hemisphere", "--sampler", "independent", "--accel", "none"];
    let more = ["--no-roulette", "--aperture", "0.01", "--focus", "2"];
    let stats = program.stats(QUAD_LIGHT, &[&small[..], &other, &more].concat());
    let other = features(&stats);
    for feature in ["HEMISPHERE", "BRUTE_FORCE", "LENS"] {
        assert!(other.contains(&feature), "{feature} not in {other:?}");
    }
    for feature in ["NEE", "MIS", "ROULETTE", "SOBOL"] {
        assert!(!other.contains(&feature), "{feature} in {other:?}");
    }
    assert_eq!(stats["nodes"], 0);

    let all = ["--features", "all", "--strategy", "light", "--light-samples", "3"];
    let stats = program.stats(QUAD_LIGHT, &[&small[..], &all, &["--accel", "median"]].concat());
    let all = features(&stats);
    for feature in ["TRANSMISSION", "SPHERES", "LIGHT_ONLY", "MANY_LIGHT_SAMPLES"] {
        assert!(all.contains(&feature), "{feature} not in {all:?}");
    }
    assert!(stats["nodes"].as_u64().unwrap() > 0);
}

/// The terms of one bounce each add up to all light of so many bounces. The paths
/// are the same ones, so what is left is the rounding of f32 sums of 16 samples.
#[test]
fn bounces_add_up() {
    let program = Program::new();
    let pixel = ["--resolution", "8x8", "--spp", "16", "--pixel", "3,3", "--no-roulette"];
    let of = |flags: &[&str]| radiance(&program, FURNACE_BOX, &[&pixel[..], flags].concat());
    let whole = of(&["--max-bounces", "2"]);
    let terms = ["0", "1", "2"].map(|k| of(&["--only-bounce", k]));
    for channel in 0..3 {
        assert!(terms.iter().all(|t| t[channel] > 0.0), "{terms:?}");
        let sum: f32 = terms.iter().map(|t| t[channel]).sum();
        let difference = (sum - whole[channel]).abs();
        assert!(difference <= 64.0 * f32::EPSILON * sum, "{sum} {whole:?}");
    }
}

/// The picture's corner sees nothing but the environment.
#[test]
fn the_environment_is_seen_as_it_is_given() {
    let program = Program::new();
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let corner = ["--resolution", "16x8", "--spp", "4", "--pixel", "0,0"];
    let of = |flags: &[&str]| radiance(&program, "triangle.gltf", &[&corner[..], flags].concat());
    let radiance = ["--environment-radiance", "0.25,0.5,1"];
    assert_eq!(of(&radiance), [0.25, 0.5, 1.0]);
    let brighter = ["--environment-intensity", "4", "--environment-rotation", "-90"];
    assert_eq!(of(&[&radiance[..], &brighter].concat()), [1.0, 2.0, 4.0]);
}

/// The flag turns a map as the scene's own entry does, and away from where it was.
#[test]
fn the_environment_turns_as_in_a_scene_file() {
    let program = Program::new();
    let columns: Vec<[f32; 3]> = (1..=16).map(|x| [x as f32, 0.0, 0.0]).collect();
    let map = ExrImage::from_picture(&Picture::new(16, 2, [&columns[..], &columns].concat()));
    write_exr(&program.path("map.exr"), &map, Precision::Float).unwrap();
    let mut scene = scene::triangle();
    scene::write(&program.path("plain.gltf"), &scene);
    scene["scenes"][0]["extras"] =
        json!({ "steradian": { "environment": { "uri": "map.exr", "rotation": 60.0 } } });
    scene::write(&program.path("turned.gltf"), &scene);

    let corner = ["--resolution", "16x8", "--spp", "4", "--pixel", "0,0"];
    let of = |scene, flags: &[&str]| radiance(&program, scene, &[&corner[..], flags].concat());
    let map = ["--environment", "map.exr"];
    let turned = of("plain.gltf", &[&map[..], &["--environment-rotation", "60"]].concat());
    assert_eq!(turned, of("turned.gltf", &[]));
    assert_ne!(turned, of("plain.gltf", &map));
    assert_eq!(of("plain.gltf", &map), of("turned.gltf", &["--environment-rotation", "0"]));
}

#[test]
fn cameras_go_by_name_and_index() {
    let program = Program::new();
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let light = ["--environment-radiance", "1", "--max-bounces", "0"];
    let middle = ["--resolution", "16x16", "--spp", "4", "--pixel", "8,8"];
    let of = |camera: &str| {
        let flags = [&light[..], &middle, &["--camera", camera]].concat();
        radiance(&program, "triangle.gltf", &flags)
    };
    // Near, the triangle covers the pixel and does not emit; far, it is a
    // hundredth of a pixel.
    assert_eq!(of("near"), [0.0; 3]);
    assert_eq!(of("0"), of("near"));
    assert!(of("far")[0] > 0.5);
    assert_eq!(of("1"), of("far"));
}

/// A camera's file gives its picture, metadata and all; an edited one another.
#[test]
fn a_camera_in_a_file_is_the_scenes() {
    let program = Program::new();
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let render = |camera: &str, name: &str| {
        let flags = ["--scale", "0.05", "--spp", "4", "--environment-radiance", "1"];
        let call = ["render", "triangle.gltf", "--camera", camera, "-o", name];
        program.succeed(&[&call[..], &flags].concat());
        std::fs::read(program.path(name)).unwrap()
    };
    let dumped = program.succeed(&["info", "triangle.gltf", "--dump-camera", "far"]);
    std::fs::write(program.path("far.json"), &dumped).unwrap();
    assert!(render("far.json", "file.exr") == render("1", "index.exr"));
    let nearer = dumped.replace("400.0", "4.0");
    assert_ne!(nearer, dumped);
    std::fs::write(program.path("camera"), nearer).unwrap();
    assert!(render("camera", "near.exr") != render("1", "index.exr"));
}

#[test]
fn time_ends_a_render_without_making_it_partial() {
    let program = Program::new();
    let begin = Instant::now();
    let stats = program.stats(QUAD_LIGHT, &["--resolution", "16x16", "--time", "0.5s"]);
    // Not a bound on speed: without the limit it would run for days.
    assert!(begin.elapsed() >= Duration::from_millis(500));
    assert_eq!(stats["partial"], false);
    assert!(stats["requested_spp"].is_null());
    assert_eq!(stats["block"], 16);
    assert!(stats["samples"].as_u64().unwrap() >= 16 * 16);
    // Whichever comes first.
    let stats = program.stats(
        QUAD_LIGHT,
        &["--resolution", "8x8", "--time", "1h", "--spp", "4", "--threads", "1"],
    );
    assert_eq!([&stats["spp"], &stats["requested_spp"], &stats["block"]], [4, 4, 1]);
}

#[test]
fn devices_are_numbered_lines() {
    let program = Program::new();
    let lines = program.succeed(&["devices"]);
    for (index, line) in lines.lines().enumerate() {
        assert!(line.starts_with(&format!("{index} ")), "{line}");
    }
    assert!(!lines.is_empty());
    let stats = program.stats(QUAD_LIGHT, &["--resolution", "8x8", "--spp", "1", "--device", "0"]);
    assert!(lines.starts_with(&format!("0 {},", stats["device"].as_str().unwrap())), "{lines}");
}

#[test]
fn info_counts_what_is_in_the_scene() {
    let program = Program::new();
    scene::write(&program.path("triangle.gltf"), &scene::triangle());
    let printed = program.succeed(&["info", "triangle.gltf"]);
    for line in [
        "scene         triangle",
        "bounds        -1 -1 0 to 1 1 0 m",
        "meshes        1, placed 1 times",
        "triangles     1, after instancing 1",
        "camera        1 \"far\", perspective, 57.30 degrees high, aspect ratio 2, pinhole",
        "environment   none",
    ] {
        assert!(printed.lines().any(|l| l == line), "no {line:?} in {printed}");
    }
    assert!(printed.contains("the scene fits"), "{printed}");
}

#[test]
fn help_and_version_are_data() {
    let program = Program::new();
    assert!(program.succeed(&["--help"]).contains("Exit codes"));
    assert!(program.succeed(&["render", "--help"]).contains("--strategy"));
    let version = program.succeed(&["--version"]);
    assert_eq!(version, format!("steradian {}\n", env!("CARGO_PKG_VERSION")));
}
