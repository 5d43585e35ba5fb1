//! `render --reference`: no device takes part.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, read_json, talk};
use std::process::Output;
use steradian::image::read_exr;

/// Runs where the Vulkan loader finds no driver at all.
fn run_without_device(program: &Program, arguments: &[&str]) -> Output {
    let mut command = program.command(arguments);
    let nowhere = program.path("no-driver.json");
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, &nowhere);
    }
    command.output().unwrap()
}

const SMALL: [&str; 4] = ["--resolution", "12x10", "--spp", "64"];

#[test]
fn it_needs_no_device() {
    let program = Program::new();
    let base = ["render", QUAD_LIGHT, "-o", "a.exr", "--stats", "a.json"];
    let flags = [&base[..], &SMALL].concat();
    let output = run_without_device(&program, &flags);
    assert_eq!(output.status.code(), Some(4), "a device was found: {}", talk(&output));
    let output = run_without_device(&program, &[&flags[..], &["--reference"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));

    let stats = read_json(&program.path("a.json"));
    assert_eq!(stats["device"], "reference, f64 on the processor");
    assert_eq!([&stats["strategy"], &stats["driver"]], ["reference", ""]);
    assert_eq!([&stats["spp"], &stats["samples"]], [64, 64 * 120]);
    assert!(stats["rays_closest"].as_u64().unwrap() >= 64 * 120);
    let image = read_exr(&program.path("a.exr")).unwrap();
    // quad-light's truth, and 3.9 standard errors of the whole picture's mean.
    let (mean, truth) = (stats["mean_luminance"].as_f64().unwrap(), 0.478912940921547);
    let error = mean * (stats["estimated_relmse"].as_f64().unwrap() / 120.0).sqrt();
    assert!((mean - truth).abs() <= 3.9 * error && error < 0.01 * truth, "{mean} ± {error}");
    assert_eq!(image.picture().unwrap().rgb.len(), 120);
}

#[test]
fn crops_pixels_and_seeds_work_as_with_a_device() {
    let program = Program::new();
    let render = |name: &str, flags: &[&str]| {
        let base = ["render", FURNACE_BOX, "--reference", "-o", name];
        let output = run_without_device(&program, &[&base[..], &SMALL, flags].concat());
        assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
        read_exr(&program.path(name)).unwrap().picture().unwrap().rgb
    };
    let (whole, other) = (render("a.exr", &[]), render("b.exr", &["--seed", "1"]));
    assert!(whole != other, "the seed has no effect");
    let crop = render("c.exr", &["--crop", "3,2,5,4"]);
    for (i, pixel) in crop.iter().enumerate() {
        assert_eq!(*pixel, whole[(2 + i / 5) * 12 + 3 + i % 5], "{i}");
    }
    let flags = ["render", FURNACE_BOX, "--reference", "--pixel", "4,3"];
    let output = run_without_device(&program, &[&flags[..], &SMALL].concat());
    let printed = String::from_utf8(output.stdout).unwrap();
    let [r, g, b] = whole[3 * 12 + 4];
    assert!(printed.contains(&format!("radiance {r:?} {g:?} {b:?}\n")), "{printed}");
}

#[test]
fn flags_without_meaning_are_refused() {
    let program = Program::new();
    let cases: [&[&str]; 6] = [
        &["--strategy", "mis"],
        &["--sampler", "sobol"],
        &["--light-samples", "1"],
        &["--accel", "bvh"],
        &["--features", "all"],
        &["--no-roulette"],
    ];
    for flags in cases {
        let base = ["render", QUAD_LIGHT, "-o", "a.exr", "--reference"];
        let output = program.run(&[&base[..], flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        let said = talk(&output);
        let first = said.lines().next().unwrap_or_default();
        assert!(first.contains(flags[0]) && first.contains("--reference"), "{said}");
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}
