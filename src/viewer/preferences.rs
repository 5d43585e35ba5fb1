//! What is kept from one session to the next: how the window looks, nothing about a scene.

use crate::cli::values::{TONE_CURVES, word_for};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};
use steradian::image::{ToneCurve, write_atomically};
use steradian::{Error, Result};

/// Kept in `viewer.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Preferences {
    /// Inner width and height of the window, points.
    pub(super) window: (f32, f32),
    pub(super) is_panel_open: bool,
    /// As `--tone-map` has it.
    tone_curve: String,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            window: (1280.0, 800.0),
            is_panel_open: true,
            tone_curve: word_for(TONE_CURVES, &ToneCurve::None).into(),
        }
    }
}

impl Preferences {
    /// The file, in the folder for settings that the system names.
    pub(super) fn path() -> Option<PathBuf> {
        let named = |name| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
        let folder = named("XDG_CONFIG_HOME").or_else(|| Some(named("HOME")?.join(".config")))?;
        Some(folder.join("steradian/viewer.json"))
    }

    /// Those of the last session; without a file the default.
    ///
    /// # Errors
    /// A file that is there and cannot be used.
    pub(super) fn load(path: &Path) -> Result<Self> {
        let bytes = match std::fs::read(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Self::default()),
            read => read.map_err(|e| Error::io(path, e))?,
        };
        let read: Self = serde_json::from_slice(&bytes).map_err(|e| Error::io(path, e.into()))?;
        let default = Self::default();
        let side = |s: f32, default: f32| if (200.0..=20_000.0).contains(&s) { s } else { default };
        let window = (side(read.window.0, default.window.0), side(read.window.1, default.window.1));
        Ok(Self { window, ..read })
    }

    /// Keeps them.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn save(&self, path: &Path) -> Result<()> {
        let failure = |e: std::io::Error| Error::io(path, e);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failure)?;
        }
        let mut json = serde_json::to_string_pretty(self).map_err(|e| failure(e.into()))?;
        json.push('\n');
        write_atomically(path, |file| file.write_all(json.as_bytes()).map_err(failure))
    }

    /// The curve of the last picture; none where the word is unknown.
    pub(super) fn tone_curve(&self) -> ToneCurve {
        let named = TONE_CURVES.iter().find(|(word, _, _)| *word == self.tone_curve);
        named.map_or(ToneCurve::None, |(_, curve, _)| *curve)
    }

    /// Keeps a curve for the next picture.
    pub(super) fn set_tone_curve(&mut self, curve: ToneCurve) {
        self.tone_curve = word_for(TONE_CURVES, &curve).into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_come_back_as_they_were_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/viewer.json");
        assert_eq!(Preferences::load(&path).unwrap(), Preferences::default());
        let mut kept = Preferences { window: (640.0, 480.0), ..Preferences::default() };
        kept.is_panel_open = false;
        kept.set_tone_curve(ToneCurve::Agx);
        kept.save(&path).unwrap();
        let read = Preferences::load(&path).unwrap();
        assert_eq!((&read, read.tone_curve()), (&kept, ToneCurve::Agx));
    }

    #[test]
    fn a_damaged_file_is_an_error_and_odd_sizes_are_not_taken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("viewer.json");
        std::fs::write(&path, "{").unwrap();
        assert!(Preferences::load(&path).is_err());
        std::fs::write(&path, r#"{"window":[1e9,300],"unknown":1}"#).unwrap();
        assert_eq!(Preferences::load(&path).unwrap().window, (1280.0, 300.0));
    }
}
