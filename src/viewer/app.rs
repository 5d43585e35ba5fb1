//! The window's content, one frame at a time. Knows nothing of windows: it is given input and a
//! place to draw, so that it can be tested without one.

use super::canvas::Canvas;
use super::keys::{self, Action};
use super::latency::Latency;
use super::link::Link;
use super::navigate;
use super::preferences::Preferences;
use super::tree::TreeView;
use super::wish::{Message, Report, Request, SceneInfo, Wish};
use super::{help, panel, status};
use crate::cli::flags::EnvironmentFlags;
use egui::{Panel, Ui};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use steradian::image::DisplayTransform;
use steradian::settings::Strategy;

/// How long a message is shown.
const MESSAGE_TIME: Duration = Duration::from_secs(6);
const ERROR_TIME: Duration = Duration::from_secs(20);
/// Width of the panel, points.
const PANEL_WIDTH: f32 = 264.0;

/// All of the window's state.
pub(super) struct App {
    pub(super) link: Link,
    pub(super) scene: Option<Arc<SceneInfo>>,
    pub(super) wish: Option<Wish>,
    sent: Option<Wish>,
    sent_serial: u64,
    /// Number of the last pick that was taken.
    picked: u64,
    /// Number of the last wish that was given up.
    refused: u64,
    pub(super) canvas: Canvas,
    pub(super) tree: TreeView,
    pub(super) preferences: Preferences,
    pub(super) latency: Latency,
    pub(super) is_help_open: bool,
    /// Sides of the squares that a picture's pixel covers on the display, physical pixels.
    pub(super) pixel_size: u32,
    /// Estimator to go back to from the hemisphere's.
    pub(super) strategy_before: Strategy,
    message: Option<(Message, Instant)>,
    message_serial: u64,
    /// Where S saves; by the scene's name if there is none.
    pub(super) output: Option<PathBuf>,
    /// By buttons of this frame.
    pub(super) asked: Vec<Action>,
    dialog: Option<std::sync::mpsc::Receiver<Option<PathBuf>>>,
    /// The window should close.
    pub(super) is_over: bool,
}

impl App {
    /// `output`: the file that saving writes.
    pub(super) fn new(link: Link, preferences: Preferences, output: Option<PathBuf>) -> Self {
        Self {
            link,
            scene: None,
            wish: None,
            sent: None,
            sent_serial: 0,
            refused: 0,
            picked: 0,
            canvas: Canvas::default(),
            tree: TreeView::default(),
            preferences,
            latency: Latency::new(),
            is_help_open: false,
            pixel_size: 1,
            strategy_before: Strategy::Mis,
            message: None,
            message_serial: 0,
            output,
            asked: Vec::new(),
            dialog: None,
            is_over: false,
        }
    }

    /// What the engine says now.
    pub(super) fn report(&self) -> Report {
        self.link.report()
    }

    /// One frame.
    pub(super) fn ui(&mut self, ui: &mut Ui) {
        let report = self.link.report();
        self.adopt(&report);
        self.take_back(&report);
        self.take_pick(&report);
        self.take_message(&report);
        self.take_files(ui);
        self.take_keys(ui);
        Panel::bottom("status").show(ui, |ui| status::show(ui, self, &report));
        if self.preferences.is_panel_open {
            let panel = Panel::right("panel").default_size(PANEL_WIDTH).resizable(true);
            panel.show(ui, |ui| panel::show(ui, self, &report));
        }
        for action in std::mem::take(&mut self.asked) {
            self.act(ui, action);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| super::canvas::show(ui, self, &report));
        if self.is_help_open {
            help::show(ui, &mut self.is_help_open);
        }
        self.send();
    }

    /// Begins to show a scene that has arrived.
    fn adopt(&mut self, report: &Report) {
        let Some(info) = &report.scene else { return };
        if self.scene.as_ref().is_some_and(|s| s.generation == info.generation) {
            return;
        }
        let is_first = self.scene.is_none();
        if is_first && report.is_software && !info.has_fixed_size {
            // A quarter of the work; the panel says so.
            self.pixel_size = 2;
        }
        let wish = match self.wish.take().filter(|_| info.is_again) {
            Some(wish) => Wish {
                generation: info.generation,
                base: wish.base.min(info.cameras.len().saturating_sub(1)),
                ..wish
            },
            None => {
                let wish = self.first_wish(info);
                self.canvas.begin(&wish.camera);
                wish
            }
        };
        self.wish = Some(wish);
        self.tree = TreeView::default();
        self.scene = Some(info.clone());
    }

    fn first_wish(&self, info: &Arc<SceneInfo>) -> Wish {
        let base = info.settings.camera;
        let mut settings = info.settings.clone();
        let display = self.sent.as_ref().map_or_else(
            || DisplayTransform {
                exposure_ev: info.exposure_ev.unwrap_or(0.0),
                tone_curve: info.tone_curve.unwrap_or(self.preferences.tone_curve()),
            },
            |before| before.display,
        );
        if let Some(before) = &self.sent {
            // The way to sample stays from scene to scene; what is about one scene does not.
            let (resolution, crop) = (settings.resolution, None);
            settings = before.settings.clone();
            (settings.resolution, settings.crop) = (resolution, crop);
        }
        Wish {
            generation: info.generation,
            base,
            camera: info.cameras[base].clone(),
            settings,
            environment: info.environment.clone(),
            display,
            view: self.sent.as_ref().map_or(info.view, |before| before.view),
            is_paused: false,
        }
    }

    /// Gives up a wish that the engine cannot follow.
    fn take_back(&mut self, report: &Report) {
        let Some((serial, good)) = &report.refused else { return };
        if *serial != self.sent_serial || self.refused == *serial {
            return;
        }
        self.refused = *serial;
        if let (Some(good), Some(wish)) = (good, &mut self.wish) {
            *wish = Wish { display: wish.display, view: wish.view, ..good.as_ref().clone() };
        }
    }

    /// Turns about what was picked, and focuses on it.
    fn take_pick(&mut self, report: &Report) {
        let Some(picked) = report.picked.filter(|p| p.serial > self.picked) else { return };
        self.picked = picked.serial;
        let Some(wish) = &mut self.wish else { return };
        let (from, to) = picked.ray;
        self.tree.ray = Some((from, to));
        self.canvas.pivot = to;
        let along = (to - navigate::eye(&wish.camera)).dot(navigate::forward(&wish.camera));
        if along > 0.0 {
            wish.camera.focus_distance = along;
        }
        self.say(format!("pivot and focus at {:.3} m", from.distance(to)));
    }

    fn take_message(&mut self, report: &Report) {
        if let Some(message) = &report.message
            && message.serial > self.message_serial
        {
            self.message_serial = message.serial;
            self.message = Some((message.clone(), Instant::now()));
        }
    }

    /// A line of the window's own.
    pub(super) fn say(&mut self, text: String) {
        crate::cli::talk::line(&text);
        let message = Message { text, is_error: false, serial: self.message_serial };
        self.message = Some((message, Instant::now()));
    }

    /// The message to show, if it is still fresh.
    pub(super) fn fresh_message(&self) -> Option<&Message> {
        let (message, since) = self.message.as_ref()?;
        let time = if message.is_error { ERROR_TIME } else { MESSAGE_TIME };
        (since.elapsed() < time).then_some(message)
    }

    /// Files that were dropped on the window, or chosen in the dialog.
    fn take_files(&mut self, ui: &Ui) {
        let dropped: Vec<PathBuf> =
            ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_owned()).collect());
        for path in dropped {
            self.open(&path);
        }
        if let Some(dialog) = &self.dialog
            && let Ok(chosen) = dialog.try_recv()
        {
            self.dialog = None;
            if let Some(path) = chosen {
                self.open(&path);
            }
        }
    }

    /// Opens a scene, or puts an environment around the one that is open.
    pub(super) fn open(&mut self, path: &Path) {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match (ending.as_str(), &mut self.wish) {
            ("hdr" | "exr", Some(wish)) => {
                wish.environment.environment = Some(path.to_owned());
                wish.environment.environment_radiance = None;
            }
            ("hdr" | "exr", None) => self.say("open a scene before its environment".into()),
            _ => self.link.ask(Request::Open(path.to_owned())),
        }
    }

    /// The system's file dialog, in a thread of its own: it may stay open for long.
    pub(super) fn open_dialog(&mut self, ui: &Ui) {
        if self.dialog.is_some() {
            return;
        }
        let (sender, receiver) = std::sync::mpsc::channel();
        let ctx = ui.ctx().clone();
        let work = move || {
            let dialog = rfd::FileDialog::new()
                .add_filter("glTF scenes", &["gltf", "glb"])
                .add_filter("environments", &["hdr", "exr"]);
            // The window may be gone.
            let _ = sender.send(dialog.pick_file());
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("file dialog".into()).spawn(work) {
            Ok(_) => self.dialog = Some(receiver),
            Err(e) => self.say(format!("no file dialog: {e}")),
        }
    }

    fn take_keys(&mut self, ui: &Ui) {
        if ui.ctx().text_edit_focused() || self.canvas.is_flying {
            return;
        }
        let is_tree_shown = self.tree.is_shown;
        let actions: Vec<Action> = ui.input(|input| {
            let of_event = |event: &egui::Event| match event {
                egui::Event::Copy => Some(Action::CopyCommand),
                egui::Event::Key { key, physical_key, pressed: true, modifiers, .. } => {
                    let find = |key| keys::action(key, *modifiers, is_tree_shown);
                    find(*key).or_else(|| physical_key.and_then(find))
                }
                _ => None,
            };
            input.events.iter().filter_map(of_event).collect()
        });
        for action in actions {
            self.act(ui, action);
        }
    }

    /// Asks the engine for what it cannot know.
    pub(super) fn ask(&self, request: Request) {
        self.link.ask(request);
    }

    /// Leaves the wish with the engine, if it is new.
    fn send(&mut self) {
        if self.wish.is_some() && self.wish != self.sent {
            self.sent.clone_from(&self.wish);
            if let Some(wish) = &self.wish {
                let serial = self.link.send(wish.clone());
                self.sent_serial = serial;
                self.latency.asked(serial);
            }
        }
    }

    /// Whether the scene's own environment, or another, is there to be turned.
    pub(super) fn has_environment(&self) -> bool {
        let is_given =
            |e: &EnvironmentFlags| e.environment.is_some() || e.environment_radiance.is_some();
        self.scene.as_ref().is_some_and(|s| s.has_environment)
            || self.wish.as_ref().is_some_and(|w| is_given(&w.environment))
    }
}
