//! What is computed for a picture's file when the light is done: layers, and the denoised picture.

use super::destination::Picture as Destination;
use super::job::Job;
use super::layer_flags::{Denoiser, LayerFlags, STANDARD_OUTPUT};
use super::render::Call;
use super::talk;
use std::cell::RefCell;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use steradian::denoise::{Guides, Oidn};
use steradian::image::{Attribute, Layer, OutputFormat, Picture};
use steradian::layers::{LayerKind, LayerTracer};
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::scene::gltf::{LoadOptions, load_with};
use steradian::settings::Crop;
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
    has_time: bool,
) -> Result<()> {
    if flags.kinds().contains(&LayerKind::Motion) && !has_time {
        let message = "--layers motion: needs the time of the frame; give --frame-time or --frames";
        return Err(Error::Settings(message.into()));
    }
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
    if flags.denoise.is_some() {
        // Now, before the scene is read, it costs nobody time if it is not there.
        Oidn::load()?;
    }
    if is_reference && flags.kinds().iter().any(|kind| kind.is_traced()) {
        let message = "--layers with --reference: a device traces them; only variance needs none";
        return Err(Error::Settings(message.into()));
    }
    Ok(())
}

/// Traces layers, and takes noise away.
pub(crate) struct PictureLayers {
    tracer: Option<RefCell<LayerTracer>>,
    denoiser: Option<(Oidn, RefCell<LayerTracer>)>,
}

/// What a denoiser's guides are made from.
const GUIDES: &[LayerKind] = &[LayerKind::Albedo, LayerKind::ShadingNormal, LayerKind::Coverage];

impl PictureLayers {
    /// Compiles and loads what the flags ask for.
    pub(super) fn new(call: &Call, job: &Job, prepared: &PreparedScene) -> Result<Self> {
        let flags = &call.flags.layers;
        let tracer = |kinds: &[LayerKind]| {
            let (scene, settings, rays) = (&job.scene, &job.settings, flags.layer_rays);
            let tracer =
                LayerTracer::new(prepared, scene, settings, kinds, rays, &Tuning::default())?;
            let Some(time) = call.time.filter(|_| kinds.contains(&LayerKind::Motion)) else {
                return Ok(RefCell::new(tracer));
            };
            let frame_time = Some(time - flags.motion_step.unwrap_or(1.0 / call.flags.frames.fps));
            let options = LoadOptions { frame_time, ..call.flags.job.scene.options() };
            let before = load_with(&call.flags.scene, &options)?;
            Ok::<_, Error>(RefCell::new(tracer.with_motion(scene, before, settings)?))
        };
        let is_traced = flags.kinds().iter().any(|kind| kind.is_traced());
        let denoiser = match flags.denoise {
            Some(Denoiser::Oidn) => Some((Oidn::load()?, tracer(GUIDES)?)),
            None => None,
        };
        Ok(Self { tracer: is_traced.then(|| tracer(flags.kinds())).transpose()?, denoiser })
    }

    /// Attributes of a file with the layers.
    pub(super) fn metadata(&self) -> Vec<(String, Attribute)> {
        self.tracer.as_ref().map_or(Vec::new(), |tracer| tracer.borrow().metadata())
    }

    /// The traced layers of a part of the picture.
    pub(super) fn trace(&self, window: Crop) -> Result<Vec<Layer>> {
        self.tracer.as_ref().map_or(Ok(Vec::new()), |tracer| tracer.borrow_mut().trace(window))
    }

    /// The picture of `window` without noise, if that is asked for.
    pub(super) fn denoised(&self, picture: &Picture, window: Crop) -> Result<Option<Picture>> {
        let Some((oidn, tracer)) = &self.denoiser else { return Ok(None) };
        let layers = tracer.borrow_mut().trace(window)?;
        // They are there: they were asked for.
        let guides = Guides::from_layers(&layers).unwrap_or_default();
        drop(layers);
        oidn.denoise(picture, guides).map(Some)
    }

    /// One line about rays that went wrong.
    pub(super) fn warn(&self) {
        let tracers = self.tracer.iter().chain(self.denoiser.iter().map(|(_, tracer)| tracer));
        let faulty: usize = tracers.map(|tracer| tracer.borrow().faulty_pixels()).sum();
        if faulty > 0 {
            talk::line(&format!("warning: layers: the walk failed for rays of {faulty} pixels"));
        }
    }
}

/// Of the denoised picture beside the PNG at `path`.
pub(super) fn denoised_path(path: &Path) -> PathBuf {
    path.with_extension("denoised.png")
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
