//! `steradian compare` from outside: exit codes, folders, JSON, acceptance. No device is needed.

use crate::ramp;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use steradian::image::{Attribute, ExrImage, Picture, PngOptions, Precision, write_exr, write_png};
use tempfile::TempDir;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["actual", "expected"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn exr(&self, name: &str, picture: &Picture, driver: &str) {
        let mut image = ExrImage::from_picture(picture);
        image.metadata.insert("steradian.driver".into(), Attribute::Text(driver.into()));
        write_exr(&self.path(name), &image, Precision::Float).unwrap();
    }

    fn compare(&self, flags: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_steradian");
        let mut command = Command::new(program);
        command.arg("compare").args(flags).current_dir(self.0.path()).output().unwrap()
    }
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A picture that is off by `share` everywhere.
fn scaled(share: f32) -> Picture {
    let mut picture = ramp(16, 8);
    picture.rgb.iter_mut().flatten().for_each(|v| *v *= 1.0 + share);
    picture
}

#[test]
fn exit_codes() {
    let folder = Folder::new();
    folder.exr("a.exr", &scaled(0.01), "d");
    folder.exr("b.exr", &scaled(0.0), "d");
    folder.exr("small.exr", &ramp(4, 4), "d");
    write_png(&folder.path("c.png"), &scaled(0.0), &PngOptions::default()).unwrap();
    std::fs::write(folder.path("broken.exr"), b"no picture").unwrap();
    let run = |flags: &[&str]| code(&folder.compare(flags));
    assert_eq!(run(&["b.exr", "b.exr"]), 0);
    assert_eq!(run(&["a.exr", "b.exr"]), 1);
    assert_eq!(run(&["a.exr", "b.exr", "--tolerance", "relmse<1e-3"]), 0);
    assert_eq!(run(&["a.exr", "b.exr", "--tolerance", "relmse<1e-3", "-t", "exact"]), 1);
    // A missing reference is a failure, like a missing picture.
    assert_eq!(run(&["a.exr", "nothing.exr"]), 1);
    assert_eq!(run(&["nothing.exr", "a.exr"]), 1);
    for (flags, word) in [
        (vec!["a.exr", "small.exr"], "sizes differ"),
        (vec!["a.exr", "c.png"], "compare like with like"),
        (vec!["a.exr", "broken.exr"], "broken.exr"),
        (vec!["a.exr", "b.exr", "-t", "verdict"], "needs the noise"),
        (vec!["a.exr", "b.exr", "--layer", "albedo"], "no layer albedo"),
    ] {
        let output = folder.compare(&flags);
        assert_eq!(code(&output), 2, "{flags:?}");
        assert!(printed(&output).contains(word), "{flags:?}: {}", printed(&output));
        assert!(!printed(&output).contains("panicked"));
    }
    for flags in [
        vec!["a.exr"],
        vec!["a.exr", "b.exr", "-t", "psnr<1"],
        vec!["a.exr", "actual"],
        vec!["actual", "expected"],
        vec!["a.exr", "b.exr", "--report-size", "3"],
    ] {
        let output = folder.compare(&flags);
        assert_eq!(code(&output), 2, "{flags:?}");
        assert!(said(&output).starts_with("error:"), "{flags:?}: {}", said(&output));
    }
}

#[test]
fn folders_are_paired_by_name_and_the_worst_comes_first() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("actual/deep")).unwrap();
    std::fs::create_dir(folder.path("expected/deep")).unwrap();
    for (name, share) in [("near.exr", 0.02), ("deep/far.exr", 0.5), ("same.exr", 0.0)] {
        folder.exr(&format!("actual/{name}"), &scaled(share), "d");
        folder.exr(&format!("expected/{name}"), &scaled(0.0), "d");
    }
    folder.exr("actual/new.exr", &scaled(0.0), "d");
    folder.exr("expected/lost.exr", &scaled(0.0), "d");
    std::fs::write(folder.path("actual/notes.txt"), b"no picture").unwrap();
    let flags = ["actual", "expected", "--report", "out", "--json", "out/run.json"];
    let output = folder.compare(&flags);
    assert_eq!(code(&output), 1);
    assert!(said(&output).contains("report: out/report.html"), "{}", said(&output));
    let json: Value =
        serde_json::from_slice(&std::fs::read(folder.path("out/run.json")).unwrap()).unwrap();
    let cases = json["cases"].as_array().unwrap().iter();
    let cases: Vec<_> =
        cases.map(|c| (c["name"].as_str().unwrap(), c["status"].as_str().unwrap())).collect();
    let expected = [
        ("lost.exr", "missing"),
        ("new.exr", "missing"),
        ("deep/far.exr", "differs"),
        ("near.exr", "differs"),
        ("same.exr", "same"),
    ];
    assert_eq!(cases, expected);
    assert!(printed(&output).contains("5 pictures: 1 same, 2 differs, 2 missing, 0 unusable"));
    // One that cannot be compared does not hide the others.
    folder.exr("actual/same.exr", &ramp(3, 3), "d");
    assert_eq!(code(&folder.compare(&["actual", "expected", "-q"])), 2);
}

#[test]
fn json_holds_every_figure() {
    let folder = Folder::new();
    folder.exr("a.exr", &scaled(0.01), "new");
    folder.exr("b.exr", &scaled(0.0), "old");
    let output = folder.compare(&["a.exr", "b.exr", "--json", "-"]);
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!((&json["schema"], &json["passes"]), (&Value::from(1), &Value::from(false)));
    let case = &json["cases"][0];
    let metrics = &case["comparison"]["layers"][0]["metrics"];
    let relmse = metrics["relmse"].as_f64().unwrap();
    assert!((0.9e-4..1e-4).contains(&relmse), "{relmse}");
    for name in
        ["mse", "relmse.trimmed", "smape", "error.max", "error.p99", "flip.mean", "hdrflip.mean"]
    {
        assert!(metrics[name].as_f64().unwrap() > 0.0, "{name}");
    }
    assert!(case["comparison"]["layers"][0]["epsilon"].as_f64().unwrap() > 0.0);
    assert_eq!(case["comparison"]["notes"][0], "driver: actual new, expected old");
    assert_eq!(case["metadata"]["actual"]["steradian.driver"], "new");
    // A value that is not finite has no figures.
    let mut spoilt = scaled(0.0);
    spoilt.rgb[3][0] = f32::NAN;
    folder.exr("a.exr", &spoilt, "new");
    let output = folder.compare(&["a.exr", "b.exr", "--json", "-", "-t", "mse<1"]);
    assert_eq!(code(&output), 1);
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    let layer = &json["cases"][0]["comparison"]["layers"][0];
    assert!(layer["metrics"]["mse"].is_null());
    assert_eq!(layer["non_finite"]["first"]["x"], 3);
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

#[test]
fn accepting_replaces_what_does_not_pass() {
    let folder = Folder::new();
    for (name, share, driver) in
        [("wrong.exr", 0.5, "d"), ("other.exr", 0.5, "another"), ("same.exr", 0.0, "d")]
    {
        folder.exr(&format!("actual/{name}"), &scaled(share), driver);
        folder.exr(&format!("expected/{name}"), &scaled(0.0), "d");
    }
    folder.exr("actual/new.exr", &scaled(0.0), "d");
    let mut spoilt = scaled(0.0);
    spoilt.rgb[0][0] = f32::INFINITY;
    folder.exr("actual/spoilt.exr", &spoilt, "d");
    let before = bytes(&folder.path("expected/other.exr"));
    let output = folder.compare(&["--accept", "actual", "expected", "-q"]);
    let said = said(&output);
    assert_eq!(code(&output), 1, "{said}");
    for word in [
        "accepted: wrong.exr",
        "accepted: new.exr",
        "not accepted: other.exr",
        "not accepted: spoilt.exr",
    ] {
        assert!(said.contains(word), "{said}");
    }
    assert!(said.contains("driver \"d\", this one of \"another\""), "{said}");
    for name in ["wrong.exr", "new.exr"] {
        let [a, b] = ["actual", "expected"].map(|f| bytes(&folder.path(&format!("{f}/{name}"))));
        assert!(a == b, "{name}");
    }
    assert!(bytes(&folder.path("expected/other.exr")) == before);
    assert!(!folder.path("expected/spoilt.exr").exists());
    std::fs::remove_file(folder.path("actual/spoilt.exr")).unwrap();
    std::fs::remove_file(folder.path("actual/other.exr")).unwrap();
    std::fs::remove_file(folder.path("expected/other.exr")).unwrap();
    assert_eq!(code(&folder.compare(&["actual", "expected", "-q"])), 0);
}
