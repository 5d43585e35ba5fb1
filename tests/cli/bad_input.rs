//! Bad input: one clear line, the documented exit code, no file.

use super::{Program, QUAD_LIGHT, scene, talk};
use std::process::Output;

/// Small, so that a mistake in the checks costs little time.
const SMALL: [&str; 4] = ["--resolution", "8x8", "--spp", "1"];

/// Checks that nothing but one line with each of `words` was said.
fn assert_refused(output: &Output, code: i32, words: &[&str], what: &str) {
    let message = talk(output);
    assert_eq!(output.status.code(), Some(code), "{what}: {message}");
    assert!(output.stdout.is_empty(), "{what}: it wrote to standard output");
    assert!(message.starts_with("error: "), "{what}: {message}");
    assert_eq!(message.lines().count(), 1, "{what}: {message}");
    for word in words {
        assert!(message.contains(word), "{what}: {message:?} does not say {word:?}");
    }
}

#[test]
fn a_bad_command_line_exits_with_2() {
    let program = Program::new();
    let cases: &[&[&str]] = &[
        &[],
        &["rendre"],
        &["render"],
        &["render", QUAD_LIGHT],
        &["render", QUAD_LIGHT, "-o"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--sppp", "4"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--spp", "0"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--spp", "-1"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--resolution", "0x8"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--resolution", "65536x8"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--scale", "0"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--time", "soon"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--strategy", "magic"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--light-samples", "0"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--block", "3"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--crop", "0,0,0,4"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--crop", "0,0,4,4", "--pixel", "0,0"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--aperture", "-1"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--bits", "12"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--threads", "0"],
        &["render", QUAD_LIGHT, "-o", "a.png", "--features", "most"],
        &["render", QUAD_LIGHT, "-o", "a.png", "-q", "-v"],
    ];
    for arguments in cases {
        let output = program.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", talk(&output));
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments:?}");
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}

#[test]
fn settings_that_do_not_fit_the_scene_exit_with_2() {
    let program = Program::new();
    let cases: &[(&[&str], &[&str])] = &[
        (&["-o", "a.jpg"], &["a.jpg", ".png", ".exr"]),
        (&["-o", "picture"], &["picture", ".png", ".exr"]),
        (&["-o", "a.png", "--camera", "99"], &["99", "the scene has 0"]),
        (&["-o", "a.png", "--camera", "nobody"], &["nobody", "the scene has 0"]),
        (&["-o", "a.png", "--crop", "4,4,5,4"], &["crop", "8x8"]),
        (&["-o", "a.png", "--crop", "4294967295,0,4294967295,1"], &["crop", "8x8"]),
        (&["--pixel", "8,0"], &["--pixel 8,0", "8x8"]),
        (&["-o", "a.png", "--scale", "1e6"], &["--scale", "65535"]),
        (&["-o", "a.png", "--scale", "8191.875"], &["65535x65535", "--crop"]),
        (&["-o", "a.png", "--block", "256"], &["256", "128"]),
        (&["-o", "a.png", "--only-bounce", "3", "--max-bounces", "2"], &["--only-bounce 3"]),
        (&["-o", "a.png", "--environment-intensity", "2"], &["no environment"]),
        (&["-o", "a.exr", "--exposure", "1"], &["--exposure", "PNG"]),
        (&["-o", "a.exr", "--tone-map", "agx"], &["--tone-map", "PNG"]),
        (&["-o", "a.png", "--stats", "a.png"], &["same file"]),
    ];
    for (flags, words) in cases {
        let output = program.run(&[&["render", QUAD_LIGHT], &SMALL[..], flags].concat());
        assert_refused(&output, 2, words, &format!("{flags:?}"));
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}

#[test]
fn an_unusable_scene_exits_with_3() {
    let program = Program::new();
    std::fs::write(program.path("empty.glb"), b"").unwrap();
    std::fs::write(program.path("text.gltf"), b"no JSON").unwrap();
    scene::write(&program.path("glitter.gltf"), &scene::triangle_with_unknown_extension());
    let before = program.files();
    let cases: &[(&[&str], &str)] = &[
        (&["missing.gltf"], "missing.gltf"),
        (&["."], "."),
        (&["empty.glb"], "empty.glb"),
        (&["text.gltf"], "text.gltf"),
        (&["glitter.gltf", "--strict"], "KHR_materials_glitter"),
        (&[QUAD_LIGHT, "--environment", "missing.hdr"], "missing.hdr"),
        (&[QUAD_LIGHT, "--environment", "empty.glb"], "empty.glb"),
        (&[QUAD_LIGHT, "--camera", "missing.json"], "missing.json"),
        (&[QUAD_LIGHT, "--camera", "text.gltf"], "text.gltf"),
    ];
    for (arguments, word) in cases {
        let flags = [&["-o", "a.png"], &SMALL[..]].concat();
        let output = program.run(&[&["render"], *arguments, &flags[..]].concat());
        assert_refused(&output, 3, &[word], &format!("{arguments:?}"));
    }
    assert_refused(&program.run(&["info", "empty.glb"]), 3, &["empty.glb"], "info");
    let dump = program.run(&["info", QUAD_LIGHT, "--dump-camera", "99"]);
    assert_refused(&dump, 2, &["--dump-camera 99", "the scene has 0"], "dump");
    assert_eq!(program.files(), before);
}

#[test]
fn an_unwritable_place_exits_with_1_before_anything_is_rendered() {
    let program = Program::new();
    std::fs::write(program.path("file"), b"old").unwrap();
    std::fs::create_dir(program.path("folder.png")).unwrap();
    let before = program.files();
    let mut cases = vec![
        (vec!["-o", "missing/a.png"], "missing"),
        (vec!["-o", "file/a.png"], "file"),
        (vec!["-o", "folder.png"], "folder.png"),
        (vec!["-o", "a.png", "--stats", "missing/a.json"], "missing"),
    ];
    if cfg!(target_os = "linux") {
        // Not even root can make a file here.
        cases.push((vec!["-o", "/proc/a.png"], "/proc"));
    }
    for (flags, word) in &cases {
        // A scene that is not there: the place is looked at first.
        let output = program.run(&[&["render", "missing.gltf"], &flags[..]].concat());
        assert_refused(&output, 1, &[word], &format!("{flags:?}"));
    }
    assert_eq!(program.files(), before);
}

#[test]
fn no_device_exits_with_4_and_says_what_to_install() {
    let program = Program::new();
    let blind = |arguments: &[&str]| {
        let mut command = program.command(arguments);
        for name in ["VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "STERADIAN_DEVICE"] {
            command.env_remove(name);
        }
        command.env("VK_DRIVER_FILES", "/dev/null").output().unwrap()
    };
    let render = [&["render", QUAD_LIGHT, "-o", "a.png"], &SMALL[..]].concat();
    assert_refused(&blind(&render), 4, &["install", "mesa-vulkan-drivers"], "render");
    assert_refused(&blind(&["devices"]), 4, &["install", "mesa-vulkan-drivers"], "devices");
    assert!(program.files().is_empty(), "{:?}", program.files());

    let info = blind(&["info", QUAD_LIGHT]);
    assert_eq!(info.status.code(), Some(0), "{}", talk(&info));
    assert!(String::from_utf8_lossy(&info.stdout).contains("none found"));
}

#[test]
fn a_device_that_is_not_there_exits_with_4_and_lists_those_that_are() {
    let program = Program::new();
    let arguments = [&["render", QUAD_LIGHT, "-o", "a.png"], &SMALL[..]].concat();
    let by_flag = program.run(&[&arguments[..], &["--device", "no such device"]].concat());
    assert_refused(&by_flag, 4, &["no such device", "there are: 0 "], "flag");
    let mut command = program.command(&arguments);
    let by_variable = command.env("STERADIAN_DEVICE", "77").output().unwrap();
    assert_refused(&by_variable, 4, &["77", "there are: 0 "], "variable");
    assert!(program.files().is_empty(), "{:?}", program.files());
}

#[test]
fn a_refused_render_leaves_the_old_picture() {
    let program = Program::new();
    std::fs::write(program.path("a.png"), b"old").unwrap();
    let output = program.run(&["render", QUAD_LIGHT, "-o", "a.png", "--camera", "99"]);
    assert_refused(&output, 2, &["--camera 99"], "camera");
    assert_eq!(std::fs::read(program.path("a.png")).unwrap(), b"old");
    assert_eq!(program.files(), ["a.png"]);
}
