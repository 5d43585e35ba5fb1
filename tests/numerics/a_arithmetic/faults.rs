//! Samples that are not numbers are counted and located.

use crate::common::{Stage, emitter, lambert, settings, with_device};
use glam::Vec3;
use steradian::passes::Tuning;
use steradian::renderer::RenderStatistics;
use steradian::shader::generated::Fault;
use steradian::{RenderSettings, Renderer};

const SPP: u32 = 64;
const SIDE: u32 = 16;

/// Whether the injection of [`render_with`] strikes this sample.
fn is_struck(x: u32, y: u32, sample: u32) -> bool {
    (x * 7919 + y * 104_729 + sample * 1_299_709) % 1009 == 17
}

/// Renders a closed box in which every path goes on for five bounces, with `radiance` added at
/// the vertex of index `bounce` of the struck samples.
fn render_with(bounce: u32, radiance: &str) -> (RenderStatistics, Vec<f32>) {
    let mut stage = Stage::perspective(Vec3::ZERO, -Vec3::Z, 1.0);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let (u, v) = (axis.any_orthonormal_vector(), axis.cross(axis.any_orthonormal_vector()));
        stage.quad(axis * 2.0, v * 2.0, u * 2.0, lambert(0.9));
        stage.quad(axis * -2.0, u * 2.0, v * 2.0, lambert(0.9));
    }
    stage.sphere(Vec3::new(0.5, 1.0, -0.5), 0.2, emitter(1.0));
    let mut tuning = Tuning::default();
    let path_trace = tuning.library.get_mut("path_trace").unwrap();
    let watch = "fault_watch(p.radiance, bounce, material);\n        p.is_alive = p.is_alive";
    assert!(path_trace.contains(watch));
    let strike = format!(
        "let at = vec2<u32>(sampler_p.pixel & 0xffffu, sampler_p.pixel >> 16u);
        if bounce == {bounce}u && p.is_alive && (at.x * 7919u + at.y * 104729u
            + sampler_p.sample_index * 1299709u) % 1009u == 17u {{
            p.radiance += vec3<f32>(0.0, {radiance}, 0.0);
        }}
        {watch}"
    );
    *path_trace = path_trace.replace(watch, &strike).into();
    // A sphere may hide a wall from a camera path: no roulette, and bounces that all can make.
    let settings =
        RenderSettings { roulette: false, max_bounces: Some(4), ..settings(SIDE, SIDE, SPP) };
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, &stage.scene, &settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        let picture = renderer.film().picture().rgb;
        (renderer.statistics().clone(), picture.into_iter().flatten().collect())
    })
}

/// Samples that are struck, and the first of them in the order in which pixels are folded.
fn struck() -> (u64, Vec<(u32, u32, u32)>) {
    let samples =
        (0..SPP).flat_map(|s| (0..SIDE).flat_map(move |y| (0..SIDE).map(move |x| (x, y, s))));
    let all: Vec<_> = samples.filter(|&(x, y, s)| is_struck(x, y, s)).collect();
    (all.len() as u64, all)
}

#[test]
fn a3_injected_faults_are_counted_located_and_leave_no_trace_in_the_picture() {
    let (count, places) = struck();
    assert!((8..64).contains(&count), "{count}");
    let quotient = "p.ray.t_max * 0.0 / (0.0 * p.throughput.x)";
    let overflow = "p.ray.t_max * p.ray.t_max";
    for (bounce, radiance, cause) in [
        (0, quotient, Fault::NonFinite),
        (2, overflow, Fault::NonFinite),
        (3, "-1e9", Fault::Negative),
    ] {
        let (statistics, picture) = render_with(bounce, radiance);
        let mut expected = [0; 4];
        expected[cause as usize] = count;
        let what = format!("{radiance} at bounce {bounce}");
        assert_eq!(statistics.faults, expected, "{what}");
        assert_eq!(statistics.samples, u64::from(SIDE * SIDE * SPP), "{what}");
        let first = statistics.first_fault.unwrap();
        assert!(places.contains(&(first.pixel.0, first.pixel.1, first.sample)), "{first:?}");
        assert_eq!(first.bounce, Some(bounce), "{what}");
        // Material of a wall or of the lamp: the last surface met.
        assert!(first.material.is_some_and(|m| m < 7), "{first:?}");
        assert!(picture.iter().all(|c| c.is_finite() && *c >= 0.0), "{what}");
    }
}

#[test]
fn a3_nothing_is_counted_where_nothing_is_wrong() {
    let (statistics, _) = render_with(0, "0.0");
    assert_eq!(statistics.faults, [0; 4]);
    assert_eq!(statistics.first_fault, None);
}
