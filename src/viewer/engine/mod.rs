//! The engine: a thread that owns the scene, the device and the renderer, follows the newest wish, and
//! reports pictures. Each turn is short: a piece of work that the renderer bounds, or one picture of
//! low resolution while things move.

mod develop;
mod load;
mod look;
mod recover;
mod save;
mod show;
mod stage;
#[cfg(test)]
mod tests;
mod views;
mod watch;

use super::link::{Link, News};
use super::wish::{Phase, Progress, Request, Wish};
use crate::cli::flags::JobFlags;
use develop::Developed;
#[cfg(test)]
pub(super) use load::scene_info;
use load::{Loader, Source};
use recover::Losses;
use stage::Stage;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use steradian::gpu::{Device, DeviceKind};
use steradian::passes::Tuning;
use steradian::{Error, Renderer, Result};
use views::Glance;
use watch::Watch;

/// After the camera's last motion, the time until the whole resolution is rendered again.
const REST: Duration = Duration::from_millis(200);
/// Largest side of the squares of a picture in motion, pixels.
const COARSEST: u32 = 16;
/// Seconds of one submission: an answer waits for at most one. Longer ones cost less.
const SUBMIT_SECONDS: f64 = 0.03;
/// Least time between two pictures of a render that goes on.
const PUBLISH_PAUSE: Duration = Duration::from_millis(60);
/// Share of the time that showing pictures may take: one in so many.
const PUBLISH_SHARE: u32 = 5;
/// Where there is nothing to do.
const IDLE: Duration = Duration::from_millis(500);

/// What the engine is started with.
pub(super) struct Options {
    /// As of `steradian render`; for every scene that is opened.
    pub(super) flags: JobFlags,
    /// Name or index of the device.
    pub(super) device: Option<String>,
    /// Folder to read shaders from, in place of those in the program.
    pub(super) shaders: Option<PathBuf>,
    /// Scene to open first.
    pub(super) scene: Option<PathBuf>,
}

/// The thread's state.
pub(super) struct Engine {
    link: Link,
    options: Options,
    device: Option<Arc<Device>>,
    tuning: Tuning,
    source: Source,
    loader: Option<Loader>,
    watch: Watch,
    stage: Option<Stage>,
    wish: Option<(u64, Arc<Wish>)>,
    /// Number of the newest wish that was looked at.
    seen: u64,
    renderer: Option<Renderer>,
    /// It has all its samples, or its time is over.
    is_over: bool,
    /// When the whole resolution may begin.
    resume_at: Instant,
    /// Steps to take although paused.
    steps: u32,
    developed: Developed,
    glance: Option<Glance>,
    /// The next picture had to wait for a kernel.
    has_compiled: bool,
    /// Samples per second, for the size of pictures in motion.
    samples_per_second: f64,
    losses: Losses,
    message_count: u64,
}

impl Engine {
    /// Starts the thread.
    pub(super) fn start(
        link: Link,
        options: Options,
    ) -> std::io::Result<std::thread::JoinHandle<()>> {
        let builder = std::thread::Builder::new().name("engine".into());
        builder.spawn(move || Self::new(link, options).run())
    }

    fn new(link: Link, options: Options) -> Self {
        let source = Source::new(&options);
        Self {
            link,
            device: None,
            tuning: Tuning { submit_seconds: SUBMIT_SECONDS, ..Tuning::default() },
            watch: Watch::new(options.shaders.clone()),
            source,
            options,
            loader: None,
            stage: None,
            wish: None,
            seen: 0,
            renderer: None,
            is_over: false,
            resume_at: Instant::now(),
            steps: 0,
            developed: Developed::default(),
            glance: None,
            has_compiled: false,
            samples_per_second: 1e5,
            losses: Losses::default(),
            message_count: 0,
        }
    }

    fn run(mut self) {
        self.begin();
        loop {
            let patience = self.patience();
            let News { wish, requests, is_over } = self.link.news(patience);
            if is_over {
                break;
            }
            let turn = self.turn(wish, requests);
            if let Err(error) = turn {
                self.recover(&error);
            }
        }
        self.end_loading();
    }

    /// Opens the device and the first scene.
    fn begin(&mut self) {
        match self.read_shaders() {
            Ok(()) => {}
            Err(e) => self.say(e.to_string(), true),
        }
        if let Err(error) = self.open_device() {
            self.link.tell(|report| report.phase = Phase::Failed);
            self.say(error.to_string(), true);
            return;
        }
        if let Some(path) = self.options.scene.clone() {
            self.open(path, false);
        }
    }

    /// One turn of the loop: what is asked, then a piece of work.
    fn turn(&mut self, wish: Option<(u64, Arc<Wish>)>, requests: Vec<Request>) -> Result<()> {
        for request in requests {
            self.serve(request)?;
        }
        self.receive_scene()?;
        self.look_at_files();
        if let Some((serial, wish)) = wish {
            self.follow(serial, &wish)?;
        }
        self.work()
    }

    /// How long there is nothing to do.
    fn patience(&self) -> Duration {
        let is_paused = self.wish.as_ref().is_some_and(|(_, w)| w.is_paused) && self.steps == 0;
        match (&self.stage, &self.renderer) {
            _ if self.loader.is_some() => Duration::from_millis(10),
            (None, _) => IDLE,
            _ if self.unfinished_view().is_some() => {
                self.resume_at.saturating_duration_since(Instant::now()).min(IDLE)
            }
            _ if is_paused => IDLE,
            (Some(_), None) if self.wish.is_some() => {
                self.resume_at.saturating_duration_since(Instant::now()).min(IDLE)
            }
            (Some(_), Some(_)) if !self.is_over => Duration::ZERO,
            _ => IDLE,
        }
    }

    fn serve(&mut self, request: Request) -> Result<()> {
        match request {
            Request::Open(path) => self.open(path, false),
            Request::Reload => {
                self.read_shaders().unwrap_or_else(|e| self.say(e.to_string(), true));
                if let Some(path) = self.source.path().map(PathBuf::from) {
                    self.open(path, true);
                }
            }
            Request::Save(path) => match self.save(&path) {
                Ok(()) => self.say(format!("saved {}", path.display()), false),
                Err(e @ Error::DeviceLost(_)) => return Err(e),
                Err(e) => self.say(e.to_string(), true),
            },
            Request::Restart => {
                self.renderer = None;
                self.resume_at = Instant::now();
                if self.device.is_none() {
                    self.losses = Losses::default();
                    self.open_device()?;
                    self.read_again();
                }
            }
            Request::Step => self.steps += 1,
            Request::Pick(pixel) => self.pick(pixel)?,
            Request::Tree => self.show_tree()?,
            #[cfg(test)]
            Request::LoseDevice => return Err(Error::DeviceLost("taken away by a test".into())),
        }
        Ok(())
    }

    /// Compares a wish with the last one, and begins what is new in it.
    fn follow(&mut self, serial: u64, wish: &Arc<Wish>) -> Result<()> {
        let Some(stage) = &mut self.stage else { return Ok(()) };
        if wish.generation != stage.generation {
            // It is about the scene before.
            return Ok(());
        }
        if self.seen == serial {
            return Ok(());
        }
        self.seen = serial;
        let before = self.wish.replace((serial, wish.clone()));
        let before = before.filter(|(_, w)| w.generation == stage.generation);
        let last = before.as_ref().map(|(_, w)| w.as_ref());
        let is_same = last.is_some_and(|last| {
            (&last.camera, last.base, &last.settings, &last.environment)
                == (&wish.camera, wish.base, &wish.settings, &wish.environment)
        });
        if is_same {
            let is_paused = wish.is_paused;
            self.link.tell(|report| match report.phase {
                Phase::Rendering if is_paused => report.phase = Phase::Paused,
                Phase::Paused if !is_paused => report.phase = Phase::Rendering,
                _ => {}
            });
            return match last.map(|last| last.view) {
                Some(view) if view == wish.view => self.show_again(),
                _ => self.change_view(),
            };
        }
        // Things that are dragged come many times: the whole resolution waits for their rest.
        let is_restart = last.is_none_or(|last| {
            last.camera == wish.camera
                && last.environment == wish.environment
                && last.settings.resolution == wish.settings.resolution
        });
        match stage.apply(wish) {
            Ok(()) => {}
            Err(e @ Error::DeviceLost(_)) => return Err(e),
            Err(e) => {
                // What was before goes on, and the window is told to wish for that again.
                let good = before.as_ref().map(|(_, wish)| wish.clone());
                self.link.tell(|report| report.refused = Some((serial, good)));
                self.say(e.to_string(), true);
                self.wish = before.map(|(_, wish)| (serial, wish));
                return Ok(());
            }
        }
        self.renderer = None;
        self.resume_at = if is_restart { Instant::now() } else { Instant::now() + REST };
        self.show_motion()
    }

    /// One piece of the render.
    fn work(&mut self) -> Result<()> {
        let Some((serial, wish)) = self.wish.clone() else { return Ok(()) };
        let Some(stage) = &self.stage else { return Ok(()) };
        if wish.generation != stage.generation {
            return Ok(());
        }
        if let Some(view) = self.unfinished_view() {
            return self.trace_view(view);
        }
        if wish.is_paused && self.steps == 0 {
            return Ok(());
        }
        if self.renderer.is_none() {
            if Instant::now() < self.resume_at {
                return Ok(());
            }
            let made = stage.renderer(&stage.job.settings, &self.tuning);
            match made {
                Ok(renderer) => {
                    self.renderer = Some(renderer);
                    self.is_over = false;
                }
                Err(e @ (Error::DeviceLost(_) | Error::Shader { .. })) => return Err(e),
                Err(e) => {
                    self.say(e.to_string(), true);
                    self.resume_at = Instant::now() + Duration::from_secs(3600);
                    return Ok(());
                }
            }
        }
        let Some(renderer) = &mut self.renderer else { return Ok(()) };
        if self.is_over {
            return Ok(());
        }
        self.is_over = !renderer.step()? || renderer.is_done();
        self.steps = self.steps.saturating_sub(1);
        if self.is_over || wish.is_paused || self.developed.is_due() {
            self.show(serial)?;
        }
        if self.is_over {
            let Progress { spp: (_, most), seconds, .. } = self.link.report().progress;
            let took = crate::cli::talk::duration(seconds);
            crate::cli::talk::line(&format!("done: {most} spp in {took}"));
        }
        Ok(())
    }

    /// A line for the person.
    fn say(&mut self, text: String, is_error: bool) {
        self.message_count += 1;
        let serial = self.message_count;
        let prefix = if is_error { "error: " } else { "" };
        crate::cli::talk::line(&format!("{prefix}{text}"));
        let message = super::wish::Message { text, is_error, serial };
        self.link.tell(|report| report.message = Some(message));
    }

    fn open_device(&mut self) -> Result<()> {
        let device = Device::open(self.options.device.as_deref())?;
        let info = device.info();
        let (name, driver) = (info.name.clone(), info.driver.clone());
        let is_software = info.kind == DeviceKind::Cpu;
        self.samples_per_second = if is_software { 1e5 } else { 2e7 };
        self.device = Some(Arc::new(device));
        self.link.tell(|report| {
            (report.device, report.driver, report.is_software) = (name, driver, is_software);
        });
        Ok(())
    }
}
