//! Renders that are stopped, killed, cut into parts or lose their device end with the bytes of one
//! that is not.
#![cfg(unix)]

use super::{CORNELL_BOX, Program, talk};
use std::collections::BTreeMap;
use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Small, and long enough to be met in the middle.
const LONG: [&str; 6] = ["--resolution", "48x40", "--spp", "192", "--max-bounces", "6"];
/// Of which the sums are cut in five.
const SHORT: [&str; 4] = ["--resolution", "40x72", "--spp", "80"];

fn render(scene: &'static str, output: &'static str, more: &[&'static str]) -> Vec<&'static str> {
    [&["render", scene, "-o", output, "-q"], more].concat()
}

fn kill(child: &Child, signal: &str) {
    let kill = format!("kill -{signal} {}", child.id());
    // It may have ended by itself.
    let _ = Command::new("sh").args(["-c", &kill]).stderr(Stdio::null()).status();
}

/// What killing a render came to.
struct Kills {
    count: u32,
    /// Times that it went on from the middle.
    resumed: u32,
}

/// How long a render takes to begin, and to end if it is left alone.
#[derive(Clone, Copy)]
struct Life {
    begin: Duration,
    end: Duration,
}

impl Life {
    fn of(program: &Program, name: &'static str, settings: &[&'static str]) -> Self {
        let time = |more: &[&'static str]| {
            let begin = Instant::now();
            program.succeed(&render(CORNELL_BOX, name, &[settings, more].concat()));
            begin.elapsed()
        };
        // The crop has the same kernels, which may have to be compiled first, and next to nothing to
        // trace; the whole comes last and stays.
        let crop = ["--crop", "0,0,1,1"];
        time(&crop);
        Self { begin: time(&crop), end: time(&[]) }
    }

    /// A moment to end the render at, `share` being 0 to 1: some before it has begun to trace, and so
    /// that most of it is done when it has been ended `times` times.
    fn moment(&self, share: f64, times: u32) -> Duration {
        let work = self.end.saturating_sub(self.begin).as_secs_f64() / f64::from(times);
        let begin = self.begin.as_secs_f64();
        Duration::from_secs_f64(0.9 * begin + (0.1 * begin + work) * share)
    }
}

/// Ends a render at different moments, `-9` or asked, `most` times or until it has ended by itself.
fn kill_until_done(
    program: &Program,
    arguments: &[&str],
    life: Life,
    most: u32,
    signals: &[&str],
) -> Kills {
    let mut state = 0x9E37_79B9_u32;
    let mut kills = Kills { count: 0, resumed: 0 };
    let mut codes = BTreeMap::new();
    loop {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let share = f64::from(state >> 8) / f64::from(1 << 24);
        let end = match kills.count < most {
            true => life.moment(share, most),
            false => Duration::from_secs(60),
        };
        let signal = signals[kills.count as usize % signals.len()];
        let mut child = program.command(arguments).stderr(Stdio::piped()).spawn().unwrap();
        let begin = Instant::now();
        while child.try_wait().unwrap().is_none() && begin.elapsed() < end {
            sleep(Duration::from_millis(2));
        }
        let has_ended = child.try_wait().unwrap().is_some();
        if !has_ended {
            kill(&child, signal);
        }
        let output = child.wait_with_output().unwrap();
        let (code, said) = (output.status.code(), talk(&output));
        let from = said.split("going on from c.film, ").nth(1);
        kills.resumed += u32::from(from.is_some_and(|share| !share.starts_with("0.0 %")));
        if code == Some(0) {
            eprintln!("{} kills, by signal and exit code: {codes:?}", kills.count);
            return kills;
        }
        assert!(!has_ended && matches!(code, None | Some(75 | 130 | 143)), "{code:?}: {said}");
        kills.count += 1;
        *codes.entry((signal.to_owned(), code)).or_insert(0) += 1;
    }
}

/// Gives how often it was ended.
fn survives(settings: &[&'static str], signals: &[&str], most: u32) -> u32 {
    let program = Program::new();
    let life = Life::of(&program, "whole.exr", settings);
    let farm = ["--checkpoint", "c.film", "--checkpoint-every", "0.02s", "--resume"];
    let base = ["render", CORNELL_BOX, "-o", "killed.exr"];
    let arguments = [&base[..], settings, &farm].concat();
    let kills = kill_until_done(&program, &arguments, life, most, signals);
    assert_same(&program, "killed.exr", "whole.exr");
    assert!(!program.path("c.film").exists(), "the checkpoint of a render that is done");
    let Kills { count, resumed } = kills;
    assert!(count >= 2 && resumed >= 1, "{count} kills, {resumed} times gone on");
    count
}

fn assert_same(program: &Program, a: &str, b: &str) {
    let read = |name| fs::read(program.path(name)).unwrap();
    assert!(read(a) == read(b), "{a} and {b} differ");
}

#[test]
fn a_render_that_is_killed_again_and_again_has_the_same_bytes() {
    survives(&LONG, &["KILL", "KILL", "TERM", "INT"], 6);
}

#[test]
fn so_has_one_whose_pixels_stop_one_by_one() {
    let adaptive = ["--resolution", "48x40", "--noise", "0.1", "--spp", "512"];
    survives(&adaptive, &["KILL", "TERM"], 6);
}

#[test]
#[ignore = "takes minutes: make kill-study"]
fn fifty_kills_each() {
    let size = ["--resolution", "64x48"];
    let signals = ["KILL", "TERM", "KILL", "TERM", "INT"];
    let fixed = [&size[..], &["--spp", "8192"]].concat();
    let adaptive = [&size[..], &["--noise", "0.01", "--spp", "16384"]].concat();
    for settings in [fixed, adaptive] {
        let count = survives(&settings, &signals, 50);
        assert!(count >= 50, "it ended after {count} kills");
    }
}

/// Fails with this exit code; gives what it said.
fn refused(program: &Program, arguments: &[&str], code: i32) -> String {
    let output: Output = program.run(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", talk(&output));
    talk(&output)
}

#[test]
fn a_checkpoint_is_of_one_render() {
    let program = Program::new();
    let with = |more: &[&'static str]| {
        let farm = ["--checkpoint", "c.film", "--checkpoint-every", "0.01s"];
        render(CORNELL_BOX, "a.exr", &[&SHORT[..], &farm, more].concat())
    };
    let drill = [("STERADIAN_DRILL", "lose-device@4,lose-device@8")];
    let lost = program.command(&with(&[])).envs(drill).output().unwrap();
    assert_eq!(lost.status.code(), Some(75), "{}", talk(&lost));
    assert!(talk(&lost).contains("--resume goes on from the checkpoint"), "{}", talk(&lost));
    assert_eq!(program.files(), ["c.film"]);

    assert!(refused(&program, &with(&[]), 2).contains("go on from it with --resume"));
    let others = [["--seed", "1"], ["--light-samples", "2"], ["--crop", "0,0,8,8"]];
    for other in others {
        let message = refused(&program, &with(&["--resume", other[0], other[1]]), 2);
        assert!(message.contains("is of settings"), "{message}");
    }
    let mut scene = with(&["--resume"]);
    scene[1] = super::QUAD_LIGHT;
    assert!(refused(&program, &scene, 2).contains("is of scene"));

    let whole = fs::read(program.path("c.film")).unwrap();
    let mut bytes = whole.clone();
    bytes[whole.len() / 2] ^= 1;
    for (bytes, word) in [(&bytes[..], "damaged"), (&whole[..whole.len() / 3], "cut off")] {
        fs::write(program.path("c.film"), bytes).unwrap();
        let message = refused(&program, &with(&["--resume"]), 1);
        assert!(message.contains("c.film") && message.contains(word), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    fs::write(program.path("c.film"), &whole).unwrap();
    program.succeed(&with(&["--resume"]));
    program.succeed(&render(CORNELL_BOX, "whole.exr", &SHORT));
    assert_same(&program, "a.exr", "whole.exr");
}

#[test]
fn a_lost_device_is_opened_again() {
    let program = Program::new();
    program.succeed(&render(CORNELL_BOX, "whole.exr", &SHORT));
    let arguments = render(CORNELL_BOX, "lost.exr", &SHORT);
    let drill = |what| program.command(&arguments).env("STERADIAN_DRILL", what).output().unwrap();
    let once = drill("lose-device@5");
    assert_eq!(once.status.code(), Some(0), "{}", talk(&once));
    assert!(talk(&once).contains("opening the device again"), "{}", talk(&once));
    assert_same(&program, "lost.exr", "whole.exr");
    fs::remove_file(program.path("lost.exr")).unwrap();
    let twice = drill("lose-device@5,lose-device@7");
    assert_eq!(twice.status.code(), Some(75), "{}", talk(&twice));
    assert_eq!(program.files(), ["whole.exr"]);
    assert_eq!(drill("lose-it").status.code(), Some(2));
}

/// Renders the parts, in no order, and joins them.
fn merge(program: &Program, count: u32, more: &[&'static str], picture: &str) {
    let names: Vec<String> = (0..count).map(|i| format!("{i}.film")).collect();
    for (i, name) in names.iter().enumerate().rev() {
        let shard = format!("{i}/{count}");
        let base = ["render", CORNELL_BOX, "-q", "-o", name, "--shard", &shard];
        program.succeed(&[&base, more].concat());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    program.succeed(&[&["merge", "-q", "-o", picture], &names[..]].concat());
}

#[test]
fn parts_join_to_the_bytes_of_the_whole() {
    let program = Program::new();
    let layers = ["--layers", "N,Z,id,crypto-object,variance", "--layer-rays", "4"];
    let settings = [&SHORT[..], &layers].concat();
    program.succeed(&render(CORNELL_BOX, "whole.exr", &settings));
    program.succeed(&render(CORNELL_BOX, "whole.png", &SHORT));
    // Of the samples up to five, of the rows beyond.
    for count in [1, 2, 4, 5, 8] {
        merge(&program, count, &settings, "joined.exr");
        assert_same(&program, "joined.exr", "whole.exr");
    }
    merge(&program, 3, &SHORT, "joined.png");
    assert_same(&program, "joined.png", "whole.png");
    let crop = ["--crop", "5,3,30,61", "--path-reuse"];
    let settings = [&SHORT[..], &crop].concat();
    program.succeed(&render(CORNELL_BOX, "crop.exr", &settings));
    for count in [4, 6] {
        merge(&program, count, &settings, "joined.exr");
        assert_same(&program, "joined.exr", "crop.exr");
    }
}

#[test]
fn parts_that_do_not_make_a_whole_are_refused() {
    let program = Program::new();
    merge(&program, 3, &SHORT, "joined.exr");
    fs::remove_file(program.path("joined.exr")).unwrap();
    let merge = |parts: &[&str], code| {
        let message = refused(&program, &[&["merge", "-o", "m.exr"], parts].concat(), code);
        assert!(!program.path("m.exr").exists());
        message
    };
    assert!(merge(&["0.film", "2.film"], 2).contains("of 3 parts these are missing: 1"));
    let twice = merge(&["0.film", "1.film", "2.film", "./1.film"], 2);
    assert!(twice.contains("is part 1/3, and so is"), "{twice}");
    let other = ["--shard", "1/3", "--seed", "1"];
    program.succeed(&render(CORNELL_BOX, "other.film", &[&SHORT[..], &other].concat()));
    assert!(merge(&["0.film", "other.film", "2.film"], 2).contains("is of settings"));
    program.succeed(&render(CORNELL_BOX, "half.film", &[&SHORT[..], &["--shard", "1/2"]].concat()));
    assert!(merge(&["0.film", "half.film"], 2).contains("parts of different numbers"));
    let bytes = fs::read(program.path("1.film")).unwrap();
    fs::write(program.path("cut.film"), &bytes[..bytes.len() - 9]).unwrap();
    assert!(merge(&["0.film", "cut.film", "2.film"], 1).contains("cut off"));
    fs::write(program.path("none.film"), "what is this").unwrap();
    assert!(merge(&["none.film"], 1).contains("is not a film file"));
    assert!(merge(&["missing.film"], 1).contains("missing.film"));
}

#[test]
fn what_cannot_be_cut_is_refused() {
    let program = Program::new();
    let shard = ["--shard", "0/2"];
    let with = |output, more: &[&'static str]| {
        render(CORNELL_BOX, output, &[&SHORT[..], &shard, more].concat())
    };
    assert!(refused(&program, &with("a.film", &["--noise", "0.1"]), 2).contains("--frames"));
    assert!(refused(&program, &with("a.film", &["--time", "9s"]), 2).contains("--spp"));
    // Frames are shared out whole, whatever stops their pixels.
    let frames =
        ["render", CORNELL_BOX, "-q", "-o", "f.png", "--resolution", "8x8", "--noise", "0.5"];
    program.succeed(&[&frames[..], &["--shard", "1/2", "--frames", "3-7"]].concat());
    assert_eq!(program.files(), ["f.0004.png", "f.0006.png"]);
    for name in program.files() {
        fs::remove_file(program.path(&name)).unwrap();
    }
    assert!(refused(&program, &with("a.exr", &[]), 2).contains(".film"));
    let many = ["render", CORNELL_BOX, "-o", "a.film", "--resolution", "8x8", "--shard", "1/99"];
    assert!(refused(&program, &many, 2).contains("--block"));
    assert_eq!(program.files(), [""; 0]);
}

#[test]
fn a_part_that_was_stopped_goes_on_and_joins() {
    let program = Program::new();
    let life = Life::of(&program, "whole.exr", &LONG);
    let farm = ["--checkpoint", "c.film", "--checkpoint-every", "0.02s", "--resume"];
    let part = |output, shard| {
        render(CORNELL_BOX, output, &[&LONG[..], &["--shard", shard], &farm].concat())
    };
    for (output, shard) in [("0.film", "0/2"), ("1.film", "1/2")] {
        kill_until_done(&program, &part(output, shard), life, 3, &["TERM", "KILL"]);
    }
    program.succeed(&["merge", "-q", "0.film", "1.film", "-o", "joined.exr"]);
    assert_same(&program, "joined.exr", "whole.exr");
}

/// Starts a render that would take days, and waits until it traces.
fn endless(program: &Program, more: &[&str]) -> Child {
    let base = ["render", CORNELL_BOX, "--resolution", "16x16", "--spp", "1000000000"];
    let arguments = [&base[..], more].concat();
    let child = program.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(2));
    child
}

fn wait_for(program: &Program, name: &str) {
    let begin = Instant::now();
    while !program.path(name).exists() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no {name}");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn sigusr1_writes_what_there_is_and_goes_on() {
    let program = Program::new();
    let mut child = endless(&program, &["-o", "a.exr"]);
    kill(&child, "USR1");
    wait_for(&program, "a.exr");
    let image = steradian::image::read_exr(&program.path("a.exr")).unwrap();
    assert_eq!(image.metadata["steradian.partial"].to_string(), "true");
    assert!(child.try_wait().unwrap().is_none(), "it has ended");
    kill(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

/// The scheduler's signal, after which the same command is run again.
#[test]
fn sigterm_with_a_checkpoint_asks_to_be_tried_again() {
    let program = Program::new();
    let mut child = endless(&program, &["-o", "a.exr", "--checkpoint", "c.film"]);
    kill(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(75));
    assert_eq!(program.files(), ["a.exr", "c.film"]);
}

#[test]
fn work_is_not_lost_where_the_folder_has_gone() {
    let program = Program::new();
    fs::create_dir(program.path("out")).unwrap();
    let spare = program.path("spare");
    fs::create_dir(&spare).unwrap();
    let base = ["render", CORNELL_BOX, "--resolution", "16x16", "--spp", "1000000000"];
    let arguments = [&base[..], &["-o", "out/a.exr", "--checkpoint", "out/c.film"]].concat();
    let mut command = program.command(&arguments);
    let child = command.env("TMPDIR", &spare).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(2));
    fs::remove_dir_all(program.path("out")).unwrap();
    kill(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let said = talk(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let kept: Vec<_> = fs::read_dir(&spare).unwrap().map(|e| e.unwrap().path()).collect();
    assert_eq!(kept.len(), 1, "{kept:?} {said}");
    assert!(said.contains(kept[0].to_str().unwrap()), "{said}");
    assert!(steradian::image::read_exr(&kept[0].join("a.exr")).is_ok());
}

/// A limit on the size of files, set when the device has its memory, stands for a full disk.
#[test]
fn a_full_disk_leaves_the_old_files() {
    let program = Program::new();
    fs::write(program.path("a.exr"), "old").unwrap();
    let script = format!(
        "trap '' XFSZ; exec {} render {CORNELL_BOX} --resolution 16x16 --spp 1000000000 -o a.exr \
         --checkpoint c.film --checkpoint-every 2.5s",
        env!("CARGO_BIN_EXE_steradian")
    );
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(program.path(".")).env("TMPDIR", program.path("."));
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(2));
    let limit = ["--pid", &child.id().to_string(), "--fsize=512:512"];
    assert!(Command::new("prlimit").args(limit).status().unwrap().success());
    sleep(Duration::from_secs(2));
    kill(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let said = talk(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("warning: no checkpoint") && said.contains("error: a.exr"), "{said}");
    assert_eq!(program.files(), ["a.exr"], "{said}");
    assert_eq!(fs::read(program.path("a.exr")).unwrap(), b"old");
}
