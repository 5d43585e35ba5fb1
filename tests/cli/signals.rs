//! A signal ends a render with the partial picture written.
#![cfg(unix)]

use super::pictures::png_text;
use super::{Program, QUAD_LIGHT, read_json};
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use steradian::image::{Attribute, ChannelData, read_exr, read_png};

/// Starts a render that would take days, stops it when it has begun to trace,
/// and gives the exit code.
fn interrupt(program: &Program, signal: &str, picture: &str, more: &[&str]) -> Option<i32> {
    interrupt_saying(program, signal, picture, more).0
}

/// [`interrupt`], and what was said afterwards.
fn interrupt_saying(
    program: &Program,
    signal: &str,
    picture: &str,
    more: &[&str],
) -> (Option<i32>, String) {
    let flags = ["--resolution", "32x32", "--spp", "1000000000", "--stats", "s.json", "-v"];
    let arguments = [&["render", QUAD_LIGHT, "-o", picture], &flags[..], more].concat();
    let mut child = program.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    // The last line before tracing begins.
    while !line.contains("lines of WGSL") {
        line.clear();
        assert!(said.read_line(&mut line).unwrap() > 0, "it ended before it traced");
    }
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    assert!(
        rest.contains(&format!("partial picture {}", picture.split('.').next().unwrap())),
        "{rest}"
    );
    (child.wait().unwrap().code(), rest)
}

#[test]
fn frames_after_a_signal_are_not_begun() {
    let program = Program::new();
    let (code, said) = interrupt_saying(&program, "INT", "a.exr", &["--frames", "4,5,6"]);
    assert_eq!(code, Some(130));
    assert!(said.contains("stopped: 2 frames not begun"), "{said}");
    assert_eq!(program.files(), ["a.0004.exr", "s.0004.json"]);
}

#[test]
fn sigint_writes_the_partial_picture_and_exits_with_130() {
    let program = Program::new();
    assert_eq!(interrupt(&program, "INT", "a.exr", &[]), Some(130));
    let image = read_exr(&program.path("a.exr")).unwrap();
    assert_eq!(image.metadata["steradian.partial"], Attribute::Text("true".into()));
    assert!(image.picture().unwrap().rgb.iter().any(|p| p[0] > 0.0), "nothing was traced");
    let stats = read_json(&program.path("s.json"));
    assert_eq!(stats["partial"], true);
    let samples = stats["samples"].as_u64().unwrap();
    assert!(samples > 0 && samples < 32 * 32 * 1_000_000_000, "{samples}");
    assert_eq!(program.files(), ["a.exr", "s.json"]);
}

#[test]
fn sigterm_writes_the_partial_picture_and_exits_with_143() {
    let program = Program::new();
    assert_eq!(interrupt(&program, "TERM", "a.png", &[]), Some(143));
    let picture = read_png(&program.path("a.png")).unwrap();
    assert_eq!((picture.width, picture.height), (32, 32));
    let chunks = png_text(&program.path("a.png"));
    assert!(chunks.contains(&("steradian.partial".into(), "true".into())), "{chunks:?}");
}

#[test]
fn pixels_that_a_signal_left_are_unfinished() {
    let program = Program::new();
    assert_eq!(interrupt(&program, "INT", "a.exr", &["--noise", "1e-6"]), Some(130));
    let image = read_exr(&program.path("a.exr")).unwrap();
    let Some(ChannelData::U32(reasons)) = image.channel("noise", "stop_reason") else {
        panic!("no reasons in the file");
    };
    let Some(ChannelData::F32(half_widths)) = image.channel("noise", "half_width") else {
        panic!("no half-widths in the file");
    };
    // The limit is far away, and what is lit is not so well known so soon.
    assert!(reasons.iter().all(|&r| r <= 1) && reasons.contains(&0), "{reasons:?}");
    assert!(half_widths.iter().all(|&h| h >= 0.0), "{half_widths:?}");
    let stats = read_json(&program.path("s.json"));
    let unfinished = reasons.iter().filter(|&&r| r == 0).count();
    assert_eq!(stats["stopping"]["unfinished_pixels"], unfinished);
    assert_eq!(stats["stopping"]["pixels_at_limit"], 0);
}
