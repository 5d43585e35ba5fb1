//! The device, tiny scenes, and what a stochastic test needs to decide.

#![allow(
    dead_code,
    unused_imports,
    unused_macros,
    reason = "each test program uses a part of this"
)]

mod batch;
mod estimate;
mod random;
mod record;
mod stage;
mod world;

pub(crate) use batch::{Call, harness};
pub(crate) use estimate::{
    Estimate, STRIP, assert_agree, assert_constant, assert_truth, grey, strips,
};
pub(crate) use random::Random;
pub(crate) use record::{
    assert_at_least, assert_at_most, assert_naive_fails, report, report_above, report_below,
};
pub(crate) use stage::{Stage, box_mesh, emitter, lambert, quad_mesh, with_uvs};
pub(crate) use world::{BUILDERS, Primitive, World, items, random_ray, scene_of, soup};

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use steradian::film::Film;
use steradian::gpu::Device;
use steradian::scene::{Scene, gltf};
use steradian::{RenderSettings, Renderer};

/// Calls `use_it` with a device that no other test uses meanwhile: an error is reported to whoever
/// waits for a device next. Tests that run side by side have one each, because a device compiles
/// its kernels one after the other.
///
/// # Panics
/// Without one: a test on the device that does not run must not pass.
pub(crate) fn with_device<T>(use_it: impl FnOnce(Arc<Device>) -> T) -> T {
    static IDLE: Mutex<Vec<Arc<Device>>> = Mutex::new(Vec::new());
    let idle = || IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let open = || match Device::open(None) {
        Ok(device) => Arc::new(device),
        Err(error) => panic!("these tests need a Vulkan device: {error}"),
    };
    let taken = idle().pop();
    let device = taken.unwrap_or_else(open);
    let result = use_it(device.clone());
    idle().push(device);
    result
}

/// Settings of a picture of `width` by `height` pixels.
pub(crate) fn settings(width: u32, height: u32, spp: u32) -> RenderSettings {
    RenderSettings { resolution: (width, height), spp, ..RenderSettings::default() }
}

/// Renders all samples, and asserts what holds for every render: no fault, and
/// all samples taken, each with a ray at least.
pub(crate) fn render(scene: &Scene, settings: &RenderSettings) -> Film {
    with_device(|device| {
        let mut renderer = Renderer::new(device, scene, settings).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        let statistics = renderer.statistics();
        assert_eq!(statistics.faults, [0; 4], "first at {:?}", statistics.first_fault);
        let window = settings.window();
        let pixels = u64::from(window.width) * u64::from(window.height);
        assert_eq!(statistics.samples, pixels * u64::from(settings.spp));
        assert!(statistics.closest_rays >= statistics.samples);
        assert_eq!(renderer.film().least_samples(), settings.spp);
        renderer.film().clone()
    })
}

/// Path of a bundled scene: `scenes/NAME/LAST PART OF NAME.gltf`.
fn bundled_path(name: &str) -> PathBuf {
    let stem = name.rsplit('/').next().unwrap_or(name);
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    folder.join(format!("{stem}.gltf"))
}

/// A bundled scene.
pub(crate) fn bundled(name: &str) -> Scene {
    gltf::load(&bundled_path(name)).unwrap()
}

/// The radiance that a bundled scene says every pixel has.
pub(crate) fn bundled_truth(name: &str) -> f64 {
    let text = std::fs::read_to_string(bundled_path(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let truth = &json["scenes"][0]["extras"]["steradian"]["truth"]["radiance"];
    let [r, g, b] = [0, 1, 2].map(|k| truth[k].as_f64().unwrap());
    assert!(r == g && g == b, "{name}: a grey truth is expected");
    r
}
