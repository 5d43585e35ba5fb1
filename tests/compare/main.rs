//! Comparison of pictures: what is read, what is measured, what the program says, what the report
//! holds, and image tests of our own.

#[path = "../common/mod.rs"]
mod common;

mod files;
mod flip;
mod image_tests;
mod metrics;
mod program;
mod report;
mod rules;
mod verdict;

use steradian::image::compare::PictureFile;
use steradian::image::{OutputFormat, Picture};

/// A picture whose pixels are `color(x, y)`.
fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Picture::new(width, height, pixels.map(|(x, y)| color(x, y)).collect())
}

/// A smooth picture with values above 1.
fn ramp(width: u32, height: u32) -> Picture {
    picture(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        [2.0 * u, 0.1 + v, 0.3 + 0.2 * u * v]
    })
}

fn linear(picture: &Picture) -> PictureFile {
    PictureFile::from_picture(picture, OutputFormat::Exr)
}
