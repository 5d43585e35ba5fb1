//! The renderer against the reference, on bundled scenes.

use crate::agreement::{Visible, compare};
use crate::common::{bundled, settings};
use steradian::RenderSettings;
use steradian::settings::Crop;

/// 960 samples are 60 blocks of 16: fifteen observations of a pixel.
const SPP: u32 = 960;

/// The whole of a small picture.
fn small(side: u32) -> RenderSettings {
    settings(side, side, SPP)
}

/// A part of a larger one.
fn part(side: u32, x: u32, y: u32) -> RenderSettings {
    let crop = Crop { x, y, width: 8, height: 8 };
    RenderSettings { crop: Some(crop), ..small(side) }
}

#[test]
fn cornell_box() {
    compare("cornell-box", &bundled("cornell-box"), &small(8), Visible { mean: 0.02, tile: 0.1 });
}

#[test]
fn cornell_spheres() {
    let scene = bundled("cornell-spheres");
    // The glass sphere and the floor below it, where its caustic is.
    compare("cornell-spheres", &scene, &part(16, 6, 8), Visible { mean: 0.1, tile: 0.4 });
}

#[test]
fn veach_mis() {
    let scene = bundled("veach-mis");
    compare("veach-mis", &scene, &part(16, 2, 4), Visible { mean: 0.03, tile: 0.15 });
}

#[test]
fn environment() {
    let scene = bundled("environment");
    compare("environment", &scene, &part(16, 4, 4), Visible { mean: 0.05, tile: 0.15 });
}
