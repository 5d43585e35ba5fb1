//! Functions of `shaders/`, each called for an array of inputs on the device, against
//! their twins in Rust or the same in f64.

#[path = "../common/mod.rs"]
mod common;

mod bsdf;
mod geometry;

use bytemuck::Pod;
use common::{Call, Random, harness};
use steradian::shader::Feature;

/// One call without a scene.
fn run<I: Pod, O: Pod>(
    kernel: (&'static str, &'static str),
    features: &[Feature],
    inputs: &[I],
    per_input: usize,
) -> Vec<O> {
    Call::new(kernel, features).run(inputs, per_input)
}
