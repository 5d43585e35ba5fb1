//! Samples that are not numbers, over many.

use crate::common::{assert_at_most, bundled, report, settings, with_device};
use steradian::settings::Sampler;
use steradian::{RenderSettings, Renderer};

/// Scenes with every material, light and primitive, and what is left of 1e9 samples for each.
const SCENES: [&str; 8] = [
    "cornell-spheres",
    "cornell-box",
    "veach-mis",
    "environment",
    "statue",
    "tests/glass-slab",
    "tests/white-furnace-mixed",
    "tests/sphere-in-sphere",
];

/// Samples and faults of a scene, in as many passes of other seeds as `samples` need.
fn count(scene: &str, samples: u64) -> (u64, [u64; 4]) {
    const SIDE: u32 = 256;
    let spp = (samples / u64::from(SIDE * SIDE)).max(1) as u32;
    let scene = bundled(scene);
    let (mut taken, mut faults) = (0, [0; 4]);
    for (seed, sampler) in [(1, Sampler::Sobol), (2, Sampler::Independent)] {
        let settings = RenderSettings { seed, sampler, ..settings(SIDE, SIDE, spp.div_ceil(2)) };
        with_device(|device| {
            let mut renderer = Renderer::new(device, &scene, &settings).unwrap();
            while renderer.step().unwrap() {}
            renderer.finish().unwrap();
            let statistics = renderer.statistics();
            taken += statistics.samples;
            for (total, n) in faults.iter_mut().zip(statistics.faults) {
                *total += n;
            }
        });
    }
    println!("{}: {taken} samples, faults {faults:?}", scene.name);
    (taken, faults)
}

fn check(samples: u64) {
    let (mut taken, mut faults) = (0, [0; 4]);
    for scene in SCENES {
        let (n, of_scene) = count(scene, samples / SCENES.len() as u64);
        taken += n;
        for (total, n) in faults.iter_mut().zip(of_scene) {
            *total += n;
        }
    }
    assert!(taken >= samples);
    report("H6", "samples of 8 scenes, both samplers", taken as f64);
    let what = format!("{taken:.1e} samples of 8 scenes:");
    let names = ["not finite", "negative", "cut off by a loop's bound", "with a full stack"];
    for (name, n) in names.into_iter().zip(faults) {
        assert_at_most("H6", &format!("{what} {name}"), n as f64, 0.0);
    }
}

#[test]
#[ignore = "tier N: about 60 minutes on two cores"]
fn h6_no_sample_in_1e9_is_not_a_number() {
    check(1_000_000_000);
}
