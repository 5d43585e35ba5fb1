//! Pictures, made by calls of the program that the page prints.

use crate::clock::children_seconds;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;
use steradian::image::{Picture, read_picture};

/// Where pictures are made; in the printed commands too.
pub(crate) const FOLDER: &str = "out/gallery";

/// What to render.
#[derive(Clone)]
pub(crate) struct Job {
    /// Path of the scene.
    pub(crate) scene: String,
    /// Columns and rows.
    pub(crate) side: u32,
    /// Samples per pixel.
    pub(crate) spp: u32,
    /// All other flags, with a space between each.
    pub(crate) flags: String,
}

/// A picture and how it came about.
pub(crate) struct Shot {
    /// The call, as one may repeat it in the repository root.
    pub(crate) command: String,
    pub(crate) picture: Picture,
    /// The file of the picture, with its other layers.
    pub(crate) exr: PathBuf,
    /// What `--stats` wrote.
    pub(crate) stats: Value,
    /// Processor time of the call, all threads, less that of the same call at one sample
    /// and 8x8 pixels (of a crop, at one sample): what tracing took, without loading and compiling.
    pub(crate) seconds: f64,
    /// Samples that were not finite, negative or cut off.
    pub(crate) faults: u64,
}

/// A bundled scene.
pub(crate) fn bundled(name: &str) -> String {
    format!("scenes/{name}/{name}.gltf")
}

impl Shot {
    /// The picture's error as the renderer itself estimates it.
    pub(crate) fn estimate(&self) -> f64 {
        self.stats["estimated_relmse"].as_f64().unwrap_or(f64::NAN)
    }
}

impl Job {
    /// `scene` rendered with `flags`.
    pub(crate) fn new(scene: impl Into<String>, side: u32, spp: u32, flags: &str) -> Self {
        Self { scene: scene.into(), side, spp, flags: flags.to_owned() }
    }

    /// With other samples and more flags: the seed is another, so that a picture and its
    /// reference share no sample.
    pub(crate) fn reference(&self, spp: u32) -> Self {
        let flags = format!("{} --seed 1", self.flags);
        Self { spp, flags: flags.trim().to_owned(), ..self.clone() }
    }

    /// Name of the files: scene, pixels of a side, samples per pixel, flags.
    fn stem(&self) -> String {
        let scene = Path::new(&self.scene).file_stem().unwrap_or_default().to_string_lossy();
        let mut stem = format!("{scene}-{}-{}", self.side, self.spp);
        let mut words = self.flags.split_whitespace();
        while let Some(word) = words.next() {
            stem += match word {
                "--max-bounces" => "-m",
                "--only-bounce" => "-b",
                "--light-samples" => "-l",
                "--seed" => "-s",
                "--crop" => "-crop",
                "--noise" => "-noise",
                "--strategy" | "--sampler" | "--accel" | "--adaptive" | "--preset" => "-",
                other => other,
            };
            stem += &words.next().unwrap_or_default().replace(':', "");
        }
        stem
    }

    fn arguments(&self) -> String {
        let Self { scene, side, spp, flags } = self;
        let file = format!("{FOLDER}/{}", self.stem());
        let call = format!("render -q {scene} --resolution {side}x{side} --spp {spp} {flags}");
        format!("{} -o {file}.exr --stats {file}.json", call.trim())
    }
}

/// The program, and the pictures that it has made.
pub(crate) struct Program {
    path: PathBuf,
    built: SystemTime,
}

impl Program {
    /// The program beside this one, in the folder of the build.
    pub(crate) fn find() -> Result<Self, String> {
        let path = sibling("../steradian")?;
        let built = modified(&path).ok_or(format!("{}: build it first", path.display()))?;
        fs::create_dir_all(FOLDER).map_err(|e| format!("{FOLDER}: {e}"))?;
        Ok(Self { path, built })
    }

    /// The picture of `job`, of which every sample must be good.
    pub(crate) fn shot(&self, job: &Job) -> Result<Shot, String> {
        let shot = self.attempt(job)?;
        match shot.faults {
            0 => Ok(shot),
            faults => Err(format!("{faults} faulty samples: {}", shot.command)),
        }
    }

    /// The picture of `job`: rendered, unless there is one newer than program and scene.
    pub(crate) fn attempt(&self, job: &Job) -> Result<Shot, String> {
        let file = format!("{FOLDER}/{}", job.stem());
        let (exr, time) = (PathBuf::from(format!("{file}.exr")), format!("{file}.seconds"));
        let needed = modified(Path::new(&job.scene)).map_or(self.built, |t| t.max(self.built));
        let is_kept = modified(Path::new(&time)).is_some_and(|then| then > needed);
        if !is_kept {
            self.render(job, &time)?;
        }
        let stats = read_json(&format!("{file}.json"))?;
        let seconds = read_json(&time)?["seconds"].as_f64().ok_or("no seconds")?;
        let picture = read_picture(&exr).map_err(|e| e.to_string())?;
        let command = format!("steradian {}", job.arguments());
        let faults = stats["faults"].as_object();
        let faults = faults.map_or(0, |f| f.values().filter_map(Value::as_u64).sum());
        Ok(Shot { command, picture, exr, stats, seconds, faults })
    }

    fn render(&self, job: &Job, time: &str) -> Result<(), String> {
        eprintln!("steradian {}", job.arguments());
        // The first call compiles, the second finds that in the driver's cache.
        let side = if job.flags.contains("--crop") { job.side } else { 8 };
        let start_up = Job { side, spp: 1, ..job.clone() };
        self.call(&start_up.arguments())?;
        let start_up = self.call(&start_up.arguments())?;
        let seconds = (self.call(&job.arguments())? - start_up).max(0.0);
        let text = json!({ "seconds": seconds }).to_string();
        fs::write(time, text).map_err(|e| format!("{time}: {e}"))
    }

    /// Runs the program; gives its processor time.
    fn call(&self, arguments: &str) -> Result<f64, String> {
        run(&self.path, arguments)
    }
}

/// Runs `make_scenes` of the same build.
pub(crate) fn make_scenes(arguments: &str) -> Result<(), String> {
    run(&sibling("make_scenes")?, arguments).map(|_| ())
}

fn run(program: &Path, arguments: &str) -> Result<f64, String> {
    let before = children_seconds();
    let output = Command::new(program).args(arguments.split(' ')).output();
    let output = output.map_err(|e| format!("{}: {e}", program.display()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{} {arguments}: {}\n{said}", program.display(), output.status));
    }
    Ok(children_seconds() - before)
}

fn sibling(relative: &str) -> Result<PathBuf, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    Ok(this.parent().unwrap_or(Path::new(".")).join(relative))
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|m| m.modified()).ok()
}

fn read_json(path: &str) -> Result<Value, String> {
    let text = fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))?;
    serde_json::from_str(&text).map_err(|e| format!("{path}: {e}"))
}
