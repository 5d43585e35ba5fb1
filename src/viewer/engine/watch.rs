//! Whether files have changed: the scene's, and those of shaders.
//!
//! Asked twice a second by size and time, which works on every file system; a change counts once it
//! has held still.

use super::stage::in_motion;
use super::{COARSEST, Engine};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};
use steradian::passes::Tuning;
use steradian::shader::{Library, library};
use steradian::{Error, Renderer, Result};

const INTERVAL: Duration = Duration::from_millis(500);

/// Size and time of files; `None` for one that is not there.
type State = BTreeMap<PathBuf, Option<(u64, SystemTime)>>;

/// Files to look at.
pub(super) struct Watch {
    scene: Seen,
    shaders: Seen,
    folder: Option<PathBuf>,
    next: Instant,
}

/// What was seen of some files.
#[derive(Default)]
struct Seen {
    /// As they were read.
    known: State,
    /// As they were at the last look.
    last: State,
}

impl Seen {
    fn new(files: impl Iterator<Item = PathBuf>) -> Self {
        let known: State = files.map(|f| (f.clone(), stamp(&f))).collect();
        Self { last: known.clone(), known }
    }

    /// Whether they differ from what was read, and not from the last look.
    fn has_settled_anew(&mut self) -> bool {
        let now: State = self.known.keys().map(|f| (f.clone(), stamp(f))).collect();
        let is_new = now != self.known && now == self.last;
        self.last.clone_from(&now);
        if is_new {
            self.known = now;
        }
        is_new
    }
}

fn stamp(path: &Path) -> Option<(u64, SystemTime)> {
    let metadata = path.metadata().ok()?;
    Some((metadata.len(), metadata.modified().ok()?))
}

impl Watch {
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        Self { scene: Seen::default(), shaders: Seen::default(), folder, next: Instant::now() }
    }

    /// Looks at a scene's files from now on.
    pub(super) fn files_of(&mut self, scene: &Path) {
        self.scene = Seen::new(files_of(scene).into_iter());
    }
}

/// The scene's file and those that it names.
fn files_of(scene: &Path) -> Vec<PathBuf> {
    let mut files = vec![scene.to_owned()];
    let folder = scene.parent().unwrap_or(Path::new(""));
    let json = std::fs::read(scene).ok().filter(|bytes| bytes.first() == Some(&b'{'));
    let document = json.and_then(|b| serde_json::from_slice::<serde_json::Value>(&b).ok());
    for list in ["buffers", "images"] {
        let Some(items) = document.as_ref().and_then(|d| d[list].as_array()) else { continue };
        let uris = items.iter().filter_map(|item| item["uri"].as_str());
        for uri in uris.filter(|uri| !uri.starts_with("data:")) {
            let name = percent_encoding::percent_decode_str(uri).decode_utf8_lossy();
            files.push(folder.join(name.as_ref()));
        }
    }
    files
}

impl Engine {
    /// Reads what has changed.
    pub(super) fn look_at_files(&mut self) {
        if Instant::now() < self.watch.next {
            return;
        }
        self.watch.next = Instant::now() + INTERVAL;
        if self.watch.shaders.has_settled_anew() {
            match self.read_shaders() {
                Ok(()) => self.say("shaders read again".into(), false),
                Err(e) => self.say(format!("{e}; the shaders before stay"), true),
            }
        }
        if self.loader.is_none()
            && self.watch.scene.has_settled_anew()
            && let Some(path) = self.source.path().map(PathBuf::from)
        {
            self.say(format!("{} has changed", path.display()), false);
            self.open(path, true);
        }
    }

    /// Takes the shaders of the folder, if there is one and they work.
    pub(super) fn read_shaders(&mut self) -> Result<()> {
        let Some(folder) = self.watch.folder.clone() else { return Ok(()) };
        let names = library();
        let file = |name: &str| folder.join(format!("{name}.wgsl"));
        self.watch.shaders = Seen::new(names.keys().map(|name| file(name)));
        let mut read = Library::new();
        for name in names.into_keys() {
            let path = file(name);
            let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
            read.insert(name, Cow::Owned(text));
        }
        let tuning = Tuning { library: read, ..self.tuning.clone() };
        if let Some(stage) = &self.stage {
            let small = in_motion(&stage.job.settings, COARSEST);
            Renderer::of_prepared(stage.prepared.clone(), &stage.job.scene, &small, &tuning)?;
        }
        self.tuning = tuning;
        self.renderer = None;
        self.resume_at = Instant::now();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_once_when_it_has_settled() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        std::fs::write(&file, "1").unwrap();
        let mut seen = Seen::new([file.clone()].into_iter());
        assert!(!seen.has_settled_anew());
        std::fs::write(&file, "12").unwrap();
        assert!(!seen.has_settled_anew(), "still being written, perhaps");
        assert!(seen.has_settled_anew());
        assert!(!seen.has_settled_anew());
        std::fs::remove_file(&file).unwrap();
        assert!(!seen.has_settled_anew());
        assert!(seen.has_settled_anew());
    }

    #[test]
    fn the_files_of_a_scene_are_those_it_names() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("s.gltf");
        let json =
            r#"{"buffers":[{"uri":"a%20b.bin"},{"uri":"data:x,"}],"images":[{"uri":"c.png"}]}"#;
        std::fs::write(&scene, json).unwrap();
        let names = ["s.gltf", "a b.bin", "c.png"].map(|n| folder.path().join(n));
        assert_eq!(files_of(&scene), names);
    }
}
