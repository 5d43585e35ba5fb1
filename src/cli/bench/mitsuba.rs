//! Mitsuba 3 as a child that renders what it is asked for (`tools/mitsuba_server.py`).

use super::lane::{Lane, Taken};
use serde::Deserialize;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;
use steradian::image::Picture;
use steradian::renderer::RenderStatistics;
use steradian::{Error, RenderSettings, Result};

/// What the child runs; put into a folder of its own, so that the program needs no other files.
const SCRIPTS: [(&str, &str); 3] = [
    ("mitsuba_server.py", include_str!("../../../tools/mitsuba_server.py")),
    ("mitsuba_scene.py", include_str!("../../../tools/mitsuba_scene.py")),
    ("gltf_reader.py", include_str!("../../../tools/gltf_reader.py")),
];

/// The program that runs them, with Mitsuba loaded.
pub(super) struct Server {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    folder: tempfile::TempDir,
    python: String,
    /// Version and variant.
    pub(super) version: String,
}

#[derive(Deserialize)]
struct Rendered {
    wall: f64,
    cpu: f64,
    spp: f64,
}

impl Server {
    /// Starts Python and waits until Mitsuba is loaded.
    ///
    /// # Errors
    /// [`Error::Io`] where there is no such Python or it has no Mitsuba.
    pub(super) fn start(python: &str) -> Result<Self> {
        let folder = tempfile::tempdir().map_err(|e| Error::io("temporary folder", e))?;
        for (name, text) in SCRIPTS {
            let path = folder.path().join(name);
            std::fs::write(&path, text).map_err(|e| Error::io(path, e))?;
        }
        let mut command = Command::new(python);
        command.arg(folder.path().join(SCRIPTS[0].0));
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|e| {
            let message =
                format!("--against mitsuba needs Python 3, or another name in --python: {e}");
            Error::io(python, std::io::Error::new(e.kind(), message))
        })?;
        let missing = || failed(python, "its pipes are gone");
        let requests = child.stdin.take().ok_or_else(missing)?;
        let answers = BufReader::new(child.stdout.take().ok_or_else(missing)?);
        let version = String::new();
        let python = python.into();
        let mut server = Self { child, requests, answers, folder, python, version };
        let hello = server.answer()?;
        server.version = hello["version"].as_str().unwrap_or_default().into();
        Ok(server)
    }

    /// Loads a scene; gives the seconds that it took.
    pub(super) fn load(
        &mut self,
        scene: &Path,
        sampler: &str,
        settings: &RenderSettings,
    ) -> Result<f64> {
        let scene = std::path::absolute(scene).map_err(|e| Error::io(scene, e))?;
        let (width, height) = settings.resolution;
        let request = json!({
            "load": scene, "width": width, "height": height, "sampler": sampler,
            // Mitsuba counts the segments of a path.
            "max_depth": settings.max_bounces.map_or(-1, |n| i64::from(n) + 1),
            "rr_depth": if settings.roulette { 5 } else { 1 << 30 },
        });
        Ok(self.ask(&request)?["seconds"].as_f64().unwrap_or(f64::NAN))
    }

    /// Renders what was loaded.
    pub(super) fn render(
        &mut self,
        settings: &RenderSettings,
        spp: u32,
        seed: u32,
    ) -> Result<Taken> {
        let path = self.folder.path().join("picture.f32");
        let answer = self.ask(&json!({ "spp": spp, "seed": seed, "path": path }))?;
        let Rendered { wall, cpu, spp } =
            serde_json::from_value(answer).map_err(|e| failed(&self.python, &e.to_string()))?;
        let (width, height) = settings.resolution;
        let bytes = std::fs::read(&path).map_err(|e| Error::io(&path, e))?;
        if bytes.len() != width as usize * height as usize * 12 {
            return Err(failed(&self.python, "Mitsuba's picture has another size"));
        }
        let value = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        let pixel = |b: &[u8]| [value(b), value(&b[4..]), value(&b[8..])];
        let rgb = bytes.chunks_exact(12).map(pixel).collect();
        Ok(Taken { picture: Picture::new(width, height, rgb), wall, cpu, samples: spp })
    }

    fn ask(&mut self, request: &Value) -> Result<Value> {
        let written = writeln!(self.requests, "{request}").and_then(|()| self.requests.flush());
        // If it is gone, its answer says why.
        if let Err(e) = written
            && e.kind() != ErrorKind::BrokenPipe
        {
            return Err(Error::io(&self.python, e));
        }
        self.answer()
    }

    fn answer(&mut self) -> Result<Value> {
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(|e| Error::io(&self.python, e))?;
        if line.is_empty() {
            let remedy =
                "the program beside has ended; Mitsuba comes with: python3 -m pip install mitsuba";
            return Err(failed(&self.python, remedy));
        }
        let answer: Value = serde_json::from_str(&line)
            .map_err(|e| failed(&self.python, &format!("{e}: {line}")))?;
        match answer["error"].as_str() {
            Some(message) => Err(failed(&self.python, message)),
            None => Ok(answer),
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Nothing depends on how it ends.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn failed(python: &str, message: &str) -> Error {
    Error::io(PathBuf::from(python), std::io::Error::other(message.to_owned()))
}

/// Its curve for one scene.
pub(super) struct Mitsuba {
    server: Rc<RefCell<Server>>,
    settings: RenderSettings,
    points: Vec<u32>,
}

impl Mitsuba {
    /// Of the scene that is loaded.
    pub(super) fn new(
        server: Rc<RefCell<Server>>,
        settings: &RenderSettings,
        points: &[u32],
    ) -> Self {
        Self { server, settings: settings.clone(), points: points.into() }
    }
}

impl Lane for Mitsuba {
    fn name(&self) -> &str {
        "Mitsuba"
    }

    fn points(&self) -> usize {
        self.points.len()
    }

    fn take(&mut self, point: usize, seed: u32) -> Result<Taken> {
        self.server.borrow_mut().render(&self.settings, self.points[point], seed)
    }

    fn counts(&self) -> Option<&RenderStatistics> {
        None
    }
}
