//! `--view`: false colours and numbers.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, talk};
use steradian::image::{ChannelData, read_exr, read_png};

const SMALL: [&str; 4] = ["--resolution", "16x12", "--spp", "4"];

#[test]
fn every_view_is_a_picture_and_numbers() {
    let program = Program::new();
    let of_film = ["--noise", "20%"];
    let views: [(&str, &[&str], &str, &str); 11] = [
        ("normals", &[], "normals", "Z"),
        ("geometric-normals", &[], "geometric_normals", "X"),
        ("albedo", &[], "albedo", "R"),
        ("depth", &[], "depth", "Z"),
        ("uv", &[], "uv", "U"),
        ("material", &[], "material", "id"),
        ("node-visits", &[], "node_visits", "nodes"),
        ("sample-count", &[], "sample_count", "samples"),
        ("standard-error", &[], "standard_error", "luminance"),
        ("stop-reason", &of_film, "stop_reason", "reason"),
        ("non-finite", &[], "faults", "non_finite"),
    ];
    for (view, flags, layer, channel) in views {
        for name in ["a.png", "a.exr"] {
            let call = ["render", FURNACE_BOX, "-o", name, "--view", view];
            program.succeed(&[&call[..], &SMALL, flags].concat());
        }
        let picture = read_png(&program.path("a.png")).unwrap();
        assert_eq!((picture.width, picture.height), (16, 12), "{view}");
        let image = read_exr(&program.path("a.exr")).unwrap();
        let Some(data) = image.channel(layer, channel) else {
            panic!("{view}: no channel {layer}.{channel}")
        };
        let zeros = match data {
            ChannelData::F32(v) => v.iter().all(|v| *v == 0.0),
            ChannelData::U32(v) => v.iter().all(|v| *v == 0),
        };
        // One material without texture coordinates, seen everywhere, and no fault.
        let is_zero = ["uv", "material", "non-finite"].contains(&view);
        assert_eq!(zeros, is_zero, "{view}: {data:?}");
    }
}

#[test]
fn a_view_goes_with_the_flags_that_have_a_meaning() {
    let program = Program::new();
    let cases: &[(&[&str], &str)] = &[
        (&["--view", "depth", "--stats", "s.json"], "--stats"),
        (&["--view", "depth", "--noise", "5%"], "--noise"),
        (&["--view", "depth", "--reference"], "--reference"),
        (&["--view", "stop-reason"], "--noise"),
        (&["--view", "depth", "--exposure", "1"], "--exposure"),
        (&["--view", "light"], "light"),
    ];
    for (flags, word) in cases {
        let call = ["render", QUAD_LIGHT, "-o", "a.png", "--resolution", "8x8"];
        let output = program.run(&[&call[..], flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", talk(&output));
        assert!(talk(&output).contains(word), "{flags:?}: {}", talk(&output));
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}
