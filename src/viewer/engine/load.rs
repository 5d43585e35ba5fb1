//! Loading, beside the engine's own work: the scene before stays until the next one is ready.

use super::stage::{Stage, in_motion};
use super::{COARSEST, Engine, Options};
use crate::cli::flags::{CameraFlags, EnvironmentFlags, JobFlags};
use crate::cli::job::Job;
use crate::viewer::link::Link;
use crate::viewer::wish::{Phase, SceneInfo};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Instant;
use steradian::gpu::Device;
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::scene::gltf::load_with;
use steradian::scene::{Environment, Treatment};
use steradian::{Error, Renderer, Result};

/// Where scenes come from.
pub(super) struct Source {
    flags: JobFlags,
    path: Option<PathBuf>,
    generation: u64,
}

/// A scene on its way.
pub(super) struct Loader {
    result: Receiver<Result<Loaded>>,
    thread: JoinHandle<()>,
    path: PathBuf,
    is_again: bool,
}

/// A scene that arrived.
struct Loaded {
    job: Job,
    prepared: PreparedScene,
    /// The scene's own, before the flags.
    environment: Option<Environment>,
    /// Those of the file.
    own_camera_count: usize,
}

impl Source {
    pub(super) fn new(options: &Options) -> Self {
        Self { flags: options.flags.clone(), path: options.scene.clone(), generation: 0 }
    }

    /// The scene that is shown or on its way.
    pub(super) fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Flags for a scene: those about one scene's camera, part and light are for the first alone.
    fn flags_for(&mut self, path: &Path) -> JobFlags {
        if self.path.as_deref() != Some(path) {
            self.flags.camera = CameraFlags::default();
            self.flags.environment = EnvironmentFlags::default();
            self.flags.picture.crop = None;
            self.path = Some(path.to_owned());
        }
        self.flags.clone()
    }
}

impl Engine {
    /// Begins to load; `is_again`: the same scene, whose view stays.
    pub(super) fn open(&mut self, path: PathBuf, is_again: bool) {
        let Some(device) = self.device.clone() else { return };
        self.end_loading();
        let flags = self.source.flags_for(&path);
        let (sender, result) = channel();
        let (link, tuning, file) = (self.link.clone(), self.tuning.clone(), path.clone());
        let work = move || {
            // The engine may have lost interest.
            let _ = sender.send(load(&link, &file, &flags, device, &tuning));
            link.busy(None);
        };
        match std::thread::Builder::new().name("loader".into()).spawn(work) {
            Ok(thread) => self.loader = Some(Loader { result, thread, path, is_again }),
            Err(e) => self.say(format!("cannot load {}: {e}", path.display()), true),
        }
    }

    /// Reads the scene of a device that is gone for a new one.
    pub(super) fn read_again(&mut self) {
        if let Some(path) = self.source.path().map(PathBuf::from) {
            self.open(path, true);
        }
    }

    /// Waits for a thread that loads; its result is not wanted.
    pub(super) fn end_loading(&mut self) {
        if let Some(loader) = self.loader.take() {
            // A panic has been reported.
            let _ = loader.thread.join();
        }
    }

    /// Takes a scene that has arrived.
    pub(super) fn receive_scene(&mut self) -> Result<()> {
        let Some(loader) = &self.loader else { return Ok(()) };
        let result = match loader.result.try_recv() {
            Err(TryRecvError::Empty) => return Ok(()),
            Err(TryRecvError::Disconnected) => {
                Err(Error::scene(&loader.path, "loading it ended without a result"))
            }
            Ok(result) => result,
        };
        let Some(loader) = self.loader.take() else { return Ok(()) };
        self.watch.files_of(&loader.path);
        match result {
            Ok(loaded) => self.show_scene(&loader, loaded),
            Err(e @ Error::DeviceLost(_)) => return Err(e),
            Err(e) => {
                // The scene before stays; so does its name for Reload, unless there is none.
                if let Some(shown) = self.link.report().scene.as_ref() {
                    self.source.path = Some(shown.path.clone());
                }
                self.say(e.to_string(), true);
            }
        }
        Ok(())
    }

    fn show_scene(&mut self, loader: &Loader, loaded: Loaded) {
        let Loaded { job, prepared, environment, own_camera_count } = loaded;
        self.source.generation += 1;
        let flags = self.source.flags.clone();
        let seconds = prepared.build_seconds();
        let generation = self.source.generation;
        let mut info = scene_info(&loader.path, &job, &flags, generation, own_camera_count);
        info.is_again = loader.is_again;
        info.seconds.1 = seconds;
        let seconds = info.seconds.0 + info.seconds.1;
        self.say(format!("{}: ready in {}", info.name, crate::cli::talk::duration(seconds)), false);
        self.renderer = None;
        self.stage = Some(Stage {
            environment,
            applied: flags.environment,
            camera_count: job.scene.cameras.len(),
            generation: info.generation,
            prepared: Arc::new(prepared),
            job,
        });
        self.link.tell(|report| {
            report.scene = Some(Arc::new(info));
            report.tree = None;
            report.phase = Phase::Rendering;
        });
    }
}

/// What the window needs to know of a scene that is not prepared yet. `flags`: those that made
/// `job`; the file has the first `own_camera_count` of its cameras.
pub(in crate::viewer) fn scene_info(
    path: &Path,
    job: &Job,
    flags: &JobFlags,
    generation: u64,
    own_camera_count: usize,
) -> SceneInfo {
    let scene = &job.scene;
    let is_told = |n: &&steradian::scene::Notice| n.treatment != Treatment::Honoured;
    SceneInfo {
        generation,
        is_again: false,
        path: path.to_owned(),
        name: scene.name.clone(),
        cameras: scene.cameras.clone(),
        own_camera_count,
        bounds: scene.bounds().unwrap_or_default(),
        settings: job.settings.clone(),
        environment: flags.environment.clone(),
        has_environment: scene.environment.is_some(),
        has_fixed_size: flags.picture.resolution.is_some(),
        exposure_ev: flags.picture.png.exposure,
        tone_curve: flags.picture.png.tone_map,
        view: flags.picture.view,
        animation: [flags.scene.frame_time.map(|t| t.to_string()), flags.scene.animation.clone()],
        has_lens_flags: flags.camera.aperture.is_some() || flags.camera.focus.is_some(),
        primitive_count: scene.primitive_count(),
        seconds: (job.load_seconds, 0.0),
        notices: scene.notices.iter().filter(is_told).map(|n| n.message.clone()).collect(),
    }
}

/// Everything that takes long, with a word about what is going on.
fn load(
    link: &Link,
    path: &Path,
    flags: &JobFlags,
    device: Arc<Device>,
    tuning: &Tuning,
) -> Result<Loaded> {
    let tell = |what| link.busy(Some(what));
    tell("reading the scene");
    let begin = Instant::now();
    let scene = load_with(path, &flags.scene.options())?;
    let (environment, own_camera_count) = (scene.environment.clone(), scene.cameras.len());
    let job = Job::of(scene, flags, begin)?;
    tell("building trees");
    let prepared = Arc::new(PreparedScene::new(device, &job.scene, &job.settings)?);
    tell("compiling shaders");
    // Kernels stay with the device: the first picture finds this one ready.
    let small = in_motion(&job.settings, COARSEST);
    Renderer::of_prepared(prepared.clone(), &job.scene, &small, tuning)?;
    let prepared = Arc::into_inner(prepared)
        .ok_or_else(|| Error::DeviceLost("a render outlived its test".into()))?;
    Ok(Loaded { job, prepared, environment, own_camera_count })
}
