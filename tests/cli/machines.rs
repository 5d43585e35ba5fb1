//! What other programs read: the log, progress, statistics, completions, manual pages.

use super::{Program, QUAD_LIGHT, read_json, scene, talk};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

const SMALL: [&str; 4] = ["--resolution", "16x16", "--spp", "4"];

fn render<'a>(flags: &[&'a str]) -> Vec<&'a str> {
    [&["render", QUAD_LIGHT], &SMALL[..], flags].concat()
}

/// What is wrong with `value` by the keywords of JSON Schema that ours has. A keyword that is not
/// known here is an error, too.
fn errors(schema: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
    let is_of = |word: &Value| match word.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("type {other}"),
    };
    let count = value.as_array().map(|items| items.len() as u64);
    let members = value.as_object();
    for (keyword, rule) in schema.as_object().unwrap() {
        let holds = match keyword.as_str() {
            "$schema" | "title" | "description" => true,
            "type" => match rule {
                Value::Array(words) => words.iter().any(is_of),
                word => is_of(word),
            },
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|v| v >= rule.as_f64().unwrap()),
            "minItems" => count.is_none_or(|n| n >= rule.as_u64().unwrap()),
            "maxItems" => count.is_none_or(|n| n <= rule.as_u64().unwrap()),
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    errors(rule, item, &format!("{place}[{k}]"), found);
                }
                true
            }
            "required" => members.is_none_or(|members| {
                rule.as_array()
                    .unwrap()
                    .iter()
                    .all(|name| members.contains_key(name.as_str().unwrap()))
            }),
            "properties" => {
                for (name, member) in members.into_iter().flatten() {
                    if let Some(rule) = rule.get(name) {
                        errors(rule, member, &format!("{place}.{name}"), found);
                    }
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(rule, false);
                let known = &schema["properties"];
                members.is_none_or(|members| members.keys().all(|name| known.get(name).is_some()))
            }
            other => panic!("keyword {other}"),
        };
        if !holds {
            found.push(format!("{place}: {keyword}"));
        }
    }
}

fn schema_errors(stats: &Value) -> Vec<String> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/stats.schema.json");
    let schema = read_json(Path::new(path));
    // Every member that is described is there always.
    for object in [&schema, &schema["properties"]["stopping"], &schema["properties"]["faults"]] {
        let mut required: Vec<_> =
            object["required"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        required.sort_unstable();
        let described: Vec<_> = object["properties"].as_object().unwrap().keys().collect();
        assert_eq!(required, described);
    }
    let mut found = Vec::new();
    errors(&schema, stats, "stats", &mut found);
    found
}

#[test]
fn statistics_are_as_their_schema_says() {
    let program = Program::new();
    let stats = program.stats(QUAD_LIGHT, &SMALL);
    assert_eq!(schema_errors(&stats), [""; 0]);
    let noise = program.stats(QUAD_LIGHT, &["--resolution", "16x16", "--noise", "50%"]);
    assert!(noise["stopping"].is_object());
    assert_eq!(schema_errors(&noise), [""; 0]);
    // Errors are found.
    let change = |change: &dyn Fn(&mut Value)| {
        let mut stats = stats.clone();
        change(&mut stats);
        schema_errors(&stats)
    };
    assert_eq!(change(&|s| s["new"] = json!(1)), ["stats: additionalProperties"]);
    assert_eq!(change(&|s| drop(s.as_object_mut().unwrap().remove("spp"))), ["stats: required"]);
    assert_eq!(change(&|s| s["samples"] = json!(1.5)), ["stats.samples: type"]);
    assert_eq!(change(&|s| s["window"] = json!([0, 0, 1])), ["stats.window: minItems"]);
    assert_eq!(change(&|s| s["faults"]["stack"] = json!(-1)), ["stats.faults.stack: minimum"]);
    assert_eq!(change(&|s| s["schema"] = json!(0)), ["stats.schema: const"]);
}

#[test]
fn a_log_of_objects_has_one_in_each_line() {
    let program = Program::new();
    let flags = ["-o", "a.png", "--log-format", "json", "--log-file", "log", "--frames", "1,2"];
    let output = program.run(&render(&[&flags[..], &["--environment-radiance", "1"]].concat()));
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty());
    let lines = |text: &str| -> Vec<Value> {
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let shown = lines(&talk(&output));
    assert!(shown.iter().any(|line| line["message"] == "frame 2, 2 of 2"), "{shown:?}");
    assert!(shown.iter().all(|line| line["level"] != "debug" && line["time"].is_f64()));
    let logged = lines(&std::fs::read_to_string(program.path("log")).unwrap());
    assert!(logged.iter().any(|line| line["level"] == "debug"), "{logged:?}");
    assert!(shown.iter().all(|line| logged.contains(line)), "{shown:?} {logged:?}");

    let output = program.run(&["render", "none.glb", "-o", "a.png", "--log-format", "json"]);
    assert_eq!(output.status.code(), Some(3));
    let said = lines(&talk(&output));
    assert_eq!((said.len(), &said[0]["level"]), (1, &json!("error")));
    assert!(said[0]["message"].as_str().unwrap().starts_with("none.glb: "), "{said:?}");
}

#[test]
fn what_is_written_is_no_other_file() {
    let program = Program::new();
    scene::write(&program.path("s.gltf"), &scene::moving_triangle());
    let before = std::fs::read(program.path("s.gltf")).unwrap();
    for (output, log) in [("a.png", "s.gltf"), ("a.png", "a.png"), ("a#.png", "a1.png")] {
        let flags = ["-o", output, "--log-file", log, "--frames", "1"];
        let output = program.run(&[&["render", "s.gltf"], &flags[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{log}: {}", talk(&output));
        assert!(talk(&output).contains("--log-file"), "{}", talk(&output));
    }
    let flags = ["-o", "a.png", "--stats", "s.gltf"];
    let output = program.run(&[&["render", "s.gltf"], &flags[..]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", talk(&output));
    assert_eq!(std::fs::read(program.path("s.gltf")).unwrap(), before);
}

#[test]
fn open_job_description_reads_progress() {
    let program = Program::new();
    let flags = ["-q", "-o", "a.png", "--progress", "openjd", "--frames", "3,4", "--fps", "1"];
    let output = program.run(&render(&flags));
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    let lines: Vec<_> = said.lines().collect();
    let expected = [
        "openjd_status: frame 3, 1 of 2",
        "openjd_progress: 0.00",
        "openjd_progress: 50.00",
        "openjd_status: frame 4, 2 of 2",
        "openjd_progress: 50.00",
        "openjd_progress: 100.00",
    ];
    // On a slow machine there are more between them.
    let mut rest = lines.iter();
    for line in expected {
        assert!(rest.any(|said| *said == line), "{line}: {said}");
    }
    let shares = lines.iter().filter_map(|line| line.strip_prefix("openjd_progress: "));
    let shares: Vec<f64> = shares.map(|share| share.parse().unwrap()).collect();
    assert!(shares.is_sorted(), "{shares:?}");
    assert_eq!(talk(&output), "");
    let none = program.run(&render(&["-o", "a.png", "--progress", "none"]));
    assert!(!talk(&none).contains("elapsed"), "{}", talk(&none));
    let refused = ["-o", "a.png", "--progress", "bar", "--log-format", "json"];
    assert_eq!(program.run(&render(&refused)).status.code(), Some(2));
}

#[test]
fn shells_complete_and_manuals_have_pages() {
    let program = Program::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = program.succeed(&["completions", shell]);
        assert!(script.contains("skip-existing"), "{shell}");
        std::fs::write(program.path(shell), script).unwrap();
    }
    let check = Command::new("bash").arg("-n").arg(program.path("bash")).output().unwrap();
    assert!(check.status.success(), "{check:?}");
    // The function proposes what is asked for.
    let asks = "source ./bash; COMP_WORDS=(steradian render --skip); COMP_CWORD=2; \
                _steradian steradian --skip render; echo \"${COMPREPLY[@]}\"";
    let answer = program.folder.path();
    let answer = Command::new("bash").args(["-c", asks]).current_dir(answer).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&answer.stdout).trim(), "--skip-existing", "{answer:?}");
    assert_eq!(program.run(&["completions", "cmd"]).status.code(), Some(2));

    std::fs::create_dir(program.path("man")).unwrap();
    program.succeed(&["man", "man"]);
    let page = |name: &str| std::fs::read_to_string(program.path("man").join(name)).unwrap();
    let (main, render) = (page("steradian.1"), page("steradian-render.1"));
    assert!(main.contains(".TH steradian 1") && main.contains("steradian\\-render(1)"), "{main}");
    assert!(render.contains("skip\\-existing") && main.contains("75 the same command"));
    assert_eq!(program.run(&["man", "nowhere"]).status.code(), Some(1));
}
