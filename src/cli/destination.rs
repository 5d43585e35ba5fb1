//! Where files will go, checked before any time is spent on making them.

use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};
use steradian::image::{BitDepth, OutputFormat, ToneCurve};
use steradian::{Error, Result};

use super::flags::RenderFlags;
use super::layer_flags::{ExrOptions, STANDARD_OUTPUT};
use super::picture_layers;

/// The picture to write.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    /// Final name.
    pub(crate) path: PathBuf,
    /// By the ending of the name.
    pub(crate) format: OutputFormat,
    /// For PNG.
    pub(crate) depth: BitDepth,
    /// For PNG, stops.
    pub(crate) exposure_ev: f32,
    /// For PNG.
    pub(crate) tone_curve: ToneCurve,
    /// For EXR.
    pub(crate) exr: ExrOptions,
}

/// All files of a render.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Destinations {
    /// None where one pixel is printed.
    pub(crate) picture: Option<Picture>,
    /// Statistics.
    pub(crate) stats: Option<PathBuf>,
    /// Map of the samples taken.
    pub(crate) sample_map: Option<PathBuf>,
}

impl Destinations {
    /// Checks names, endings and folders.
    pub(crate) fn check(flags: &RenderFlags) -> Result<Self> {
        let picture = flags.output.as_deref().map(|path| picture(path, flags)).transpose()?;
        let format = picture.as_ref().map(|p| p.format);
        let has_time = flags.job.scene.frame_time.is_some();
        picture_layers::check(&flags.layers, format, flags.job.sampling.reference, has_time)?;
        let is_png = picture.as_ref().is_some_and(|p| p.format == OutputFormat::Png);
        let shown = &flags.job.picture;
        let is_shown = shown.bits.is_some() || shown.exposure.is_some() || shown.tone_map.is_some();
        if !is_png && is_shown {
            let message = "--bits, --exposure and --tone-map are for PNG; other output has linear \
                           32-bit floats";
            return Err(Error::Settings(message.into()));
        }
        let sample_map = flags.sample_map.clone();
        if let Some(map) = &sample_map
            && OutputFormat::from_path(map)? != OutputFormat::Png
        {
            let message = format!("{}: --sample-map writes a .png", map.display());
            return Err(Error::Settings(message));
        }
        let has_second = is_png && flags.layers.denoise.is_some();
        let denoised =
            flags.output.as_deref().filter(|_| has_second).map(picture_layers::denoised_path);
        let named = [
            ("--output", flags.output.as_ref()),
            ("--stats", flags.stats.as_ref()),
            ("--sample-map", sample_map.as_ref()),
            ("--denoise", denoised.as_ref()),
        ];
        for (i, (flag, path)) in named.iter().enumerate() {
            let Some(path) = path else { continue };
            if let Some((other, _)) = named[..i].iter().find(|(_, p)| *p == Some(*path)) {
                let message = format!("{}: {other} and {flag} name the same file", path.display());
                return Err(Error::Settings(message));
            }
            if *flag != "--output" || path.as_os_str() != STANDARD_OUTPUT {
                check_place(path)?;
            }
        }
        Ok(Self { picture, stats: flags.stats.clone(), sample_map })
    }
}

fn picture(path: &Path, flags: &RenderFlags) -> Result<Picture> {
    let format = flags.layers.format_of(path, picture_layers::is_terminal())?;
    let depth = match flags.job.picture.bits.as_deref() {
        Some("16") => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    };
    let exposure_ev = flags.job.picture.exposure.unwrap_or(0.0);
    let tone_curve = flags.job.picture.tone_map.unwrap_or_default();
    let exr = flags.layers.exr();
    Ok(Picture { path: path.to_owned(), format, depth, exposure_ev, tone_curve, exr })
}

/// That a file can be made at `path`: its folder is there and lets a file be
/// created, which alone tells of permissions, read-only disks and full ones.
pub(crate) fn check_place(path: &Path) -> Result<()> {
    let failure =
        |path: &Path, kind, reason: &str| Err(Error::io(path, IoError::new(kind, reason)));
    if path.is_dir() {
        return failure(path, ErrorKind::IsADirectory, "is a folder; name a file in it");
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return failure(folder, ErrorKind::NotFound, "no such folder; create it first");
    }
    match tempfile::Builder::new().prefix(".steradian-").suffix(".part").tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(e) => failure(folder, e.kind(), &format!("cannot be written into: {}", reason(&e))),
    }
}

/// The system's reason without the temporary file's name.
fn reason(error: &IoError) -> String {
    let text = error.to_string();
    text.split(" at path ").next().unwrap_or(&text).to_owned()
}
