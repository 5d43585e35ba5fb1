//! Samples that are not numbers, over many.

use crate::common::{assert_at_most, bundled, report, settings, with_device};
use steradian::settings::Sampler;
use steradian::{RenderSettings, Renderer};

/// Scenes with every material, light and primitive, and the hundredths of all samples that each
/// gets: about as much time as the others.
const SCENES: [(&str, u64); 9] = [
    ("cornell-spheres", 4),
    ("cornell-box", 3),
    ("veach-mis", 10),
    ("environment", 2),
    ("statue", 1),
    ("tests/glass-slab", 10),
    ("tests/white-furnace-mixed", 48),
    ("tests/sphere-in-sphere", 2),
    ("tests/sphere-light", 20),
];

/// Samples and faults of a scene, in as many passes of other seeds as `samples` need.
fn count(scene: &str, samples: u64) -> (u64, [u64; 4]) {
    const SIDE: u32 = 256;
    let spp = samples.div_ceil(u64::from(SIDE * SIDE)) as u32;
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
    for (scene, share) in SCENES {
        let (n, of_scene) = count(scene, samples * share / 100);
        taken += n;
        for (total, n) in faults.iter_mut().zip(of_scene) {
            *total += n;
        }
    }
    assert!(taken >= samples);
    report("H6", "samples of 9 scenes, both samplers", taken as f64);
    let what = format!("{taken:.1e} samples of 9 scenes:");
    let names = ["not finite", "negative", "cut off by a loop's bound", "with a full stack"];
    for (name, n) in names.into_iter().zip(faults) {
        assert_at_most("H6", &format!("{what} {name}"), n as f64, 0.0);
    }
}

#[test]
#[ignore = "tier N: about 12 minutes"]
fn h6_no_sample_in_1e9_is_not_a_number() {
    check(1_000_000_000);
}
