//! The worst sines and cosines that WGSL allows: an absolute error of 2^-11.

use crate::common::{
    Call, Estimate, Random, Stage, assert_at_most, emitter, harness, lambert, settings, with_device,
};
use glam::{Vec3, Vec4};
use steradian::passes::Tuning;
use steradian::scene::Environment;
use steradian::settings::Strategy;
use steradian::shader::{Feature, Library, library};
use steradian::{RenderSettings, Renderer};

/// The program's shaders with sines and cosines off by ±2^-11, by a hash of their bits.
fn worst_library() -> Library {
    let mut worst = library();
    let mut calls = 0;
    for (path, text) in &mut worst {
        if *path == "math/math" {
            continue;
        }
        for name in ["sin", "cos"] {
            for before in [" ", "(", "-"] {
                let call = format!("{before}{name}(");
                calls += text.matches(&call).count();
                *text = text.replace(&call, &format!("{before}worst_{name}(")).into();
            }
        }
    }
    assert!(calls >= 4, "{calls}");
    let math = worst.get_mut("math/math").unwrap();
    let functions = "
fn worst_error(x: f32) -> f32 {
    let h = (bitcast<u32>(x) * 747796405u + 2891336453u) >> 16u;
    return select(-0.00048828125, 0.00048828125, (h & 1u) == 0u);
}
fn worst_sin(x: f32) -> f32 {
    return clamp(sin(x) + worst_error(x), -1.0, 1.0);
}
fn worst_cos(x: f32) -> f32 {
    return clamp(cos(x) + worst_error(x + 1.0), -1.0, 1.0);
}
";
    *math = format!("{math}{functions}").into();
    worst
}

#[test]
fn a4_directions_have_unit_length_with_the_worst_sines() {
    let mut random = Random(4);
    let inputs: Vec<Vec4> = (0..1 << 16)
        .map(|_| Vec4::new(random.unit(), random.unit(), random.unit().max(1e-3), 0.0))
        .collect();
    let call = Call::new(harness!("directions"), &[Feature::Ggx]);
    let worst = |outputs: Vec<Vec4>| {
        let of =
            |k: usize| outputs.iter().map(|o| f64::from((o[k] - 1.0).abs())).fold(0.0, f64::max);
        [of(0), of(1), of(2)]
    };
    for (name, library) in [("the device's", library()), ("the worst", worst_library())] {
        let errors = worst(call.clone().with_library(library).run(&inputs, 1));
        for (sampler, error) in ["cosine", "uniform", "GGX"].into_iter().zip(errors) {
            let what = format!("| |d|² - 1 | of {sampler} directions, {name} sines");
            assert_at_most("A4", &what, error, 1e-6);
        }
    }
}

/// A furnace is one whatever the directions are, as long as densities and weights belong together.
#[test]
fn a4_furnaces_with_the_worst_sines() {
    let mut stage = Stage::perspective(Vec3::new(0.1, 0.2, 0.3), -Vec3::Z, 1.0);
    let wall = steradian::scene::Material { double_sided: true, ..lambert(0.5) };
    stage.sphere(
        Vec3::ZERO,
        1.0,
        steradian::scene::Material { emission: emitter(0.5).emission, ..wall },
    );
    let settings =
        RenderSettings { roulette: false, max_bounces: Some(32), ..settings(16, 16, 512) };
    let estimate = estimate(&stage, &settings, worst_library());
    assert!(estimate.standard_error <= 2.5e-4, "{estimate:?}");
    assert_at_most(
        "A4",
        "|L - 1| in a sphere furnace, the worst sines",
        (estimate.mean - 1.0).abs(),
        1e-3,
    );
}

/// A sky of 512 rows: the solid angle of a texel is 100 times smaller than the error of a sine.
#[test]
fn a4_a_sky_with_the_worst_sines() {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-5);
    stage.floor(Vec3::new(0.002, 0.0, 0.001), 0.01, lambert(0.5));
    let mut sky = Environment::constant(Vec3::ZERO);
    (sky.width, sky.height) = (1024, 512);
    sky.radiance = vec![Vec3::ONE; 1024 * 512];
    stage.scene.environment = Some(sky);
    for (name, library) in [("the device's", library()), ("the worst", worst_library())] {
        let settings = RenderSettings { strategy: Strategy::Light, ..settings(16, 16, 256) };
        let estimate = estimate(&stage, &settings, library);
        let what = format!("relative error of a sky's irradiance by light samples, {name} sines");
        assert!(estimate.standard_error <= 1e-3 * 0.5 / 4.0, "{estimate:?}");
        assert_at_most("A4", &what, (estimate.mean / 0.5 - 1.0).abs(), 1e-3);
    }
}

fn estimate(stage: &Stage, settings: &RenderSettings, library: Library) -> Estimate {
    let tuning = Tuning { library, ..Tuning::default() };
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, &stage.scene, settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        assert_eq!(renderer.statistics().faults, [0; 4]);
        Estimate::of_pixels(renderer.film())
    })
}
