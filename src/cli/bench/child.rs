//! This program in a process of its own: with other caches, other threads, and an end.

use super::flags::BenchFlags;
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use steradian::{Error, Result};

/// How often a child is looked at.
const LOOK: Duration = Duration::from_millis(2);
/// Folders of shader caches, by driver: Mesa and NVIDIA.
const CACHES: [&str; 2] = ["MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH"];

/// A `render` to do.
pub(super) struct Request {
    pub(super) flags: Vec<OsString>,
    /// The driver's shader cache; the user's own if none is named.
    pub(super) cache: Option<PathBuf>,
    pub(super) variables: Vec<(&'static str, String)>,
    /// The child is stopped after this.
    pub(super) limit: Option<Duration>,
}

/// What came of it.
pub(super) struct Rendered {
    /// Seconds of the whole process.
    pub(super) wall: f64,
    /// `--stats`.
    pub(super) stats: Value,
    /// The picture's bytes, without what is written about it.
    pub(super) picture: steradian::image::Picture,
}

impl Request {
    /// Of a scene with the flags that say what is seen.
    pub(super) fn new(scene: &Path, flags: &BenchFlags) -> Self {
        let mut words: Vec<OsString> = vec!["render".into(), scene.into(), "--quiet".into()];
        let mut add = |name: &str, value: Option<OsString>| {
            if let Some(value) = value {
                words.extend([name.into(), value]);
            }
        };
        let number = |value: Option<f32>| value.map(|v| v.to_string().into());
        let environment = &flags.environment;
        add("--camera", flags.camera.camera.as_ref().map(Into::into));
        add("--aperture", number(flags.camera.aperture));
        add("--focus", number(flags.camera.focus));
        add("--environment", environment.environment.as_ref().map(Into::into));
        let radiance = environment.environment_radiance;
        add("--environment-radiance", radiance.map(|r| format!("{},{},{}", r.x, r.y, r.z).into()));
        add("--environment-rotation", number(environment.environment_rotation));
        add("--environment-intensity", number(environment.environment_intensity));
        add("--max-bounces", flags.sampling.max_bounces.map(|n| n.to_string().into()));
        add("--seed", Some(flags.sampling.seed.to_string().into()));
        add("--device", flags.device.as_ref().map(Into::into));
        for folder in &flags.scene.allow_external {
            add("--allow-external", Some(folder.into()));
        }
        Self { flags: words, cache: None, variables: Vec::new(), limit: None }
    }
}

/// Renders in a child and waits; `None` if the limit came first.
pub(super) fn render(request: &Request) -> Result<Option<Rendered>> {
    let folder = tempfile::tempdir().map_err(|e| Error::io("temporary folder", e))?;
    let [picture, stats] = ["a.exr", "a.json"].map(|name| folder.path().join(name));
    let program = std::env::current_exe().map_err(|e| Error::io("this program", e))?;
    let mut command = Command::new(&program);
    command.args(&request.flags).arg("-o").arg(&picture).arg("--stats").arg(&stats);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    if let Some(cache) = &request.cache {
        CACHES.iter().for_each(|name| {
            command.env(name, cache);
        });
    }
    command.envs(request.variables.iter().map(|(name, value)| (*name, value)));
    let begin = Instant::now();
    let mut child = command.spawn().map_err(|e| Error::io(&program, e))?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| Error::io(&program, e))? {
            break status;
        }
        if request.limit.is_some_and(|limit| begin.elapsed() >= limit) {
            // It may have ended by itself just now.
            let _ = child.kill();
            let _ = child.wait();
            return Ok(None);
        }
        std::thread::sleep(LOOK);
    };
    let wall = begin.elapsed().as_secs_f64();
    if !status.success() {
        let mut said = String::new();
        if let Some(mut pipe) = child.stderr.take() {
            use std::io::Read;
            // What it said is for people only.
            let _ = pipe.read_to_string(&mut said);
        }
        let message = format!("a render in a child failed ({status}): {}", said.trim());
        return Err(Error::io(&program, std::io::Error::other(message)));
    }
    let text = std::fs::read(&stats).map_err(|e| Error::io(&stats, e))?;
    let stats = serde_json::from_slice(&text).map_err(|e| Error::io(&stats, e.into()))?;
    let picture = steradian::image::read_picture(&picture)?;
    Ok(Some(Rendered { wall, stats, picture }))
}

impl Rendered {
    /// A number of the statistics.
    pub(super) fn number(&self, name: &str) -> f64 {
        self.stats[name].as_f64().unwrap_or(f64::NAN)
    }
}
