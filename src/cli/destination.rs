//! Where files will go, checked before any time is spent on making them.

use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};
use steradian::image::{BitDepth, OutputFormat, ToneCurve};
use steradian::{Error, Result};

use super::film_output;
use super::flags::RenderFlags;
use super::layer_flags::{ExrOptions, STANDARD_OUTPUT};
use super::names::Names;
use super::{picture_layers, values};
use clap::Args;

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
    /// Sums for `steradian merge`, in place of the picture.
    pub(crate) film: Option<PathBuf>,
    /// What is kept until the render is done.
    pub(crate) checkpoint: Option<PathBuf>,
    /// Statistics.
    pub(crate) stats: Option<PathBuf>,
    /// Map of the samples taken.
    pub(crate) sample_map: Option<PathBuf>,
}

impl Destinations {
    /// Checks names, endings and folders.
    pub(crate) fn check(flags: &RenderFlags, names: &Names) -> Result<Self> {
        let expand = |path: &Option<PathBuf>| path.as_ref().map(|p| names.expand(p)).transpose();
        let (output, stats) = (expand(&flags.output)?, expand(&flags.stats)?);
        let sample_map = expand(&flags.sample_map)?;
        let checkpoint = expand(&flags.farm.checkpoint)?;
        let film = output.clone().filter(|path| film_output::is_film(path));
        let png = &flags.job.picture.png;
        let picture = match output.as_deref().filter(|_| film.is_none()) {
            None if png.are_given() => return Err(not_for_png()),
            None => None,
            Some(path) => {
                let format = flags.layers.format_of(path, picture_layers::is_terminal())?;
                Some(picture(path, format, png, flags.layers.exr())?)
            }
        };
        let format = picture.as_ref().map(|p| p.format);
        let has_time = flags.job.scene.frame_time.is_some() || flags.frames.frames.is_some();
        let of_reference = flags.job.sampling.reference;
        picture_layers::check(&flags.layers, format, film.is_some(), of_reference, has_time)?;
        if let Some(map) = &sample_map
            && OutputFormat::from_path(map)? != OutputFormat::Png
        {
            let message = format!("{}: --sample-map writes a .png", map.display());
            return Err(Error::Settings(message));
        }
        let has_second = format == Some(OutputFormat::Png) && flags.layers.denoise.is_some();
        let denoised = output.as_deref().filter(|_| has_second).map(picture_layers::denoised_path);
        let scene = "the scene";
        let named = [
            (scene, Some(&flags.scene)),
            ("--output", output.as_ref()),
            ("--stats", stats.as_ref()),
            ("--sample-map", sample_map.as_ref()),
            ("--checkpoint", checkpoint.as_ref()),
            ("--denoise", denoised.as_ref()),
            ("--log-file", flags.machine.log_file.as_ref()),
        ];
        for (i, (flag, path)) in named.iter().enumerate() {
            let Some(path) = path else { continue };
            if let Some((other, _)) = named[..i].iter().find(|(_, p)| *p == Some(*path)) {
                let message = format!("{}: {other} and {flag} name the same file", path.display());
                return Err(Error::Settings(message));
            }
            let is_stream = *flag == "--output" && path.as_os_str() == STANDARD_OUTPUT;
            if *flag != scene && !is_stream {
                check_place(path)?;
            }
        }
        Ok(Self { picture, film, checkpoint, stats, sample_map })
    }

    /// All files that are there in the end.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        let picture = self.picture.as_ref().map(|picture| picture.path.as_path());
        let others = [self.film.as_deref(), self.stats.as_deref(), self.sample_map.as_deref()];
        picture.into_iter().chain(others.into_iter().flatten())
    }
}

fn not_for_png() -> Error {
    let message =
        "--bits, --exposure and --tone-map are for PNG; other output has linear 32-bit floats";
    Error::Settings(message.into())
}

/// How the colours of a PNG are asked for.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct PngFlags {
    /// Bits of a colour component of a PNG: 8 (default) or 16
    #[arg(long, value_name = "8|16", value_parser = ["8", "16"])]
    pub(crate) bits: Option<String>,

    /// Exposure of a PNG in stops: radiance is multiplied by 2 to this power
    #[arg(long, value_name = "EV", value_parser = values::finite, allow_negative_numbers = true)]
    pub(crate) exposure: Option<f32>,

    /// Tone curve of a PNG, after the exposure; none by default
    #[arg(long, value_parser = values::one_of(values::TONE_CURVES))]
    pub(crate) tone_map: Option<ToneCurve>,
}

impl PngFlags {
    fn are_given(&self) -> bool {
        self.bits.is_some() || self.exposure.is_some() || self.tone_map.is_some()
    }
}

/// The picture of that name and format.
pub(crate) fn picture(
    path: &Path,
    format: OutputFormat,
    png: &PngFlags,
    exr: ExrOptions,
) -> Result<Picture> {
    if png.are_given() && format != OutputFormat::Png {
        return Err(not_for_png());
    }
    let depth = match png.bits.as_deref() {
        Some("16") => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    };
    let exposure_ev = png.exposure.unwrap_or(0.0);
    let tone_curve = png.tone_map.unwrap_or_default();
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
