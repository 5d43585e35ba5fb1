//! `steradian view`: a window in which the picture gets better while one walks around in it.
//!
//! ```text
//!  window ─► app ─ wish ─► engine ─► renderer
//!    ▲        ▲             │
//!    └────────┴── report ◄──┘
//! ```
//!
//! The window's thread only draws and listens. The engine's thread loads, traces and develops; it
//! follows the newest [`wish::Wish`] and leaves the newest [`wish::Report`]. Neither ever waits for
//! the other. Everything that is shown, `steradian render` can make: `command` says how.

mod act;
mod app;
mod canvas;
mod command;
mod engine;
mod help;
mod keys;
mod latency;
mod link;
mod mouse;
mod navigate;
mod panel;
mod preferences;
mod status;
#[cfg(test)]
mod tests;
mod theme;
mod tree;
mod window;
mod wish;

use crate::cli::destination::check_place;
use crate::cli::flags::{JobFlags, ViewFlags};
use crate::cli::signals::StopRequest;
use crate::cli::talk;
use app::App;
use engine::{Engine, Options};
use link::Link;
use preferences::Preferences;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use steradian::image::{OutputFormat, write_atomically};
use steradian::{Error, Result};

/// Where pixels stop unless the command line says otherwise: a noise that is hard to see.
const NOISE: f32 = 0.02;

/// Opens the window and stays until it is closed.
pub(crate) fn run(flags: &ViewFlags) -> Result<ExitCode> {
    let picture = &flags.job.picture;
    if flags.job.sampling.reference || picture.pixel.is_some() || picture.png.bits.is_some() {
        let message = "--reference, --pixel and --bits are for `render`, not for a window";
        return Err(Error::Settings(message.into()));
    }
    if let Some(path) = &flags.output {
        OutputFormat::from_path(path)?;
        check_place(path)?;
    }
    if let Some(path) = &flags.stats {
        check_place(path)?;
    }
    let stop = StopRequest::listen()?;
    let path = Preferences::path();
    let preferences = path.as_deref().map_or(Ok(Preferences::default()), Preferences::load);
    let preferences = preferences.unwrap_or_else(|e| {
        talk::line(&format!("{e}; settings are those of a first start"));
        Preferences::default()
    });
    let events = window::event_loop()?;
    let link = Link::new(window::waker(&events));
    let mut app = App::new(link.clone(), preferences.clone(), flags.output.clone());
    let options = Options {
        flags: JobFlags {
            stopping: flags.job.stopping.clone().or_noise(NOISE),
            ..flags.job.clone()
        },
        device: flags.device.clone(),
        shaders: flags.shaders.clone(),
        scene: flags.scene.clone(),
    };
    let engine = Engine::start(link.clone(), options).map_err(|e| Error::io("a thread", e))?;
    let shown = window::run(events, &mut app, || stop.exit_code().is_some());
    link.end();
    // A panic there has been reported, and the window has told of everything else.
    let is_whole = engine.join().is_ok();
    shown?;
    if let Some(path) = path.filter(|_| app.preferences != preferences) {
        app.preferences.save(&path).unwrap_or_else(|e| talk::line(&e.to_string()));
    }
    if let Some(path) = &flags.stats {
        write_stats(path, &app)?;
    }
    Ok(match (stop.exit_code(), is_whole) {
        (Some(code), _) => ExitCode::from(code),
        (None, true) => ExitCode::SUCCESS,
        (None, false) => ExitCode::FAILURE,
    })
}

/// What `--stats` writes.
#[derive(Serialize)]
struct Stats<'a> {
    /// Raised when a member changes its meaning or goes.
    schema: u32,
    version: &'a str,
    scene: Option<&'a str>,
    device: &'a str,
    driver: &'a str,
    /// Of the picture at the end, pixels.
    resolution: Option<(u32, u32)>,
    /// Where it was in the window, pixels: left, top, right, bottom.
    picture_edges: Option<[f32; 4]>,
    #[serde(flatten)]
    latency: latency::LatencyReport,
}

fn write_stats(path: &Path, app: &App) -> Result<()> {
    let failure = |e: std::io::Error| Error::io(path, e);
    let report = app.report();
    let stats = Stats {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        scene: report.scene.as_ref().map(|s| s.name.as_str()),
        device: &report.device,
        driver: &report.driver,
        resolution: app.wish.as_ref().map(|w| w.settings.resolution),
        picture_edges: app.canvas.pixels,
        latency: app.latency.report(),
    };
    let mut json = serde_json::to_string_pretty(&stats).map_err(|e| failure(e.into()))?;
    json.push('\n');
    write_atomically(path, |file| file.write_all(json.as_bytes()).map_err(failure))
}
