//! Pictures in memory and in files: OpenEXR keeps the linear radiance and any
//! number of further channels, PNG holds what a display shows.

pub mod compare;
mod display;
mod exr;
mod png;
mod sample_map;
mod srgb;
mod tone;

pub use self::display::DisplayTransform;
pub use self::exr::{
    Attribute, ChannelData, ExrHeader, ExrImage, Layer, Precision, read_exr, write_exr,
    write_exr_bands,
};
pub use self::png::{BitDepth, PngOptions, read_png, write_png};
pub use self::sample_map::{MapColors, sample_map};
pub use self::srgb::{linear_from_srgb, srgb_from_linear};
pub use self::tone::ToneCurve;

use crate::{Error, Result};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// A picture in linear Rec. 709.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels, row by row; row 0 is the top.
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// Wraps pixels.
    ///
    /// # Panics
    /// If their number is not `width * height`.
    pub fn new(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Self {
        assert_eq!(rgb.len(), width as usize * height as usize, "pixels of a picture");
        Self { width, height, rgb }
    }
}

/// Kinds of picture file that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputFormat {
    /// PNG, sRGB: exposed, by a tone curve or clipped, and rounded.
    Png,
    /// OpenEXR: linear, nothing lost.
    Exr,
}

impl OutputFormat {
    /// The format that a file name asks for by its ending, in any case.
    /// Other endings are an [`Error::Settings`].
    pub fn from_path(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(Error::Settings(format!(
                "{}: pictures are .png (what a display shows) or .exr (linear radiance); \
                 give the file one of these endings",
                path.display()
            ))),
        }
    }
}

/// Reads the colours of a PNG or EXR file, by its ending, as linear Rec. 709.
pub fn read_picture(path: &Path) -> Result<Picture> {
    match OutputFormat::from_path(path)? {
        OutputFormat::Png => read_png(path),
        OutputFormat::Exr => {
            let image = read_exr(path)?;
            image.picture().ok_or_else(|| {
                invalid_data(path, "has no channels named R, G and B that hold numbers")
            })
        }
    }
}

/// Creates or replaces the file at `path` by what `write` puts into it, so that
/// under this name there is at any time either the old file or the whole new
/// one. The new one is made beside it under a temporary name, synced to the
/// disk, and renamed; when anything fails it is removed and `path` is untouched.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut File) -> Result<()>) -> Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let source = io::Error::new(io::ErrorKind::NotFound, "no such folder; create it first");
        return Err(Error::io(folder, source));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".steradian-").suffix(".part");
    #[cfg(unix)]
    {
        // Temporary files are private by default; a picture gets what the
        // user's umask leaves, like any other file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder).map_err(|e| Error::io(folder, e))?;
    write(temporary.as_file_mut())?;
    temporary.as_file().sync_all().map_err(|e| Error::io(path, e))?;
    temporary.persist(path).map_err(|e| Error::io(path, e.error))?;
    // The rename itself is durable once the folder is. Not every system lets a
    // folder be opened or synced, and the file is complete either way.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// An [`Error::Io`] that says what is wrong with the contents of `path`.
fn invalid_data(path: impl Into<PathBuf>, message: impl Into<String>) -> Error {
    Error::io(path, io::Error::new(io::ErrorKind::InvalidData, message.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn output_format_follows_the_ending_in_any_case() {
        assert_eq!(OutputFormat::from_path(Path::new("a/b.PNG")).unwrap(), OutputFormat::Png);
        assert_eq!(OutputFormat::from_path(Path::new("b.c.exr")).unwrap(), OutputFormat::Exr);
        for path in ["a.jpg", "png", "a.png/b", ""] {
            let error = OutputFormat::from_path(Path::new(path)).unwrap_err();
            assert!(matches!(error, Error::Settings(_)), "{path}");
            let message = error.to_string();
            assert!(message.contains(".png") && message.contains(".exr"), "{message}");
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let fail = |file: &mut File| {
            file.write_all(b"half a pict").unwrap();
            Err(Error::Limit("stopped".into()))
        };
        assert!(matches!(write_atomically(&path, fail), Err(Error::Limit(_))));
        assert!(names(folder.path()).is_empty());

        std::fs::write(&path, b"old").unwrap();
        assert!(write_atomically(&path, fail).is_err());
        assert_eq!(names(folder.path()), ["picture.png"]);
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn a_write_replaces_the_whole_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        std::fs::write(&path, b"a longer old file").unwrap();
        let write = |file: &mut File| file.write_all(b"new").map_err(|e| Error::io(&path, e));
        write_atomically(&path, write).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["picture.exr"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_the_permissions_of_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&path, |_| Ok(())).unwrap();
        std::fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }

    #[test]
    fn an_unusable_place_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing");
        let error = write_atomically(&missing.join("a.png"), |_| Ok(())).unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if *path == missing), "{error}");
        // A folder stands where the file should go.
        std::fs::create_dir(&missing).unwrap();
        std::fs::write(missing.join("inside"), b"").unwrap();
        let error = write_atomically(&missing, |_| Ok(())).unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if *path == missing), "{error}");
        assert_eq!(names(folder.path()), ["missing"]);
    }

    #[test]
    fn read_picture_takes_either_format() {
        let folder = tempfile::tempdir().unwrap();
        let picture = Picture::new(2, 1, vec![[0.0, 1.0, 0.0], [1.0, 0.0, 1.0]]);
        let (png, exr) = (folder.path().join("a.png"), folder.path().join("a.exr"));
        write_png(&png, &picture, &PngOptions::default()).unwrap();
        write_exr(&exr, &ExrImage::from_picture(&picture), Precision::Float).unwrap();
        assert_eq!(read_picture(&png).unwrap(), picture);
        assert_eq!(read_picture(&exr).unwrap(), picture);
        let depth = Layer { name: String::new(), channels: vec![] };
        let no_colour = ExrImage { layers: vec![depth], ..ExrImage::from_picture(&picture) };
        assert!(no_colour.picture().is_none());
    }
}
