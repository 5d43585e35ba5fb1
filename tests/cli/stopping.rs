//! Pixels that stop one by one: flags, sample maps, what files and lines say, and the bench.

use super::{Program, QUAD_LIGHT, read_json, talk};
use std::collections::BTreeMap;
use steradian::image::{Attribute, ChannelData, linear_from_srgb, read_exr, read_png};

/// A sphere whose radiance is the same everywhere, in surroundings of that radiance.
const WHITE_FURNACE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/tests/white-furnace/white-furnace.gltf");

/// A scene with easy and hard pixels, and a black background.
const VEACH_MIS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/veach-mis/veach-mis.gltf");

const SIZE: [&str; 2] = ["--resolution", "24x16"];
const PIXELS: usize = 24 * 16;

fn render(program: &Program, name: &str, flags: &[&str]) {
    program.succeed(&[&["render", VEACH_MIS, "-o", name], &SIZE[..], flags].concat());
}

/// What an EXR file says of every pixel.
struct Noise {
    /// Luminance, W/(sr m²).
    mean: Vec<f64>,
    samples: Vec<u32>,
    standard_error: Vec<f32>,
    half_width: Vec<f32>,
    reason: Vec<u32>,
    metadata: BTreeMap<String, Attribute>,
}

fn noise(program: &Program, name: &str) -> Noise {
    let image = read_exr(&program.path(name)).unwrap();
    let floats = |channel| match image.channel("noise", channel) {
        Some(ChannelData::F32(values)) => values.clone(),
        _ => panic!("no {channel}"),
    };
    let counts = |channel| match image.channel("noise", channel) {
        Some(ChannelData::U32(values)) => values.clone(),
        _ => panic!("no {channel}"),
    };
    let luminance = |c: &[f32; 3]| {
        let [r, g, b] = c.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    Noise {
        mean: image.picture().unwrap().rgb.iter().map(luminance).collect(),
        samples: counts("samples"),
        standard_error: floats("standard_error"),
        half_width: floats("half_width"),
        reason: counts("stop_reason"),
        metadata: image.metadata.clone().into_iter().collect(),
    }
}

#[test]
fn flags_reach_the_rule() {
    let program = Program::new();
    let of =
        |flags: &[&str]| program.stats(QUAD_LIGHT, &[&["--resolution", "8x8"], flags].concat());
    let cases: [(&[&str], &str); 5] = [
        (&["--noise", "0.2"], "noise 0.2, confidence 0.95, preset default"),
        (&["--noise", "20%", "--preset", "strict"], "noise 0.2, confidence 0.95, preset strict"),
        (&["--noise", "1%", "--confidence", "0.5"], "noise 0.01, confidence 0.5, preset default"),
        (&["--adaptive", "seed"], "seed:32,0.05"),
        (&["--adaptive", "seed:24,50%"], "seed:24,0.5"),
    ];
    let all: Vec<_> = cases
        .iter()
        .map(|(flags, rule)| {
            let stats = of(&[*flags, &["--spp", "768"]].concat());
            assert_eq!(stats["stopping"]["rule"], *rule);
            stats
        })
        .collect();
    // Each stops as early as it may, and no earlier.
    let least = |i: usize| all[i]["spp"].as_u64().unwrap();
    assert_eq!([least(0), least(1), least(3) % 32, least(4)], [128, 256, 0, 24]);
    assert!(all[0]["samples"].as_u64() < all[1]["samples"].as_u64());
    // Half of all cases is easier than nearly all of them.
    let sure = of(&["--noise", "1%", "--spp", "768"]);
    assert!(all[2]["samples"].as_u64() < sure["samples"].as_u64());
    assert_eq!(of(&["--noise", "20%"])["requested_spp"], 4096);
    assert!(of(&["--spp", "4"])["stopping"].is_null());
}

#[test]
fn what_makes_no_sense_exits_with_2() {
    let program = Program::new();
    let cases: &[(&[&str], &str)] = &[
        (&["--noise", "0.1", "--adaptive", "seed"], "--adaptive"),
        (&["--noise", "0.1", "--block", "8"], "--block"),
        (&["--adaptive", "seed", "--block", "8"], "--block"),
        (&["--noise", "0.1", "--reference"], "--reference"),
        (&["--adaptive", "seed", "--reference"], "--reference"),
        (&["--preset", "strict"], "--noise"),
        (&["--confidence", "0.9"], "--noise"),
        (&["--adaptive", "seed", "--confidence", "0.9"], "--adaptive"),
        (&["--adaptive", "seed", "--preset", "strict"], "--adaptive"),
        (&["--noise", "1.5"], "--noise"),
        (&["--noise", "-0.1"], "-0"),
        (&["--noise", "101%"], "--noise"),
        (&["--noise", "nan"], "--noise"),
        (&["--noise", "0.1", "--confidence", "1"], "--confidence"),
        (&["--noise", "0.1", "--confidence", "0.4"], "--confidence"),
        (&["--noise", "0.1", "--preset", "lax"], "--preset"),
        (&["--adaptive", "sead"], "--adaptive"),
        (&["--adaptive", "seed:0"], "--adaptive"),
        (&["--adaptive", "seed:32,2"], "--adaptive"),
        (&["--sample-map-colors", "rate"], "--sample-map"),
        (&["--sample-map", "map.png", "--sample-map-colors", "heat"], "--sample-map-colors"),
        // The scene is not there: names are looked at first.
        (&["--sample-map", "map.exr"], "map.exr: --sample-map writes a .png"),
        (&["--sample-map", "map.jpg"], "map.jpg"),
        (&["--sample-map", "a.png"], "a.png: --output and --sample-map name the same file"),
        (&["--stats", "m.png", "--sample-map", "m.png"], "--stats and --sample-map"),
    ];
    for (flags, word) in cases {
        let output = program.run(&[&["render", "missing.gltf", "-o", "a.png"], *flags].concat());
        let message = talk(&output);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {message}");
        // What is wrong, before the hint at the usage.
        let said = message.split("\n\n").next().unwrap();
        assert!(said.starts_with("error: ") && said.contains(word), "{flags:?}: {message}");
    }
    assert!(program.files().is_empty(), "{:?}", program.files());
}

#[test]
fn a_sample_map_shows_the_counts() {
    let program = Program::new();
    let rule = ["--adaptive", "seed:8,20%", "--spp", "256"];
    let rate = ["--sample-map", "rate.png", "--sample-map-colors", "rate"];
    render(&program, "a.exr", &[&rule[..], &rate].concat());
    render(&program, "b.exr", &[&rule[..], &["--sample-map", "viridis.png"]].concat());
    let samples = noise(&program, "a.exr").samples;
    let [rate, viridis] = ["rate.png", "viridis.png"].map(|n| read_png(&program.path(n)).unwrap());
    assert_eq!((rate.width, rate.height, viridis.width, viridis.height), (24, 16, 24, 16));
    let (mut few, mut all) = (0, 0);
    for (i, &n) in samples.iter().enumerate() {
        let t = n as f32 / 256.0;
        let middle = 1.0 - (2.0 * t - 1.0).abs();
        let expected = [(2.0 * t - 1.0).max(0.0), middle, (1.0 - 2.0 * t).max(0.0)];
        for (shown, component) in rate.rgb[i].iter().zip(expected) {
            // Half a step of 8 bits, at the steepest place of the curve.
            let difference = shown - linear_from_srgb(component);
            assert!(difference.abs() <= 2.4 / 255.0, "pixel {i}, {n} samples: {:?}", rate.rgb[i]);
        }
        few += usize::from(n == 8);
        all += usize::from(n == 256);
        let is_darkest = viridis.rgb[i] == [68, 1, 84].map(|c| linear_from_srgb(c as f32 / 255.0));
        assert_eq!(is_darkest, n == 8, "pixel {i}, {n} samples: {:?}", viridis.rgb[i]);
    }
    assert!(few > 10 && all > 10, "{few} blue, {all} red: no test");
}

/// Mean over the pixels.
fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn what_files_say_of_the_pixels_fits_together() {
    let program = Program::new();
    let flags = ["--noise", "10%", "--spp", "512", "--stats", "s.json"];
    render(&program, "a.exr", &flags);
    let noise = noise(&program, "a.exr");
    let floor = 0.01 * average(&noise.mean);
    for i in 0..PIXELS {
        let (n, mean) = (noise.samples[i], noise.mean[i]);
        let half_width = f64::from(noise.half_width[i]);
        assert!((128..=512).contains(&n) && n.is_multiple_of(8), "pixel {i}: {n}");
        let has_enough = n >= if mean > 0.0 { 128 } else { 1024 };
        // The device has the mean and the interval in f32.
        let allowed = 0.1 * mean.max(floor);
        if (half_width - allowed).abs() > 1e-4 * allowed {
            let is_converged = has_enough && half_width < allowed;
            assert_eq!(noise.reason[i] == 1, is_converged, "pixel {i}: {half_width} {allowed}");
        }
        assert!(noise.reason[i] == 1 || (noise.reason[i] == 2 && n == 512), "pixel {i}");
        // 1.75 standard errors, and more where the neighbours or the brightest block ask for it.
        let least = 1.75 * f64::from(noise.standard_error[i]);
        assert!(half_width >= (1.0 - 1e-4) * least, "pixel {i}: {half_width} {least}");
    }
    let count = |reason| noise.reason.iter().filter(|&&r| r == reason).count();
    assert!(count(1) > 20 && count(2) > 20, "{} {}: no test", count(1), count(2));

    let stats = read_json(&program.path("s.json"));
    let stopping = &stats["stopping"];
    assert_eq!(stopping["converged_pixels"], count(1));
    assert_eq!(stopping["pixels_at_limit"], count(2));
    assert_eq!(stopping["unfinished_pixels"], 0);
    assert_eq!(stats["samples"], noise.samples.iter().sum::<u32>());
    assert_eq!(stats["spp"], *noise.samples.iter().min().unwrap());
    assert_eq!(stopping["most_samples"], 512);
    // At 64, 96, 128, 192, 256, 384 and 512 samples, and where pixels that have stopped go on.
    assert!(stopping["decisions"].as_u64().unwrap() >= 7);
    let seconds = |name: &str| stats[name].as_f64().unwrap();
    assert!(seconds("stopping_seconds") > 0.0);
    assert!(seconds("stopping_seconds") < seconds("render_seconds"));

    let entry = |name: &str| noise.metadata[&format!("steradian.{name}")].clone();
    let rule = "noise 0.1, confidence 0.95, preset default";
    assert_eq!(entry("stopping"), Attribute::Text(rule.into()));
    assert_eq!(entry("spp_limit"), Attribute::Number(512.0));
    assert_eq!(entry("most_samples"), Attribute::Number(512.0));
}

#[test]
fn the_summary_says_what_ended_the_render() {
    let program = Program::new();
    let of = |scene: &str, flags: &[&str]| {
        let output = program
            .run(&[&["render", scene, "-o", "a.png", "--resolution", "8x8"], flags].concat());
        assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
        talk(&output)
    };
    let cases: [(&str, &[&str], &[&str]); 4] = [
        (
            WHITE_FURNACE,
            &["--noise", "5%"],
            &["preset default: 100.0 % of the pixels converged\n", "ended by the noise\n"],
        ),
        (
            QUAD_LIGHT,
            &["--noise", "0.01%", "--spp", "128"],
            &[" % not within 128 samples\n", "ended by the samples\n", "128 to 128, median 128"],
        ),
        (
            QUAD_LIGHT,
            &["--noise", "0.0001%", "--time", "0.3s"],
            &[" % unfinished\n", "ended by the time\n"],
        ),
        (QUAD_LIGHT, &["--time", "0.3s"], &["ended by the time\n"]),
    ];
    for (scene, flags, words) in cases {
        let said = of(scene, flags);
        for word in words {
            assert!(said.contains(word), "{flags:?}: {said:?} does not say {word:?}");
        }
        assert_eq!(said.matches("ended by").count(), 1, "{said}");
    }
    assert!(!of(QUAD_LIGHT, &["--spp", "4"]).contains("ended by"));
}

#[test]
fn no_tolerance_is_the_fixed_render() {
    let program = Program::new();
    render(&program, "fixed.exr", &["--spp", "40"]);
    render(&program, "noise.exr", &["--spp", "40", "--noise", "0"]);
    render(&program, "seed.exr", &["--spp", "40", "--adaptive", "seed:32,0"]);
    let bytes = |name: &str| std::fs::read(program.path(name)).unwrap();
    assert!(bytes("fixed.exr") == bytes("noise.exr"), "--noise 0");
    assert!(bytes("fixed.exr") == bytes("seed.exr"), "--adaptive seed:32,0");
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let program = Program::new();
    let of = |name: &str, flags: &[&str]| {
        let map = format!("{name}.map.png");
        let rule = ["--noise", "10%", "--spp", "256", "--sample-map", &map];
        render(&program, &format!("{name}.exr"), &[&rule[..], flags].concat());
        [format!("{name}.exr"), map].map(|file| std::fs::read(program.path(&file)).unwrap())
    };
    let first = of("a", &[]);
    assert!(first == of("b", &[]));
    assert!(first[0] != of("c", &["--seed", "1"])[0], "the seed has no effect");
}

#[test]
fn bench_measures_coverage() {
    let program = Program::new();
    let base = ["bench", QUAD_LIGHT, "--coverage", "--noise", "20%", "--resolution", "8x8"];
    let small = ["--spp", "256", "--truth-spp", "4096", "--runs", "8", "--rules", "seed,strict"];
    let printed = program.succeed(&[&base[..], &small, &["--json", "c.json"]].concat());
    let rows: Vec<_> = printed.lines().filter(|line| line.starts_with("| quad-light")).collect();
    assert_eq!(rows.len(), 2, "{printed}");
    assert!(rows[0].contains("| seed 20 % |") && rows[1].contains("| strict 20 % |"), "{printed}");
    let columns = |line: &str| line.matches('|').count();
    assert!(printed.lines().take(4).all(|line| columns(line) == columns(rows[0])), "{printed}");
    assert!(printed.contains("8 runs of a picture, at most 256 samples"), "{printed}");

    let json = read_json(&program.path("c.json"));
    for (row, rule) in json.as_array().unwrap().iter().zip(["seed", "strict"]) {
        assert_eq!(row["rule"], rule);
        assert_eq!([&row["runs"], &row["limit"]], [8, 256]);
        assert_eq!([&row["tolerance"], &row["confidence"], &row["truth_spp"]], [0.2, 0.95, 4096.0]);
        let interval = |name: &str| {
            let of = |k: usize| row[name][k].as_f64().unwrap_or_else(|| panic!("{name}: {row}"));
            let [value, low, high] = [0, 1, 2].map(of);
            assert!(low <= value && value <= high, "{name}: {row}");
            value
        };
        assert!((0.0..=1.0).contains(&interval("coverage")));
        assert!(interval("bias").abs() < 1.0);
        assert!(interval("relmse_ratio") > 0.0 && interval("relmse_ratio_at_equal_time") > 0.0);
        for share in ["tenth_percentile", "tenth_percentile_by_chance", "worst", "at_limit"] {
            assert!((0.0..=1.0).contains(&row[share].as_f64().unwrap()), "{share}: {row}");
        }
        assert!((1..=64).contains(&row["pixels"].as_u64().unwrap()));
        let [least, mean, most] = [0, 1, 2].map(|k| row["samples"][k].as_f64().unwrap());
        assert!(least <= mean && mean <= most && most <= 256.0, "{row}");
        assert!(row["samples_over_oracle"].as_f64().unwrap() >= 1.0 || rule == "seed", "{row}");
        let resolved = row["truth_resolved"].as_f64().unwrap();
        assert!(resolved > 0.5 && resolved <= 1.0, "{row}");
        let overhead = row["overhead"].as_f64().unwrap();
        assert!(overhead > 0.0 && overhead < 1.0, "{row}");
        assert!(row["black_stops"].is_u64() && row["device"].is_string(), "{row}");
    }
    assert_eq!(json.as_array().unwrap().len(), 2);
}

#[test]
fn a_bench_that_cannot_be_is_refused_at_once() {
    let program = Program::new();
    let cases: &[(&[&str], i32, &str)] = &[
        (&["--noise", "5%"], 2, "--coverage"),
        (&["--coverage"], 2, "--noise"),
        (&["--coverage", "--noise", "5%", "--runs", "7"], 2, "--runs"),
        (&["--coverage", "--noise", "5%", "--rules", "seed,lax"], 2, "--rules"),
        (&["--coverage", "--noise", "5%", "--truth-spp", "100"], 2, "--truth-spp"),
        (&["--coverage", "--noise", "5%", "--time", "1s"], 2, "--time"),
        (&["--coverage", "--noise", "5%", "--seed", "3"], 2, "--seed"),
        (&["--coverage", "--noise", "0"], 2, "--coverage"),
        (&["--coverage", "--noise", "5%", "--json", "missing/c.json"], 1, "missing"),
    ];
    for (flags, code, word) in cases {
        let output = program.run(&[&["bench", QUAD_LIGHT], *flags].concat());
        let message = talk(&output);
        assert_eq!(output.status.code(), Some(*code), "{flags:?}: {message}");
        let mut lines = message.lines();
        assert!(lines.next().unwrap().starts_with("error: "), "{flags:?}: {message}");
        assert!(message.contains(word), "{flags:?}: {message}");
    }
    assert!(program.files().is_empty());
}
