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

/// Bounce at which a struck sample gets a radiance, the radiance, and what it is counted as. The
/// picture's seed is the index of the one that is injected, so that all need one kernel; of the
/// struck paths of these seeds none has ended at the lamp.
const STRIKES: [(u32, &str, Fault); 3] = [
    (3, "-1e9", Fault::Negative),
    (2, "p.ray.t_max * p.ray.t_max", Fault::NonFinite),
    (0, "p.ray.t_max * 0.0 / (0.0 * p.throughput.x)", Fault::NonFinite),
];

/// Renders a closed box in which every path goes on for five bounces, with the strike of that
/// index, if there is one, at the struck samples.
fn render_with(strike: usize) -> (RenderStatistics, Vec<f32>) {
    let mut stage = Stage::perspective(Vec3::ZERO, -Vec3::Z, 1.0);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let (u, v) = (axis.any_orthonormal_vector(), axis.cross(axis.any_orthonormal_vector()));
        stage.quad(axis * 2.0, v * 2.0, u * 2.0, lambert(0.9));
        stage.quad(axis * -2.0, u * 2.0, v * 2.0, lambert(0.9));
    }
    stage.sphere(Vec3::new(0.5, 1.0, -0.5), 0.2, emitter(1.0));
    let mut tuning = Tuning::default();
    let radiance = tuning.library.get_mut("path/radiance").unwrap();
    let watch = "fault_watch(p.radiance, bounce, material);\n        p.is_alive = p.is_alive";
    assert!(radiance.contains(watch));
    let strikes: String = (0..)
        .zip(STRIKES)
        .map(|(k, (bounce, radiance, _))| {
            format!(
                "if is_struck && frame.seed == {k}u && bounce == {bounce}u {{
                    p.radiance.y += {radiance};
                }}\n"
            )
        })
        .collect();
    let strikes = format!(
        "let at = vec2<u32>(sampler_p.pixel & 0xffffu, sampler_p.pixel >> 16u);
        let is_struck = p.is_alive && (at.x * 7919u + at.y * 104729u
            + sampler_p.sample_index * 1299709u) % 1009u == 17u;
        {strikes}{watch}"
    );
    *radiance = radiance.replace(watch, &strikes).into();
    // A sphere may hide a wall from a camera path: no roulette, and bounces that all can make.
    let settings = RenderSettings {
        roulette: false,
        max_bounces: Some(4),
        seed: strike as u32,
        ..settings(SIDE, SIDE, SPP)
    };
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
    for (k, (bounce, radiance, cause)) in STRIKES.into_iter().enumerate() {
        let (statistics, picture) = render_with(k);
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
    let (statistics, _) = render_with(STRIKES.len());
    assert_eq!(statistics.faults, [0; 4]);
    assert_eq!(statistics.first_fault, None);
}
