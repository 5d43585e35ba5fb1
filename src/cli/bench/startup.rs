//! Time to the first pixel, and whether equal runs compile again.

use super::child::{self, Rendered, Request};
use super::flags::BenchFlags;
use super::words::number;
use crate::cli::job::Job;
use crate::cli::talk;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;
use steradian::bench::{Section, Table};
use steradian::{Error, Result};

/// Renders after the first.
const AGAIN: usize = 2;

/// Of every scene.
pub(super) fn section(flags: &BenchFlags) -> Result<Section> {
    let columns = [
        "scene",
        "shader cache",
        "whole program, s",
        "load",
        "trees",
        "compile",
        "sample",
        "new cache files",
    ];
    let mut table = Table::new("", &columns);
    let mut data = Vec::new();
    for scene in &flags.scenes {
        let job = Job::new(scene, &flags.job(1))?;
        talk::line(&format!("{}: start-up", job.scene.name));
        let (width, height) = job.settings.resolution;
        let folder = tempfile::tempdir().map_err(|e| Error::io("temporary folder", e))?;
        let mut request = Request::new(scene, flags);
        let size = format!("{width}x{height}");
        request.flags.extend(["--spp", "1", "--resolution", &size].map(Into::into));
        request.cache = Some(folder.path().to_owned());
        request.limit = Some(Duration::from_secs_f64(flags.compile_limit));
        for run in 0..=AGAIN {
            let before = files(folder.path());
            let Some(rendered) = child::render(&request)? else {
                let message = format!("start-up took more than {} s", flags.compile_limit);
                return Err(Error::io(scene, std::io::Error::other(message)));
            };
            let new = files(folder.path()).difference(&before).count();
            let state =
                if run == 0 { "empty".to_owned() } else { format!("used, run {}", run + 1) };
            table.row(row(&job.scene.name, &state, &rendered, new));
            data.push(json!({
                "scene": job.scene.name, "run": run + 1, "wall_seconds": rendered.wall,
                "compile_seconds": rendered.number("compile_seconds"), "new_cache_files": new,
            }));
        }
    }
    Ok(Section {
        title: "Start-up".into(),
        text: vec![
            "From the start of a process to its picture of one sample a pixel on the disk, with an empty shader \
             cache of the driver and again with what this leaves. Whatever a run compiles anew is a new file of the \
             cache; drivers that keep none of their own there show 0 throughout."
                .into(),
        ],
        tables: vec![table],
        data: json!(data),
        ..Section::default()
    })
}

fn row(scene: &str, state: &str, rendered: &Rendered, new: usize) -> Vec<String> {
    let names = ["load_seconds", "bvh_seconds", "compile_seconds", "render_seconds"];
    let mut cells = vec![scene.to_owned(), state.to_owned(), number(rendered.wall)];
    cells.extend(names.map(|name| number(rendered.number(name))));
    cells.push(new.to_string());
    cells
}

/// All files of a folder and the folders in it with their sizes. What cannot be read is left out.
fn files(folder: &Path) -> BTreeSet<(PathBuf, u64)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return BTreeSet::new() };
    let mut found = BTreeSet::new();
    for entry in entries.flatten() {
        let path = entry.path();
        match entry.metadata() {
            Ok(data) if data.is_dir() => found.append(&mut files(&path)),
            Ok(data) => {
                found.insert((path, data.len()));
            }
            Err(_) => {}
        }
    }
    found
}
