//! Sampling of lights.

mod choice;
mod environment;
mod samples;
mod spheres;
mod tree;
mod triangles;

use crate::common::{
    Call, Estimate, Random, Stage, assert_truth, harness, lambert, render, settings,
};
use glam::{DVec3, Vec3, Vec4};
use steradian::RenderSettings;
use steradian::scene::Scene;

/// Of the receivers.
const ALBEDO: f32 = 0.5;

/// A small receiver about the origin that faces up, seen over a field so small that light does
/// not vary over it. The camera is close, so that no light is in between. `scale`: how close
/// lights come.
fn receiver(scale: f32) -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01 * scale, Vec3::ZERO, 1e-5 * scale);
    stage.floor(Vec3::new(0.002, 0.0, 0.001) * scale, 0.01 * scale, lambert(ALBEDO));
    stage
}

/// Towards a light at this angle from the receiver's normal.
fn direction(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, cos, 0.0)
}

/// Asserts the radiance of the receiver under lights of radiance 1 for form factor `f`; gives
/// the relative error of the irradiance.
fn check(what: &str, scene: &Scene, f: f64, spp: u32, visible_bias: f64) -> f64 {
    let truth = f64::from(ALBEDO) * f;
    // Lights reflect nothing.
    let settings = RenderSettings { max_bounces: Some(1), ..settings(16, 16, spp) };
    let estimate = Estimate::of_pixels(&render(scene, &settings));
    assert_truth(what, estimate, truth, visible_bias);
    (estimate.mean / truth - 1.0).abs()
}

/// `Output` of `light.wgsl`.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    wi: Vec3,
    pdf: f32,
    weight: Vec3,
    is_blocked: bool,
    /// Density of the direction as a ray that finds the light has it.
    met_pdf: f32,
    meets_emitter: bool,
}

/// Draws a light sample at each place, with random numbers.
fn draw(scene: &Scene, places: &[Vec3], random: &mut Random) -> Vec<Drawn> {
    let input =
        |p: &Vec3| [p.extend(0.0), Vec4::new(random.unit(), random.unit(), random.unit(), 0.0)];
    let inputs: Vec<[Vec4; 2]> = places.iter().map(input).collect();
    let settings = RenderSettings::default();
    let outputs: Vec<[Vec4; 3]> =
        Call::new(harness!("light"), &[]).on(scene, &settings).run(&inputs, 1);
    let drawn = |[sampled, weight, met]: [Vec4; 3]| Drawn {
        wi: sampled.truncate(),
        pdf: sampled.w,
        weight: weight.truncate(),
        is_blocked: weight.w != 0.0,
        met_pdf: met.x,
        meets_emitter: met.y != 0.0,
    };
    outputs.into_iter().map(drawn).collect()
}

/// Radiance from and density of light samples for directions at one place.
fn densities(scene: &Scene, place: Vec3, directions: &[Vec3]) -> Vec<Vec4> {
    let inputs: Vec<[Vec4; 2]> =
        directions.iter().map(|d| [place.extend(0.0), d.extend(0.0)]).collect();
    Call::new(harness!("light_pdf"), &[]).on(scene, &RenderSettings::default()).run(&inputs, 1)
}
