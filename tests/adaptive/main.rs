//! Pixels that stop one by one: the device against the rules in plain arithmetic, and what may
//! not depend on how work was cut.

#[path = "../common/mod.rs"]
mod common;

mod bits;
mod decisions;
mod populations;

use common::{bundled, settings, with_device};
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::passes::Tuning;
use steradian::renderer::{RenderStatistics, Renderer};
use steradian::scene::Scene;
use steradian::stopping::{CalibratedRule, Preset, SeedRule, StoppingRule};

/// A scene with easy and hard pixels, a light's edge, and a black background.
fn scene() -> Scene {
    bundled("veach-mis")
}

fn calibrated(tolerance: f32, preset: Preset) -> StoppingRule {
    StoppingRule::Calibrated(CalibratedRule::new(tolerance, 0.95, preset))
}

fn seed(batch: u32, tolerance: f32) -> StoppingRule {
    StoppingRule::Seed(SeedRule { batch, tolerance })
}

/// Settings of a picture of 38 × 21 pixels, which tiles reach over, with that rule and limit.
fn with_rule(rule: StoppingRule, spp: u32) -> RenderSettings {
    RenderSettings { stopping: Some(rule), ..settings(38, 21, spp) }
}

fn render_with(
    scene: &Scene,
    settings: &RenderSettings,
    tuning: &Tuning,
) -> (Film, RenderStatistics) {
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        assert_eq!(renderer.statistics().faults, [0; 4]);
        (renderer.film().clone(), renderer.statistics().clone())
    })
}

fn render(scene: &Scene, settings: &RenderSettings) -> (Film, RenderStatistics) {
    render_with(scene, settings, &Tuning::default())
}
