//! From radiance to the bytes of a display: the newest samples, and behind those that are missing
//! the last picture in motion.

use super::{PUBLISH_PAUSE, PUBLISH_SHARE};
use crate::viewer::wish::Display;
use std::time::{Duration, Instant};
use steradian::image::{Picture, srgb_from_linear};
use steradian::renderer::Preview;

/// The newest picture, not yet exposed.
pub(super) struct Developed {
    newest: Option<Preview>,
    backdrop: Option<(Picture, u32)>,
    next: Instant,
}

impl Default for Developed {
    fn default() -> Self {
        Self { newest: None, backdrop: None, next: Instant::now() }
    }
}

impl Developed {
    /// A picture in motion.
    pub(super) fn keep_backdrop(&mut self, preview: Preview, scale: u32) {
        self.backdrop = Some((preview.picture, scale));
        self.newest = None;
        self.next = Instant::now();
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

    /// Whether every pixel of the whole resolution has a sample.
    pub(super) fn is_whole(&self) -> bool {
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
    pub(super) fn develop(&self, display: &Display) -> Option<([usize; 2], Vec<u8>)> {
        let backdrop = self.backdrop.as_ref().map(|(picture, _)| picture);
        let picture = match &self.newest {
            Some(preview) => filled(preview, backdrop),
            None => backdrop?.clone(),
        };
        let size = [picture.width as usize, picture.height as usize];
        Some((size, encode(&picture, display)))
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

/// As a PNG has it: exposed, clipped, sRGB, rounded to nearest. What is not a number is magenta,
/// which no light is.
fn encode(picture: &Picture, display: &Display) -> Vec<u8> {
    let scale = display.exposure_ev.exp2();
    let byte = |v: f32| (srgb_from_linear((v * scale).clamp(0.0, 1.0)) * 255.0).round() as u8;
    let rgba = |c: &[f32; 3]| match c.iter().all(|v| v.is_finite()) {
        true => [byte(c[0]), byte(c[1]), byte(c[2]), 255],
        false => [255, 0, 255, 255],
    };
    picture.rgb.iter().flat_map(rgba).collect()
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
        assert!(developed.develop(&Display::default()).is_none());
        let small = Picture::new(1, 1, vec![[1.0; 3]]);
        developed.keep_backdrop(preview(small, vec![1]), 2);
        assert_eq!(developed.scale(), 2);
        let picture = Picture::new(2, 1, vec![[0.0; 3], [0.0; 3]]);
        developed.keep(preview(picture, vec![1, 0]));
        let (size, bytes) = developed.develop(&Display::default()).unwrap();
        assert_eq!((size, developed.scale()), ([2, 1], 1));
        assert_eq!(bytes, [0, 0, 0, 255, 255, 255, 255, 255]);
    }

    #[test]
    fn exposure_is_in_stops_and_what_is_no_number_shows() {
        let picture = Picture::new(2, 1, vec![[0.25, 0.5, 2.0], [f32::NAN, 0.0, 0.0]]);
        let bytes = encode(&picture, &Display { exposure_ev: 1.0 });
        assert_eq!(bytes, [188, 255, 255, 255, 255, 0, 255, 255]);
    }
}
