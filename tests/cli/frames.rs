//! Frames of an animation: their names, their times, what is left out.

use super::{Program, read_json, scene, talk};
use std::fs;
use steradian::image::{Picture, read_exr};

const SCENE: &str = "moving.gltf";
const SMALL: [&str; 6] = ["--resolution", "16x16", "--spp", "4", "--environment-radiance", "1"];

fn program() -> Program {
    let program = Program::new();
    scene::write(&program.path(SCENE), &scene::moving_triangle());
    program
}

/// Arguments of a render.
fn render<'a>(flags: &[&'a str]) -> Vec<&'a str> {
    [&["render", SCENE], &SMALL[..], flags].concat()
}

fn picture(program: &Program, name: &str) -> Picture {
    read_exr(&program.path(name)).unwrap().picture().unwrap()
}

#[test]
fn a_frame_is_the_scene_at_its_time_whatever_came_before() {
    let program = program();
    let outputs = ["-o", "a.exr", "--stats", "s.json", "--sample-map", "m-##.png"];
    program.succeed(&render(&[&outputs[..], &["--frames", "0,12,24-48:12"]].concat()));
    let mut names = vec![SCENE.to_owned()];
    for n in [0, 12, 24, 36, 48] {
        names.extend([format!("a.{n:04}.exr"), format!("m-{n:02}.png"), format!("s.{n:04}.json")]);
    }
    names.sort();
    assert_eq!(program.files(), names);
    // From 24 on the triangle is at rest, and its tree is the one of the frame before.
    let kept = |number: &str| {
        read_json(&program.path(&format!("s.{number}.json")))["trees"]["kept"].clone()
    };
    assert_eq!(["0000", "0024", "0036", "0048"].map(kept), [0, 0, 1, 1]);
    let times = [("0012", "12"), ("0036", "36"), ("0048", "48")];
    for (number, frame) in times {
        program.succeed(&render(&["-o", "one.exr", "--frames", frame]));
        let [one, of_many] = ["one.exr".to_owned(), format!("a.{number}.exr")]
            .map(|name| fs::read(program.path(&name)).unwrap());
        assert!(one == of_many, "frame {number} is another alone");
    }
    program.succeed(&render(&["-o", "half.exr", "--frame-time", "0.5"]));
    assert_eq!(picture(&program, "half.exr"), picture(&program, "a.0012.exr"));
    assert_ne!(picture(&program, "a.0000.exr"), picture(&program, "a.0012.exr"));
    assert_ne!(picture(&program, "a.0024.exr"), picture(&program, "a.0036.exr"));
    program.succeed(&render(&["-o", "rate.exr", "--frames", "6", "--fps", "12"]));
    assert_eq!(picture(&program, "rate.exr"), picture(&program, "a.0012.exr"));
    // By default all frames have the same noise.
    program.succeed(&render(&["-o", "seed.exr", "--frames", "12", "--animate-seed"]));
    assert_ne!(picture(&program, "seed.exr"), picture(&program, "a.0012.exr"));
    program.succeed(&render(&["-o", "seed12.exr", "--frame-time", "0.5", "--seed", "12"]));
    assert_eq!(picture(&program, "seed.exr"), picture(&program, "seed12.exr"));
}

#[test]
fn names_have_places_for_scene_camera_and_frame() {
    let program = program();
    fs::create_dir(program.path("near")).unwrap();
    let output = ["-o", "{camera}/{scene}_%03d.png", "--stats", "{camera}/{frame:2}.json"];
    program.succeed(&render(&[&output[..], &["--frames", "1-2"]].concat()));
    let mut names: Vec<_> = fs::read_dir(program.path("near")).unwrap().collect();
    names.sort_by_key(|entry| entry.as_ref().unwrap().file_name());
    let names: Vec<_> =
        names.into_iter().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(names, ["01.json", "02.json", "moving_001.png", "moving_002.png"]);
    program.succeed(&render(&["-o", "{scene}#.png", "--camera", "far"]));
    assert!(program.files().contains(&"moving#.png".to_owned()), "{:?}", program.files());
}

#[test]
fn what_cannot_be_is_refused_before_the_scene_is_read() {
    let program = Program::new();
    let cases: &[(&[&str], &str)] = &[
        (&["-o", "a.png", "--frames", "1-999999999999"], "the largest number"),
        (&["-o", "a.png", "--frames", "1-999999999"], "100000 frames"),
        (&["-o", "a.png", "--frames", "5-1"], "ends before it begins"),
        (&["-o", "a.png", "--frames", "1", "--fps", "0"], "frames in a second"),
        (&["-o", "a.png", "--fps", "25"], "--frames"),
        (&["-o", "a.png", "--frames", "1", "--frame-time", "1"], "--frame-time"),
        (&["-o", "{frame}.png"], "without --frames"),
        (&["-o", "{shot}.png", "--frames", "1"], "places are"),
        (&["-o", "a.####.png", "--sample-map", "a.png", "--frames", "1,2"], "the same file"),
        (&["-o", "a1#.png", "--sample-map", "a#.png", "--frames", "1,11"], "frames 1 and 11"),
        (&["-o", "a.jpg", "--frames", "1,2"], ".png"),
    ];
    for (flags, word) in cases {
        let output = program.run(&[&["render", "missing.gltf"], *flags].concat());
        let said = talk(&output);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        assert!(said.contains(word), "{flags:?}: {said}");
    }
    let output = program.run(&["render", "missing.gltf", "-o", "no/a.png", "--frames", "1,2"]);
    assert_eq!(output.status.code(), Some(1), "{}", talk(&output));
    assert!(program.files().is_empty());
}

/// The last line about frames.
fn tally(program: &Program, flags: &[&str]) -> String {
    let output = program.run(&render(flags));
    let said = talk(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let line = said.lines().find(|line| line.contains("frames rendered")).unwrap();
    line.rsplit_once(',').unwrap().0.to_owned()
}

#[test]
fn frames_that_are_there_are_skipped() {
    let program = program();
    let base = ["-o", "#.png", "--stats", "#.json", "--frames", "1-3", "--skip-existing"];
    let with = |more: &[&'static str]| [&base[..], more].concat();
    let (none, some, all) = (
        "3 frames rendered, 0 skipped",
        "2 frames rendered, 1 skipped",
        "0 frames rendered, 3 skipped",
    );
    assert_eq!(tally(&program, &with(&[])), none);
    let first = fs::read(program.path("1.png")).unwrap();
    assert_eq!(tally(&program, &with(&[])), all);
    // One is cut off, of one the statistics are gone.
    fs::write(program.path("1.png"), &first[..first.len() - 20]).unwrap();
    fs::remove_file(program.path("2.json")).unwrap();
    assert_eq!(tally(&program, &with(&[])), some);
    assert!(fs::read(program.path("1.png")).unwrap() == first, "it is another now");
    // Another render: of settings, of what is shown, of the scene.
    assert_eq!(tally(&program, &with(&["--exposure", "1"])), none);
    assert_eq!(tally(&program, &with(&["--exposure", "1", "--seed", "1"])), none);
    assert_eq!(tally(&program, &with(&["--fps", "12"])), none);
    assert_eq!(tally(&program, &with(&["--fps", "12"])), all);
    let exr = ["-o", "#.exr", "--frames", "1-3", "--skip-existing", "--view", "depth"];
    assert_eq!(tally(&program, &exr), none);
    assert_eq!(tally(&program, &exr), all);
    let cut = fs::read(program.path("3.exr")).unwrap();
    fs::write(program.path("3.exr"), &cut[..cut.len() - 20]).unwrap();
    fs::write(program.path("2.exr"), b"").unwrap();
    assert_eq!(tally(&program, &exr), some);
    assert!(fs::read(program.path("3.exr")).unwrap() == cut);
}
