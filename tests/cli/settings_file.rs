//! `--settings`, `--set` and `--dump-settings` from outside; which flag wins is tested within.

use super::{Program, QUAD_LIGHT, talk};
use serde_json::Value;

#[test]
fn what_is_dumped_is_what_is_read() {
    let program = Program::new();
    let flags =
        ["-o", "a.exr", "--spp", "8", "--seed", "3", "--no-roulette", "--exposure", "-1.50"];
    let more = ["--environment-radiance", "1,2,3", "--allow-external", "x", "--allow-external=y"];
    let base = ["render", QUAD_LIGHT, "--dump-settings"];
    let dump = program.succeed(&[&base[..], &flags, &more].concat());
    assert!(program.files().is_empty(), "it rendered");
    std::fs::write(program.path("s.json"), &dump).unwrap();
    assert_eq!(program.succeed(&[&base[..], &["--settings", "s.json"]].concat()), dump);
    let value: Value = serde_json::from_str(&dump).unwrap();
    assert_eq!(value["output"], "a.exr");
    assert_eq!(value["exposure"], "-1.50");
    assert_eq!(value["allow-external"], serde_json::json!(["x", "y"]));
    assert_eq!(value["noise"], Value::Null);

    // A flag over --set over the file.
    let order = ["--settings", "s.json", "--set", "seed=4", "--set", "spp=16", "--spp", "32"];
    let dump = program.succeed(&[&base[..], &order].concat());
    let value: Value = serde_json::from_str(&dump).unwrap();
    assert_eq!([&value["seed"], &value["spp"]], [4, 32]);
    assert_eq!(value["no-roulette"], true);
}

#[test]
fn settings_render_as_flags_do() {
    let program = Program::new();
    let json = r#"{"resolution": "16x16", "spp": 4, "seed": 7, "time": null, "output": "a.exr"}"#;
    std::fs::write(program.path("s.json"), json).unwrap();
    program.succeed(&["render", QUAD_LIGHT, "--settings", "s.json"]);
    let flags = ["--resolution", "16x16", "--spp", "4", "--seed", "7"];
    program.succeed(&[&["render", QUAD_LIGHT, "-o", "b.exr"], &flags[..]].concat());
    let read = |name: &str| std::fs::read(program.path(name)).unwrap();
    assert!(read("a.exr") == read("b.exr"));
}

#[test]
fn what_is_no_setting_exits_with_2() {
    let program = Program::new();
    let cases = [
        (r#"{"spps": 4}"#, "did you mean \"spp\"?"),
        (r#"{"spp": true}"#, "spp: true is no value"),
        (r#"{"spp": [4]}"#, "spp: [4] is no value"),
        (r#"{"spp": 0}"#, "--spp"),
        (r#"[4]"#, "not a JSON object"),
        ("spp: 4", "no JSON"),
    ];
    for (json, word) in cases {
        std::fs::write(program.path("s.json"), json).unwrap();
        let output = program.run(&["render", QUAD_LIGHT, "-o", "a.png", "--settings", "s.json"]);
        assert_eq!(output.status.code(), Some(2), "{json}: {}", talk(&output));
        assert!(talk(&output).contains(word), "{json}: {}", talk(&output));
    }
    let output = program.run(&["render", QUAD_LIGHT, "-o", "a.png", "--settings", "none.json"]);
    assert_eq!(output.status.code(), Some(1), "{}", talk(&output));
    assert_eq!(program.files(), ["s.json"]);
}
