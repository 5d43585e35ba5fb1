//! Functions of `shaders/`, each called for an array of inputs on the device, against
//! their twins in Rust or the same in f64.

#[path = "../common/mod.rs"]
mod common;

mod bsdf;
mod geometry;
mod numbers;
mod stack;

use bytemuck::Pod;
use steradian::gpu::Batch;
use steradian::shader::{Feature, Features, library};

/// A kernel of `tests/shaders/` that calls `call(i)` for every invocation; its text.
macro_rules! harness {
    ($name:literal) => {
        ($name, include_str!(concat!("../shaders/", $name, ".wgsl")))
    };
}
pub(crate) use harness;

/// Threads of a harness kernel's workgroup.
const WORKGROUP: usize = 64;

/// Runs the kernel once for each of `inputs`, which it knows as `inputs`, and gives
/// what it wrote to `outputs`, `per_input` values for each.
fn run<I: Pod, O: Pod>(
    (entry, text): (&'static str, &'static str),
    features: &[Feature],
    inputs: &[I],
    per_input: usize,
) -> Vec<O> {
    assert!(inputs.len().is_multiple_of(WORKGROUP));
    let mut library = library();
    library.insert(entry, text);
    let features = features.iter().fold(Features::default(), |set, &f| set.with(f));
    let bytes = common::with_device(|device| {
        let batch = Batch {
            library: &library,
            entry,
            features,
            inputs: &[("inputs", bytemuck::cast_slice(inputs))],
            output: ("outputs", inputs.len() * per_input * size_of::<O>()),
            workgroups: (inputs.len() / WORKGROUP) as u32,
        };
        batch.run(&device).unwrap()
    });
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Random numbers: SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// Uniform in the cube from -1 to 1.
    fn in_cube(&mut self) -> glam::Vec3 {
        glam::Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// A unit vector, uniform.
    fn direction(&mut self) -> glam::Vec3 {
        loop {
            let v = self.in_cube().as_dvec3();
            let l = v.length();
            if l > 1e-3 && l <= 1.0 {
                return (v / l).as_vec3();
            }
        }
    }
}
