//! Pictures into files, by the same writer as those of `steradian render`.

use super::Engine;
use crate::cli::destination::{Picture, check_place};
use crate::cli::output;
use crate::cli::report::Outcome;
use std::path::Path;
use steradian::image::{BitDepth, OutputFormat};
use steradian::{Error, Result};

impl Engine {
    /// Writes all samples that there are.
    pub(super) fn save(&mut self, path: &Path) -> Result<()> {
        let format = OutputFormat::from_path(path)?;
        check_place(path)?;
        let (Some(stage), Some(renderer), Some(device)) =
            (&self.stage, &self.renderer, &self.device)
        else {
            return Err(Error::Settings("there is no picture to save yet".into()));
        };
        let (film, statistics) = renderer.snapshot()?;
        let display = self.wish.as_ref().map(|(_, w)| w.display).unwrap_or_default();
        let info = device.info();
        let outcome = Outcome {
            job: &stage.job,
            device: &info.name,
            driver: &info.driver,
            film: &film,
            statistics: &statistics,
            // What is not done is marked, as a picture is that a signal ended.
            stop_code: (!renderer.is_done()).then_some(0),
        };
        let picture = Picture {
            path: path.to_owned(),
            format,
            depth: BitDepth::Eight,
            exposure_ev: display.exposure_ev,
            tone_curve: display.tone_curve,
        };
        output::write(&picture, &outcome)
    }
}
