//! Every exit code that the README lists, with what is said. 130 and 143 are in `signals`.
#![cfg(unix)]

use super::{CORNELL_BOX, Program, QUAD_LIGHT, talk};
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

const SMALL: [&str; 5] = ["--resolution", "8x8", "--spp", "4", "-q"];

fn render<'a>(scene: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", scene, "-o", output], &SMALL[..], more].concat()
}

/// One line, and this code.
fn ends(output: &Output, code: i32, word: &str) {
    let said = talk(output);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(word), "{word}: {said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn from_0_to_4() {
    let program = Program::new();
    let run = |arguments: &[&str]| program.run(arguments);
    assert_eq!(run(&render(QUAD_LIGHT, "a.png", &[])).status.code(), Some(0));
    fs::write(program.path("file"), "").unwrap();
    ends(&run(&render(QUAD_LIGHT, "file/a.png", &[])), 1, "file");
    ends(&run(&render(QUAD_LIGHT, "a.gif", &[])), 2, "a.gif");
    fs::write(program.path("bad.gltf"), "{}").unwrap();
    ends(&run(&render("bad.gltf", "b.png", &[])), 3, "bad.gltf");

    let mut command = program.command(&render(QUAD_LIGHT, "b.png", &[]));
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, program.path("no-driver.json"));
    }
    ends(&command.output().unwrap(), 4, "install a Vulkan driver");
    assert_eq!(program.files(), ["a.png", "bad.gltf", "file"]);
}

/// What no retry helps is told apart from what one may.
#[test]
fn memory_that_is_not_there_is_3_and_memory_that_is_taken_is_75() {
    let program = Program::new();
    let large = ["--resolution", "256x256", "--spp", "4", "-q"];
    let arguments = [&["render", QUAD_LIGHT, "-o", "a.png"], &large[..]].concat();
    let drill =
        |what: &str| program.command(&arguments).env("STERADIAN_DRILL", what).output().unwrap();
    ends(&drill("memory@8"), 3, "8.0 MiB is all there is; render parts with --crop");
    ends(&drill("memory@64,free-memory@8"), 75, "8.0 MiB is free now; try again later");
    assert_eq!(program.files(), [""; 0]);
    let output = drill("memory@64");
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    ends(&drill("memory"), 2, "STERADIAN_DRILL");
}

/// A scheduler's signal that comes while trees are built and shaders compiled costs nothing: the same
/// command is to be run again. (Where the machine is so slow that it comes later, the code is the same.)
#[test]
fn sigterm_before_the_first_sample_is_75_with_a_checkpoint() {
    let program = Program::new();
    let flags = ["--resolution", "16x16", "--spp", "1000000000", "-v", "--checkpoint", "c.film"];
    let arguments = [&["render", CORNELL_BOX, "-o", "a.png"], &flags[..]].concat();
    let mut child = program.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("device") {
        line.clear();
        assert!(said.read_line(&mut line).unwrap() > 0, "it ended before");
    }
    let kill = format!("kill -TERM {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(75));
}

/// The device is lost twice, and there is no third time.
#[test]
fn a_device_that_stays_lost_is_75() {
    let program = Program::new();
    let mut command = program.command(&render(CORNELL_BOX, "a.png", &["--block", "1"]));
    let output = command.env("STERADIAN_DRILL", "lose-device@1,lose-device@2").output().unwrap();
    assert_eq!(output.status.code(), Some(75), "{}", talk(&output));
    assert!(talk(&output).lines().last().unwrap().contains("for the second time"));
    assert_eq!(program.files(), [""; 0]);
}
