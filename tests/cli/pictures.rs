//! Pictures and what comes with them.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, read_json, scene, talk};
use std::path::Path;
use steradian::image::{
    ChannelData, DisplayTransform, ExrImage, Picture, ToneCurve, read_exr, read_png,
};

const SMALL: [&str; 4] = ["--resolution", "48x40", "--spp", "16"];

fn render(program: &Program, name: &str, flags: &[&str]) {
    program.succeed(&[&["render", FURNACE_BOX, "-o", name], &SMALL[..], flags].concat());
}

fn exr(program: &Program, name: &str) -> ExrImage {
    read_exr(&program.path(name)).unwrap()
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u32; 3] {
    picture.rgb[(y * picture.width + x) as usize].map(f32::to_bits)
}

/// `name` and the values behind it, from the lines of `--pixel`.
fn values<'a>(printed: &'a str, name: &str) -> Vec<&'a str> {
    let mut words = printed.lines().map(|line| line.split(' '));
    let line = words.find_map(|mut w| (w.next() == Some(name)).then_some(w));
    line.unwrap_or_else(|| panic!("no {name} in {printed:?}")).collect()
}

#[test]
fn both_formats_hold_the_picture() {
    let program = Program::new();
    let flags = [&["render", QUAD_LIGHT, "-o", "a.exr"], &SMALL[..]].concat();
    let output = program.run(&flags);
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    assert!(output.stdout.is_empty(), "only data that was asked for goes to standard output");
    let said = talk(&output);
    for word in ["a.exr: 48x40, 16 spp", "samples/s", "rays/s", "estimated relMSE"] {
        assert!(said.contains(word), "{said:?} does not say {word:?}");
    }
    program.succeed(&[&["render", QUAD_LIGHT, "-o", "a.png", "--bits", "16"], &SMALL[..]].concat());
    let (linear, shown) =
        (exr(&program, "a.exr").picture().unwrap(), read_png(&program.path("a.png")).unwrap());
    assert_eq!((shown.width, shown.height), (48, 40));
    assert!(linear.rgb.iter().any(|p| p[1] > 0.0), "the picture is black");
    for (shown, linear) in shown.rgb.iter().flatten().zip(linear.rgb.iter().flatten()) {
        // Half a step of 16 bits, at the steepest place of the curve below.
        assert!((shown - linear.min(1.0)).abs() <= 2.4 / 65535.0, "{shown} {linear}");
    }
}

#[test]
fn exposure_doubles_with_every_stop() {
    let program = Program::new();
    render(&program, "a.png", &["--bits", "16", "--exposure", "-3"]);
    render(&program, "b.png", &["--bits", "16", "--exposure", "-4"]);
    let read = |name| read_png(&program.path(name)).unwrap();
    for (a, b) in read("a.png").rgb.iter().flatten().zip(read("b.png").rgb.iter().flatten()) {
        assert!(*a > 0.0 && (a - 2.0 * b).abs() <= 4.0 / 65535.0, "{a} {b}");
    }
}

/// The file has the curve of what the file without one has.
#[test]
fn a_tone_curve_is_applied_to_the_linear_picture() {
    let program = Program::new();
    render(&program, "linear.exr", &[]);
    let linear = exr(&program, "linear.exr").picture().unwrap();
    let curves =
        [("neutral", ToneCurve::Neutral), ("agx", ToneCurve::Agx), ("aces", ToneCurve::Aces)];
    for (word, tone_curve) in curves {
        let display = DisplayTransform { exposure_ev: 1.0, tone_curve };
        render(&program, "a.png", &["--bits", "16", "--exposure", "1", "--tone-map", word]);
        let shown = read_png(&program.path("a.png")).unwrap();
        for (shown, linear) in shown.rgb.iter().zip(&linear.rgb) {
            for (shown, expected) in shown.iter().zip(display.linear(*linear)) {
                assert!((shown - expected).abs() <= 2.4 / 65535.0, "{word}: {shown} {expected}");
            }
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let program = Program::new();
    for name in ["a.exr", "b.exr", "a.png", "b.png"] {
        render(&program, name, &["--seed", "7"]);
    }
    render(&program, "c.exr", &["--seed", "8"]);
    let bytes = |name: &str| std::fs::read(program.path(name)).unwrap();
    assert!(bytes("a.exr") == bytes("b.exr"), "EXR files differ");
    assert!(bytes("a.png") == bytes("b.png"), "PNG files differ");
    let picture = |name| exr(&program, name).picture().unwrap();
    assert!(picture("a.exr") != picture("c.exr"), "the seed has no effect");
}

#[test]
fn a_crop_is_the_crop_of_the_whole_bit_by_bit() {
    let program = Program::new();
    render(&program, "whole.exr", &[]);
    render(&program, "crop.exr", &["--crop", "5,7,20,11"]);
    let (whole, crop) = (exr(&program, "whole.exr"), exr(&program, "crop.exr"));
    assert_eq!(crop.resolution, (48, 40));
    assert_eq!((crop.window.x, crop.window.y), (5, 7));
    let (whole, crop) = (whole.picture().unwrap(), crop.picture().unwrap());
    assert_eq!((crop.width, crop.height), (20, 11));
    for (x, y) in (0..11).flat_map(|y| (0..20).map(move |x| (x, y))) {
        assert_eq!(pixel(&crop, x, y), pixel(&whole, x + 5, y + 7), "{x},{y}");
    }
}

#[test]
fn a_printed_pixel_is_that_of_the_picture() {
    let program = Program::new();
    render(&program, "whole.exr", &[]);
    let whole = exr(&program, "whole.exr");
    let printed =
        program.succeed(&[&["render", FURNACE_BOX, "--pixel", "31,17"], &SMALL[..]].concat());
    assert_eq!(values(&printed, "pixel"), ["31", "17"]);
    assert_eq!(values(&printed, "samples"), ["16"]);
    let radiance: Vec<u32> =
        values(&printed, "radiance").iter().map(|v| v.parse::<f32>().unwrap().to_bits()).collect();
    assert_eq!(radiance, pixel(&whole.picture().unwrap(), 31, 17));
    let Some(ChannelData::F32(error)) = whole.channel("noise", "standard_error") else {
        panic!("no standard error in the file");
    };
    let printed_error: f32 = values(&printed, "standard_error_of_luminance")[0].parse().unwrap();
    assert!(printed_error > 0.0);
    assert_eq!(printed_error.to_bits(), error[17 * 48 + 31].to_bits());
    assert_eq!(program.files(), ["whole.exr"]);
}

#[test]
fn files_say_what_made_them() {
    let program = Program::new();
    let flags = ["--seed", "9", "--strategy", "light", "--max-bounces", "3"];
    render(&program, "a.exr", &flags);
    render(&program, "a.png", &flags);
    let image = exr(&program, "a.exr");
    let text = |name: &str| image.metadata[name].to_string();
    let chunks = png_text(&program.path("a.png"));
    for (name, value) in [
        ("steradian.version", env!("CARGO_PKG_VERSION")),
        ("steradian.scene", "furnace-box"),
        ("steradian.spp", "16"),
        ("steradian.seed", "9"),
        ("steradian.strategy", "light"),
        ("steradian.max_bounces", "3"),
        ("steradian.only_bounce", "none"),
        ("steradian.partial", "false"),
    ] {
        assert_eq!(text(name), value, "{name}");
        assert!(chunks.contains(&(name.into(), value.into())), "{name}: {chunks:?}");
    }
    assert!(!text("steradian.device").is_empty() && !text("steradian.driver").is_empty());
    let Some(ChannelData::U32(samples)) = image.channel("noise", "samples") else {
        panic!("no sample counts in the file");
    };
    assert!(samples.len() == 48 * 40 && samples.iter().all(|n| *n == 16));
}

/// Keywords and texts of a PNG.
pub(crate) fn png_text(path: &Path) -> Vec<(String, String)> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    let chunks = &reader.info().utf8_text;
    chunks.iter().map(|c| (c.keyword.clone(), c.get_text().unwrap())).collect()
}

#[test]
fn statistics_are_complete_and_consistent() {
    let program = Program::new();
    let stats = program.stats(FURNACE_BOX, &SMALL);
    assert_eq!(stats["schema"], 1);
    assert_eq!(stats["scene"], "furnace-box");
    assert_eq!([&stats["width"], &stats["height"], &stats["spp"]], [48, 40, 16]);
    let samples = 48 * 40 * 16;
    assert_eq!(stats["samples"], samples);
    assert!(stats["rays_closest"].as_u64().unwrap() >= samples);
    assert!(stats["rays_any"].as_u64().unwrap() > 0);
    for time in ["load_seconds", "bvh_seconds", "compile_seconds", "render_seconds"] {
        assert!(stats[time].as_f64().unwrap() > 0.0, "{time}");
    }
    assert!(stats["estimated_relmse"].as_f64().unwrap() > 0.0);
    assert!(!stats["device"].as_str().unwrap().is_empty());
    assert!(!stats["driver"].as_str().unwrap().is_empty());
    let faults = stats["faults"].as_object().unwrap();
    assert!(faults.len() == 4 && faults.values().all(|n| *n == 0), "{faults:?}");
    assert!(stats["features"].as_array().unwrap().iter().any(|f| f == "TRIANGLES"));
    assert_eq!(stats["partial"], false);
    // One block tells nothing of the error.
    let one = program.stats(FURNACE_BOX, &["--resolution", "8x8", "--spp", "4", "--block", "4"]);
    assert!(one["estimated_relmse"].is_null());
}

#[test]
fn what_is_not_honoured_is_said_unless_quiet() {
    let program = Program::new();
    let path = program.path("glitter.gltf");
    scene::write(&path, &scene::triangle_with_unknown_extension());
    let flags = ["render", "glitter.gltf", "-o", "a.png", "--scale", "0.02", "--stats", "s.json"];
    let output = program.run(&flags);
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    assert!(
        talk(&output).contains("ignored: extension KHR_materials_glitter"),
        "{}",
        talk(&output)
    );
    // 512 rows and the camera's aspect ratio of 2, scaled.
    let stats = read_json(&program.path("s.json"));
    assert_eq!([&stats["width"], &stats["height"]], [20, 10]);

    let quiet = program.run(&[&flags[..], &["-q"]].concat());
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stderr.is_empty() && quiet.stdout.is_empty(), "{}", talk(&quiet));
    let info = program.succeed(&["info", "glitter.gltf"]);
    assert!(info.contains("ignored       extension KHR_materials_glitter"), "{info}");
}
