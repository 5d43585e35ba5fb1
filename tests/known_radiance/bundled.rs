//! The scenes of `scenes/tests` have the radiance that they say they have.

use crate::common::{Estimate, assert_truth, bundled, bundled_truth, render, settings};

/// Renders the scene with default settings and asserts its truth; `visible_bias` as in
/// [`assert_truth`].
fn check(name: &str, side: u32, spp: u32, visible_bias: f64) {
    let name = format!("tests/{name}");
    let film = render(&bundled(&name), &settings(side, side, spp));
    assert_truth(&name, Estimate::of_pixels(&film), bundled_truth(&name), visible_bias);
}

#[test]
fn furnaces_are_in_balance() {
    check("furnace-box", 32, 64, 0.01);
    check("furnace-sphere", 32, 64, 0.01);
}

#[test]
fn what_absorbs_nothing_vanishes_in_uniform_light() {
    check("white-furnace", 32, 64, 0.001);
    check("white-furnace-mixed", 32, 64, 0.001);
}

#[test]
fn lights_without_extent_are_exact() {
    check("point-light", 8, 4, 1e-4);
    check("spot-light", 8, 4, 1e-4);
    check("directional-light", 8, 4, 1e-4);
}

#[test]
fn lights_with_extent() {
    check("sphere-light", 16, 64, 0.002);
    check("quad-light", 16, 64, 0.002);
}

#[test]
fn lights_in_a_sphere() {
    check("point-in-sphere", 16, 64, 0.01);
    check("sphere-in-sphere", 32, 256, 0.01);
}

#[test]
fn smooth_interfaces() {
    check("glass-slab", 32, 256, 0.002);
    check("metal-fresnel", 8, 4, 1e-4);
}
