//! `steradian view` where there can be no window; `tools/test_viewer.sh` opens real ones.

use super::{Program, QUAD_LIGHT, talk};

#[test]
fn without_a_display_there_is_one_line_and_a_code() {
    let program = Program::new();
    let mut command = program.command(&["view", QUAD_LIGHT]);
    let output = command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap();
    assert_eq!(output.status.code(), Some(4));
    let talk = talk(&output);
    assert!(talk.contains("no display") && talk.contains("steradian render"), "{talk}");
    assert_eq!(talk.lines().count(), 1, "{talk}");
}

#[test]
fn flags_that_make_no_sense_in_a_window_are_refused() {
    let program = Program::new();
    for flags in [&["--reference"][..], &["--pixel", "1,1"], &["--bits", "16"], &["-o", "a.jpg"]] {
        let output = program.run(&[&["view", QUAD_LIGHT], flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", talk(&output));
        assert_eq!(talk(&output).lines().count(), 1, "{}", talk(&output));
    }
    let output = program.run(&["view", "-o", "nowhere/a.png"]);
    assert_eq!(output.status.code(), Some(1), "{}", talk(&output));
}
