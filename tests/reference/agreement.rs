//! Two pictures with their own noise: whether they are of the same radiance.

use crate::common::with_device;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;
use steradian::gpu::Device;
use steradian::image::Picture;
use steradian::image::compare::{ComparisonSettings, NoisyPicture, PictureComparison};
use steradian::reference::Reference;
use steradian::scene::Scene;
use steradian::settings::Sampler;
use steradian::statistics::{FALSE_ALARM, Verdict};
use steradian::{RenderSettings, Renderer};

/// Independent runs of each side.
const RUNS: u32 = 16;

/// Relative bias that the comparison would show: of the picture's mean, and of every tile's,
/// relative to the picture's mean.
#[derive(Clone, Copy)]
pub(crate) struct Visible {
    pub(crate) mean: f64,
    pub(crate) tile: f64,
}

/// Renders with both, and asserts that they agree in all channels: in the mean, in tiles of
/// four by four pixels and in every pixel. `settings.spp` is that of all runs together.
#[track_caller]
pub(crate) fn compare(what: &str, scene: &Scene, settings: &RenderSettings, visible: Visible) {
    let spp = settings.spp / RUNS;
    assert!(spp.is_power_of_two() && spp <= 128, "a run is a block");
    // Of one render only independent samples make independent blocks.
    let sampler = Sampler::Independent;
    let settings = RenderSettings { sampler, block_size: spp, ..settings.clone() };
    let picture = NoisyPicture::of_runs(&with_device(|device| runs(device, scene, &settings)));
    let truth = NoisyPicture::of_runs(&reference_runs(scene, &settings));
    let asked = ComparisonSettings {
        level: FALSE_ALARM,
        tiles: (picture.width / 4, picture.height / 4),
        visible_bias: visible.mean,
        visible_tile_bias: visible.tile,
        // As for other renders in f32: 128 units of 2^-24.
        rounding: 128.0 / 16_777_216.0,
    };
    let found = PictureComparison::of(&picture, &truth, &asked);
    println!("{what}: {found}");
    assert_eq!(found.verdict(), Verdict::Agrees, "{what}: {found}");
}

/// The blocks of one render, of which the kernel is compiled once. A block's mean is what the
/// film's mean moved by, to some 1e-6 of the mean.
fn runs(device: Arc<Device>, scene: &Scene, settings: &RenderSettings) -> Vec<Picture> {
    let mut renderer = Renderer::new(device, scene, settings).unwrap();
    let mut runs = Vec::new();
    let mut before: Option<Picture> = None;
    loop {
        let goes_on = renderer.step().unwrap();
        let film = renderer.film();
        let blocks = film.least_samples() / settings.block_size;
        if blocks as usize > runs.len() {
            assert_eq!(film.most_samples(), film.least_samples(), "a block of all pixels");
            let now = film.picture();
            let n = blocks as f32;
            let block = |i: usize, c: usize| {
                let earlier = before.as_ref().map_or(0.0, |before| before.rgb[i][c]);
                n * now.rgb[i][c] - (n - 1.0) * earlier
            };
            let rgb = (0..now.rgb.len()).map(|i| [0, 1, 2].map(|c| block(i, c))).collect();
            runs.push(Picture::new(now.width, now.height, rgb));
            before = Some(now);
        }
        if !goes_on {
            break;
        }
    }
    assert_eq!(renderer.statistics().faults, [0; 4], "{:?}", renderer.statistics().first_fault);
    assert_eq!(runs.len(), RUNS as usize);
    runs
}

fn reference_runs(scene: &Scene, settings: &RenderSettings) -> Vec<Picture> {
    let reference = Reference::new(scene, settings).unwrap();
    let (window, spp) = (settings.window(), settings.block_size);
    let block = |run: u32, x: u32, y: u32| {
        let sample = |index| reference.sample(window.x + x, window.y + y, index);
        let sum: DVec3 = (run * spp..(run + 1) * spp).map(sample).sum();
        assert!(sum.is_finite());
        (sum / f64::from(spp)).as_vec3().to_array()
    };
    let run = |run| {
        let places = (0..window.height).flat_map(|y| (0..window.width).map(move |x| (x, y)));
        let rgb = places.map(|(x, y)| block(run, x, y)).collect();
        Picture::new(window.width, window.height, rgb)
    };
    (0..RUNS).into_par_iter().map(run).collect()
}
