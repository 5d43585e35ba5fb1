//! Where files will go, checked before any time is spent on making them.

use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};
use steradian::image::{BitDepth, OutputFormat, ToneCurve};
use steradian::{Error, Result};

use super::film_output;
use super::flags::RenderFlags;

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
}

/// All files of a render.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Destinations {
    /// None where one pixel is printed.
    pub(crate) picture: Option<Picture>,
    /// Sums for `steradian merge`, in place of the picture.
    pub(crate) film: Option<PathBuf>,
    /// Statistics.
    pub(crate) stats: Option<PathBuf>,
    /// Map of the samples taken.
    pub(crate) sample_map: Option<PathBuf>,
}

impl Destinations {
    /// Checks names, endings and folders.
    pub(crate) fn check(flags: &RenderFlags) -> Result<Self> {
        let film = flags.output.clone().filter(|path| film_output::is_film(path));
        let shown = &flags.job.picture;
        let is_shown = shown.bits.is_some() || shown.exposure.is_some() || shown.tone_map.is_some();
        let picture = match flags.output.as_deref().filter(|_| film.is_none()) {
            None if is_shown => return Err(not_for_png()),
            None => None,
            Some(path) => {
                let depth = bit_depth(shown.bits.as_deref());
                Some(picture(path, depth, shown.exposure, shown.tone_map, is_shown)?)
            }
        };
        let sample_map = flags.sample_map.clone();
        if let Some(map) = &sample_map
            && OutputFormat::from_path(map)? != OutputFormat::Png
        {
            let message = format!("{}: --sample-map writes a .png", map.display());
            return Err(Error::Settings(message));
        }
        let named = [
            ("--output", flags.output.as_ref()),
            ("--stats", flags.stats.as_ref()),
            ("--sample-map", sample_map.as_ref()),
            ("--checkpoint", flags.farm.checkpoint.as_ref()),
        ];
        for (i, (flag, path)) in named.iter().enumerate() {
            let Some(path) = path else { continue };
            if let Some((other, _)) = named[..i].iter().find(|(_, p)| *p == Some(*path)) {
                let message = format!("{}: {other} and {flag} name the same file", path.display());
                return Err(Error::Settings(message));
            }
            check_place(path)?;
        }
        Ok(Self { picture, film, stats: flags.stats.clone(), sample_map })
    }
}

fn not_for_png() -> Error {
    let message =
        "--bits, --exposure and --tone-map are for PNG; other output has linear 32-bit floats";
    Error::Settings(message.into())
}

/// What `--bits` asks for.
pub(crate) fn bit_depth(bits: Option<&str>) -> BitDepth {
    match bits {
        Some("16") => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    }
}

/// The picture of that name; `is_shown`: whether anything is asked for that PNG alone has.
pub(crate) fn picture(
    path: &Path,
    depth: BitDepth,
    exposure: Option<f32>,
    tone_curve: Option<ToneCurve>,
    is_shown: bool,
) -> Result<Picture> {
    let format = OutputFormat::from_path(path)?;
    if is_shown && format != OutputFormat::Png {
        return Err(not_for_png());
    }
    let (exposure_ev, tone_curve) = (exposure.unwrap_or(0.0), tone_curve.unwrap_or_default());
    Ok(Picture { path: path.to_owned(), format, depth, exposure_ev, tone_curve })
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
