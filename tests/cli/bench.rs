//! `steradian bench`: what it reports, not how fast anything is.

use super::{FURNACE_BOX, Program, QUAD_LIGHT, read_json, talk};
use serde_json::Value;

/// Little work: the figures mean nothing, their form does.
const SMALL: [&str; 6] = ["--resolution", "8x8", "--spp", "4,16", "--runs", "3"];

/// The part of a report with that heading, at any depth.
fn section<'a>(report: &'a Value, title: &str) -> &'a Value {
    let inner = report["sections"].as_array().unwrap();
    inner
        .iter()
        .find(|s| s["title"] == title)
        .unwrap_or_else(|| panic!("no section {title}: {report}"))
}

/// Every table has as many cells in a row as columns.
fn assert_tables(section: &Value) {
    for table in section["tables"].as_array().unwrap() {
        let columns = table["columns"].as_array().unwrap().len();
        let rows = table["rows"].as_array().unwrap();
        assert!(!rows.is_empty(), "{table}");
        assert!(rows.iter().all(|r| r.as_array().unwrap().len() == columns), "{table}");
    }
    section["sections"].as_array().unwrap().iter().for_each(assert_tables);
}

#[test]
fn the_curves_of_two_scenes() {
    let program = Program::new();
    let files = ["--json", "b.json", "--report", "b.html", "--markdown", "b.md"];
    let flags = [&["bench", QUAD_LIGHT, FURNACE_BOX][..], &SMALL, &files].concat();
    let printed = program.succeed(&flags);
    assert!(printed.starts_with("# Speed against error\n"), "{printed}");
    let report = read_json(&program.path("b.json"));
    assert_tables(&report);
    for name in ["quad-light", "furnace-box"] {
        let data = &section(&report, name)["data"];
        assert_eq!(data["resolution"], serde_json::json!([8, 8]));
        let [method, shared] = &data["methods"].as_array().unwrap()[..] else { panic!("{data}") };
        assert_eq!(method["name"], "default");
        assert_eq!(shared["name"], "path reuse");
        let points = method["points"].as_array().unwrap();
        for (point, spp) in points.iter().zip([4.0, 16.0]) {
            assert_eq!(point["samples"], spp);
            let runs = point["runs"].as_array().unwrap();
            assert_eq!(runs.len(), 3);
            for run in runs {
                let error = run["error"].as_f64().unwrap();
                assert!(error.abs() < 1.0, "{run}");
                assert!(run["wall"].as_f64().unwrap() > 0.0 && run["cpu"].as_f64().unwrap() > 0.0);
            }
        }
        assert_eq!(points.len(), 2);
        // The runs have seeds of their own.
        let of = |k: usize| &points[0]["runs"][k]["error"];
        assert!(of(0) != of(1) && of(1) != of(2), "{method}");
        assert_eq!(method["rays"]["samples"], 8 * 8 * 16);
        // Every path looks for a nearest hit at least once.
        assert!(method["rays"]["closest"].as_u64().unwrap() >= 8 * 8 * 16);
        // What its own variance adds is known, and small beside what it is to measure.
        let reference = data["references"][0]["relmse"].as_f64().unwrap();
        let mean = |k: usize| {
            let runs = points[k]["runs"].as_array().unwrap();
            runs.iter().map(|r| r["error"].as_f64().unwrap()).sum::<f64>() / runs.len() as f64
        };
        assert!(reference > 0.0 && reference < mean(0), "{reference} {}", mean(0));
        assert!(mean(1) < mean(0), "{} {}", mean(0), mean(1));
        assert!(program.path("b").join(format!("{name}-wall.svg")).is_file());
    }
    let html = std::fs::read_to_string(program.path("b.html")).unwrap();
    assert!(html.contains("<svg") && html.contains("quad-light") && !html.contains("<script"));
    let text = std::fs::read_to_string(program.path("b.md")).unwrap();
    assert!(text.contains("(b/furnace-box-cpu.svg)"), "{text}");
}

/// A scene whose time is over has the least number of runs all the same.
#[test]
fn the_time_of_a_scene_ends_its_runs() {
    let program = Program::new();
    let few = ["--resolution", "8x8", "--spp", "4", "--runs", "50", "--scene-time", "0.001s"];
    program.succeed(&[&["bench", QUAD_LIGHT, "--json", "b.json"][..], &few].concat());
    let report = read_json(&program.path("b.json"));
    let points = &section(&report, "quad-light")["data"]["methods"][0]["points"];
    assert_eq!(points[0]["runs"].as_array().unwrap().len(), 4, "{points}");
}

/// With the size that the renders have, and the file's own standard errors.
#[test]
fn a_reference_from_a_file() {
    let program = Program::new();
    let size = ["--resolution", "8x8"];
    program.succeed(
        &[&["render", QUAD_LIGHT, "-o", "r.exr", "--spp", "256", "--seed", "77"][..], &size]
            .concat(),
    );
    let reference = ["--reference-file", "r.exr", "--json", "b.json"];
    program.succeed(&[&["bench", QUAD_LIGHT][..], &SMALL, &reference].concat());
    let report = read_json(&program.path("b.json"));
    let data = &section(&report, "quad-light")["data"];
    assert_eq!(data["references"][0]["name"], "r.exr");
    // The file has standard errors, of which the variance follows.
    assert!(data["references"][0]["relmse"].as_f64().unwrap() > 0.0, "{data}");

    let output =
        program.run(&[&["bench", QUAD_LIGHT][..], &["--resolution", "9x8"], &reference].concat());
    assert_eq!(output.status.code(), Some(2), "{}", talk(&output));
    assert!(talk(&output).contains("8x8"), "{}", talk(&output));
}

#[test]
fn costs_against_sizes() {
    let program = Program::new();
    let flags = [
        "--scale",
        "triangles,lights,pixels,bounces",
        "--most-triangles",
        "2000",
        "--most-lights",
        "20",
    ];
    let printed = program
        .succeed(&[&["bench", "--resolution", "8x8", "--json", "b.json"][..], &flags].concat());
    let report = read_json(&program.path("b.json"));
    assert_tables(&report);
    for (what, sizes) in [("triangles", 2), ("lights", 3), ("pixels", 4), ("bounces", 6)] {
        let part = section(&report, &format!("Cost against {what}"));
        assert_eq!(part["data"]["sizes"].as_array().unwrap().len(), sizes, "{part}");
        for size in part["data"]["sizes"].as_array().unwrap() {
            let costs = size["costs"].as_array().unwrap();
            assert!(costs.iter().all(|c| c[1].as_f64().unwrap() >= 0.0), "{size}");
        }
        // A row below the sizes names the growth.
        let rows = part["tables"][0]["rows"].as_array().unwrap();
        assert_eq!(rows.last().unwrap()[0], "exponent");
        assert!(printed.contains(&format!("## Cost against {what}")), "{printed}");
    }
    // As many pixels four times as many: the work is known, whatever it costs.
    let sizes = &section(&report, "Cost against pixels")["data"]["sizes"];
    assert_eq!([&sizes[0]["size"], &sizes[3]["size"]], [4.0, 256.0]);
}

#[test]
fn start_up_does_not_compile_twice() {
    let program = Program::new();
    program
        .succeed(&[&["bench", QUAD_LIGHT, "--startup", "--json", "b.json"][..], &SMALL].concat());
    let report = read_json(&program.path("b.json"));
    assert_tables(&report);
    let runs = &section(&report, "Start-up")["data"];
    assert_eq!(runs.as_array().unwrap().len(), 3);
    // Mesa keeps its cache where it is told to; other drivers may show nothing.
    assert_eq!([&runs[1]["new_cache_files"], &runs[2]["new_cache_files"]], [0, 0], "{runs}");
}

#[test]
fn a_speed_bench_that_cannot_be_is_refused_at_once() {
    let program = Program::new();
    let cases: &[(&[&str], i32, &str)] = &[
        (&[], 2, "SCENE"),
        (&["missing.gltf"], 3, "missing.gltf"),
        (&[QUAD_LIGHT, "missing.gltf"], 3, "missing.gltf"),
        (&[QUAD_LIGHT, "--spp", "4,0"], 2, "--spp"),
        (&[QUAD_LIGHT, "--runs", "1"], 2, "--runs"),
        (&[QUAD_LIGHT, "--targets", "0"], 2, "--targets"),
        (&[QUAD_LIGHT, "--targets", "1e-2,x"], 2, "--targets"),
        (&[QUAD_LIGHT, "--times=-1"], 2, "--times"),
        (&[QUAD_LIGHT, "--against", "povray"], 2, "--against"),
        (&[QUAD_LIGHT, "--mitsuba-sampler", "independent"], 2, "--against"),
        (&[QUAD_LIGHT, "--noise", "5%"], 2, "--coverage"),
        (&[QUAD_LIGHT, "--reference-file", "none.exr", "--resolution", "8x8"], 1, "none.exr"),
        (&[QUAD_LIGHT, "--reference"], 2, "--reference-file"),
        (&[QUAD_LIGHT, "--pixel", "0,0"], 2, "--pixel"),
        (&[QUAD_LIGHT, "--time", "1s"], 2, "--time"),
        (&[QUAD_LIGHT, "--against", "mitsuba", "--crop", "0,0,4,4"], 2, "--crop"),
        (&[QUAD_LIGHT, "--against", "mitsuba", "--environment-radiance", "1"], 2, "environment"),
        (&[QUAD_LIGHT, "--scale", "wishes"], 2, "--scale"),
        (&["--scale", "threads"], 2, "needs a scene"),
        (&["--scale", "pixels", "--startup"], 2, "needs a scene"),
        (&[QUAD_LIGHT, "--json", "missing/b.json"], 1, "missing"),
        (&[QUAD_LIGHT, "--report", "missing/b.html"], 1, "missing"),
        (&[QUAD_LIGHT, QUAD_LIGHT, "--coverage", "--noise", "5%"], 2, "--coverage"),
        (&[QUAD_LIGHT, "--coverage", "--noise", "5%", "--spp", "4,8"], 2, "--coverage"),
        (&[QUAD_LIGHT, "--coverage", "--noise", "5%", "--ablation"], 2, "--ablation"),
    ];
    for (flags, code, word) in cases {
        let output = program.run(&[&["bench"], *flags].concat());
        let message = talk(&output);
        assert_eq!(output.status.code(), Some(*code), "{flags:?}: {message}");
        assert!(message.contains("error: ") && message.contains(word), "{flags:?}: {message}");
        assert!(output.stdout.is_empty(), "{flags:?}");
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}

/// Without it, or without Python, it says so and ends with 1.
#[test]
fn a_rival_that_is_not_there_is_an_error() {
    let program = Program::new();
    let base = [&["bench", QUAD_LIGHT, "--against", "mitsuba"][..], &SMALL].concat();
    for python in ["no-such-python", "false"] {
        let output = program.run(&[&base[..], &["--python", python]].concat());
        let message = talk(&output);
        assert_eq!(output.status.code(), Some(1), "{python}: {message}");
        assert!(message.contains(python), "{message}");
        assert!(
            message.contains("--against mitsuba") || message.contains("pip install"),
            "{message}"
        );
    }
}

/// The other side of the pipe, in place of Mitsuba: grey pictures of a known error at a known
/// cost. What is read of it is what is reported.
#[test]
#[cfg(unix)]
fn a_rival_is_measured_by_what_it_answers() {
    use std::os::unix::fs::PermissionsExt;
    let program = Program::new();
    // A line to say hello, one for the scene, and then pictures of 8 × 8 pixels of 1 ± 0.1.
    let script = r#"#!/bin/sh
echo '{"version": "Rival 1"}'
read -r line
echo '{"seconds": 0.5}'
n=0
while read -r line; do
    path=$(printf '%s' "$line" | sed 's/.*"path":"\([^"]*\)".*/\1/')
    spp=$(printf '%s' "$line" | sed 's/.*"spp":\([0-9]*\).*/\1/')
    n=$((n + 1))
    : > "$path"
    for i in $(seq 96); do
        # 0.9 and 1.1 as little-endian floats, the other way round in every other picture.
        if [ $(( (i + n) % 2 )) = 0 ]; then printf '\146\146\146\077\315\314\214\077' >> "$path"
        else printf '\315\314\214\077\146\146\146\077' >> "$path"; fi
    done
    echo "{\"wall\": 2.0, \"cpu\": 4.0, \"spp\": $spp}"
done
"#;
    let path = program.path("rival.sh");
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    let flags = ["--against", "mitsuba", "--python", path.to_str().unwrap(), "--json", "b.json"];
    let printed = program.succeed(&[&["bench", QUAD_LIGHT][..], &SMALL, &flags].concat());
    assert!(printed.contains("Rival 1"), "{printed}");
    let report = read_json(&program.path("b.json"));
    assert_tables(&report);
    let data = &section(&report, "quad-light")["data"];
    let rival = &data["methods"][2];
    assert_eq!(rival["name"], "Mitsuba");
    for run in rival["points"][1]["runs"].as_array().unwrap() {
        assert_eq!([&run["wall"], &run["cpu"]], [2.0, 4.0]);
    }
    // 16 parts of alternating sign: the mean is 1 to 1e-8, its variance 0.01 / 15.
    let own = data["references"][1]["relmse"].as_f64().unwrap();
    assert!((own / (0.01 / 15.0) - 1.0).abs() < 1e-3, "{own}");
    let error = rival["points"][0]["runs"][0]["error"].as_f64().unwrap();
    assert!((error / (0.01 - own) - 1.0).abs() < 1e-3, "{error}");
    assert!(data["difference"]["mean"].as_f64().unwrap() > 0.5, "{data}");
}
