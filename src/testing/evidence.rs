//! What a failed test leaves behind.

use super::{ImageTest, ImageTestFailure, Rendered};
use crate::Result;
use crate::image::compare::report::{ReportOptions, write_report};
use crate::image::compare::{Case, ComparisonOptions, PictureFile, Run, hdr_flip, magma};
use crate::image::{Picture, PngOptions, linear_from_srgb, write_png};
use std::path::{Path, PathBuf};

impl ImageTest {
    /// Keeps both pictures and a report; gives the failure that names them.
    pub(super) fn keep(
        &self,
        message: &str,
        actual: &Rendered,
        expected: &Rendered,
        options: &ComparisonOptions,
    ) -> ImageTestFailure {
        let folder = self.output.join(&self.name);
        let file = folder.join("expected.exr");
        let stored = make_folder(&folder).and_then(|()| expected.write(&file));
        self.keep_beside(message, stored, actual, &file, options)
    }

    /// The same for an expected picture that is a file already.
    pub(super) fn keep_beside(
        &self,
        message: &str,
        before: Result<()>,
        actual: &Rendered,
        expected: &Path,
        options: &ComparisonOptions,
    ) -> ImageTestFailure {
        let kept = before.and_then(|()| self.write_evidence(actual, expected, options));
        match kept {
            Ok(report) => ImageTestFailure { message: message.to_owned(), report: Some(report) },
            Err(error) => {
                let message = format!("{message}\nthe evidence could not be kept: {error}");
                ImageTestFailure { message, report: None }
            }
        }
    }

    fn write_evidence(
        &self,
        actual: &Rendered,
        expected: &Path,
        options: &ComparisonOptions,
    ) -> Result<PathBuf> {
        let folder = self.output.join(&self.name);
        make_folder(&folder)?;
        let (exr, report) = (folder.join("actual.exr"), folder.join("report.html"));
        actual.write(&exr)?;
        let stored = PictureFile::read(expected)?;
        let shown = |name: &str, picture: &Picture| {
            // A PNG has no room for a pixel that is not finite.
            let rgb = picture.rgb.iter();
            let rgb = rgb.map(|p| p.map(|v| if v.is_finite() { v } else { 1.0 })).collect();
            let picture = Picture::new(picture.width, picture.height, rgb);
            write_png(&folder.join(name), &picture, &PngOptions::default())
        };
        let picture = actual.picture();
        shown("actual.png", &picture)?;
        if let Some(reference) = stored.picture() {
            shown("expected.png", &reference)?;
            let values = picture.rgb.iter().chain(&reference.rgb).flatten();
            let is_finite = values.clone().all(|v| v.is_finite());
            let size = (picture.width, picture.height);
            if is_finite && size == (reference.width, reference.height) {
                let colors = magma();
                let flip = hdr_flip(&picture, &reference);
                let color = |v: &f32| {
                    let code = colors[(v.clamp(0.0, 1.0) * 255.0 + 0.5) as usize];
                    code.map(|c| linear_from_srgb(f32::from(c) / 255.0))
                };
                let rgb = flip.map.iter().map(color).collect();
                shown("flip.png", &Picture::new(size.0, size.1, rgb))?;
            }
        }
        let case = Case::of(&self.name, &exr, expected, options);
        let options = ReportOptions {
            title: format!("Image test {}", self.name),
            accept_command: "STERADIAN_BLESS=1 cargo test".into(),
            ..ReportOptions::default()
        };
        write_report(&report, &Run::from_cases(vec![case]), &options)?;
        Ok(report)
    }
}

pub(super) fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| crate::Error::io(folder, e))
}
