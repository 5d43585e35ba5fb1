//! Random numbers and sequences, as the device draws them.

mod pairs;
mod sequences;
mod streams;
mod warps;

use crate::common::{Call, Stage, harness, lambert};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::settings::Sampler;

const SAMPLERS: [Sampler; 2] = [Sampler::Sobol, Sampler::Independent];

/// Which four numbers of which sample, as `sampler.wgsl` numbers them.
type Place = [u32; 3];

/// Column and row as a sampler's pixel.
fn pixel(x: u32, y: u32) -> u32 {
    x | y << 16
}

/// The numbers that paths draw at `places`.
fn draws(sampler: Sampler, places: &[Place]) -> Vec<[f32; 4]> {
    let mut stage = Stage::perspective(Vec3::Y, Vec3::ZERO, 1.0);
    stage.floor(Vec3::ZERO, 1.0, lambert(0.5));
    let settings = RenderSettings { sampler, light_samples: 3, ..RenderSettings::default() };
    Call::new(harness!("sampler"), &[]).on(&stage.scene, &settings).run(places, 1)
}

/// Pearson's correlation of two lists.
fn correlation(a: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = a.clone().count() as f64;
    let (sum_x, sum_y) = a.clone().fold((0.0, 0.0), |(x, y), (p, q)| (x + p, y + q));
    let (mean_x, mean_y) = (sum_x / n, sum_y / n);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (p, q) in a {
        let (p, q) = (p - mean_x, q - mean_y);
        xx += p * p;
        yy += q * q;
        xy += p * q;
    }
    xy / (xx * yy).sqrt()
}

/// A step of PCG-RXS-M-XS with 32 bits of state (O'Neill 2014), the common generator of shaders.
fn pcg_step(state: u32) -> u32 {
    state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453)
}
