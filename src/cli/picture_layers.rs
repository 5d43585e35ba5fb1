//! What is computed for a picture's file when the light is done: layers, and the denoised picture.

use super::destination::Picture as Destination;
use super::job::Job;
use super::layer_flags::{LayerFlags, STANDARD_OUTPUT};
use std::cell::RefCell;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use steradian::image::OutputFormat;
use steradian::layers::LayerTracer;
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::{Error, Result};

/// Whether a picture's bytes would go to a person's screen.
pub(super) fn is_terminal() -> bool {
    std::io::stdout().is_terminal()
}

/// That the flags go with each other and with the picture, before anything is rendered.
pub(super) fn check(
    flags: &LayerFlags,
    format: Option<OutputFormat>,
    is_film: bool,
    is_reference: bool,
) -> Result<()> {
    let is_exr = format == Some(OutputFormat::Exr);
    let of_exr = [
        // Joined films become an EXR.
        ("--layers", flags.layers.is_some() && !is_film),
        ("--exr-precision", flags.exr_precision.is_some()),
        ("--exr-times", flags.exr_times),
    ];
    if let Some((flag, _)) = of_exr.iter().find(|(_, is_given)| *is_given && !is_exr) {
        return Err(Error::Settings(format!("{flag}: for an EXR; give --output a name in .exr")));
    }
    if is_reference && flags.kinds().iter().any(|kind| kind.is_traced()) {
        let message = "--layers with --reference: a device traces them; only variance needs none";
        return Err(Error::Settings(message.into()));
    }
    Ok(())
}

/// Traces layers.
pub(crate) struct PictureLayers {
    tracer: RefCell<LayerTracer>,
}

impl PictureLayers {
    /// Compiles what the flags ask for; `None` where no rays are needed.
    pub(super) fn new(
        flags: &LayerFlags,
        job: &Job,
        prepared: &PreparedScene,
    ) -> Result<Option<Self>> {
        let kinds = flags.kinds();
        if !kinds.iter().any(|kind| kind.is_traced()) {
            return Ok(None);
        }
        let (tuning, rays) = (Tuning::default(), flags.layer_rays);
        let tracer = LayerTracer::new(prepared, &job.scene, &job.settings, kinds, rays, &tuning)?;
        Ok(Some(Self { tracer: RefCell::new(tracer) }))
    }

    pub(super) fn tracer(&self) -> std::cell::RefMut<'_, LayerTracer> {
        self.tracer.borrow_mut()
    }
}

/// Has `write` make the file of `picture`, or another that is then copied to standard output.
pub(super) fn deliver(
    picture: &Destination,
    write: impl FnOnce(&Destination) -> Result<()>,
) -> Result<()> {
    if picture.path != Path::new(STANDARD_OUTPUT) {
        return write(picture);
    }
    let folder = std::env::temp_dir();
    let place = tempfile::tempdir().map_err(|e| Error::io(&folder, e))?;
    let path: PathBuf = place.path().join("picture");
    write(&Destination { path: path.clone(), ..picture.clone() })?;
    let mut file = File::open(&path).map_err(|e| Error::io(&path, e))?;
    let mut output = std::io::stdout().lock();
    let copied = std::io::copy(&mut file, &mut output).and_then(|_| output.flush());
    copied.map_err(|e| Error::io("standard output", e))
}
