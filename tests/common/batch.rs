//! Single functions of `shaders/`, called for an array of inputs on the device.

use super::with_device;
use bytemuck::Pod;
use steradian::RenderSettings;
use steradian::gpu::Batch;
use steradian::scene::Scene;
use steradian::shader::{Feature, Features, Library, library};

/// Threads of a harness kernel's workgroup.
const WORKGROUP: usize = 64;

/// A kernel of `tests/shaders/` with one thread for each input; its name and text.
macro_rules! harness {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/shaders/", $name, ".wgsl")),
        )
    };
}
pub(crate) use harness;

/// How a harness kernel is to be called.
#[derive(Clone)]
pub(crate) struct Call<'a> {
    harness: (&'static str, &'static str),
    library: Library,
    features: Features,
    scene: Option<(&'a Scene, &'a RenderSettings)>,
}

impl<'a> Call<'a> {
    pub(crate) fn new(harness: (&'static str, &'static str), features: &[Feature]) -> Self {
        let features = features.iter().fold(Features::default(), |set, &f| set.with(f));
        Self { harness, library: library(), features, scene: None }
    }

    /// With the buffers, uniforms and features of a scene.
    pub(crate) fn on(mut self, scene: &'a Scene, settings: &'a RenderSettings) -> Self {
        self.scene = Some((scene, settings));
        self
    }

    /// With modules from another library.
    pub(crate) fn with_library(mut self, library: Library) -> Self {
        self.library = library;
        self
    }

    /// Runs the kernel once for each of `inputs`, which it knows as `inputs`; their number is
    /// a multiple of 64. Gives what it wrote to `outputs`, `per_input` values for each.
    pub(crate) fn run<I: Pod, O: Pod>(&self, inputs: &[I], per_input: usize) -> Vec<O> {
        assert!(inputs.len().is_multiple_of(WORKGROUP));
        let (entry, text) = self.harness;
        let mut library = self.library.clone();
        library.insert(entry, text.into());
        let bytes = with_device(|device| {
            let batch = Batch {
                library: &library,
                entry,
                features: self.features,
                scene: self.scene,
                inputs: &[("inputs", bytemuck::cast_slice(inputs))],
                output: ("outputs", inputs.len() * per_input * size_of::<O>()),
                workgroups: (inputs.len() / WORKGROUP) as u32,
            };
            batch.run(&device).unwrap()
        });
        bytemuck::pod_collect_to_vec(&bytes)
    }
}
