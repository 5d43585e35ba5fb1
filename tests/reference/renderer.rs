//! The renderer against the reference, on bundled scenes.

use crate::agreement::{Visible, compare};
use crate::common::{bundled, settings};
use steradian::RenderSettings;
use steradian::settings::Crop;

/// Eight by eight pixels of a picture with `side` rows and columns, from `x`, `y` on. Lamps that
/// a pixel sees in part only are left out: their edges would drown all else in noise.
fn part(side: u32, x: u32, y: u32) -> RenderSettings {
    let crop = Crop { x, y, width: 8, height: 8 };
    RenderSettings { crop: Some(crop), ..settings(side, side, 2048) }
}

#[test]
fn cornell_box() {
    let scene = bundled("cornell-box");
    compare("cornell-box", &scene, &part(16, 4, 8), Visible { mean: 0.03, tile: 0.1 });
}

#[test]
fn cornell_spheres() {
    let scene = bundled("cornell-spheres");
    // Both spheres and the caustic on the floor.
    compare("cornell-spheres", &scene, &part(12, 2, 4), Visible { mean: 0.12, tile: 0.45 });
}

#[test]
fn veach_mis() {
    let scene = bundled("veach-mis");
    compare("veach-mis", &scene, &part(24, 16, 12), Visible { mean: 0.04, tile: 0.15 });
}

#[test]
fn environment() {
    let scene = bundled("environment");
    // Metal, plastic and clay.
    compare("environment", &scene, &part(32, 0, 8), Visible { mean: 0.1, tile: 0.4 });
}
