//! The program from outside: what it writes, what it says, how it exits. These
//! tests need a Vulkan device.

mod bad_input;
mod bench;
mod display;
mod exit_codes;
mod farm;
mod flags;
mod frames;
mod layers;
mod machines;
mod pictures;
mod reference;
mod scene;
mod settings_file;
mod signals;
mod stopping;
#[cfg(feature = "viewer")]
mod view;
mod views;

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A bundled scene of one emitting rectangle over a grey one.
const QUAD_LIGHT: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/tests/quad-light/quad-light.gltf");

/// The Cornell box.
const CORNELL_BOX: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box/cornell-box.gltf");

/// A bundled scene whose walls both emit and reflect.
const FURNACE_BOX: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/tests/furnace-box/furnace-box.gltf");

/// The program with its work folder, empty at first.
struct Program {
    folder: TempDir,
}

impl Program {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A command that runs in the work folder.
    fn command<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_steradian"));
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs what must succeed; gives what it printed.
    fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", talk(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Renders `scene` with more flags and gives the statistics.
    fn stats(&self, scene: &str, flags: &[&str]) -> Value {
        let base = ["render", scene, "-o", "stats.exr", "--stats", "stats.json"];
        self.succeed(&[&base[..], flags].concat());
        read_json(&self.path("stats.json"))
    }

    /// Names of the files in the work folder.
    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn talk(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn read_json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}
