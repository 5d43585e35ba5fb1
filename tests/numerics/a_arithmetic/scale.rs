//! Sizes of scenes: the same picture from the microscopic to the astronomic.

use crate::common::{
    Estimate, Stage, assert_at_most, emitter, grey, lambert, render, settings, with_device,
};
use glam::Vec3;
use steradian::passes::Tuning;
use steradian::{RenderSettings, Renderer};

/// A receiver and a sphere light two radii away at 30 degrees: radiance 0.5 F, by the form factor
/// F = cos 30° / 4.
fn receiver(scale: f32) -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y * 0.01 * scale, Vec3::ZERO, 1e-5 * scale);
    stage.floor(Vec3::new(0.002, 0.0, 0.001) * scale, 0.01 * scale, lambert(0.5));
    let direction = Vec3::new(0.5, 0.75_f32.sqrt(), 0.0);
    stage.sphere(direction * 2.0 * scale, scale, emitter(1.0));
    stage
}

#[test]
fn a5_scenes_of_any_size() {
    let truth = 0.5 * 0.75_f64.sqrt() / 4.0;
    for exponent in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let film = render(&receiver(10_f32.powi(exponent)).scene, &settings(16, 16, 256));
        let estimate = Estimate::of_pixels(&film);
        let error = (estimate.mean - truth).abs() / truth;
        assert!(estimate.standard_error <= 1e-3 * truth / 4.0, "{estimate:?}");
        let what = format!("relative error of irradiance, size 1e{exponent}");
        assert_at_most("A5", &what, error, 1e-3);
    }
}

/// Light so dim that a device may turn it into 0 adds nothing that is seen.
#[test]
fn a6_flushed_subnormals_change_nothing() {
    let mut stage = Stage::perspective(Vec3::ZERO, -Vec3::Z, 1.0);
    stage.sphere(
        Vec3::ZERO,
        1.0,
        steradian::scene::Material { double_sided: true, ..lambert(1e-4) },
    );
    stage.scene.materials[0].emission = Vec3::splat(1.0);
    // The throughput after 16 bounces is 1e-64: it passes through all subnormals.
    let settings =
        RenderSettings { roulette: false, max_bounces: Some(16), ..settings(16, 16, 16) };
    let picture = |tuning: &Tuning| {
        with_device(|device| {
            let mut renderer =
                Renderer::with_tuning(device, &stage.scene, &settings, tuning).unwrap();
            while renderer.step().unwrap() {}
            renderer.finish().unwrap();
            assert_eq!(renderer.statistics().faults, [0; 4]);
            grey(renderer.film())
        })
    };
    let mut flushing = Tuning::default();
    let path = flushing.library.get_mut("path/path").unwrap();
    let line = "    p.throughput *= scattered.weight;\n";
    assert!(path.contains(line));
    let flush = format!(
        "{line}    p.throughput = select(p.throughput, vec3<f32>(0.0), p.throughput < vec3<f32>(1.1754944e-38));\n"
    );
    *path = path.replace(line, &flush).into();
    let (kept, flushed) = (picture(&Tuning::default()), picture(&flushing));
    let worst = kept.iter().zip(&flushed).map(|(a, b)| (a - b).abs() / a).fold(0.0, f64::max);
    assert_at_most("A6", "relative difference of pixels, subnormals flushed or kept", worst, 1e-6);
}
