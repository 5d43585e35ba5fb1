//! From radiance to the bytes of a display: the newest samples, and behind those that are missing
//! the last picture in motion.

use super::{PUBLISH_PAUSE, PUBLISH_SHARE};
use std::time::{Duration, Instant};
use steradian::image::{DisplayTransform, Picture};
use steradian::renderer::Preview;
use steradian::view::ViewPicture;

/// The newest picture, not yet exposed.
pub(super) struct Developed {
    newest: Option<Preview>,
    backdrop: Option<(Picture, u32)>,
    /// What is shown in place of light.
    pub(super) overlay: Option<ViewPicture>,
    /// It has all its rays.
    pub(super) is_overlay_whole: bool,
    next: Instant,
}

impl Default for Developed {
    fn default() -> Self {
        Self {
            newest: None,
            backdrop: None,
            overlay: None,
            is_overlay_whole: false,
            next: Instant::now(),
        }
    }
}

impl Developed {
    /// A picture in motion.
    pub(super) fn keep_backdrop(&mut self, preview: Preview, scale: u32) {
        // Where there was no time for a sample the picture before stays, though it is of the past.
        let before = self.newest.take().map(|p| p.picture).or(self.backdrop.take().map(|b| b.0));
        self.backdrop = Some((filled(&preview, before.as_ref()), scale));
        self.next = Instant::now();
    }

    /// The camera has moved, and there is no picture of light yet.
    pub(super) fn forget(&mut self) {
        self.newest = None;
    }

    /// A picture of the render.
    pub(super) fn keep(&mut self, preview: Preview) {
        self.newest = Some(preview);
    }

    /// Pixels that one of the picture stands for.
    pub(super) fn scale(&self) -> u32 {
        match (&self.newest, &self.backdrop) {
            (None, Some((_, scale))) => *scale,
            _ => 1,
        }
    }

    /// Whether what is shown has a sample in all pixels of the whole resolution.
    pub(super) fn is_whole(&self) -> bool {
        if self.overlay.is_some() {
            return self.is_overlay_whole;
        }
        self.newest.as_ref().is_some_and(|preview| !preview.sample_counts.contains(&0))
    }

    /// Whether it is time for the next picture.
    pub(super) fn is_due(&self) -> bool {
        Instant::now() >= self.next
    }

    /// Showing one took so long.
    pub(super) fn paid(&mut self, cost: Duration) {
        self.next = Instant::now() + PUBLISH_PAUSE.max(cost * PUBLISH_SHARE);
    }

    /// Columns and rows, and sRGB with alpha; `None` before there is a picture.
    pub(super) fn develop(&self, display: &DisplayTransform) -> Option<([usize; 2], Vec<[u8; 4]>)> {
        if let Some(view) = &self.overlay {
            let size = [view.picture.width as usize, view.picture.height as usize];
            // Its colours are what is to be seen.
            return Some((size, DisplayTransform::default().srgb8(&view.picture.rgb)));
        }
        let backdrop = self.backdrop.as_ref().map(|(picture, _)| picture);
        let picture = match &self.newest {
            Some(preview) => filled(preview, backdrop),
            None => backdrop?.clone(),
        };
        let size = [picture.width as usize, picture.height as usize];
        Some((size, display.srgb8(&picture.rgb)))
    }
}

/// Pixels without samples show what is behind them.
fn filled(preview: &Preview, backdrop: Option<&Picture>) -> Picture {
    let mut picture = preview.picture.clone();
    let Some(backdrop) = backdrop else { return picture };
    let (width, height) = (picture.width as usize, picture.height as usize);
    for (i, (pixel, count)) in picture.rgb.iter_mut().zip(&preview.sample_counts).enumerate() {
        if *count == 0 {
            let x = (i % width) * backdrop.width as usize / width;
            let y = (i / width) * backdrop.height as usize / height;
            *pixel = backdrop.rgb[y * backdrop.width as usize + x];
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preview(picture: Picture, sample_counts: Vec<u32>) -> Preview {
        Preview { picture, sample_counts, statistics: Default::default() }
    }

    #[test]
    fn empty_pixels_show_the_backdrop() {
        let mut developed = Developed::default();
        assert!(developed.develop(&DisplayTransform::default()).is_none());
        let small = Picture::new(1, 1, vec![[1.0; 3]]);
        developed.keep_backdrop(preview(small, vec![1]), 2);
        assert_eq!(developed.scale(), 2);
        let picture = Picture::new(2, 1, vec![[0.0; 3], [0.0; 3]]);
        developed.keep(preview(picture, vec![1, 0]));
        let (size, bytes) = developed.develop(&DisplayTransform::default()).unwrap();
        assert_eq!((size, developed.scale()), ([2, 1], 1));
        assert_eq!(bytes, [[0, 0, 0, 255], [255; 4]]);
    }
}
