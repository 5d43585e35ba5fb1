//! Pictures into files, by the same writers as those of `steradian render`.

use super::Engine;
use super::stage::traced;
use super::views::of_hits;
use crate::cli::destination::{Picture, check_place};
use crate::cli::layer_flags::ExrOptions;
use crate::cli::output;
use crate::cli::report::Outcome;
use crate::cli::view::{self, DEFAULT_RAYS};
use std::path::Path;
use steradian::image::{BitDepth, OutputFormat};
use steradian::view::{View, of_first_hits};
use steradian::{Error, Result};

impl Engine {
    /// Writes what is shown: light with all samples that there are, or a view.
    pub(super) fn save(&mut self, path: &Path) -> Result<()> {
        let format = OutputFormat::from_path(path)?;
        check_place(path)?;
        let Some((_, wish)) = &self.wish else { return Err(nothing()) };
        let picture = Picture {
            path: path.to_owned(),
            format,
            depth: BitDepth::Eight,
            exposure_ev: wish.display.exposure_ev,
            tone_curve: wish.display.tone_curve,
            exr: ExrOptions::default(),
        };
        match (wish.view, of_hits(wish)) {
            (_, Some(view)) => self.save_hits(&picture, view),
            (view, None) => self.save_film(&picture, view),
        }
    }

    fn save_film(&self, picture: &Picture, view: Option<View>) -> Result<()> {
        let (Some(stage), Some(renderer), Some(device)) =
            (&self.stage, &self.renderer, &self.device)
        else {
            return Err(nothing());
        };
        let (film, statistics) = renderer.snapshot()?;
        let info = device.info();
        let outcome = Outcome {
            job: &stage.job,
            device: &info.name,
            driver: &info.driver,
            film: &film,
            statistics: &statistics,
            layers: None,
            // What is not done is marked, as a picture is that a signal ended.
            stop_code: None,
            is_snapshot: !self.is_over,
        };
        match view {
            Some(view) => view::write_of_film(picture, view, &outcome).map(drop),
            None => output::write(picture, &outcome),
        }
    }

    /// With as many rays as `render --view` takes.
    fn save_hits(&self, picture: &Picture, view: View) -> Result<()> {
        let (Some(stage), Some(device)) = (&self.stage, &self.device) else {
            return Err(nothing());
        };
        let settings = &stage.job.settings;
        let hits = traced(stage, settings, view, DEFAULT_RAYS, &self.tuning)?;
        let window = settings.window();
        let Some(shown) = of_first_hits(view, &hits, (window.width, window.height)) else {
            return Err(nothing());
        };
        let entries = view::of_rays(&stage.job, device.info(), DEFAULT_RAYS);
        view::write(picture, view, shown, entries, (settings.resolution, window))
    }
}

fn nothing() -> Error {
    Error::Settings("there is no picture to save yet".into())
}
